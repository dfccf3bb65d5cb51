"""Laws of networks with several lanes, ramps, and lanes that end, begin and are changed.

The borders of lanes are computed here by the formulas of OpenDRIVE.
"""

import math
from collections.abc import Iterator
from functools import cache
from itertools import groupby, pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from network.random_designs import random_lanes_design
from network.shared_laws import check_that_ways_join_the_arms
from roadgpt.geometry import CubicProfile
from roadgpt.network import NetworkRoad, RoadEnd, Route, build_route
from roadgpt.network.lane_along import change_windows
from roadgpt.road import World, read_design

settled = settings(max_examples=10, deadline=None)
seeds = st.integers(0, 9)
"""Few, so that all laws look at the same networks."""
EXACT = 1e-9  # m and rad
NEAR = 1e-6  # m


@cache
def drawn(seed: int) -> Route:
    return build_route(read_design(random_lanes_design(seed))[0], World())


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
    return build_route(read_design(data)[0], World())


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
@pytest.mark.parametrize(("forward", "length"), [(1, 10.0), (2, 95.0), (3, 300.0)])
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
