"""Lanes of networks against slow references: dense samples, networkx, and overlaps of polygons made here."""

from functools import cache
from itertools import combinations, pairwise

import networkx
import numpy as np
import pytest
import shapely
from scipy.spatial import cKDTree

from network.random_designs import random_design, random_lanes_design
from network.random_maps import map_route
from roadgpt.geometry import CubicProfile
from roadgpt.network import Leg, Network, NetworkRoad, build_route
from roadgpt.network.lanes import Lanes, lanes_of
from roadgpt.road import World, read_design

MAKERS = {
    "route": lambda seed: build_route(read_design(random_design(seed))[0], World()),
    "lanes": lambda seed: build_route(read_design(random_lanes_design(seed))[0], World()),
    "map": map_route,
}
# Small ones, and two large ones: stars, all kinds of junctions and ramps, and roundabouts of both makers.
NETWORKS = [("route", 0), ("route", 3), ("lanes", 2), ("lanes", 3), ("map", 1), ("map", 3)]
FINE = 0.02  # m between the samples of the slow references
EDGE = 0.02  # m; points this close to the edge of a lane are not compared


@cache
def network_of(kind: str, seed: int) -> Network:
    return MAKERS[kind](seed).network


@pytest.fixture(params=NETWORKS, ids=lambda each: f"{each[0]}{each[1]}")
def lanes(request: pytest.FixtureRequest) -> Lanes:
    return lanes_of(network_of(*request.param))


def width_of(width: float | CubicProfile, s: np.ndarray) -> np.ndarray:
    if not isinstance(width, CubicProfile):
        return np.full(s.shape, width)
    at = np.clip(np.searchsorted(width.stations, s, side="right") - 1, 0, None)
    a, b, c, d = np.array(width.coefficients)[at].T
    u = np.maximum(s - np.array(width.stations)[at], 0.0)
    return a + u * (b + u * (c + u * d))


def bands(member: NetworkRoad, s: np.ndarray) -> dict[Leg, tuple[np.ndarray, np.ndarray]]:
    """The offsets of the right and left edge of every lane, summed up here from the widths of the profile."""
    profile, found = member.profile, {}
    for sign, strips in ((1, profile.left), (-1, profile.right)):
        edge = width_of(profile.offset, s)
        for number, strip in enumerate(strips, 1):
            outer = edge + sign * width_of(strip.width, s)
            found[Leg(member.id, sign * number)] = (np.minimum(edge, outer), np.maximum(edge, outer))
            edge = outer
    return found


def slow_polygons(network: Network) -> dict[Leg, shapely.Polygon]:
    found = {}
    for member in network.roads:
        s = np.linspace(0, member.road.length, int(member.road.length / 0.1) + 2)
        points, heading = member.road.at(s)[:, :2], member.road.heading(s)
        left = np.stack((-np.sin(heading), np.cos(heading)), axis=-1)
        for key, (low, high) in bands(member, s).items():
            ring = np.concatenate((points + low[:, None] * left, (points + high[:, None] * left)[::-1]))
            found[key] = shapely.Polygon(ring).buffer(0)
    return found


