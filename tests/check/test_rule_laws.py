"""Laws of the rules: what a road is does not hang on where it lies or which way it is driven."""

import math
from itertools import combinations
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from network.changing import WORLD as MAP
from network.changing import passing
from network.random_designs import random_design
from network.ruled import RULE_OF, all_findings, findings
from roadgpt import plugins
from roadgpt.check import inspect
from roadgpt.check.footprint import footprint
from roadgpt.geometry import GradeProfile, Piece, PieceCurve
from roadgpt.network import Network, NetworkRoad, RoadEnd, Route, build_route
from roadgpt.network.paved import ribbon
from roadgpt.road import CrossSection, Road, Site, World, read_design

WORLD = World(site=Site(map_size=1000))
SHAPE_RULES = (
    "finite",
    "number_of_points",
    "too_short",
    "below_floor",
    "too_steep",
    "too_tight",
    "no_overlap",
)

lengths = st.floats(5, 60)
bends = st.one_of(st.just(0.0), st.floats(17, 80).map(lambda r: 1 / r), st.floats(6, 12).map(lambda r: 1 / r))
pieces = st.builds(lambda n, k, hand: Piece(n, hand * k, hand * k), lengths, bends, st.sampled_from([-1, 1]))
gentle = st.builds(
    lambda n, k, hand: Piece(n, hand * k, hand * k), lengths, st.floats(0, 0.06), st.sampled_from([-1, 1])
)
grades = st.one_of(st.floats(-0.14, 0.14), st.floats(0.16, 0.5), st.floats(-0.5, -0.16))
settled = settings(max_examples=60, deadline=None)


@st.composite
def roads(draw: st.DrawFn) -> Road:
    plan = PieceCurve(500.0, 500.0, 0.0, tuple(draw(st.lists(pieces, min_size=1, max_size=7))))
    return Road(plan, GradeProfile(100.0, (0.0, plan.length), (draw(grades), draw(grades))))


def laid(road: Road, x: float, y: float, turn: float) -> Road:
    """The same road at another place, turned."""
    assert isinstance(road.plan, PieceCurve)
    return Road(PieceCurve(x, y, road.plan.heading0 + turn, road.plan.pieces), road.elevation)


def reversed_way(road: Road) -> Road:
    """The same road driven from its end."""
    assert isinstance(road.plan, PieceCurve)
    assert isinstance(road.elevation, GradeProfile)
    x, y, z = road.at(road.length)
    back = tuple(Piece(p.length, -p.k1, -p.k0) for p in road.plan.pieces[::-1])
    g0, g1 = road.elevation.grades
    plan = PieceCurve(x, y, float(road.heading(road.length)) + math.pi, back)
    return Road(plan, GradeProfile(z, (0.0, road.length), (-g1, -g0)))


def objects(rule: str, road: Road, world: World = WORLD) -> bool:
    return bool(findings(rule, road, world))


def is_no_close_call(road: Road) -> bool:
    """Does the verdict on overlap stay the same if lanes are 5 cm wider or narrower?"""
    wider, narrower = (
        World(site=Site(map_size=1000), section=CrossSection(lane_width=width)) for width in (4.05, 3.95)
    )
    return objects("no_overlap", road, wider) == objects("no_overlap", road, narrower)


@given(roads(), st.floats(-100, 100), st.floats(-100, 100), st.floats(-math.pi, math.pi))
@settled
def test_where_a_road_lies_changes_no_verdict_but_inside_map(
    road: Road, dx: float, dy: float, turn: float
) -> None:
    assume(is_no_close_call(road))
    there = laid(road, 500 + dx, 500 + dy, turn)
    assert [objects(rule, there) for rule in SHAPE_RULES] == [objects(rule, road) for rule in SHAPE_RULES]


@given(roads())
@settled
def test_driving_it_backwards_changes_no_verdict_on_overlap_radius_and_map(road: Road) -> None:
    assume(is_no_close_call(road))
    for rule in ("no_overlap", "too_tight", "too_steep", "inside_map", "too_short"):
        assert objects(rule, reversed_way(road)) == objects(rule, road), rule


@given(roads(), st.floats(0, 250), st.floats(0, 250), st.floats(-math.pi, math.pi))
@settled
def test_a_road_is_inside_the_map_where_all_its_edge_points_are(
    road: Road, x: float, y: float, turn: float
) -> None:
    road, world = laid(road, x, y, turn), World(site=Site(map_size=250))
    s = np.linspace(0, road.length, 4000)
    edge = np.concatenate([road.at(s, t)[:, :2] for t in (-4.0, 4.0)])
    room = min(edge.min(), 250 - edge.max())
    assume(room < -0.1 or room > 1.5)  # nearer to the border, SBFT's spline has a word in it
    assert objects("inside_map", road, world) == (room < 0)


@given(
    st.lists(gentle, min_size=1, max_size=4), st.floats(-math.pi, math.pi), st.floats(0, 2), st.floats(0, 2)
)
@settings(max_examples=80, deadline=None)
def test_what_strict_lets_pass_the_competition_lets_pass(
    shape: list[Piece], turn: float, room_x: float, room_y: float
) -> None:
    """Roads in a corner of the map, as close to its border as that."""
    road = Road(PieceCurve(0.0, 0.0, turn, tuple(shape)), GradeProfile(0.0, (0.0, 1.0), (0.0, 0.0)))
    x, y = np.min([road.at(np.linspace(0, road.length, 500), t)[:, :2].min(axis=0) for t in (-4, 4)], axis=0)
    road = laid(road, room_x - x, room_y - y, 0.0)
    assert inspect(road, None, World()) or not inspect(road, None, World(), rules="sbft")


