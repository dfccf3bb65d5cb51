"""What the words say about the surface sets the friction: in every way from words to a drive, and said."""

import csv
import json
import logging
import re
from functools import partial
from itertools import islice
from pathlib import Path
from types import SimpleNamespace

import pytest
from click.testing import CliRunner, Result

from page_words import words_of
from roadgpt.brief import Brief, exactly, read, remarks, sentence
from roadgpt.brief.beside import IN_SCENES
from roadgpt.brief.plan import read_scene
from roadgpt.brief.scene import Scene, scene_text
from roadgpt.campaign.lifecycle import begin, work
from roadgpt.campaign.model import CellBudget
from roadgpt.campaign.plan import Plan, read_plan
from roadgpt.campaign.record import Record
from roadgpt.campaign.run_folder import campaign
from roadgpt.cli import app
from roadgpt.cli.options import WORLD
from roadgpt.design.room import world_for
from roadgpt.errors import UsageError
from roadgpt.road import Limits, Road, Site, World
from roadgpt.run import Setup, perform, prove, read_run
from roadgpt_gym.lane_keeping import LaneKeeping
from roadgpt_sbft import RoadGPTTestGenerator

WET, ICE, DRY = "turn x2 | beside(wet)", "turn x2 | beside(wet, ice)", "turn x2"
PLANS = Setup(reader="plan", drives=False)
USED = "the words say 'wet': friction is 0.6; --friction gives another"
SET = "the words say 'wet', but friction is {}: the surface in the words is not used"


def roadgpt(*words: object) -> Result:
    result = CliRunner().invoke(app, [str(word) for word in words], prog_name="roadgpt")
    assert result.exit_code == 0, result.output
    return result


@pytest.fixture(autouse=True)
def in_a_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_the_slipperiest_surface_counts_and_every_one_is_said() -> None:
    three = Brief(turns=exactly(3), beside=("ice", "night", "snow", "wet"))
    assert three.friction == 0.1
    assert Brief(beside=("snowfall", "gravel")).friction is None
    assert sentence(three) == "A road with 3 turns; on a wet road; on a snowy road; on an icy road."
    assert remarks(three, 250)[1] == (
        "the words say 'wet', 'snow' and 'ice': the lowest friction counts, 0.1"
    )
    assert remarks(Brief(beside=("wet",)), 250, 0.6, (), False) == (USED,)
    assert remarks(Brief(beside=("wet",)), 250, 1.0) == (SET.format(1),)
    assert remarks(Brief(beside=("wind",)), 250) == ("wind is not built; the road is made without it",)


@pytest.mark.parametrize("name", IN_SCENES)
def test_what_a_scene_can_have_is_not_told_to_be_unbuilt(name: str) -> None:
    """The scene that the remark proposes is one, and all that was said is in it."""
    (said,) = remarks(Brief(beside=(name,)), 250)
    (proposed,) = re.findall(r"; --scene '([^']+)' adds it$", said)
    assert "yet" not in said
    assert scene_text(read_scene(proposed))


def test_rain_and_fog_of_the_words_are_driven_in_and_rain_makes_the_road_wet() -> None:
    """Rain from 2.5 to 7.6 mm/h is moderate (Glossary of Meteorology), fog below 200 m is thick."""
    found = world_for(Brief(beside=("rain", "fog")), World())
    assert [str(each.amount) for each in found.scene.weather] == ["50 to 200", "2.5 to 7.6"]
    assert found.site.friction == 0.6
    assert world_for(Brief(beside=("rain", "ice")), World()).site.friction == 0.1
    given = world_for(Brief(beside=("rain", "fog")), World(scene=read_scene("rain 20")))
    assert [str(each.amount) for each in given.scene.weather] == ["50 to 200", "20"]
    none = world_for(Brief(beside=("rain", "fog", "snow")), World(scene=Scene()))
    assert none == World(scene=Scene())