def test_a_point_lies_in_the_lanes_that_dense_samples_show(lanes: Lanes) -> None:
    network, rng = lanes.network, np.random.default_rng(0)
    members = [network.roads[n] for n in rng.integers(len(network.roads), size=50)]
    aside = rng.uniform(-1, 1, len(members))
    along = rng.uniform(0, 1, len(members))
    points = np.array(
        [
            each.road.at(s * each.road.length, t * (each.profile.reach + 3))[:2]
            for each, s, t in zip(members, along, aside, strict=True)
        ]
    )
    found, counted = lanes.places(points), 0
    for member in network.roads:
        s = np.linspace(0, member.road.length, int(member.road.length / FINE) + 2)
        line, heading = member.road.at(s)[:, :2], member.road.heading(s)
        edges = bands(member, s)
        nearby = cKDTree(line).query(points)[1].tolist()
        for point, places, nearest in zip(points, found, nearby, strict=True):
            away = point - line[nearest]
            along = away @ (np.cos(heading[nearest]), np.sin(heading[nearest]))
            t = away @ (-np.sin(heading[nearest]), np.cos(heading[nearest]))
            if abs(along) > 2 * FINE or not FINE < s[nearest] < s[-1] - FINE:
                continue  # beyond an end of the road
            by_lane = {place.lane.id: place for place in places}
            for key, (low, high) in edges.items():
                if min(abs(t - low[nearest]), abs(t - high[nearest])) < EDGE:
                    continue
                assert (key in by_lane) == (low[nearest] < t < high[nearest]), (key, point)
                if key in by_lane:
                    counted += 1
                    own = by_lane[key].lane.at(by_lane[key].s, by_lane[key].t)[:2]
                    assert np.abs(own - point).max() < 0.02
                    middle = (low[nearest] + high[nearest]) / 2
                    side = 1 if by_lane[key].lane.is_along else -1
                    assert by_lane[key].t == pytest.approx(side * (t - middle), abs=0.03)
    assert counted > 10


def test_neighbours_lie_beside_a_lane_and_drive_the_same_way(lanes: Lanes) -> None:
    for lane in lanes:
        for key, side in ((lane.left, 1), (lane.right, -1)):
            if key is None:
                continue
            other = lanes[key]
            middle, width = lane.length / 2, lane.width(lane.length / 2)
            s, t = other.locate(*lane.at(middle, side * (width / 2 + 0.2))[:2])
            assert abs(t) <= other.width(s) / 2
            turned = np.cos(other.heading(s) - lane.heading(middle))
            assert turned > 0.99
            assert lane.id == (other.right if side > 0 else other.left)


def test_a_lane_ends_where_its_successors_begin(lanes: Lanes) -> None:
    joints = 0
    for lane in lanes:
        for key in lane.successors:
            after = lanes[key]
            joints += 1
            assert lane.id in after.predecessors
            assert np.abs(lane.at(lane.length) - after.at(0.0)).max() < 1e-4
            assert np.cos(lane.heading(lane.length) - after.heading(0.0)) > 1 - 1e-9
    assert joints


def test_the_length_of_a_lane_is_that_of_its_middle(lanes: Lanes) -> None:
    for lane in lanes:
        dense = lane.at(np.linspace(0, lane.length, 2000))[:, :2]
        measured = np.linalg.norm(np.diff(dense, axis=0), axis=1).sum()
        assert lane.length == pytest.approx(measured, rel=2e-4, abs=1e-3)
        assert np.linalg.norm(dense[1] - dense[0]) == pytest.approx(lane.length / 1999, rel=0.02, abs=1e-4)


@pytest.mark.parametrize("cost", ["length", "changes"])
def test_the_shortest_way_is_that_of_networkx(lanes: Lanes, cost: str) -> None:
    graph = networkx.DiGraph()
    for lane in lanes:
        for key in lane.successors:
            metres = lane.length if cost == "length" else lane.length / 1e6
            graph.add_edge(lane.id, key, weight=metres)
        for key, may in ((lane.left, lane.may_change_left), (lane.right, lane.may_change_right)):
            if key is not None and may:
                graph.add_edge(lane.id, key, weight=0.0 if cost == "length" else 1.0)
    driving = [lane.id for lane in lanes if lane.kind == "driving"]
    rng = np.random.default_rng(1)
    for one, two in rng.integers(len(driving), size=(60, 2)):
        start, goal = driving[one], driving[two]
        found = lanes.shortest(start, goal, cost)
        if start not in graph or goal not in graph or not networkx.has_path(graph, start, goal):
            assert found is None or start == goal
            continue
        best = networkx.dijkstra_path_length(graph, start, goal)
        assert found is not None
        assert (found[0], found[-1]) == (start, goal)
        assert sum(graph.edges[pair]["weight"] for pair in pairwise(found)) == pytest.approx(best, abs=1e-9)


