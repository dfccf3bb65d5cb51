"""A motorway is one: radii of 600 m or more and 5 percent at most; or a sentence says what is not kept."""

from functools import cache

import numpy as np
import pytest

from roadgpt import check
from roadgpt.brief import read, remarks, sentence
from roadgpt.brief.expressions import says_motorway
from roadgpt.brief.plan import plan, read_plan
from roadgpt.design import draft
from roadgpt.road import Road, Site, World, build
from tables import rows

NAMES = rows(__file__, "names")


def tightest_and_steepest(road: Road) -> tuple[float, float]:
    """Metres and percent, by three points of the centre line 20 m apart: no code of the project."""
    x, y, z = np.asarray(road.centreline())[::20].T[:3]
    a = np.hypot(np.diff(x), np.diff(y))
    area = (x[1:-1] - x[:-2]) * (y[2:] - y[:-2]) - (y[1:-1] - y[:-2]) * (x[2:] - x[:-2])
    chord = np.hypot(x[2:] - x[:-2], y[2:] - y[:-2])
    curvature = 2 * np.abs(area) / (a[:-1] * a[1:] * chord)
    return float(1 / curvature.max()), float(100 * np.abs(np.diff(z) / a).max())


@cache
def road_of(line: str, size: float, seed: int) -> Road:
    """A road of a plan; most names of motorways have the same plan."""
    return build(draft(read_plan(line), World(site=Site(map_size=size)), seed=seed))


@pytest.mark.parametrize("words", NAMES)
def test_where_there_is_room_it_is_wide_and_nowhere_steep(words: str) -> None:
    size = 2000
    brief, world = read(words, map_size=size), World(site=Site(map_size=size))
    assert brief.motorway
    road = road_of(plan(brief), size, 1)
    radius, grade = tightest_and_steepest(road)
    assert 590 < radius < 1500, "wide, and no straight road"
    assert grade <= 5
    assert check.inspect(road, brief, world) == ()
    (remark,) = remarks(brief, size)
    assert remark == "a motorway has turns of 600 m radius or more, and grades of 5 % or less"


@pytest.mark.parametrize("words", [words for words in NAMES if "km" not in words])
def test_where_there_is_none_that_is_said_and_grades_are_kept(words: str) -> None:
    brief = read(words)
    (remark,) = remarks(brief, 250)
    assert "600 m radius" in remark
    assert "map of 250 m cannot hold" in remark
    size = float(remark.split("--map-size ")[1].split(";")[0])
    assert remarks(brief, size) != (remark,)
    assert "cannot" not in remarks(brief, size)[0], "the map that is proposed holds one"
    for seed in range(2):
        _, grade = tightest_and_steepest(road_of(plan(brief), 250, seed))
        assert grade <= 5
    wide = read(words, map_size=size)
    assert tightest_and_steepest(road_of(plan(wide), size, 1))[0] > 590


def test_a_road_that_is_none_breaks_the_promise() -> None:
    brief, world = read("a motorway"), World(site=Site(map_size=4000))
    tight = build(draft(read("a road with 2 sweeping turns"), World(site=Site(map_size=4000)), seed=1))
    assert any("radius" in finding.sentence for finding in check.inspect(tight, brief, world))
    assert any("600" in finding.sentence for finding in check.inspect(tight, brief, world))


@pytest.mark.parametrize("line", ["hairpin | motorway", "turn x3 sharp | motorway", "turn r=50 | motorway"])
def test_what_is_said_of_the_turns_wins_and_is_named(line: str) -> None:
    brief = read(line, "plan", map_size=4000)
    assert "tighter ones are asked for" in remarks(brief, 4000)[0]
    assert draft(brief, World(site=Site(map_size=4000)), seed=2)


@pytest.mark.parametrize("words", rows(__file__, "none"))
def test_other_roads_are_none(words: str) -> None:
    assert not says_motorway(words)


def test_the_sentence_and_the_plan_hold_it() -> None:
    brief = read("a motorway with 3 curves")
    assert sentence(brief) == "A motorway with 3 sweeping turns."
    again = read(sentence(brief))
    assert (plan(again), again.unused) == (plan(brief), ()) == ("turn x3 sweeping | motorway", ())
    assert read_plan(plan(brief)).motorway
    assert not read("a road with 3 curves").motorway
