"""Laws of networks with several lanes, ramps, and lanes that end, begin and are changed.

The borders of lanes are computed here by the formulas of OpenDRIVE.
"""

import json
import math
from collections.abc import Iterator
from functools import cache
from itertools import groupby, pairwise
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from network.random_designs import random_lanes_design
from network.shared_laws import Motion, check_that_ways_join_the_arms
from roadgpt.geometry import CubicProfile
from roadgpt.network import NetworkRoad, RoadEnd, Route, build_route, read_network_design, road_from_json
from roadgpt.network.building import edges_at
from roadgpt.network.lane_along import change_windows
from roadgpt.road import World

settled = settings(max_examples=16, deadline=None)
seeds = st.integers(0, 15)
"""Few, so that all laws look at the same networks."""
EXACT = 1e-9  # m and rad
NEAR = 1e-6  # m


@cache
def drawn(seed: int) -> Route:
    return build_route(read_network_design(random_lanes_design(seed))[0], World())


def value(width: float | CubicProfile, s: float) -> float:
    """A width at a station, by the cubic that applies there."""
    if not isinstance(width, CubicProfile):
        return width
    n = max((k for k, start in enumerate(width.stations) if start <= s + EXACT), default=0)
    a, b, c, d = width.coefficients[n]
    u = s - width.stations[n]
    return a + u * (b + u * (c + u * d))


def offsets(member: NetworkRoad, lane: int, s: float) -> tuple[float, float]:
    """The offsets of the inner and of the outer border of a lane: inner is nearer to the centre line."""
    profile = member.profile
    side, sign = (profile.right, -1) if lane < 0 else (profile.left, 1)
    centre = value(profile.offset, s)
    inside = sum(value(each.width, s) for each in side[: abs(lane) - 1])
    return centre + sign * inside, centre + sign * (inside + value(side[abs(lane) - 1].width, s))


@settled
@given(seeds, st.floats(0, 1))
def test_edges_at_one_station_are_the_outermost_borders(seed: int, share: float) -> None:
    for member in drawn(seed).network.roads:
        s, (along, against) = share * member.road.length, member.profile.count
        left, right = edges_at(member.profile, s)
        assert right == pytest.approx(offsets(member, -along, s)[1], abs=EXACT)
        begin = value(member.profile.offset, s) + member.profile.median
        widths = [value(lane.width, s) for lane in member.profile.left[:against]]
        assert left == pytest.approx(begin + sum(widths), abs=EXACT)


def borders(member: NetworkRoad, lane: int, s: float) -> np.ndarray:
    """The points (x, y, z) of the inner and of the outer border of a lane."""
    return np.array([member.road.at(s, t) for t in offsets(member, lane, s)])


def joints(route: Route) -> Iterator[tuple[tuple[NetworkRoad, int, float], tuple[NetworkRoad, int, float]]]:
    """Every pair of lanes that continue each other, each with its road and the station of the joint."""
    network = route.network

    def at(end: RoadEnd, lane: int) -> tuple[NetworkRoad, int, float]:
        member = network.road(end.road)
        return member, lane, 0.0 if end.contact == "start" else member.road.length

    for junction in network.junctions:
        for each in junction.connections:
            start, end = RoadEnd(each.road, "start"), RoadEnd(each.road, "end")
            for incoming, own, outgoing in each.lanes:
                yield at(each.incoming, incoming), at(start, own)
                yield at(end, own), at(each.outgoing, outgoing)
    for each in network.continuations:
        for before, after in each.lanes:
            yield at(each.before, before), at(each.after, after)


@given(seeds)
@settled
def test_connecting_roads_begin_and_end_on_the_arms(seed: int) -> None:
    check_that_ways_join_the_arms(drawn(seed).network, EXACT)


@given(seeds)
@settled
def test_lanes_that_continue_each_other_have_the_same_borders(seed: int) -> None:
    for one, two in joints(drawn(seed)):
        assert borders(*one) == pytest.approx(borders(*two), abs=NEAR)
        assert np.linalg.norm(np.diff(borders(*one), axis=0)) > 2.0  # m: nobody is led along a wedge


@given(seeds)
@settled
def test_roads_that_continue_each_other_join(seed: int) -> None:
    network = drawn(seed).network
    for each in network.continuations:
        one, two = network.road(each.before.road).road, network.road(each.after.road).road
        assert (each.before.contact, each.after.contact) == ("end", "start")
        assert one.at(one.length) == pytest.approx(two.at(0.0), abs=EXACT)
        assert one.heading(one.length) == pytest.approx(two.heading(0.0), abs=EXACT)
        assert one.grade(one.length) == pytest.approx(two.grade(0.0), abs=EXACT)