@pytest.mark.parametrize(("name", "friction"), [("wet", 0.6), ("snow", 0.35), ("ice", 0.1)])
def test_a_world_takes_the_friction_unless_it_was_given_one(name: str, friction: float) -> None:
    brief = Brief(beside=(name,))
    assert World().on_surface_of(brief) == World(site=Site(friction=friction))
    other = World(site=Site(map_size=400), limits=Limits(speed_limit=10))
    assert other.on_surface_of(brief) == other.changed(friction=friction)
    assert other.changed(shoulder=1).on_surface_of(brief).site.friction == friction
    for given in (
        World(site=Site(friction=1.0)),
        World().changed(friction=1.0),
        World().changed(friction=1.0).changed(map_size=300),
        World.model_validate({"friction": 1.0}),
        World.model_validate_json(World().model_dump_json()),  # a file says what was used
    ):
        assert given.on_surface_of(brief).site.friction == 1.0
    assert (World().on_surface_of(Brief()), World().on_surface_of(None)) == (World(), World())


def test_python_drives_on_the_surface_of_the_words() -> None:
    wet, dry = (perform(words, 3, World(), Setup(reader="plan")) for words in (WET, DRY))
    given = perform(WET, 3, World(site=Site(friction=1.0)), Setup(reader="plan"))
    assert (wet.world.site.friction, dry.world.site.friction, given.world.site.friction) == (0.6, 1.0, 1.0)
    assert wet.design == dry.design == given.design
    slippery = perform(DRY, 3, World(site=Site(friction=0.6)), Setup(reader="plan"))
    drives = [run.drive and run.drive.to_bytes() for run in (wet, slippery, dry, given)]
    assert drives[0] == drives[1] != drives[2] == drives[3]
    again = prove(Road.through([[40, 100], [90, 100], [140, 100]]), setup=PLANS, brief=wet.brief)
    assert again.world.site.friction == 0.6


def test_run_says_it_writes_it_and_repeats_it(tmp_path: Path) -> None:
    said = roadgpt("run", "--plan", WET, "-n", 2, "--seed", 7, "--no-plot", "--out", "a").stdout
    assert f"note: {USED}" in said
    assert "on a wet road" in said.splitlines()[0]
    card = json.loads(Path("a/runs/0001/run.json").read_text())
    assert card["remarks"] == [USED.partition("; --")[0]]
    assert card["request"]["world"]["friction"] == 0.6
    with Path("a/experiment_description.csv").open() as file:
        assert next(csv.DictReader(file))["friction"] == "0.6"
    shown = roadgpt("show", "a/runs/0002").stdout
    assert USED.partition("; --")[0] in shown
    assert shown.count("--friction 0.6") == 2  # from the words, and from the road's file
    # the same command goes on in its folder, and another friction does not
    assert "all 2 roads are there" in roadgpt("run", "--plan", WET, "-n", 2, "--out", "a").stdout
    other = CliRunner().invoke(app, ["run", "--plan", WET, "-n", "2", "--out", "a", "--friction", "1"])
    assert other.exit_code == 2
    assert "holds other roads (different friction)" in other.output
    # resumed, it keeps the friction
    before = Path("a/runs/0002/drive.npz").read_bytes()
    Path("a/test.0002.json").unlink()
    roadgpt("resume", "a")
    assert Path("a/runs/0002/drive.npz").read_bytes() == before
    assert read_run("a/runs/0002").world.site.friction == 0.6


@pytest.mark.parametrize("how", ["option", "file", "environment"])
def test_a_friction_of_the_person_wins_and_is_repeated(how: str, monkeypatch: pytest.MonkeyPatch) -> None:
    option: list[object] = []
    if how == "option":
        option = ["--friction", 1]
    elif how == "file":
        Path("roadgpt.toml").write_text("[world]\nfriction = 1.0\n")
    else:
        monkeypatch.setenv("ROADGPT_FRICTION", "1.0")
    said = roadgpt("run", "--plan", WET, "--seed", 7, "--no-plot", "--no-drive", "--out", "a", *option).stdout
    assert f"note: {SET.format(1)}" in said
    assert read_run("a/runs/0001").world.site.friction == 1.0
    assert SET.format(1) in roadgpt("read", "--plan", WET, *option).stdout
    monkeypatch.delenv("ROADGPT_FRICTION", raising=False)
    Path("roadgpt.toml").unlink(missing_ok=True)
    (again,) = [line for line in roadgpt("show", "a/runs/0001").stdout.splitlines() if " again " in line]
    assert again.endswith("--friction 1 --no-drive")
    assert USED in roadgpt("read", "--plan", WET).stdout


