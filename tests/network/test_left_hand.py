"""Traffic on the left: a network is the mirror image of one with traffic on the right."""

import re
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
from network.random_designs import random_design, random_lanes_design
from network.random_maps import random_map
from roadgpt import check
from roadgpt.brief.mirror import mirrored
from roadgpt.brief.plan import plan, read_plan
from roadgpt.check.junction_measures import measured_junctions, measured_places
from roadgpt.design import draft
from roadgpt.errors import DesignError, UsageError
from roadgpt.network import (
    Route,
    build_map,
    build_route,
    network_made_from,
    read_any_design,
    read_map_design,
    read_network_design,
    road_from_json,
)
from roadgpt.network.markings import signs, strokes
from roadgpt.network.paved import ribbon
from roadgpt.road import Site, World

WORLD = World(site=Site(map_size=600))
FLIP = np.array([1.0, -1.0, 1.0])
EXACT = 1e-9  # m
ROUNDED = 0.01  # m^2
CUSP = 0.15  # m, by which the tip of a thin island between two roads moves if corners are rounded to 0.1 mm
settled = settings(max_examples=3, deadline=None)
seeds = st.integers(0, 10_000)
DRAWINGS = pytest.mark.parametrize("draw", [random_design, random_lanes_design])
Drawing = Callable[[int], dict[str, Any]]


def pair(data: dict[str, Any]) -> tuple[Route, Route]:
    """A route with traffic on the left, and that of the mirrored design with traffic on the right."""
    left = build_route(read_network_design({**data, "left_hand": True})[0], WORLD)
    return left, build_route(read_network_design(in_mirror(data))[0], WORLD)


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
    left = build_map(read_map_design({**data, "left_hand": True})[0], WORLD)
    check_mirrored(left, build_map(design, WORLD))


@DRAWINGS
@given(seed=seeds)
@settled
def test_files_read_back_as_they_were(draw: Drawing, seed: int) -> None:
    design = read_network_design({**draw(seed), "left_hand": True})[0]
    assert read_network_design(design.to_json())[0] == design
    route = build_route(design, WORLD).on_ground()
    again = road_from_json(route.to_json())
    assert again.to_json() == route.to_json()
    assert again.network.left_hand


def test_a_right_hand_network_says_nothing_of_hands() -> None:
    data = random_design(1)
    assert "left_hand" not in str(build_route(read_network_design(data)[0], WORLD).to_json())
    assert read_network_design({**data, "left_hand": False})[0] == read_network_design(data)[0]


def test_a_network_has_traffic_on_one_side() -> None:
    route = build_route(read_network_design({**random_design(2), "left_hand": True})[0], WORLD)
    data = route.to_json()
    del data["network"]["roads"][0]["profile"]["left_hand"]
    with pytest.raises(UsageError, match="traffic drives on the left on some roads only"):
        road_from_json(data)
    data["network"]["roads"][0]["profile"]["left_hand"] = "yes"
    with pytest.raises(UsageError, match="left_hand is true or false"):
        road_from_json(data)


def test_a_road_of_no_network_has_traffic_on_the_right() -> None:
    road = (
        build_route(read_network_design({**random_design(2), "left_hand": True})[0], WORLD)
        .network.roads[0]
        .road
    )
    with pytest.raises(UsageError, match="on the left on the roads of networks only"):
        road_from_json(road.to_json())


def test_a_design_without_junctions_is_the_mirror_image_of_one_with_traffic_on_the_right() -> None:
    segment = {"distance": 40, "direction": "left", "incline": 2, "turn_degrees": 30}
    data = {"starting_point": [0, 0, 0], "theta": 0, "road_segment1": segment, "left_hand": True}
    route = network_made_from(read_any_design(data)[0], WORLD)
    (road,) = route.network.roads
    assert road.profile.left_hand
    assert road.profile.along_ids == range(1, 2)
    assert route.legs == ((1, 1),)
    mirrored_segment = {**segment, "direction": "right"}
    right = {**data, "road_segment1": mirrored_segment, "left_hand": False, "lanes": {"forward": 1}}
    other = network_made_from(read_any_design(right)[0], WORLD)
    assert other.legs == ((1, -1),)
    s = np.linspace(0, route.length, 9)
    assert route.at(s) * [1, -1, 1] == pytest.approx(other.at(s), abs=1e-9)