@given(seeds)
@settled
def test_a_lane_that_no_other_one_continues_has_no_width_there(seed: int) -> None:
    network = drawn(seed).network
    for each in network.continuations:
        for end, column in ((each.before, 0), (each.after, 1)):
            member = network.road(end.road)
            s = 0.0 if end.contact == "start" else member.road.length
            forward, backward = member.profile.count
            alone = {*range(-forward, 0), *range(1, backward + 1)} - {pair[column] for pair in each.lanes}
            for lane in alone:
                assert borders(member, lane, s)[0] == pytest.approx(borders(member, lane, s)[1], abs=NEAR)


@given(seeds)
@settled
def test_connecting_roads_begin_and_end_on_the_reference_lines_of_the_arms(seed: int) -> None:
    network = drawn(seed).network
    for junction in network.junctions:
        for each in junction.connections:
            way = network.road(each.road).road
            for end, s, into in ((each.incoming, 0.0, "end"), (each.outgoing, way.length, "start")):
                arm = network.road(end.road).road
                at = 0.0 if end.contact == "start" else arm.length
                turned = 0.0 if end.contact == into else math.pi
                assert way.at(s) == pytest.approx(arm.at(at), abs=EXACT)
                heading = float(way.heading(s) - arm.heading(at)) - turned
                assert math.remainder(heading, 2 * math.pi) == pytest.approx(0, abs=EXACT)
                assert (arm.grade(at), float(np.ptp(way.at(np.linspace(0, way.length, 9))[:, 2]))) == (0, 0)


@given(seeds)
@settled
def test_what_is_written_is_read(seed: int) -> None:
    design, remarks = read_network_design(random_lanes_design(seed))
    again, remarks2 = read_network_design(json.loads(json.dumps(design.to_json())))
    assert (again, again.to_json(), remarks, remarks2) == (design, design.to_json(), (), ())


@given(seeds)
@settled
def test_a_stored_network_is_restored_exactly(seed: int) -> None:
    route = drawn(seed)
    stored = route.to_json()
    again = road_from_json(json.loads(json.dumps(stored)))
    assert isinstance(again, Route)
    assert again.legs == route.legs
    assert again.network.junctions == route.network.junctions
    assert again.network.continuations == route.network.continuations
    assert again.to_json() == stored


@given(seeds, st.floats(-200, 200), st.floats(-200, 200), st.floats(-50, 50), st.floats(-180, 180))
@settled
def test_a_design_that_is_moved_and_turned_gives_the_network_moved_and_turned(
    seed: int, dx: float, dy: float, dz: float, degrees: float
) -> None:
    moved = Motion(random_lanes_design(seed), (dx, dy, dz), degrees)
    one, other = drawn(seed), build_route(read_network_design(moved.design)[0], World())
    assert other.legs == one.legs
    assert other.network.continuations == one.network.continuations
    for a, b in zip(one.network.roads, other.network.roads, strict=True):
        assert (a.id, a.junction) == (b.id, b.junction)
        s = np.linspace(0, min(a.road.length, b.road.length), 5)
        for lane in (-1, -a.profile.count[0]):
            here, there = (
                each.road.at(s, np.array([offsets(each, lane, at)[1] for at in s])) for each in (a, b)
            )
            assert there == pytest.approx(moved(here), abs=NEAR)


@given(seeds)
@settled
def test_lanes_of_one_junction_do_not_meet_in_the_same_lane_from_two_sides(seed: int) -> None:
    """In a merge, each lane behind it has one lane before it; in an exit, each lane before it one behind."""
    network = drawn(seed).network
    for junction in network.junctions:
        if junction.kind in ("merge", "diverge"):
            links = [(c.incoming, c.outgoing, link) for c in junction.connections for link in c.lanes]
            assert len({(end, link.incoming) for end, _, link in links}) == len(links)
            assert len({(end, link.outgoing) for _, end, link in links}) == len(links)


@pytest.mark.parametrize("seed", range(8))
def test_the_paved_area_of_lanes_is_in_one_piece(seed: int) -> None:
    assert len(shapely.get_parts(drawn(seed).network.paved)) == 1


# ------------------------------------------------------------------------------------------- the route


