"""A Route: its length, places, heights and lanes are those of its legs; other chains of roads are refused."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from network.changing import built, design, passing
from network.random_designs import random_design
from road_parts import road_of
from roadgpt.errors import UsageError
from roadgpt.network import (
    Leg,
    Network,
    Route,
    build_route,
    legs_of,
    network_of,
    only_road,
)
from roadgpt.road import CrossSection, World, read_design

settled = settings(max_examples=14, deadline=None)
seeds = st.integers(0, 10_000)
BACK = {"kind": "roundabout", "take": 4}


def drawn(seed: int) -> Route:
    return build_route(read_design(random_design(seed))[0], World())


@pytest.fixture(scope="module", params=[*range(6), "back", "first exit"])
def route(request: pytest.FixtureRequest) -> Route:
    if isinstance(request.param, int):
        return drawn(request.param)
    return built(design(60.0, BACK)) if request.param == "back" else passing("roundabout", 1)


def test_a_route_is_its_legs_one_after_another(route: Route) -> None:
    lengths = [route.network.road(leg.road).road.length for leg in route.legs]
    assert route.length == pytest.approx(math.fsum(lengths), abs=1e-9)
    assert route.starts == pytest.approx(np.r_[0.0, np.cumsum(lengths)], abs=1e-9)
    for start, leg, length in zip(route.starts, route.legs, lengths, strict=False):
        u = np.linspace(1e-6, length - 1e-6, 9)
        road = route.network.road(leg.road).road
        forward = leg.lane < 0
        own = u if forward else length - u
        sign = 1 if forward else -1
        for t in (0.0, -2.0, 3.0):
            assert route.at(start + u, t) == pytest.approx(road.at(own, sign * t), abs=1e-6)
        turned = route.heading(start + u) - road.heading(own) - (0 if forward else math.pi)
        assert np.cos(turned) == pytest.approx(1, abs=1e-12)
        assert route.curvature(start + u) == pytest.approx(sign * road.curvature(own), abs=1e-7)
        assert route.grade(start + u) == pytest.approx(sign * road.grade(own), abs=1e-6)


def test_the_lane_of_a_route_is_the_lane_of_its_legs(route: Route) -> None:
    assert route.profile is not None
    for start, leg in zip(route.starts, route.legs, strict=False):
        member = route.network.road(leg.road)
        u = np.linspace(1e-6, member.road.length - 1e-6, 7)
        own = u if leg.lane < 0 else member.road.length - u
        edges = member.profile.edges(own)
        width = -edges.right if leg.lane < 0 else edges.left
        assert route.profile.width(start + u) == pytest.approx(width, abs=1e-6)
        assert route.profile.middle(start + u) == pytest.approx(-width / 2, abs=1e-6)
        against = edges.left if leg.lane < 0 else -edges.right
        assert route.profile.edges(start + u).left == pytest.approx(against, abs=1e-6)


@given(seeds)
@settled
def test_a_route_has_no_jump(seed: int) -> None:
    route = drawn(seed)
    s = np.linspace(0, route.length, 4000)
    points = route.at(s)
    step = route.length / 3999
    assert np.hypot(*np.diff(points[:, :2], axis=0).T) == pytest.approx(step, rel=1e-3)
    heights = route.elevation.height(s)
    assert np.abs(np.diff(heights)).max() <= 0.09 * step  # designs climb by at most 8 %
    assert np.abs(np.diff(route.heading(s))).max() < step / 3


@given(seeds)
@settled
def test_the_junctions_on_the_way_are_those_of_the_design(seed: int) -> None:
    data = random_design(seed)
    kinds = [data[f"junction{n}"]["kind"] for n in range(1, 9) if f"junction{n}" in data]
    route = drawn(seed)
    assert [each.entered.kind for each in route.passages] == kinds
    for s, _, junction, *_ in route.passages:
        x, y, _ = route.at(s)
        assert math.hypot(x - junction.node[0], y - junction.node[1]) < 60
        assert any(
            np.allclose(route.network.road(arm.end.road).road.at(
                0.0 if arm.end.contact == "start" else route.network.road(arm.end.road).road.length
            )[:2], (x, y), atol=1e-6)
            for arm in junction.arms
        )  # fmt: skip


@pytest.mark.parametrize(("angle", "take"), [(-90, 1), (0, 2), (90, 3)])
def test_a_turn_changes_the_heading_by_the_angle_of_the_arm(angle: float, take: int) -> None:
    route = passing("crossroads", take)
    turned = float(route.heading(route.length) - route.heading(0.0))
    assert math.degrees(turned) == pytest.approx(angle, abs=1e-9)


@pytest.mark.parametrize("exit_", [1, 2, 3, 4])
def test_an_exit_of_a_roundabout_is_counted_from_the_right(exit_: int) -> None:
    """Four arms at right angles: exit n is 90 n degrees further around the ring than where one arrives."""
    route = built(design(60.0, BACK)) if exit_ == 4 else passing("roundabout", exit_)
    (ring,) = route.network.roundabouts
    x, y, _ = ring.centre
    ends = route.at(np.array([0.0, route.length]))
    angles = np.arctan2(ends[:, 1] - y, ends[:, 0] - x)
    around = math.degrees(angles[1] - angles[0]) % 360
    assert around == pytest.approx(90 * exit_ % 360, abs=1e-6)
    assert sum(leg.road in ring.ring for leg in route.legs) == exit_
    is_back = route.legs[-1].road == route.legs[0].road
    assert (route.legs[-1].lane, is_back) == ((1, True) if exit_ == 4 else (-1, False))


def test_the_way_back_is_driven_on_the_other_side_of_the_same_road() -> None:
    route = built(design(60.0, BACK))
    assert route.at(route.length)[:2] == pytest.approx(route.at(0.0)[:2], abs=1e-6)
    there, back = route.at(10.0, -2.0), route.at(route.length - 10.0, -2.0)
    assert math.dist(there[:2], back[:2]) == pytest.approx(4.0, abs=1e-6)


@pytest.mark.parametrize(("lanes", "driven"), [("1+1", -1), ("2+1", -2), ("3+0", -3)])
def test_a_single_road_is_a_network_of_one_road_that_is_driven_from_end_to_end(
    lanes: str, driven: int
) -> None:
    world = World(section=CrossSection(lanes=lanes))
    road = world.lay(road_of((60.0, 0.0, 2.0), (50.0, 70.0, 0.0)))
    network, (leg,) = network_of(road, world), legs_of(road, world)
    assert (network.junctions, network.continuations) == ((), ())
    (member,) = network.roads
    assert leg == (member.id, driven)
    assert member.profile == world.profile_of(road)
    only = only_road(road, world)
    assert only is not None
    s = np.linspace(0.0, road.length, 40)
    np.testing.assert_array_equal(only.road.at(s, -1.5), road.at(s, -1.5))
    assert road.has_way
    assert road.passages == ()
    assert road.starts == (0.0, road.length)
    assert only_road(drawn(0), world) is None


class TestRefusals:
    route = built(design(60.0, {"kind": "crossroads", "take": 2}, 60.0))

    def refused(self, *legs: tuple[int, int]) -> str:
        with pytest.raises(UsageError) as error:
            Route.along(self.route.network, [Leg(*leg) for leg in legs])
        said = str(error.value)
        assert "\n" not in said
        return said

    def test_no_leg_means_that_no_route_was_asked_for(self) -> None:
        none = Route.along(self.route.network, [])
        assert not none.has_way
        assert self.route.has_way
        assert none.to_json()["route"] == []
        assert none.passages == ()
        assert none.mirrored.to_json()["route"] == []
        assert repr(none) == "Route(none asked for, 4 roads)"
        with pytest.raises(UsageError, match="the network has no road outside junctions"):
            Route.along(Network((), (), ()), [])

    def test_a_road_that_does_not_exist(self) -> None:
        assert self.refused((999, -1)) == "the route names road 999, which is not in the network"

    @pytest.mark.parametrize("lane", [0, -2, 2])
    def test_a_lane_that_does_not_exist(self, lane: int) -> None:
        assert self.refused((1, lane)) == f"the route names lane {lane} of road 1, which has no such lane"

    def test_a_connecting_road_is_driven_one_way(self) -> None:
        (_, way, after) = self.route.legs
        assert "has no such lane" in self.refused((after.road, 1), (way.road, 1), (1, 1))

    def test_roads_that_are_not_joined(self) -> None:
        (_, way, after) = self.route.legs
        assert "no way leads from road 1 to road" in self.refused((1, -1), (after.road, -1))
        assert "cannot change from lane -1 to lane -1 of road 1" in self.refused((1, -1), (1, -1))
        assert "no way leads from road 1 to road" in self.refused((1, 1), way, after)
        other = next(
            arm.end.road
            for arm in self.route.network.junctions[0].arms
            if arm.end.road not in (1, after.road)
        )
        assert f"to road {other}" in self.refused((1, -1), way, (other, -1))
        assert f"to road {after.road}" in self.refused((1, -1), way, (after.road, 1))

    def test_an_end_inside_a_junction(self) -> None:
        (first, way, after) = self.route.legs
        for legs in ([first, way], [way, after], [way]):
            assert self.refused(*legs) == "a route begins and ends on a road outside junctions"


@pytest.mark.parametrize("left_hand", [False, True])
def test_a_route_begins_and_ends_also_on_the_ring_of_a_roundabout(left_hand: bool) -> None:
    """Each way inside passes one arm: on the ring it leaves at the first of them, from an arm at the next."""
    whole = built(design(60.0, BACK) | {"left_hand": left_hand})
    network, legs = whole.network, whole.legs
    own = [leg.road in network.roundabouts[0].ring for leg in legs]
    places = [n for n, is_on_ring in enumerate(own) if is_on_ring]
    assert len(places) == 4
    for first in (0, *places):
        for last in (*places, len(legs) - 1):
            if last < first:
                continue
            route = Route.along(network, legs[first : last + 1]).on_ground()
            assert route.length == pytest.approx(whole.starts[last + 1] - whole.starts[first])
            ways = [n for n in range(first, last + 1) if network.road(legs[n].road).junction is not None]
            if not ways:
                assert (first, route.passages) == (last, ())
                continue
            (passage,) = route.passages
            assert passage.start == pytest.approx(whole.starts[ways[0]] - whole.starts[first])
            assert passage.end == pytest.approx(whole.starts[ways[-1] + 1] - whole.starts[first])
            assert passage.arrival.road == legs[ways[0] - 1].road
            assert passage.departure.road == legs[ways[-1] + 1].road
            assert passage.control == ("none" if own[first] else "yield")
            if last == len(legs) - 1:
                assert passage.exit == len(ways) - (not own[first])
