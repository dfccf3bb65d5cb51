"""`roadgpt show` of a Run: what became of it, and the lines that make it again."""

import shlex
from dataclasses import replace
from pathlib import Path

import click
import pytest
from hypothesis import given
from hypothesis import strategies as st

from roadgpt.cli import app
from roadgpt.cli.options import SETUP, world_of
from roadgpt.cli.repeat_commands import replay_lines
from roadgpt.cli.summary import text_lines
from roadgpt.drive.loading import absolute_spec
from roadgpt.road import CrossSection, Limits, Road, Site, World
from roadgpt.run import Request, Run, Setup, prove, write_run
from run.doubles import folder_of

WORDS = "a road with 'quotes', $money & 3 turns"
PLACE = Path("x/runs/0004")


def a_run(request: Request, index: int = 4) -> Run:
    return Run(request, index, 11, road=Road.through([[40, 100], [90, 100], [140, 100]]))


def parsed(line: str) -> click.Context:
    """What the command line makes of a line, in ``params``."""
    roadgpt, name, *rest = shlex.split(line)
    assert roadgpt == "roadgpt"
    command = app.get_command(click.Context(app, **app.context_settings), name)
    assert command is not None
    return command.make_context(name, rest, click.Context(app, **app.context_settings))


def test_show_tells_what_happened_and_how_to_make_it_again(tmp_path: Path) -> None:
    driven = prove(Road.through([[40, 100], [90, 100], [140, 100]]), 11)
    named = replace(driven, request=driven.request.model_copy(update={"words": WORDS}), rounds=2)
    text = "\n".join(text_lines(write_run(named, tmp_path)))
    assert text.startswith(f"PASS: {driven.description}")
    assert "\n".join(text_lines(tmp_path / "test.0001.json")) == text
    for said in ("2 drafts", "roadgpt drive", "--seed 11", WORDS):
        assert said in text


def test_a_line_names_only_what_differs() -> None:
    (plain,) = replay_lines(a_run(Request(words=WORDS, seed=3)))
    assert plain == f"roadgpt run {shlex.quote(WORDS)} -n 4 --seed 3"
    odd = Request(
        words="a road",
        seed=2,
        world=World(
            limits=Limits(speed_limit=100 / 3.6), site=Site(friction=0.35), section=CrossSection(shoulder=0)
        ),
        setup=Setup(designer="thesis", driver="a b.py:D", geometry="spline", keep_driving=True, rules="sbft"),
    )
    line, again = replay_lines(a_run(odd), PLACE)
    assert line.startswith("roadgpt run 'a road' -n 4 --seed 2 --designer thesis --driver 'a b.py:D' ")
    assert line.endswith(" --speed-limit 100 --shoulder 0 --friction 0.35")
    assert again == (
        f"roadgpt drive {PLACE / 'road.json'} --seed 11 --driver 'a b.py:D' --keep-driving --rules sbft "
        "--speed-limit 100 --shoulder 0 --friction 0.35"
    )


SETUPS = st.builds(
    Setup,
    reader=st.sampled_from(["plan", "own"]),
    designer=st.sampled_from(["planner", "own"]),
    rules=st.sampled_from(["strict", "sbft"]),
    driver=st.sampled_from(["beamng_like", "my file.py:D"]),
    geometry=st.sampled_from(["arcs", "spline"]),
    keep_driving=st.booleans(),
    drives=st.booleans(),
)
WORLDS = st.builds(
    World().changed,
    map_size=st.floats(50, 10_000),
    speed_limit=st.floats(5, 300).map(lambda kmh: kmh / 3.6),
    oob_tolerance=st.floats(0.01, 1),
    shoulder=st.floats(0, 100),
    friction=st.floats(0.01, 2),
)


@given(SETUPS, st.just(World()) | WORLDS, st.sampled_from([WORDS, "-5 % slope", "--help me", "a road"]))
def test_the_command_line_reads_from_the_lines_what_the_run_was_made_with(
    setup: Setup, world: World, words: str
) -> None:
    lines = replay_lines(a_run(Request(words=words, seed=5, world=world, setup=setup)), PLACE)
    ctx = parsed(lines[0])
    params = ctx.params
    assert (params["words"], params["roads"], params["seed"]) == ((words,), 4, 5)
    with ctx:
        assert world_of(params) == world
    assert params["no_drive"] is not setup.drives
    driver = absolute_spec(setup.driver, Path.cwd())
    assert {flag.field: params[flag.field] for flag in SETUP} == {
        flag.field: driver if flag.field == "driver" else getattr(setup, flag.field) for flag in SETUP
    }
    assert len(lines) == 1 + setup.drives
    for line in lines[1:]:
        ctx = parsed(line)
        params = ctx.params
        assert (params["files"], params["seed"]) == ((str(PLACE / "road.json"),), 11)
        with ctx:
            assert world_of(params) == world
        for field in ("simulator", "rules", "keep_driving"):
            assert params[field] == getattr(setup, field)
        assert params["driver"] == absolute_spec(setup.driver, Path.cwd())


def test_a_campaign_tells_of_roads_that_cannot_be_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def one(index: int, earlier: object) -> Run:
        return replace(a_run(Request(seed=1), index), seed=index)

    list(folder_of(Request(seed=1), 3, tmp_path, one, patch=monkeypatch.setattr))
    (tmp_path / "runs" / "0002" / "run.json").write_text("{")
    (tmp_path / "runs" / "0003" / "run.json").unlink()
    (tmp_path / "test.0003.json").unlink()
    lines = [*text_lines(tmp_path)]
    assert "cannot be read" in lines[3]
    assert lines[-1] == "1 VALID, 2 unreadable"
