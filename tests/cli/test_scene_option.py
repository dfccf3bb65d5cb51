"""Scenes on the command line: the option, the words, settings and plans of campaigns, and what is refused."""

import json
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from roadgpt.brief.plan import read_scene
from roadgpt.cli import app
from roadgpt.run import read_run

pytestmark = pytest.mark.usefixtures("no_workers")

PLAN = "straight 60; turn right 40 r60"
HARD = "truck ahead gap=30 v=50: brake 6; fog 60"
SAID = (
    "a truck ahead, at a gap of 30 metres, at 50 km/h, that brakes with 6 m/s2; fog with a visual range of 60"
)


def roadgpt(*words: object) -> Result:
    return CliRunner().invoke(app, [str(word) for word in words], prog_name="roadgpt")


@pytest.fixture(autouse=True)
def in_a_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_others_and_weather_are_told_and_driven() -> None:
    result = roadgpt("run", "--plan", "--no-plot", "--out", "out", f"{PLAN} && {HARD}")
    assert result.exit_code == 0, result.output
    assert SAID in result.output.replace("\n", " ")
    run = read_run(Path("out/runs/0001"))
    assert run.world.scene == read_scene(HARD)
    assert run.drive.others.actors[0].kind == "truck"


def test_a_scene_is_in_the_run_and_in_the_command_that_repeats_it() -> None:
    made = roadgpt(
        "run", "--plan", PLAN, "--scene", "night;wet", "--no-drive", "--no-plot", "--out", "out", "-q"
    )
    assert made.exit_code == 0, made.output
    run = read_run(Path("out/runs/0001"))
    assert run.world.scene == read_scene("night; wet")
    assert run.world.site.friction == 0.6
    assert (
        json.loads(Path("out/runs/0001/run.json").read_bytes())["request"]["world"]["scene"] == "night; wet"
    )
    plain = roadgpt(
        "run", "--plan", PLAN, "--no-drive", "--no-plot", "--out", "plain", "-q", "--seed", run.request.seed
    )
    assert plain.exit_code == 0, plain.output
    assert "scene" not in Path("plain/runs/0001/run.json").read_text("utf-8")
    roads = [Path(folder, "runs", "0001", "road.json").read_bytes() for folder in ("out", "plain")]
    assert roads[0] == roads[1]


def test_an_option_wins_over_the_words_and_this_is_said() -> None:
    result = roadgpt(
        "run", "--plan", f"{PLAN} && dense", "--scene", "light", "--no-drive", "--no-plot", "--out", "out"
    )
    assert result.exit_code == 0, result.output
    assert "but the scene 'light' is set and used" in result.output
    assert read_run(Path("out/runs/0001")).world.scene == read_scene("light")


def test_a_surface_is_never_left_out_in_silence() -> None:
    assert (
        roadgpt(
            "run", "--plan", PLAN, "--no-drive", "--no-plot", "--out", "out", "-q", "--friction", 0.7
        ).exit_code
        == 0
    )
    road = "out/runs/0001/road.json"
    told = roadgpt("drive", road, "--scene", "ice", "--out", "icy")
    assert "the surface of --scene goes before the friction 0.7 of the file" in told.output
    assert read_run(Path("icy/runs/0001")).world.site.friction == 0.1
    told = roadgpt("drive", road, "--scene", "ice", "--friction", 0.8, "--out", "typed")
    assert "friction 0.8 is set and goes before 'ice' of the scene" in told.stderr
    assert read_run(Path("typed/runs/0001")).world.site.friction == 0.8


def test_words_and_a_scene_that_exclude_each_other_are_refused() -> None:
    result = roadgpt("run", "--plan", f"{PLAN} | oneway", "--scene", "oncoming light", "--no-drive")
    assert result.exit_code == 2
    assert "oncoming traffic needs an oncoming lane" in result.stderr


def test_reading_tells_the_scene() -> None:
    told = roadgpt("read", "--plan", f"{PLAN} && {HARD}", "--table").output
    assert f"; {SAID}" in told
    data = json.loads(roadgpt("read", "--plan", f"{PLAN} && {HARD}", "--json").output)
    assert data["plan"].endswith(" && truck ahead gap=30 v=50: brake decel=6; fog 60")


def test_settings_and_plans_of_campaigns_have_scenes() -> None:
    Path("roadgpt.toml").write_text("[world]\nscene = 'dense; night'", encoding="utf-8")
    shown = json.loads(roadgpt("config", "show", "--json").output)
    assert "dense; night" in json.dumps(shown)
    assert "dense" in roadgpt("run", "--plan", PLAN).stderr
    Path("roadgpt.toml").write_text("[world]\nscene = 'crowded'", encoding="utf-8")
    assert "a scene has no 'crowded'" in roadgpt("run", "--plan", PLAN).stderr
    Path("roadgpt.toml").unlink()
    table = "prompts = '{}'\nreader = 'plan'\ntests = 1\ndrive = false\n[world]\nscene = '{}'"
    Path("bad.toml").write_text(table.format(PLAN, "crowded"), encoding="utf-8")
    assert "a scene has no 'crowded'" in roadgpt("campaign", "bad.toml").stderr
    Path("plan.toml").write_text(table.format(PLAN, "medium"), encoding="utf-8")
    made = roadgpt("campaign", "plan.toml", "--out", "out")
    assert made.exit_code == 0, made.output
    again = roadgpt("campaign", "plan.toml", "--out", "out")
    assert again.exit_code == 0, again.output
    Path("plan.toml").write_text(table.format(PLAN, "light"), encoding="utf-8")
    assert roadgpt("campaign", "plan.toml", "--out", "out").exit_code == 2


def test_a_scene_beside_words_is_told() -> None:
    result = roadgpt("run", "--plan", PLAN, "--scene", "light", "--no-drive", "--no-plot", "--out", "out")
    assert "note: on the road: light traffic (5 vehicles for each km of a lane)" in result.output


def test_rain_beside_words_sets_the_friction_and_says_so() -> None:
    result = roadgpt("run", "--plan", PLAN, "--scene", "rain 5", "--no-drive", "--no-plot", "--out", "out")
    assert "note: on the road: rain of 5 mm/h; friction 0.6" in result.output
    assert read_run(Path("out/runs/0001")).world.site.friction == 0.6


def test_the_scene_of_a_run_that_is_driven_again_is_told_whatever_names_the_run() -> None:
    roadgpt("run", "--plan", "straight 20", "--scene", "fog 60", "--no-drive", "--no-plot", "--out", "out")
    names = ("out/1", "out/runs/0001", "out/runs/0001/road.json")
    said = roadgpt("drive", *names).output
    for name in names:
        assert f"{name}: the scene of the run is left out; give it with --scene 'fog 60'" in said
    assert "left out" not in roadgpt("drive", names[1], "--scene", "fog 60").output
    assert "left out" not in roadgpt("check", names[1]).output
