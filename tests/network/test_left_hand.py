"""Traffic on the left: a network is the mirror image of one with traffic on the right."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import cKDTree
from shapely.affinity import scale

from network.mirrored import in_mirror
from network.random_designs import random_design, random_lanes_design, random_turn_lanes_design
from network.random_maps import random_map
from roadgpt import check
from roadgpt.brief.model import mirrored
from roadgpt.brief.plan import read_plan
from roadgpt.check.measures import measured_junctions, measured_places
from roadgpt.design import draft
from roadgpt.network import Route, build_route
from roadgpt.network.markings import signs, strokes
from roadgpt.network.paved import ribbon
from roadgpt.road import Site, World, read_design
from roadgpt.run import Setup, perform
from tables import rows

WORLD = World(site=Site(map_size=600))
FLIP = np.array([1.0, -1.0, 1.0])
EXACT = 1e-9  # m
ROUNDED = 0.01  # m^2
CUSP = 0.15  # m, by which the tip of a thin island between two roads moves if corners are rounded to 0.1 mm
settled = settings(max_examples=2, deadline=None)
seeds = st.integers(0, 10_000)
DRAWINGS = pytest.mark.parametrize("draw", [random_design, random_lanes_design, random_turn_lanes_design])
Drawing = Callable[[int], dict[str, Any]]


def pair(data: dict[str, Any]) -> tuple[Route, Route]:
    """A route with traffic on the left, and that of the mirrored design with traffic on the right."""
    left = build_route(read_design({**data, "left_hand": True})[0], WORLD)
    return left, build_route(read_design(in_mirror(data))[0], WORLD)


def check_mirrored(left: Route, right: Route) -> None:
    """Checks centre lines, lanes, ids, markings, signs, and the paved area."""
    assert left.network.left_hand
    assert not right.network.left_hand
    assert [(leg.road, -leg.lane) for leg in right.legs] == list(left.legs)
    for one, two in zip(left.network.roads, right.network.roads, strict=True):
        assert (one.id, one.junction) == (two.id, two.junction)
        s = np.linspace(0.0, one.road.length, 15)
        mine, theirs = (each.profile.lane_edges(s) for each in (one, two))
        for own, other in zip(mine, reversed(theirs), strict=True):
            for t, u in zip(own, other, strict=True):
                assert np.abs(one.road.at(s, t) * FLIP - two.road.at(s, u)).max() < EXACT
        ribbons = [np.asarray(ribbon(each.road).exterior.coords, float) for each in (one, two)]
        assert apart(ribbons[0] * FLIP[:2], ribbons[1]) < EXACT
    s = np.linspace(0.0, left.length, 200)
    for own, other in zip(left.profile.lane(s), reversed(right.profile.lane(s)), strict=True):
        assert np.abs(left.at(s, own) * FLIP - right.at(s, other)).max() < EXACT
    check_drawn(left, right)


def check_drawn(left: Route, right: Route) -> None:
    """Checks the paved area, which is joined from roads whose corners are rounded, signs and markings."""
    seen = scale(left.network.paved, yfact=-1, origin=(0, 0))
    assert seen.symmetric_difference(right.network.paved).area < ROUNDED
    controls = [sorted(each.control for each in signs(route.network)) for route in (left, right)]
    assert controls[0] == controls[1]
    places = np.array([each.place for each in signs(left.network)]).reshape(-1, 3) * FLIP
    theirs = np.array([each.place for each in signs(right.network)]).reshape(-1, 3)
    assert apart(places, theirs) < EXACT
    for kind in ("edge", "lane", "stop", "give_way", "crosswalk"):
        painted = [
            shapely.union_all(
                [shapely.LineString(x.points[:, :2]) for x in strokes(each.network) if x.kind == kind]
            )
            for each in (left, right)
        ]
        assert mirror_distance(*painted) < CUSP


def mirror_distance(one: Any, other: Any) -> float:
    """The Hausdorff distance in metres between a shape in the mirror and another one."""
    seen = scale(one, yfact=-1, origin=(0, 0))
    return 0.0 if seen.is_empty and other.is_empty else float(shapely.hausdorff_distance(seen, other))


def apart(points: np.ndarray, others: np.ndarray) -> float:
    """How far a point of either set is from the nearest one of the other set, at most."""
    assert bool(len(points)) == bool(len(others))
    pairs = ((points, others), (others, points)) if len(points) else ()
    return max((float(cKDTree(b).query(one)[0].max()) for one, b in pairs), default=0.0)


@DRAWINGS
@given(seed=seeds)
@settled
def test_a_network_is_the_mirror_image_of_that_of_the_mirrored_design(draw: Drawing, seed: int) -> None:
    left, right = pair(draw(seed))
    check_mirrored(left, right)
    for mine, theirs in zip(measured_places(left), measured_places(right), strict=True):
        assert mine.s == pytest.approx(theirs.s)
    for one, two in zip(measured_junctions(left), measured_junctions(right), strict=True):
        assert (one.exit, one.kinds, one.control) == (two.exit, two.kinds, two.control)
        assert one.turn % 360 == pytest.approx(-two.turn % 360, abs=1e-6)
        assert one.ways == pytest.approx([-way for way in two.ways], abs=1e-6)
        assert one.gaps == pytest.approx(two.gaps, abs=1e-6)


@DRAWINGS
@given(seed=seeds)
@settled
def test_the_rules_find_the_same(draw: Drawing, seed: int) -> None:
    left, right = pair(draw(seed))
    found = [
        [(each.rule, each.s and round(each.s, 3)) for each in check.inspect(route, None, WORLD)]
        for route in (left, right)
    ]
    own, other = (sorted(each for each in rows if each[0] != "leaves_map") for rows in found)
    assert own == other


@pytest.mark.parametrize("seed", [0, 1, 3, 5])  # blocks; roundabouts and lights; T and Y; a star
def test_a_map_is_the_mirror_image_of_the_mirrored_map(seed: int) -> None:
    design = random_map(seed)
    data = design.to_json()
    for key in data:
        if key.startswith("node"):
            data[key]["at"] = [data[key]["at"][0], -data[key]["at"][1], data[key]["at"][2]]
    left = build_route(read_design({**data, "left_hand": True})[0], WORLD)
    check_mirrored(left, build_route(design, WORLD))


PLANS_WITH_SIDES = rows(__file__, "plans_with_sides")


@pytest.mark.parametrize("line", PLANS_WITH_SIDES)
def test_what_was_asked_for_is_there(line: str) -> None:
    brief = read_plan(line).model_copy(update={"left_hand": True})
    design = draft(brief, WORLD, seed=5)
    assert design.left_hand
    assert read_design(design.to_json())[0] == design
    route = build_route(design, WORLD)
    assert route.network.left_hand
    assert check.inspect(route, brief, WORLD) == ()
    other = read_plan(line.split(" side=")[0])
    has_sides = ("left" in line or "right" in line) and "side=" not in line and "lane_" not in line
    if has_sides and (route.passages or not brief.junctions):
        assert check.inspect(route, mirrored(other), WORLD) != ()


@pytest.mark.parametrize(
    "plan",
    ["| lanes=2 against=2 divided", "| lanes=3 oneway || left_hand", "| lanes=2 against=2 || left_hand"],
)
def test_a_road_without_junctions_is_driven_in_its_outermost_lane(plan: str) -> None:
    road = perform(plan, 1, setup=Setup(reader="plan", drives=False)).road
    assert isinstance(road, Route)
    profile = road.network.roads[0].profile
    away = {lane: abs(sum(map(float, profile.edges_of(lane, 10.0)))) for lane in profile.along_ids}
    assert len(away) > 1
    assert [leg.lane for leg in road.legs] == [max(away, key=lambda lane: away[lane])]
