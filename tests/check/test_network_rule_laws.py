"""Laws of the rules of networks, and slow second opinions on what they measure."""

from collections.abc import Iterator
from dataclasses import replace
from itertools import combinations
from typing import Any

import numpy as np
import pytest
import shapely

from network.changing import WORLD, built, passing, with_plan
from network.random_designs import random_design
from roadgpt import check, plugins
from roadgpt.check import Finding, inspect, inspect_network
from roadgpt.check.footprint import footprint
from roadgpt.errors import PartError, UsageError
from roadgpt.network import Network, NetworkRoad, RoadEnd, Route, build_route, read_network_design
from roadgpt.network.paved import ribbon
from roadgpt.road import Site, World

LARGE = World(site=Site(map_size=10_000))
SEEDS = range(25)


@pytest.fixture(autouse=True)
def _fresh_rules() -> Iterator[None]:
    check.network_rules_of.cache_clear()
    yield
    check.network_rules_of.cache_clear()


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
    pairs = {(each.one.id, each.other.id): each.area for each in found}
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


def test_a_station_of_a_finding_is_one_of_the_route() -> None:
    for seed in SEEDS:
        route = route_of(crowded(seed))
        for each in inspect(route, None, LARGE):
            if each.s is not None:
                assert 0 <= each.s <= route.length


def test_a_route_is_checked_by_the_rules_of_networks() -> None:
    route = passing("crossroads")
    assert inspect(route, None, WORLD) == ()
    small = World(site=Site(map_size=100))
    assert {each.rule for each in inspect(route, None, small)} == {"leaves_map"}
    assert inspect(route, None, small) == inspect_network(route.network, route, small)


def test_a_route_is_no_test_of_sbft() -> None:
    (found,) = inspect(passing("t_junction"), None, WORLD, rules="sbft")
    assert found.sentence == "the road leads through junctions, and SBFT tests are single roads"


def test_an_unknown_rule_set_is_refused_for_routes_too() -> None:
    with pytest.raises(UsageError, match="no rule set called 'lax'"):
        inspect(passing("t_junction"), None, WORLD, rules="lax")


def test_a_network_without_numbers_is_not_measured_further() -> None:
    network = passing("crossroads").network
    broken = tuple(with_plan(each, x=np.nan) if each.id == 1 else each for each in network.roads)
    found = inspect_network(replace(network, roads=broken), None, WORLD)
    assert [each.rule for each in found] == ["finite"]


def test_rules_of_other_packages_follow_ours(monkeypatch: pytest.MonkeyPatch) -> None:
    def no_stars(network: Network, route: Route | None, world: World) -> tuple[Finding, ...]:
        return (Finding("no_stars", f"the network has {len(network.roads)} roads"),)

    names, find = plugins.names, plugins.find
    monkeypatch.setattr(plugins, "names", lambda kind: sorted([*names(kind), "a_rule_of_others"]))
    monkeypatch.setattr(
        plugins, "find", lambda kind, name: no_stars if name == "a_rule_of_others" else find(kind, name)
    )
    found = inspect(passing("crossroads"), None, World(site=Site(map_size=100)))
    assert [each.rule for each in found][-1] == "no_stars"


def test_a_missing_rule_lets_no_network_pass(monkeypatch: pytest.MonkeyPatch) -> None:
    without = [name for name in plugins.names("network_rules") if name != "unreachable"]
    monkeypatch.setattr(plugins, "names", lambda kind: without)
    with pytest.raises(PartError, match="no network_rule called 'unreachable'"):
        inspect(passing("crossroads"), None, WORLD)


def test_every_rule_of_ours_is_applied() -> None:
    assert {name for name, _ in check.network_rules_of()} >= set(check.NETWORK_RULES)
    ours = {
        name
        for name in plugins.names("network_rules")
        if plugins.module_of("network_rules", name).startswith("roadgpt.")
    }
    assert ours == set(check.NETWORK_RULES)


def test_a_design_that_passes_is_far_from_the_limits() -> None:
    """Nothing is found in a network that was placed with care: two junctions and a roundabout."""
    data = {
        "starting_point": [60, 250, 0],
        "theta": 0,
        "road_segment1": {"distance": 60, "direction": "straight", "incline": 3, "turn_degrees": 0},
        "junction1": {"after": 1, "kind": "crossroads", "take": "straight", "control": "yield"},
        "road_segment2": {"distance": 60, "direction": "straight", "incline": -3, "turn_degrees": 0},
        "junction2": {"after": 2, "kind": "roundabout", "take": 3, "radius": 14},
        "road_segment3": {"distance": 90, "direction": "left", "incline": 0, "turn_degrees": 40},
    }
    assert inspect(built(data), None, WORLD) == ()