@given(roads())
@settled
def test_a_single_road_and_the_map_of_it_break_the_same_rules(road: Road) -> None:
    alone = Network((NetworkRoad(1, road.with_profile(WORLD.profile_of(road))),))
    for rule in ("finite", "below_floor", "too_steep", "too_abrupt"):
        own, on_map = findings(rule, road, WORLD), findings(rule, alone, WORLD)
        assert [each.x for each in own] == [each.x for each in on_map], rule
        assert [each.sentence.partition(": ")[2] for each in own] == [
            each.sentence.partition(": ")[2] for each in on_map
        ], rule


LARGE = World(site=Site(map_size=10_000))
SEEDS = range(10)


def moved(data: dict[str, Any], dx: float, dy: float) -> dict[str, Any]:
    x, y, z = data["starting_point"]
    return {**data, "starting_point": [x + dx, y + dy, z]}


def crowded(seed: int) -> dict[str, Any]:
    """A random design with roads so short and bent that they often overlap."""
    rng = np.random.default_rng(seed)
    data = random_design(seed)
    for key, value in data.items():
        if key.startswith("road_segment"):
            data[key] = {**value, "distance": float(rng.uniform(12, 40)), "direction": "left", "incline": 0}
            data[key]["turn_degrees"] = float(rng.uniform(20, 60))
    return moved(data, 5000, 5000)


def route_of(data: dict[str, Any]) -> Route:
    return build_route(read_design(data)[0], LARGE)


@pytest.mark.parametrize("seed", SEEDS)
def test_ends_and_carriageways_are_those_of_each_road(seed: int) -> None:
    network = route_of(random_design(seed)).network
    shapes = footprint(network)
    for member, polygon in zip(network.roads, shapes.polygons, strict=True):
        for end, s in (("start", 0.0), ("end", member.road.length)):
            pose = shapes.ends[RoadEnd(member.id, end)]  # type: ignore[arg-type]
            asked = [*member.road.at(s), float(member.road.heading(s)), float(member.road.grade(s))]
            assert list(pose) == pytest.approx(asked, abs=1e-9)
        exact = ribbon(member.road)
        assert polygon.symmetric_difference(exact).area < 0.02 * exact.length


def crossing_pairs(network: Network) -> list[tuple[NetworkRoad, NetworkRoad, float]]:
    """Each two roads, not of one junction or one roundabout, and the area in which they overlap."""
    areas = {each.id: shapely.make_valid(ribbon(each.road)) for each in network.roads}
    found = []
    for one, other in combinations(network.roads, 2):
        rings = [network.roundabout_of.get(each.id) for each in (one, other)]
        if one.junction is not None and one.junction == other.junction:
            continue
        if rings[0] is not None and rings[0] is rings[1]:
            continue
        found.append((one, other, areas[one.id].intersection(areas[other.id]).area))
    return found


@pytest.mark.parametrize("seed", SEEDS)
def test_overlaps_are_those_that_each_two_ribbons_have(seed: int) -> None:
    route = route_of(crowded(seed))
    found = footprint(route.network).overlaps
    pairs = {(one.id, other.id): area for one, other, area, *_ in found}
    for one, other, area in crossing_pairs(route.network):
        seen = pairs.get((one.id, other.id), 0.0)
        assert seen == pytest.approx(area, abs=0.02 * one.road.length), (one.id, other.id)


def test_the_crowded_designs_are_of_both_kinds() -> None:
    verdicts = {bool(findings("conflicting_overlap", route_of(crowded(seed)), LARGE)) for seed in SEEDS}
    assert verdicts == {True, False}


@pytest.mark.parametrize("seed", SEEDS)
def test_where_a_network_lies_and_which_way_it_looks_changes_no_verdict(seed: int) -> None:
    data = moved(random_design(seed), 5000, 5000)
    turned = moved({**data, "theta": data["theta"] + 77.0}, 123.0, -45.0)
    found, again = (inspect(route_of(each), None, LARGE) for each in (data, turned))
    assert [each.rule for each in found] == [each.rule for each in again]
    assert [each.s for each in found] == pytest.approx([each.s for each in again], abs=0.01)


@pytest.mark.parametrize("seed", SEEDS)
def test_every_rule_answers_with_findings_of_its_own_name(seed: int) -> None:
    route = route_of(crowded(seed))
    single = route.network.roads[0].road
    for name in plugins.names("rules"):
        own = {name, *(alias for alias, rule in RULE_OF.items() if rule == name)}
        for place in (route, route.network, single):
            found = all_findings(name, place)
            assert isinstance(found, tuple)
            assert {each.rule for each in found} <= own
            assert all(each.sentence and "\n" not in each.sentence for each in found)


def test_a_route_is_checked_by_the_rules_of_networks() -> None:
    route = passing("crossroads")
    assert inspect(route, None, MAP) == ()
    small = World(site=Site(map_size=100))
    assert {each.rule for each in inspect(route, None, small)} == {"leaves_map"}


def test_a_route_is_no_test_of_sbft() -> None:
    (found,) = inspect(passing("t_junction"), None, MAP, rules="sbft")
    assert found.sentence == "the road leads through junctions, and SBFT tests are single roads"