def joint_stations(route: Route) -> np.ndarray:
    """Stations of the joints between a road and a junction."""
    found, s = [], 0.0
    for number, _ in groupby(leg.road for leg in route.legs):
        length = route.network.road(number).road.length
        if route.network.road(number).junction is not None:
            found += [s, s + length]
        s += length
    return np.array(found)


@given(seeds)
@settled
def test_the_driven_lane_has_no_step_along_the_whole_route(seed: int) -> None:
    route = drawn(seed)
    assert route.profile is not None
    step = 1e-4  # m
    s = np.arange(0.0, route.length - step, 0.05)
    s = np.unique(np.r_[s, [max(each - step / 2, 0.0) for each in route.starts[:-1]]])
    jump = np.abs(route.profile.middle(s + step) - route.profile.middle(s))
    near = np.zeros(len(s), bool)
    for each in joint_stations(route):
        near |= np.abs(s + step / 2 - each) < step
    steepest = 1.0  # of the offset, on a short way into the outer lane of a roundabout
    assert (jump[~near] <= steepest * step + NEAR).all()


@given(seeds)
@settled
def test_the_lane_of_a_route_has_no_step_where_it_enters_a_junction(seed: int) -> None:
    route = drawn(seed)
    assert route.profile is not None
    for s in joint_stations(route):
        before, after = (route.at(at, float(route.profile.middle(at))) for at in (s - 1e-6, s + 1e-6))
        assert before == pytest.approx(after, abs=1e-4)


def legs_on_roads(route: Route) -> Iterator[tuple[float, NetworkRoad, list[int]]]:
    """The start of each road of a route, the road, and the lanes that its legs name."""
    s = 0.0
    for number, group in groupby(route.legs, key=lambda leg: leg.road):
        member = route.network.road(number)
        yield s, member, [leg.lane for leg in group]
        s += member.road.length


@given(seeds)
@settled
def test_the_middle_of_the_route_lies_in_the_lane_that_the_leg_names(seed: int) -> None:
    route = drawn(seed)
    assert route.profile is not None
    for start, member, lanes in legs_on_roads(route):
        length = member.road.length
        windows = change_windows(length, len(lanes) - 1)
        stops = [0.0, *(s for window in windows for s in window), length]
        for lane, (first, last) in zip(lanes, list(zip(stops[::2], stops[1::2], strict=True)), strict=True):
            assert lane < 0
            for s in np.linspace(first + 1e-6, last - 1e-6, 7):
                inner, outer = offsets(member, lane, float(s))
                assert float(route.profile.middle(start + s)) == pytest.approx((inner + outer) / 2, abs=1e-5)
                assert float(route.profile.width(start + s)) == pytest.approx(inner - outer, abs=1e-5)


@given(seeds)
@settled
def test_the_edges_of_a_route_are_those_of_its_roads(seed: int) -> None:
    """Also where it changes the lane: what lies beside the lane fills the road."""
    route = drawn(seed)
    assert route.profile is not None
    for start, member, _ in legs_on_roads(route):
        for s in np.linspace(1e-6, member.road.length - 1e-6, 25):
            forward, backward = member.profile.count
            right = offsets(member, -forward, float(s))[1]
            left = offsets(member, backward, float(s))[1] if backward else offsets(member, -1, float(s))[0]
            edges = route.profile.edges(start + s)
            assert (float(edges.left), float(edges.right)) == pytest.approx((left, right), abs=1e-5)


@given(seeds)
@settled
def test_a_leg_that_changes_the_lane_begins_in_the_middle_of_the_change(seed: int) -> None:
    route = drawn(seed)
    assert route.profile is not None
    for n, (one, two) in enumerate(pairwise(route.legs), 1):
        if one.road != two.road:
            continue
        assert abs(one.lane - two.lane) == 1
        member = route.network.road(one.road)
        assert member.junction is None
        begun = next(s for s, each, _ in legs_on_roads(route) if each.id == one.road)
        s = route.starts[n] - begun
        borders_of_both = [*offsets(member, one.lane, s), *offsets(member, two.lane, s)]
        shared = [t for t in borders_of_both if sum(math.isclose(t, each) for each in borders_of_both) == 2]
        widths = [abs(np.subtract(*offsets(member, lane, s))) for lane in (one.lane, two.lane)]
        if math.isclose(*widths):  # not beside a lane that ends or begins
            assert float(route.profile.middle(route.starts[n])) == pytest.approx(shared[0], abs=1e-5)


