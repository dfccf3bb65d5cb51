"""What is exported as OpenDRIVE and imported again is the same network."""

import math

import numpy as np
import pytest

from network.random_designs import random_design, random_lanes_design, random_turn_lanes_design
from network.random_maps import map_route
from roadgpt.export import exporter_of
from roadgpt.network import Network, Route, build_route, read_map
from roadgpt.road import World, read_design

CASES = [
    *(f"{kind} {seed}" for kind in ("junctions", "lanes", "left", "map") for seed in range(4)),
    *(f"{kind} {seed}" for kind in ("ramps", "turns") for seed in range(3)),
]


def route_of(case: str) -> Route:
    kind, seed = case.split()
    if kind == "map":
        return map_route(int(seed))
    data = random_design(int(seed)) if kind in ("junctions", "left") else random_lanes_design(int(seed))
    if kind in ("ramps", "turns"):
        data = random_lanes_design(int(seed) + 50) if kind == "ramps" else random_turn_lanes_design(int(seed))
    return build_route(read_design(data | ({"left_hand": True} if kind == "left" else {}))[0], World())


@pytest.fixture(scope="module", params=CASES)
def pair(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[Network, Network]:
    path = tmp_path_factory.mktemp("map") / "map.xodr"
    route = route_of(request.param)
    exporter_of("opendrive").save(route, path, World())
    read = read_map(path)
    assert read.remarks == ()
    assert read.roads == {str(each.id): (each.id,) for each in route.network.roads}
    return route.network, read.network


def test_the_roads_are_the_same(pair: tuple[Network, Network]) -> None:
    for one, two in zip(*(each.roads for each in pair), strict=True):
        assert (one.id, one.junction) == (two.id, two.junction)
        s = np.linspace(0.0, one.road.length, 40)
        assert two.road.length == pytest.approx(one.road.length, abs=1e-9)
        assert two.road.at(s) == pytest.approx(one.road.at(s), abs=1e-7)
        a, b = one.profile, two.profile
        assert a.centre_marking == b.centre_marking
        assert {n: (lane.kind, lane.marking) for n, lane in a.lanes.items()} == {
            n: (lane.kind, lane.marking) for n, lane in b.lanes.items()
        }
        for lane in a.lanes:
            assert b.edges_of(lane, s) == pytest.approx(np.array(a.edges_of(lane, s)), abs=1e-7)


def test_the_joints_are_the_same(pair: tuple[Network, Network]) -> None:
    one, two = (
        {
            frozenset(((each.before, a), (each.after, b)))
            for each in network.continuations
            for a, b in each.lanes
        }
        for network in pair
    )
    assert one == two


def test_the_junctions_are_the_same(pair: tuple[Network, Network]) -> None:
    for one, two in zip(*(each.junctions for each in pair), strict=True):
        assert (one.id, one.kind) == (two.id, two.kind)
        assert set(one.connections) == set(two.connections)
        assert len(one.connections) == len(two.connections)
        assert {(arm.end, arm.control, arm.crosswalk) for arm in one.arms} == {
            (arm.end, arm.control, arm.crosswalk) for arm in two.arms
        }
        first = [arm.end for arm in two.arms].index(one.arms[0].end)
        assert [arm.end for arm in one.arms] == [arm.end for arm in (*two.arms[first:], *two.arms[:first])]
        headings = {arm.end: arm.direction for arm in two.arms}
        for arm in one.arms:
            assert math.remainder(arm.direction - headings[arm.end], 2 * math.pi) == pytest.approx(
                0, abs=1e-6
            )
        assert two.node == pytest.approx(one.node, abs=1e-3)


def test_the_roundabouts_are_the_same(pair: tuple[Network, Network]) -> None:
    one, two = ({frozenset(each.junctions): each for each in network.roundabouts} for network in pair)
    assert one.keys() == two.keys()
    for key, ring in one.items():
        other = two[key]
        first = other.ring.index(ring.ring[0])
        assert (*other.ring[first:], *other.ring[:first]) == ring.ring
        assert (other.radius, other.width) == pytest.approx((ring.radius, ring.width), abs=1e-3)
        assert other.centre == pytest.approx(ring.centre, abs=1e-3)
