"""What a format cannot show rightly is said by name and place, and only then."""

import json
from pathlib import Path
from typing import Literal

import pytest
from click.testing import CliRunner

from exported import ROADS, WORLD
from network.changing import passing
from profiled import bend
from roadgpt import plugins
from roadgpt.cli import app
from roadgpt.export import doubts
from roadgpt.network import read_road
from roadgpt.road import Design, Profile, Road, Segment, build

ROUTE = passing("crossroads", "left")


@pytest.mark.parametrize("name", ROADS)
def test_roads_that_every_format_can_show_raise_no_doubt(name: str) -> None:
    formats = ["opendrive", "lanelet2", "geojson", "csv", "gltf", "beamng", "crg"]
    assert doubts(ROADS[name], formats, WORLD) == ()


@pytest.mark.parametrize(
    ("format_", "road", "words"),
    [
        ("sumo", bend(30, ends=True), "sumo: changes of width left out"),
        ("commonroad", ROADS["arcs"], "commonroad: heights left out"),
        ("crg", ROADS["arcs"].with_profile(Profile.of(1, 1, 4.0, 30.0)), "no room for the shoulders"),
    ],
)
def test_what_a_format_has_no_place_for_is_said(format_: str, road: Road, words: str) -> None:
    assert any(words in each for each in doubts(road, [format_], WORLD))


@pytest.mark.parametrize("side", ["left", "right"])
@pytest.mark.parametrize("name", sorted(plugins.names("exporters")))
def test_a_bend_to_either_side_raises_the_same_doubts(name: str, side: Literal["left", "right"]) -> None:
    """A bend of 14 m of radius, between straights, with 19 m of lane and shoulder on both sides."""
    turn = Segment(distance=17, direction=side, turn_degrees=70 if side == "left" else -70)
    straight = Segment(distance=40, direction="straight")
    road = build(Design(starting_point=(0, 0, 0), theta=0, segments=(straight, turn, straight)))
    said = doubts(road.with_profile(Profile.of(1, 1, 4.0, 15.0)), [name], WORLD)
    assert any("no room for the shoulders" in each for each in said) == (name == "crg")
    assert any("at s = " in each for each in said) == (name not in ("csv", "sbft"))


def test_the_command_says_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("tight.json").write_text(json.dumps(bend(3.0).to_json()))
    assert read_road("tight.json").length == pytest.approx(bend(3.0).length)
    for words, is_said in (([], True), (["-q"], False)):
        result = CliRunner().invoke(app, ["export", "tight.json", "--to", "lanelet2,csv", *words])
        assert result.exit_code == 0
        assert ("tight.json: lanelet2: at s = 3" in result.stderr) == is_said


OTHERS = "others on the road"
LEAVE_OUT = sorted({*plugins.names("exporters")} - {"openscenario", "heightmap"})
SCENE = "truck ahead gap=30 v=50: brake decel=6; fog 60"


@pytest.fixture(scope="module")
def among_others(tmp_path_factory: pytest.TempPathFactory) -> Path:
    here = tmp_path_factory.mktemp("among")
    out, plan = str(here / "out"), f"straight 60; turn right 40 r60 && {SCENE}"
    assert CliRunner().invoke(app, ["run", "--plan", "--no-plot", "--out", out, plan]).exit_code == 0
    return here


@pytest.mark.parametrize(
    ("command", "told"),
    [
        *((f"export --to {name}", f"{name}: {OTHERS} left out") for name in LEAVE_OUT),
        ("export --to openscenario", None),
    ],
)
def test_who_is_left_out_is_told(
    command: str, told: str | None, among_others: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(among_others)
    result = CliRunner().invoke(app, [*command.split(), "out/1"])
    assert result.exit_code == 0, result.output
    said = result.stderr.replace("\n", " ")
    assert "left out" not in said if told is None else told in said


def test_who_is_left_out_is_told_also_where_nobody_has_driven() -> None:
    world = WORLD.changed(scene="car parked")
    for name in LEAVE_OUT:
        assert f"{name}: {OTHERS} left out" in doubts(ROADS["flat points"], [name], world)
    assert doubts(ROADS["flat points"], ["openscenario"], world) == ()


def test_a_format_that_refuses_keeps_no_other_from_being_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("crossing.json").write_text(json.dumps(ROUTE.to_json()))
    command = ["export", "crossing.json", "--to", "sumo,opendrive,crg,csv", "--out", "out"]
    result = CliRunner().invoke(app, command)
    assert result.exit_code == 1
    refused = "crossing.json: sumo cannot hold junctions yet; opendrive can, and netconvert reads it"
    assert f"{refused}; crg cannot hold junctions yet; opendrive can" in result.stderr
    assert {path.suffix for path in Path("out").iterdir()} == {".xodr", ".json", ".csv"}
    assert result.stdout.split() == [f"out/crossing.{end}" for end in ("route.json", "xodr", "csv")]