def plain(*parts: dict[str, Any], first: dict[str, Any], length: float = 120.0) -> Route:
    """A route of straight roads with these places between them."""
    data: dict[str, Any] = {"starting_point": [0, 0, 0], "theta": 0, "lanes": first}
    for n in range(1, len(parts) + 2):
        data[f"road_segment{n}"] = {
            "distance": length, "direction": "straight", "incline": 0, "turn_degrees": 0,
        }  # fmt: skip
    for n, part in enumerate(parts, 1):
        data[f"junction{n}"] = {"after": n, **part}
    return build_route(read_network_design(data)[0], World())


def lanes_of(route: Route) -> list[list[int]]:
    return [lanes for _, member, lanes in legs_on_roads(route) if member.junction is None]


@pytest.mark.parametrize(
    ("first", "parts", "expected"),
    [
        ((2, 1), [{"kind": "lane_change", "side": "left"}], [[-2], [-2, -1]]),
        ((3, 0), [{"kind": "lane_change", "side": "left"}] * 2, [[-3], [-3, -2], [-2, -1]]),
        ((2, 2), [{"kind": "lane_change", "side": side} for side in ("left", "right")],
         [[-2], [-2, -1], [-1, -2]]),
        ((2, 1), [{"kind": "lane_change", "side": "right"}], [[-1], [-1, -2]]),
        ((3, 1), [{"kind": "lane_change", "side": "right"}] * 2, [[-1], [-1, -2], [-2, -3]]),
        ((2, 1), [{"kind": "t_junction", "take": "left"}, {"kind": "lane_change", "side": "left"}],
         [[-1], [-1, -2], [-2, -1]]),
        ((2, 1), [{"kind": "lane_drop"}], [[-1], [-1]]),
        ((2, 1), [{"kind": "lane_drop", "side": "left"}], [[-2], [-1]]),
        ((1, 1), [{"kind": "lane_gain"}], [[-1], [-1]]),
        ((1, 3), [{"kind": "lane_gain", "side": "left"}], [[-1], [-2]]),
        ((1, 0), [{"kind": "merge", "take": "ramp"}], [[-1], [-3, -2], [-2]]),
        ((2, 0), [{"kind": "merge", "take": "main"}], [[-2], [-2], [-2]]),
        ((2, 0), [{"kind": "diverge", "take": "ramp"}], [[-2], [-2, -3], [-1]]),
        ((2, 1), [{"kind": "diverge", "take": "main"}], [[-2], [-2], [-2]]),
        ((2, 2), [{"kind": "crossroads", "take": "left"}], [[-1], [-1]]),
        ((2, 2), [{"kind": "crossroads", "take": "right"}], [[-2], [-2]]),
        ((2, 2), [{"kind": "crossroads", "take": "straight"}], [[-2], [-2]]),
    ],
)  # fmt: skip
def test_a_route_changes_lanes_only_where_it_must(
    first: tuple[int, int], parts: list[dict[str, Any]], expected: list[list[int]]
) -> None:
    route = plain(*parts, first=dict(zip(("forward", "backward"), first, strict=True)))
    assert lanes_of(route) == expected


@pytest.mark.parametrize("take", ["ramp", "main"])
@pytest.mark.parametrize("kind", ["merge", "diverge"])
@pytest.mark.parametrize("forward", [1, 2, 3])
@pytest.mark.parametrize("length", [10.0, 95.0, 300.0])
def test_the_lane_of_a_ramp_is_as_long_as_asked(kind: str, take: str, forward: int, length: float) -> None:
    by_ramp = take == "ramp"
    main = {"forward": forward, "backward": 0}
    ramp = {"forward": 1, "backward": 0}
    part: dict[str, Any] = {"kind": kind, "take": take, "length": length}
    first = main
    if by_ramp and kind == "merge":
        first, part = ramp, {**part, "lanes": main}
    route = plain(part, first=first)
    beside = next(each for _, each, _ in legs_on_roads(route) if each.profile.count[0] == forward + 1)
    widths = [value(beside.profile.right[forward].width, s) for s in np.linspace(0, beside.road.length, 2001)]
    full = sum(width > 3.999 for width in widths) / 2000 * beside.road.length
    assert full == pytest.approx(length, abs=1.0)
    assert {round(widths[0], 6), round(widths[-1], 6)} == {0.0, 4.0}
    assert min(widths) >= 0
