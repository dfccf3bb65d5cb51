"""Drafts on given land: they keep their plan view, and lie where little has to be dug.

The second opinions: planes, whose grades are known, and the same drafts in the middle of the land."""

from functools import cache

import numpy as np
import pytest

import roadgpt
from grids import diagonal, pairs
from roadgpt.brief.land_words import land_in
from roadgpt.brief.model import Brief
from roadgpt.check import inspect
from roadgpt.design.designers.planner import Planner
from roadgpt.design.on_land import placed
from roadgpt.errors import DesignError
from roadgpt.ground.files import named
from roadgpt.ground.relief import Relief, Way, made, stretches
from roadgpt.road import Design, Road, World, build

SIDE = 800.0
PLANS = (
    "straight 150 | up",
    "straight 60; turn left 60 r40; straight 60",
    "turn x3 left",
    "turn x4 alternating | len=500",
    "hairpin; straight 80; turn right",
)


def relief(heights: np.ndarray, cell: float) -> Relief:
    return Relief(0.0, 0.0, cell, heights, np.full_like(heights, np.nan), np.empty((0, 3)))


def plane(east: float, north: float = 0.0, side: float = SIDE) -> Relief:
    """A plane, 300 m high in the south-west, that rises by so many metres for each metre."""
    x = np.arange(0.0, side + 1, 10.0)
    return relief(300.0 + east * x + north * x[:, None], 10.0)


@cache
def hills(words: str, seed: int) -> Relief:
    """Made land as `roadgpt ground` makes it."""
    wish, way = land_in(words), Way.through_the_middle(SIDE, 100.0, seed)
    kind = wish.kind or "hilly"
    return made(way, kind, stretches(wish.lands, SIDE), seed, (np.zeros(2), np.full(2, SIDE)))


def world(land: Relief) -> World:
    return World().changed(map_size=SIDE, ground=named("x.npy", land))


def brief(plan: str) -> Brief:
    return roadgpt.read(plan, reader="plan", is_map_fixed=False)


@cache
def draft(plan: str, seed: int = 3) -> Design:
    """A road for this plan without any land."""
    return Planner().draft(brief(plan), World().changed(map_size=SIDE), (), (), seed)


def on(land: Relief, plan: str, seed: int = 3) -> Road:
    """The road at its best place; it breaks no rule, and is what the plan asks for."""
    design = placed(draft(plan, seed), brief(plan), world(land), land)
    road = world(land).lay(build(design))
    assert inspect(road, brief(plan), world(land), "strict") == ()
    return road


def off(road: Road, land: Relief) -> np.ndarray:
    """The metres between the road and the land, at points along it."""
    points = road.at(np.linspace(0.0, road.length, 300), 0.0)
    assert points[:, :2].min() > 0
    assert points[:, :2].max() < SIDE
    return np.abs(points[:, 2] - land.at(*points[:, :2].T))


def grades(road: Road) -> np.ndarray:
    """Metres up for each metre along, from points 1 m apart."""
    points = road.at(np.arange(0.0, road.length), 0.0)
    return np.diff(points[:, 2]) / np.hypot(*np.diff(points[:, :2], axis=0).T)


@pytest.mark.parametrize(("east", "north", "seed"), [(0.06, 0.0, 0), (0.0, -0.06, 1), (0.06, 0.0, 3)])
def test_an_uphill_straight_on_a_plane_of_6_percent_has_the_grade_of_the_plane(
    east: float, north: float, seed: int
) -> None:
    """However steep the draft is: all that is asked for is that it leads uphill."""
    land = plane(east, north)
    road = on(land, "straight 150 | up", seed)
    assert off(road, land).max() < 0.5
    assert grades(road) == pytest.approx(0.06, abs=0.01)


@pytest.mark.parametrize(("east", "north", "seed"), [(0.06, 0.0, 0), (0.036, 0.048, 1), (0.06, 0.0, 2)])
def test_a_downhill_straight_falls_as_the_plane_falls_in_its_direction(
    east: float, north: float, seed: int
) -> None:
    land = plane(east, north)
    road = on(land, "straight 150 down", seed)
    start, end = road.at(np.array([0.0, road.length]), 0.0)
    falls = (end - start)[:2] / road.length @ [east, north]
    assert falls < -0.02
    assert off(road, land).max() < 0.5
    assert grades(road) == pytest.approx(falls, abs=0.003)