def test_the_reading_as_json_has_the_friction() -> None:
    told = json.loads(roadgpt("read", "--plan", ICE, "--json").stdout)
    assert told["friction"] == 0.1
    assert told["sentence"] == "A road with 2 turns; on a wet road; on an icy road."
    assert json.loads(roadgpt("read", "--plan", DRY, "--json").stdout)["friction"] == 1.0


def test_the_conversation_says_it(monkeypatch: pytest.MonkeyPatch) -> None:
    Path("roadgpt.toml").write_text('[run]\nreader = "plan"\n')
    monkeypatch.setattr("roadgpt.brief.read", partial(read, reader="plan"))
    said = CliRunner().invoke(app, [], input=f"{WET}\n1\nexit\n").stdout
    assert "on a wet road" in said
    assert f"note: {USED}" in said


FILE = """
prompts = ["turn x2 | beside(wet)", "turn x2", "turn x2 | beside(wet, ice)"]
reader = "plan"
tests = 2
"""


@pytest.mark.usefixtures("no_workers")
def test_each_cell_of_a_campaign_has_the_friction_of_its_words() -> None:
    Path("p.toml").write_text(FILE)
    said = roadgpt("campaign", "p.toml", "--out", "c").stdout
    assert f"note: {WET}: {USED}" in said
    assert f"note: {DRY}:" not in said
    with Path("c/cells.csv").open() as file:
        assert [row["friction"] for row in csv.DictReader(file)] == ["0.6", "1.0", "0.1"]
    with Record.opened(Path("c")) as record:
        assert [cell.request.world.site.friction for cell in record.cells()] == [0.6, 1.0, 0.1]
    assert {run.world.site.friction for run in (read_test("c/c01/1"), read_test("c/c01/2"))} == {0.6}
    roadgpt("report", "c", "--junit", "c.xml")
    with Path("c/tables/outcomes.csv").open() as file:
        assert [row["friction"] for row in csv.DictReader(file)] == ["0.6", "1", "0.1"]
    frictions = re.findall(r'"friction" value="([^"]+)"', Path("c.xml").read_text())
    assert frictions == ["0.6", "1", "0.1"]
    # resumed it is the same campaign; with a friction of one's own it is another
    assert "resuming in c" in roadgpt("campaign", "p.toml", "--out", "c").stdout
    Path("p.toml").write_text(FILE + "[world]\nfriction = 1.0\n")
    assert read_plan(Path("p.toml")).plan.world == World()
    other = CliRunner().invoke(app, ["campaign", "p.toml", "--out", "c"])
    assert other.exit_code == 2
    assert "another campaign (different friction)" in other.output
    Path("p.toml").write_text(FILE + "drive = false\n[world]\nfriction = 1.0\n")
    said = roadgpt("campaign", "p.toml", "--out", "d").stdout
    assert f"note: {WET}: {SET.format(1)}" in said
    with Path("d/cells.csv").open() as file:
        assert {row["friction"] for row in csv.DictReader(file)} == {"1.0"}


def read_test(name: str):  # type: ignore[no-untyped-def]
    from roadgpt.cli.roads import roads_named

    (named,) = roads_named([name], None)
    assert named.run is not None
    return named.run()


@pytest.mark.usefixtures("no_workers")
def test_a_campaign_of_one_description_says_it_and_its_report_repeats_it() -> None:
    words = [WET, "--reader", "plan", "-n", 2, "--no-drive"]
    assert f"note: {USED}" in roadgpt("campaign", *words, "--out", "c").stdout
    assert f"note: {SET.format('0.9')}" in roadgpt("campaign", *words, "--friction", 0.9, "--out", "d").stdout
    for folder, friction in (("c", 0.6), ("d", 0.9)):
        roadgpt("report", folder)
        assert f"--friction {friction}" in words_of(folder)


