"""A map that nobody gave grows with the road that is asked for; one that was given is kept."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from design.short_searches import short_searches
from roadgpt.brief.model import Brief
from roadgpt.brief.plan import read_plan
from roadgpt.check import inspect
from roadgpt.cli import app
from roadgpt.design import draft
from roadgpt.design.room import map_remark, world_for
from roadgpt.errors import RoadGPTError
from roadgpt.network import build_route
from roadgpt.road import Design, Site, World, build
from roadgpt.run import Setup, brief_of, perform

PLAN = Setup(reader="plan", drives=False)
TOO_LARGE = (
    "straight len=700",
    "turn right gentle | len=700",
    "turn x11 alternating | len=850",
    "serpentine x8 sweeping",
    "hairpin left; straight len=300; hairpin right; straight len=300; hairpin left",
    "| turns=0 up pct=3 len=500",
)


@pytest.mark.parametrize("line", TOO_LARGE)
def test_the_map_grows_until_any_seed_finds_room(line: str) -> None:
    brief = read_plan(line)
    world = world_for(brief, World())
    assert world == World().changed(map_size=world.site.map_size)
    assert 250 < world.site.map_size <= 1000
    points = build(draft(brief, world, seed=len(line))).sample().points
    assert np.all((points[:, :2] > 0) & (points[:, :2] < world.site.map_size))
    assert f"the map is {world.site.map_size:g} m wide" in map_remark(Brief(), World(), world)


LONG_ROUTES = (
    "| len=500 // junction left lights // roundabout straight normal",
    "crossroads left lights // roundabout left mini || len=1000",
    "| sweeping motorway turns=2.. // diverge ramp side=right",
)


@pytest.mark.parametrize("line", LONG_ROUTES)
def test_the_map_grows_for_a_route_until_it_has_room(line: str) -> None:
    brief = read_plan(line)
    world = world_for(brief, World())
    assert 250 < world.site.map_size <= 1000
    design = draft(brief, world, seed=20)
    assert isinstance(design, Design)
    route = build_route(design, world)
    points = route.at(np.arange(0.0, route.length))
    assert np.all((points[:, :2] > 0) & (points[:, :2] < world.site.map_size))
    assert inspect(route, brief, world) == ()


@pytest.mark.parametrize(
    "line", ["turn x3 | up", "straight len=300", "hairpin x4 | up climb=12", "winding | hard"]
)
def test_it_stays_where_there_is_room(line: str) -> None:
    assert world_for(read_plan(line), World()) == World()
    assert map_remark(Brief(), World(), World()) == ""


def test_the_reader_refuses_only_what_a_given_map_cannot_hold() -> None:
    assert brief_of("straight len=700", World(), PLAN).clauses
    with pytest.raises(RoadGPTError, match="does not fit"):
        brief_of("straight len=700", World(site=Site(map_size=250)), PLAN)


def test_a_campaign_and_read_say_it_too(tmp_path: Path) -> None:
    words = ["turn right gentle | len=700", "--reader", "plan"]
    searched = CliRunner().invoke(
        app, ["campaign", *words, "-n", "1", "--no-drive", "--out", str(tmp_path / "c")]
    )
    assert searched.exit_code == 0, searched.output
    told = CliRunner().invoke(app, ["read", *words, "--json"])
    size = json.loads(told.output)["map_size"]
    assert size > 250
    sentence = f"so the map is {size:g} m wide; --map-size sets it"
    assert sentence in searched.output
    assert sentence in json.loads(told.output)["remarks"][-1]


def test_the_command_says_how_large_the_map_is_and_resumes(tmp_path: Path) -> None:
    words = ["turn right gentle | len=700", "--plan", "--no-drive", "--no-plot", "--seed", "3"]
    first = CliRunner().invoke(app, ["run", *words, "-n", "1", "--out", str(tmp_path / "a")])
    assert first.exit_code == 0, first.output
    said = re.search(r"so the map is (\d+) m wide; --map-size sets it", first.output)
    assert said is not None
    size = int(said[1])
    again = CliRunner().invoke(app, ["run", *words, "-n", "2", "--out", str(tmp_path / "a")])
    assert "1 roads were finished before; continuing" in again.output
    told = CliRunner().invoke(
        app, ["run", *words, "-n", "1", "--out", str(tmp_path / "b"), "--map-size", str(size)]
    )
    assert "so the map is" not in told.output
    roads = [next((tmp_path / name).glob("test.0001.json")).read_bytes() for name in "ab"]
    assert roads[0] == roads[1]


@pytest.mark.parametrize("given", [World(site=Site(map_size=250)), World().changed(map_size=200)])
def test_a_map_that_was_given_is_kept(given: World) -> None:
    brief = read_plan(TOO_LARGE[1])
    assert world_for(brief, given) == given
    with short_searches(), pytest.raises(RoadGPTError, match="--map-size"):
        perform(TOO_LARGE[1], 1, given, PLAN)
