"""Commands that commands print are complete: they can be typed as they are."""

from pathlib import Path

import pytest
from click.testing import CliRunner

from hints import HintCollector, kind_of, shortened
from roadgpt.brief.plan import read_plan
from roadgpt.campaign import single_test
from roadgpt.cli import app
from roadgpt.cli.commands.make import all_remarks
from roadgpt.design.room import world_for
from roadgpt.road import World

STRAIGHT_ON = """
from roadgpt.drive import Command
class Mine:
    def steer(self, view):
        return Command(0.0, 0.5 if view.speed < 9 else 0.0, 0.0)
"""
WORDS = ("turn left 80 r=20", "--reader", "plan", "--seed", "3", "--driver", "mine.py:Mine")


@pytest.mark.usefixtures("no_workers")
def test_a_driver_of_ones_own_goes_through_every_command_that_is_printed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, hints: HintCollector
) -> None:
    here = tmp_path / "a b"
    here.mkdir()
    (here / "mine.py").write_text(STRAIGHT_ON)
    monkeypatch.chdir(here)
    honest, before = single_test.drafted, len(hints.printed)

    def stopped(words, seed, world, setup, index, *rest):  # type: ignore[no-untyped-def]
        if index == 2:
            raise KeyboardInterrupt
        return honest(words, seed, world, setup, index, *rest)

    def invoke(*words: str) -> int:
        return CliRunner().invoke(app, words, prog_name="roadgpt").exit_code

    with monkeypatch.context() as patch:
        patch.setattr(single_test, "drafted", stopped)
        limits = ("--fail-on", "error,5%", "--junit", "tests of it.xml")
        assert invoke("run", *WORDS, "-n", "2", "--no-plot", "--out", "r", *limits) == 130
        assert invoke("campaign", *WORDS, "-n", "2", "--out", "c", *limits) == 130
    for words in (("show", "r/1"), ("show", "c/c01/1"), ("show", "c"), ("report", "c"), ("resume", "c")):
        assert invoke(*words, *WORDS[-2:] * (words[0] == "resume")) == 0
    driver = f"{here}/mine.py:Mine"
    printed = {kind_of(words): words for words in hints.printed[before:]}
    typed = {
        f"{words[1]}{' --again' * ('--again' in words)}": words
        for words in printed.values()
        if words[1] not in ("view", "show")
    }
    assert {*typed} == {"campaign", "drive", "drive --again", "faults", "resume", "run"}
    for words in (words for words in printed.values() if words[1] not in ("view", "show")):
        assert words[words.index("--driver") + 1] == driver
    resumed = [words for words in printed.values() if "tests of it.xml" in words]
    assert [words[words.index("--fail-on") + 1 : -2] for words in resumed] == [["ERROR", "--fail-on", "5%"]]
    assert hints.type(resumed[0][1:]).exit_code == 6
    for words in typed.values():
        done = hints.type(shortened(words[1:]))
        assert done.exit_code in (0, 6), done.output
    without = hints.type([word for word in typed["faults"][1:] if word not in ("--driver", driver)])
    assert without.exit_code == 2
    assert f"name it yourself: --driver '{driver}'" in without.stderr


@pytest.mark.parametrize(
    ("plan", "option", "values"),
    [
        ("turn x2 | beside(snow)", "--friction", {"friction": 0.35}),
        ("turn x2 && ice", "--friction", {"friction": 0.1}),
        ("turn x2 && rain 5", "--friction", {"friction": 0.8}),
        ("turn x2 | map_size=500", "--map-size", {"map_size": 500.0}),
        ("straight 2000", "--map-size", {"map_size": 2500.0}),
        ("turn x2 | lanes=2", "--lanes", {"lanes": "2+1"}),
        ("turn x2 | beside(lanes)", "--lanes", {"lanes": "2+1"}),
        ("turn x2 | beside(lane_width)", "--lane-width", {"lane_width": 3.2}),
        ("turn x2 | beside(bank)", "--bank", {"bank": "auto"}),
        ("turn x2 | beside(speed)", "--speed-limit", {"speed_limit": 25.0}),
        ("turn x2 | speed=80", "--speed-limit", {"speed_limit": 25.0}),
    ],
)
def test_no_option_is_proposed_that_was_just_typed(plan: str, option: str, values: dict[str, object]) -> None:
    brief, usual, typed = read_plan(plan), World(), World().changed(**values)
    told, again = (" ".join(all_remarks(brief, world_for(brief, each), each)) for each in (usual, typed))
    assert option in told
    assert option not in again