def test_a_level_straight_follows_the_contours() -> None:
    land = plane(0.03, 0.05)
    road = on(land, "straight 150 flat")
    assert off(road, land).max() < 0.5
    assert np.abs(grades(road)).max() < 0.01


@pytest.mark.parametrize(
    ("plan", "words", "seed"), pairs(PLANS, ("hilly", "rolling land with a valley"), range(3))
)
def test_less_is_dug_than_in_the_middle_of_the_land(plan: str, words: str, seed: int) -> None:
    land = hills(words, seed)
    road = on(land, plan, seed)
    flat = build(draft(plan, seed)).at(np.linspace(0.0, road.length, 300), 0.0)
    there = flat[:, :2] - (flat[:, :2].min(axis=0) + flat[:, :2].max(axis=0)) / 2 + SIDE / 2
    apart = flat[:, 2] - land.at(*there.T)
    in_the_middle = np.abs(apart - np.median(apart)).mean()  # no other height is better
    assert off(road, land).mean() < in_the_middle
    assert off(road, land).max() < 15.5  # beyond that it needs a bridge or a tunnel


@pytest.mark.parametrize(("plan", "land"), diagonal(PLANS, [plane(0.04, 0.03), hills("hilly", 1)]))
def test_turns_and_lengths_stay_as_they_are(plan: str, land: Relief) -> None:
    before, after = build(draft(plan)), on(land, plan)
    assert after.length == pytest.approx(before.length, abs=1e-6)
    s = np.linspace(0.0, before.length, 500)
    assert after.curvature(s) == pytest.approx(before.curvature(s), abs=1e-9)
    one, other = (each.at(s, 0.0)[:, :2] for each in (before, after))
    apart = [np.hypot(*(each[None, ::50] - each[::50, None]).transpose(2, 0, 1)) for each in (one, other)]
    assert apart[0] == pytest.approx(apart[1], abs=1e-6)  # the same line, moved and turned


def test_the_same_land_gives_the_same_place_and_the_design_survives_a_file() -> None:
    land = hills("hilly", 2)
    one, same = (placed(draft(PLANS[1]), brief(PLANS[1]), world(land), land) for _ in range(2))
    assert one == same
    again, _ = roadgpt.road.read_design(one.to_json())
    s = np.linspace(0.0, build(one).length, 50)
    assert build(again).at(s, 0.0) == pytest.approx(build(one).at(s, 0.0), abs=1e-6)


@pytest.mark.parametrize("side", [60.0, 180.0])
def test_too_small_land_is_told_in_one_sentence(side: float) -> None:
    land = plane(0.02, 0.0, side)
    with pytest.raises(DesignError, match="no room for it; ask for a shorter") as caught:
        placed(draft(PLANS[3]), brief(PLANS[3]), world(land), land)
    assert "\n" not in str(caught.value)


def test_too_steep_land_is_told_in_one_sentence() -> None:
    x = np.arange(0.0, SIDE + 1, 10.0)
    waves = relief(400.0 + 60.0 * np.sin(x / 13.0) * np.sin(x[:, None] / 13.0), 10.0)
    with pytest.raises(DesignError, match=r"above or below the land|no place on this land") as caught:
        placed(draft(PLANS[3]), brief(PLANS[3]), world(waves), waves)
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 300


@pytest.mark.parametrize("plan", ["map columns=1 rows=1", "turn left // crossroads left"])
def test_networks_are_not_laid_on_given_land(plan: str) -> None:
    asked = brief(plan)
    assert asked.is_of_network
    with pytest.raises(DesignError, match=r"networks are not .* --ground"):
        Planner().draft(asked, world(plane(0.02)), (), (), 1)


def test_the_planner_places_its_drafts() -> None:
    land = plane(0.05)
    design = Planner().draft(brief(PLANS[0]), world(land), (), (), 3)
    assert off(build(design), land).max() < 0.5
    assert design.starting_point[2] > 250.0  # on the land, not on the map of the draft
