"""Laws of the rules of networks, and slow second opinions on what they measure."""

from itertools import combinations
from typing import Any

import numpy as np
import pytest
import shapely

from network.changing import WORLD, passing
from network.random_designs import random_design
from roadgpt import check, plugins
from roadgpt.check import inspect, inspect_network
from roadgpt.check.footprint import footprint
from roadgpt.network import Network, NetworkRoad, RoadEnd, Route, build_route, read_network_design
from roadgpt.network.paved import ribbon
from roadgpt.road import Site, World

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
    return build_route(read_network_design(data)[0], LARGE)


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
    rule = plugins.find("network_rules", "conflicting_overlap")
    verdicts = {bool(rule((route := route_of(crowded(seed))).network, route, LARGE)) for seed in SEEDS}
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
    for name, rule in check.network_rules_of():
        for found in (rule(route.network, route, WORLD), rule(route.network, None, WORLD)):
            assert isinstance(found, tuple)
            assert {each.rule for each in found} <= {name}
            assert all(each.sentence and "\n" not in each.sentence for each in found)


def test_a_route_is_checked_by_the_rules_of_networks() -> None:
    route = passing("crossroads")
    assert inspect(route, None, WORLD) == ()
    small = World(site=Site(map_size=100))
    assert {each.rule for each in inspect(route, None, small)} == {"leaves_map"}
    assert inspect(route, None, small) == inspect_network(route.network, route, small)


def test_a_route_is_no_test_of_sbft() -> None:
    (found,) = inspect(passing("t_junction"), None, WORLD, rules="sbft")
    assert found.sentence == "the road leads through junctions, and SBFT tests are single roads"