def passes_over(lanes: Lanes, one: Leg, other: Leg, common: shapely.Geometry) -> bool:
    heights = [lanes[key].at(lanes[key].locate(*common.centroid.coords[0])[0])[2] for key in (one, other)]
    return abs(heights[0] - heights[1]) > 2.5


def test_lanes_meet_where_polygons_overlap(lanes: Lanes) -> None:
    polygons = slow_polygons(lanes.network)
    driving = [lane.id for lane in lanes if lane.kind == "driving"]
    met = {(one, other) for one in driving for other in lanes.met_by(one)}
    assert all((other, one) in met for one, other in met)
    shapes = [polygons[key] for key in driving]
    near = {(a, b) for a, b in shapely.STRtree(shapes).query(shapes).T.tolist() if a < b}
    for (a, one), (b, other) in combinations(enumerate(driving), 2):
        if (a, b) not in near:
            assert (one, other) not in met
            continue
        common = polygons[one].intersection(polygons[other])
        area = 0.0 if common.area > 0.1 and passes_over(lanes, one, other, common) else common.area
        if area < 0.002 or area > 0.1:  # between the two, rounding of polygons decides
            assert ((one, other) in met) == (area > 0.1), (one, other, area)
        if area > 0.1:
            meeting = lanes.meeting(one, other)
            assert meeting is not None
            assert meeting == (lambda back: (back.others, back.own))(lanes.meeting(other, one))
            for lane, (begin, end) in zip((one, other), meeting, strict=True):
                s, _ = lanes[lane].locate(*np.asarray(common.centroid.coords[0]))
                assert begin - 0.2 <= s <= end + 0.2
    assert met or all(each.kind in ("merge", "diverge") for each in lanes.network.junctions)


def test_of_two_lanes_that_meet_at_most_one_gives_way(lanes: Lanes) -> None:
    for lane in lanes:
        for other in lanes.gives_way_to(lane.id):
            assert lane.id not in lanes.gives_way_to(other)


def crossing(kind: str = "crossroads", control: str = "none", left_hand: bool = False) -> Lanes:
    """A junction on the way to the north: the route arrives from the south."""
    data = {
        "starting_point": [0, 0, 0],
        "theta": 90,
        "left_hand": left_hand,
        "road_segment1": {"distance": 60, "direction": "straight", "incline": 0, "turn_degrees": 0},
        "junction1": {"after": 1, "kind": kind, "take": "straight", "control": control},
        "road_segment2": {"distance": 60, "direction": "straight", "incline": 0, "turn_degrees": 0},
    }
    return lanes_of(build_route(read_design(data)[0], World()).network)


COMPASS = ("east", "north", "west", "south")


def heads(lanes: Lanes, lane: Leg, at_end: bool) -> str:
    heading = lanes[lane].heading(lanes[lane].length if at_end else 0.0)
    return COMPASS[round(float(heading) / (np.pi / 2)) % 4]


def yields(lanes: Lanes) -> set[tuple[str, str]]:
    """Pairs of ways such as "south-west": from the south to the west; the first gives way to the second."""

    def name(lane: Leg) -> str:
        begin = COMPASS[(COMPASS.index(heads(lanes, lane, False)) + 2) % 4]
        return f"{begin}-{heads(lanes, lane, True)}"

    inside = [lane.id for lane in lanes if lane.member.junction is not None]
    return {(name(one), name(other)) for one in inside for other in lanes.gives_way_to(one)}


def test_without_signs_who_comes_from_the_right_goes_first() -> None:
    found = yields(crossing())
    assert {("south-north", "east-west"), ("east-west", "north-south"), ("west-east", "south-north")} <= found
    assert ("east-west", "south-north") not in found
    assert ("south-west", "north-south") in found, "who turns left waits for oncoming traffic"
    assert ("north-south", "south-west") not in found
    assert ("south-west", "north-west") in found, "also for who turns right into the same road"