def test_exits_are_counted_in_driving_order() -> None:
    arms = [{"angle": -90}, {"angle": 0, "length": 30}, {"angle": 90}]
    data = {
        **random_design(3),
        **{f"junction{n}": None for n in range(2, 5)},
        "junction1": {"after": 1, "kind": "roundabout", "take": 1, "radius": 20, "arms": arms},
    }
    data = {key: value for key, value in data.items() if value is not None}
    for number in (1, 2):
        data[f"road_segment{number}"] |= {"direction": "straight", "turn_degrees": 0.0}
    left, right = pair(data)
    assert measured_junctions(left)[0].turn == pytest.approx(90)
    assert measured_junctions(right)[0].turn == pytest.approx(-90)
    data["junction1"]["take"] = 2
    with pytest.raises(UsageError, match="the arm at 0 degrees is the one that the route takes"):
        read_network_design({**data, "left_hand": True})


@pytest.mark.parametrize("value", ["yes", 1, None])
def test_a_hand_that_is_no_truth_value_is_refused(value: object) -> None:
    for data in (random_design(1), random_map(0).to_json()):
        with pytest.raises(UsageError, match="left_hand cannot be read"):
            read_any_design({**data, "left_hand": value})


PLANS_WITH_SIDES = (
    "turn left deg=60; straight; turn right | lanes=2 against=1 up",
    "turn left; turn left; turn right | divided lanes=2 against=2",
    "turn left 60 // t_junction left // roundabout exit=2",
    "| lanes=2 against=2 divided // crossroads right lights // | lanes=2 against=2 divided",
    "crossroads left ways=left+straight+right // | up",
    "y_junction right stop // turn x2 right | down",
    "| lanes=2 // lane_change left // lane_drop side=left",
    "| lanes=2 oneway // lane_gain // crossroads left",
    "star slight_right crosswalk",
    "roundabout mini back",
    "diverge ramp side=left",
    "merge ramp side=right // | lanes=3 oneway",
    "merge main len=90",
    "map columns=2 rows=1 lights",
    "map crossroads x2; roundabout",
)


@pytest.mark.parametrize("line", PLANS_WITH_SIDES)
def test_what_was_asked_for_is_there(line: str) -> None:
    brief = read_plan(line).model_copy(update={"left_hand": True})
    design = draft(brief, WORLD, seed=5)
    assert design.left_hand
    assert read_any_design(design.to_json())[0] == design
    route = network_made_from(design, WORLD)
    assert route.network.left_hand
    assert check.inspect(route, brief, WORLD) == ()
    other = read_plan(line.split(" side=")[0])
    has_sides = ("left" in line or "right" in line) and "side=" not in line and "lane_" not in line
    if has_sides and (route.passages or not brief.junctions):
        assert check.inspect(route, mirrored(other), WORLD) != ()


@pytest.mark.parametrize("line", PLANS_WITH_SIDES)
def test_requirements_mirrored_twice_are_the_same(line: str) -> None:
    brief = read_plan(line)
    seen = mirrored(brief)
    assert mirrored(seen) == brief
    swapped = re.sub("left|right", lambda found: {"left": "right", "right": "left"}[found[0]], line)
    assert plan(seen.model_copy(update={"left_hand": False})) == plan(read_plan(swapped))


def test_a_ramp_across_oncoming_lanes_is_refused() -> None:
    brief = read_plan("| against=1 // diverge ramp side=right || left_hand")
    with pytest.raises(DesignError, match=r"^a ramp on the right would cross the oncoming lanes of its road"):
        draft(brief, WORLD, seed=1)
