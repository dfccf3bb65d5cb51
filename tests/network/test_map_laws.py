"""Laws of maps: roads join, all of them are connected, and what is written is read."""

import json
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from network.random_maps import PLANS, WORLD, map_route, random_map
from network.shared_laws import check_that_ways_join_the_arms
from roadgpt.brief.plan import read_plan
from roadgpt.check import inspect
from roadgpt.check.measures import measured_map
from roadgpt.network import road_from_json
from roadgpt.network.growing import signs_at
from roadgpt.road import read_design

settled = settings(max_examples=8, deadline=None)
seeds = st.integers(0, 7)
"""Few, so that all laws look at the same maps, one of each plan."""
EXACT = 1e-6  # m and rad


@given(seeds)
@settled
def test_connecting_roads_begin_and_end_on_the_arms(seed: int) -> None:
    check_that_ways_join_the_arms(map_route(seed).network, EXACT)


@given(seeds)
@settled
def test_a_map_is_connected_and_breaks_no_rule(seed: int) -> None:
    route = map_route(seed)
    assert measured_map(route.network).parts == 1
    assert inspect(route, read_plan(PLANS[seed % len(PLANS)]), WORLD) == ()


@given(seeds)
@settled
def test_what_is_written_is_read(seed: int) -> None:
    design, route = random_map(seed), map_route(seed)
    again, remarks = read_design(json.loads(json.dumps(design.to_json())))
    assert again == design
    assert remarks == ()
    assert again.to_json() == design.to_json()
    written = json.loads(json.dumps(route.on_ground().to_json()))
    assert road_from_json(written).to_json() == written


@given(seeds)
@settled
def test_the_route_passes_the_junctions_that_the_design_names(seed: int) -> None:
    design, route = random_map(seed), map_route(seed)
    driven = [design.nodes[n - 1] for n in design.route]
    named = [node.at for node in driven[1:-1] if node.is_junction]
    assert [each.entered.node for each in route.passages] == named
    start, end = driven[0], driven[-1]
    if start.kind == end.kind == "end":
        assert route.at(0.0) == pytest.approx(start.at)
        assert route.at(route.length) == pytest.approx(end.at, abs=EXACT)


@given(seeds)
@settled
def test_bends_are_as_wide_as_the_design_says(seed: int) -> None:
    design = random_map(seed)
    least = min((node.radius or 20.0 for node in design.nodes if node.kind == "bend"), default=None)
    plans = [each.road.plan for each in map_route(seed).network.plain_roads]
    bends = [abs(piece.k0) for plan in plans for piece in plan.pieces if piece.k0 == piece.k1 != 0]
    rings = [node.radius for node in design.nodes if node.kind == "roundabout"]
    widest = max([1 / least] if least else [0.0], default=0.0)
    assert all(k <= widest + 1e-9 or any(k == pytest.approx(1 / r) for r in rings if r) for k in bends)


@given(seeds)
@settled
def test_the_main_road_of_a_junction_has_no_sign(seed: int) -> None:
    design = random_map(seed)
    for number, node in enumerate(design.nodes, 1):
        if not node.is_junction or node.kind == "roundabout" or node.control not in ("stop", "yield"):
            continue
        others = [n for road in design.roads if number in road for n in road if n != number]
        ways = [np.subtract(design.nodes[n - 1].at, node.at) for n in others]
        directions = sorted(math.atan2(y, x) for x, y, _ in ways)
        signs = signs_at(node, directions)
        assert signs.count("priority") == 2
        assert signs.count(node.control) == len(directions) - 2