def test_where_traffic_drives_on_the_left_all_of_that_is_mirrored() -> None:
    mirror = {"east": "west", "west": "east", "north": "north", "south": "south"}
    turned = {
        tuple("-".join(mirror[word] for word in way.split("-")) for way in pair)
        for pair in yields(crossing(left_hand=True))
    }
    assert turned == yields(crossing())


def test_a_sign_to_give_way_outranks_the_side() -> None:
    found = yields(crossing(control="yield"))
    assert {("south-north", "west-east"), ("south-north", "east-west"), ("south-west", "west-east")} <= found
    assert not [pair for pair in found if pair[0] in ("west-east", "east-west")]
    assert ("west-north", "east-west") in found, "on the main road, who turns left waits"


def test_lights_settle_all_but_who_turns_across_the_oncoming_traffic() -> None:
    found = yields(crossing(control="lights"))
    assert ("south-west", "north-south") in found
    assert {frozenset(way.split("-")[0] for way in pair) for pair in found} == {
        frozenset(("south", "north")),
        frozenset(("east", "west")),
    }


def test_a_roundabout_s_arms_give_way_to_its_ring() -> None:
    lanes = crossing("roundabout", "yield")
    ring = set(lanes.network.roundabouts[0].ring)
    entries = exits = 0
    for lane in lanes:
        if lane.member.junction is None:
            continue
        first = lanes.network.connection_of[lane.id.road][1].incoming.road
        given = lanes.gives_way_to(lane.id)
        if first in ring:
            exits += 1
            assert not given
        elif given:
            entries += 1
            assert {lanes.network.connection_of[other.road][1].incoming.road for other in given} <= ring
    assert (entries, exits) == (4, 8)


@pytest.mark.parametrize("side", ["left", "right"])
@pytest.mark.parametrize("take", ["ramp", "main"])
def test_a_lane_for_acceleration_gives_way_to_the_main_road(take: str, side: str) -> None:
    ramp = {"kind": "merge", "take": take, "side": side, "after": 1}
    one_way = {"forward": 1 if take == "ramp" else 2, "backward": 0}
    straight = {"distance": 100, "direction": "straight", "incline": 0, "turn_degrees": 0}
    main = {"lanes": {"forward": 2, "backward": 0}}
    design = {
        "starting_point": [100, 100, 0], "theta": 0, "lanes": one_way, "road_segment1": straight,
        "junction1": {**ramp, **main}, "road_segment2": straight,
    }  # fmt: skip
    lanes = lanes_of(build_route(read_design(design)[0], World()).network)
    given = {lane.id: lanes.gives_way_to(lane.id) for lane in lanes if lane.kind == "driving"}
    ((own, others),) = [pair for pair in given.items() if pair[1]]
    (merge,) = lanes.network.junctions
    last = {each.outgoing for way in merge.connections for each in way.lanes}
    width = {leg: float(width_of(lanes[leg].member.profile.lanes[leg.lane].width, np.array([1e4]))[0])
             for leg in given if leg.road == own.road}  # fmt: skip
    assert own.lane in last
    assert width[own] == pytest.approx(0, abs=0.01)
    assert [abs(other.lane - own.lane) for other in others] == [1]
    assert all(width[other] > 3 and other.road == own.road for other in others)


def test_a_car_stops_before_the_line_and_the_crosswalk() -> None:
    lanes = crossing(control="stop")
    stops = [lane for lane in lanes if lane.control == "stop" and lane.kind == "driving"]
    assert {heads(lanes, lane.id, True) for lane in stops} <= {"north", "south"}
    for lane in stops:
        assert lane.stop == pytest.approx(lane.length - 0.5)
    assert all(lane.stop is None for lane in lanes if lane.control in ("none", "priority"))