@pytest.mark.usefixtures("no_workers")
def test_campaigns_from_python_take_it(tmp_path: Path) -> None:
    (run,) = campaign(WET, 1, 3, setup=PLANS, out=tmp_path / "a")
    assert run.world.site.friction == 0.6
    plan = Plan(prompts=(WET,), reader="plan", drives=False, budget=CellBudget(tests=1))
    begin(plan, tmp_path / "b")
    assert sum(1 for _ in work(tmp_path / "b"))
    with Record.opened(tmp_path / "b") as record:
        assert record.cells()[0].request.world == World(site=Site(friction=0.6))


def test_a_study_makes_each_part_on_its_surface_and_says_so() -> None:
    lines = [{"id": str(n), "prompt": words} for n, words in enumerate([WET, DRY], 1)]
    Path("p.jsonl").write_text("".join(json.dumps(line) + "\n" for line in lines))
    words = ["study", "alignment", "p.jsonl", "-n", 1, "--reader", "plan", "--no-plot", "--workers", 1]
    said = roadgpt(*words, "--out", "s").stdout
    assert said.count(USED) == 1
    cards = [json.loads(path.read_text()) for path in sorted(Path("s").rglob("run.json"))]
    assert [card["request"]["world"]["friction"] for card in cards] == [0.6, 1.0]
    assert "0.6 and 1, by what the words say" in words_of("s")
    assert "--friction" not in json.loads(Path("s/study.json").read_text())["command"]
    assert SET.format(1) in roadgpt(*words, "--out", "t", "--friction", 1).stdout
    assert "--friction 1 " in json.loads(Path("t/study.json").read_text())["command"]


def test_a_simulator_that_cannot_apply_it_is_refused_with_what_to_give(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    setup = Setup(reader="plan", simulator="beamng")
    said = "friction 0.6 has no effect in this simulator.*give --friction 1"
    with pytest.raises(UsageError, match=said):
        perform(WET, 1, World(), setup)
    with pytest.raises(UsageError, match=said):
        campaign(WET, 1, 1, World(), setup, tmp_path / "a")
    plan = Plan(prompts=(DRY, WET), reader="plan", simulators=("beamng",), budget=CellBudget(tests=1))
    with pytest.raises(UsageError, match=said):
        begin(plan, tmp_path / "b")
    assert not (tmp_path / "b").exists()


def test_an_episode_of_the_environment_has_the_surface_of_its_description() -> None:
    def friction(world: dict[str, float], words: str) -> float:
        env = LaneKeeping(DRY, reader="plan", world=world)
        frictions = []
        for prompt in (words, DRY):
            _, told = env.reset(seed=1, options={"prompt": prompt})
            assert ("on a wet road" in told["understood"]) == (prompt == WET)
            frictions.append(env._vehicle._ground.friction)
        assert frictions[1] == world.get("friction", 1.0)  # the next road is dry again
        return float(frictions[0])

    assert friction({}, WET) == 0.6
    assert friction({"friction": 1.0}, WET) == 1.0


def test_the_generator_of_the_competition_says_that_it_cannot(caplog: pytest.LogCaptureFixture) -> None:
    class Slippery(RoadGPTTestGenerator):
        description, reader = WET, "plan"

    with caplog.at_level(logging.WARNING, logger="roadgpt"):
        assert len([*islice(Slippery(SimpleNamespace()).roads(), 1)]) == 1
    assert "the surface in the words is not used" in caplog.text


def test_the_figures_of_the_help_are_those_of_the_table() -> None:
    (option,) = [flag for flag in WORLD if flag.field == "friction"]
    assert option.help is not None
    for name in ("wet", "snow"):
        assert f"{name} {read(f'turn | beside({name})', 'plan').friction:g}" in option.help
