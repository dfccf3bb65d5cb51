"""Designs of maps: each fault is said in one sentence that names what to do."""

import copy
import json
import math
import random
from pathlib import Path
from typing import Any

import pytest

from network.random_maps import random_map
from network.shared_laws import sentence_of
from roadgpt.check import inspect
from roadgpt.drive import simulate
from roadgpt.errors import UsageError
from roadgpt.network import (
    MapDesign,
    Route,
    build_map,
    read_any_design,
    read_road,
    read_source,
    road_from_json,
)
from roadgpt.network.map_design import has_nodes, read_map_design
from roadgpt.road import CrossSection, World

GOOD: dict[str, Any] = {
    "lanes": {"width": 3.5},
    "node1": {"at": [20, 80, 0], "kind": "end"},
    "node2": {"at": [80, 80, 0], "kind": "t_junction", "control": "stop", "kerb": 8},
    "node3": {"at": [150, 80, 1], "kind": "bend", "radius": 20},
    "node4": {"at": [150, 150, 1], "kind": "roundabout", "radius": 12},
    "node5": {"at": [80, 150, 1], "kind": "bend"},
    "node6": {"at": [220, 150, 1], "kind": "end"},
    "roads": [[1, 2], [2, 3], [3, 4], [4, 5], [5, 2], [4, 6]],
    "route": [1, 2, 3, 4, 6],
}
ODD = (
    *(None, True, "", "x", [], {}, [[]], [1], {"at": 1}, "NaN"),
    *(0, -1, 7, 1.5, 1e308, -1e308, math.nan, math.inf, 10**400),
)


def built(data: Any) -> Route:
    return build_map(read_map_design(data)[0], World())


def said(data: Any) -> str:
    return sentence_of(built, data)


def changed(**fields: Any) -> dict[str, Any]:
    """The good map with other fields, or other fields of a node; None for a field that is left out."""
    data = copy.deepcopy(GOOD)
    for key, value in fields.items():
        is_node = isinstance(value, dict) and key.startswith("node") and key in data
        data[key] = {**data[key], **value} if is_node else value
        if is_node:
            data[key] = {name: each for name, each in data[key].items() if each is not None}
    return {key: value for key, value in data.items() if value is not None}


def test_a_map_is_built_with_its_route() -> None:
    route = built(GOOD)
    assert [each.entered.kind for each in route.passages] == ["t_junction", "roundabout"]
    assert len(route.network.plain_roads) == 4 + 3  # three of them are pieces of the ring
    assert route.at(0.0).tolist() == [20, 80, 0]
    assert route.at(route.length) == pytest.approx([220, 150, 1], abs=1e-9)


@pytest.mark.parametrize("left_hand", [False, True])
@pytest.mark.parametrize("route", [None, []])
def test_a_map_may_have_no_route(route: list[int] | None, left_hand: bool) -> None:
    data = changed(route=route, left_hand=left_hand)
    design = read_map_design(data)[0]
    assert "route" not in design.to_json()
    assert read_map_design(design.to_json())[0] == design
    found, whole = build_map(design, World()).on_ground(), built(changed(left_hand=left_hand))
    assert found.to_route_json() == {"route": []}
    assert found.network.junctions == whole.network.junctions  # the map itself is the same
    assert [each.road.length for each in found.network.roads] == [
        each.road.length for each in whole.network.roads
    ]
    assert inspect(found, None, World()) == inspect(whole, None, World()) == ()
    again = road_from_json(json.loads(json.dumps(found.to_json())))
    assert isinstance(again, Route)
    assert again.legs == ()
    assert again.to_json() == found.to_json()


def test_the_rules_check_a_map_without_a_route() -> None:
    steep = changed(route=None, node6={"at": [220, 150, 40]})
    found = inspect(built(steep).on_ground(), None, World())
    assert "too_steep" in {finding.rule for finding in found}
    assert {finding.s for finding in found} == {None}  # there is no route on which they could lie


def test_a_map_without_a_route_is_not_driven() -> None:
    with pytest.raises(UsageError, match=r'a map without a route cannot be driven; .* "route": \[1, 2, 4\]$'):
        simulate(built(changed(route=None)).on_ground(), World(), "reference")


def test_a_road_may_lead_back_to_its_junction_and_a_route_back_at_a_roundabout() -> None:
    loop = changed(route=[1, 2, 3, 4, 5, 2, 1])
    assert [each.entered.kind for each in built(loop).passages] == ["t_junction", "roundabout", "t_junction"]
    back = built(changed(route=[6, 4, 6]))
    assert back.legs[0].road == back.legs[-1].road
    around = {key: value for key, value in changed().items() if key != "node6"}
    around["node4"] = {"at": [150, 150, 1], "kind": "bend", "radius": 25}
    around |= {"roads": GOOD["roads"][:5], "route": [1, 2, 3, 4, 5, 2, 1]}
    assert len(built(around).passages) == 2


@pytest.mark.parametrize(
    ("fields", "wanted"),
    [
        ({"node1": {"kind": "house"}}, "node 1 cannot be read: kind: is unknown; give "),
        ({"node1": {"kind": None}}, "node 1 cannot be read: kind: is missing; add it"),
        ({"node1": {"at": None}}, "node 1 cannot be read: at: is missing; add it"),
        ({"node1": {"at": [1, 2]}}, "at: give x, y and the height, as in [20, 80, 0]"),
        ({"node1": {"at": [1, 2, True]}}, "at: is not a number"),
        ({"node1": {"at": [1, 2, math.nan]}}, "at.2: is not finite"),
        ({"node1": {"at": [1e9, 2, 0]}}, "node 1 is beyond 25,000,000; give smaller numbers"),
        ({"node1": {"colour": 1}}, "colour: is not a field of a design; remove it"),
        ({"node2": {"kerb": 0.5}}, "node 2 cannot be read: kerb: is out of range; give 1 or more"),
        ({"node2": {"control": "maybe"}}, "control: is unknown"),
        ({"node2": {"kind": "crossroads"}}, "node 2 is a crossroads, which has 4 roads, and here it has 3"),
        ({"node1": {"kind": "bend"}}, "node 1 is a bend, which has 2 roads, and here it has 1 road; change"),
        ({"node3": {"kind": "end"}}, "node 3 is an end, which has 1 road, and here it has 2 roads;"),
        ({"node4": {"radius": 4}}, "node 4: an island with a radius of 4 m is too small for its arms; give"),
        ({"node3": {"radius": 3}}, "node 3: a bend with a radius of 3 m is tighter than the lane beside"),
        ({"node3": {"radius": 60}}, "nodes 2 and 3 are 70.0 m apart, and their junctions or bends take"),
        ({"node1": {"at": [80.5, 80, 0]}}, "nodes 1 and 2 are less than 1 m apart; move them apart"),
        ({"node1": {"at": [150, 100, 0]}}, "from node 2 to nodes 3 and 1 are 16 degrees apart, and 25 are"),
        ({"node5": {"at": [80, 101, 1]}}, "are 21.0 m apart, and their junctions or bends take"),
        ({"node8": GOOD["node1"]}, "the nodes of a map are numbered node1, node2 and so on, 2 to"),
        ({"node7": {"at": [0, 0, 0], "kind": "end"}}, "node 7 is an end, which has 1 road, and here it"),
        ({"nodex": 5}, "the map has a field 'nodex' that is unknown; the fields are lanes, left_hand, node1"),
        ({"node1": None}, "the nodes of a map are numbered"),
        ({"node01": GOOD["node1"]}, "the map has a field 'node01' that is unknown"),
        ({"node999999": GOOD["node1"]}, "the nodes of a map are numbered node1, node2 and so on, 2 to 400"),
        ({"roads": None}, "roads are a list of 1 to 800 pairs of nodes, such as [[1, 2], [2, 3]]"),
        ({"roads": [[1, 2, 3]]}, "road 1 is a list of two numbers of nodes, such as [1, 2]"),
        ({"roads": [[1, 2.0]]}, "road 1 is a list of two numbers of nodes"),
        ({"roads": [[1, 9]]}, "road 1 names node 9, and there are nodes 1 to 6"),
        ({"roads": [[1, 1]]}, "road 1 joins node 1 to itself; give two different nodes"),
        ({"roads": [*GOOD["roads"], [2, 1]]}, "two roads join nodes 2 and 1; leave one out"),
        ({"route": 5}, "the route is a list of two or more numbers of nodes, such as [1, 2]"),
        ({"route": [1]}, "the route is a list of two or more numbers"),
        ({"route": [1, True]}, "the route is a list of two or more numbers"),
        ({"route": [1, 3]}, "the route goes from node 1 to node 3, and no road joins them"),
        ({"route": [1, 2, 3]}, "the route begins or ends at node 3, a bend; take a junction or an end"),
        ({"route": [1, 2, 1]}, "the route turns back at node 2, and one can only at a roundabout"),
        ({"lanes": 4}, "the lanes of the map cannot be read: give an object with width"),
        ({"lanes": {"width": 1.0}}, "the lanes of the map cannot be read: width: is out of range"),
    ],
)  # fmt: skip
def test_a_map_that_is_wrong(fields: dict[str, Any], wanted: str) -> None:
    assert wanted in said(changed(**fields))


def test_parts_that_no_road_joins_and_bends_only() -> None:
    lone = changed(node7={"at": [0, 10, 0], "kind": "end"}, node8={"at": [90, 10, 0], "kind": "end"})
    lone["roads"] = [*GOOD["roads"], [7, 8]]
    assert said(lone) == "no roads lead from node 1 to node 7; join them or leave node 7 out"
    ring = {
        f"node{n}": {"at": at, "kind": "bend"}
        for n, at in enumerate([[0, 0, 0], [90, 0, 0], [90, 90, 0], [0, 90, 0]], 1)
    }
    ring |= {"roads": [[1, 2], [2, 3], [3, 4], [4, 1]], "route": [1, 2]}
    assert said(ring).startswith("all nodes are bends, so that no road begins or ends")


def test_too_steep_a_road_is_built_and_the_rules_say_so(tmp_path: Path) -> None:
    route = built(changed(node1={"at": [20, 80, 30]}))
    assert route.at(0.0)[2] == 30
    assert abs(float(route.at(route.passages[0].start)[2])) < 1e-9


def test_a_map_is_read_from_a_file(tmp_path: Path) -> None:
    path = tmp_path / "map.json"
    path.write_text(json.dumps(GOOD))
    blueprint, remarks, *_ = read_source(path)
    assert blueprint == read_any_design(GOOD)[0] == read_map_design(GOOD)[0]
    assert remarks == ()
    assert read_road(path).length == pytest.approx(built(GOOD).length)
    with pytest.raises(UsageError, match="leave out --geometry spline"):
        read_road(path, "spline")


def test_has_nodes() -> None:
    assert has_nodes(GOOD)
    assert not has_nodes({"nodes": []})
    assert not has_nodes([1])


def test_a_world_with_other_lanes_is_refused() -> None:
    with pytest.raises(UsageError, match="leave out --lanes"):
        build_map(read_map_design(GOOD)[0], World(section=CrossSection(lanes="2+1")))


def test_a_map_is_printed_with_its_junctions() -> None:
    assert repr(read_map_design(GOOD)[0]) == "MapDesign(6 roads, junctions: 1 t-junction, 1 roundabout)"


@pytest.mark.parametrize("seed", range(150))
def test_a_spoilt_map_is_built_or_refused_in_one_sentence(seed: int) -> None:
    rng = random.Random(seed)
    data = copy.deepcopy(GOOD) if seed % 3 else random_map(seed % 8).to_json()
    for _ in range(rng.randint(1, 3)):
        _spoil(data, rng)
    sentence = _outcome(data)
    assert "\n" not in sentence
    assert 0 < len(sentence) < 400


def _outcome(data: Any) -> str:
    """What is said of a map, or how long its route is."""
    try:
        design = read_any_design(data)[0]
        assert isinstance(design, MapDesign)
        length = build_map(design, World()).length
    except UsageError as error:
        return str(error)
    return f"{length:g}" if math.isfinite(length) else ""


def _spoil(data: Any, rng: random.Random) -> None:
    """Puts something else in one place of parsed JSON."""
    while True:
        keys = list(data) if isinstance(data, dict) else list(range(len(data)))
        key = rng.choice(keys)
        if isinstance(data[key], (dict, list)) and data[key] and rng.random() < 0.8:
            data = data[key]
            continue
        if rng.random() < 0.2:
            del data[key]
        else:
            data[key] = rng.choice(ODD)
        return


def test_a_mirrored_map_has_its_own_order_of_roads() -> None:
    design, _ = read_map_design(GOOD)
    before = design.neighbours, design.chains
    mirrored = design.mirrored(100.0)
    fresh = MapDesign.model_validate(mirrored.model_dump())
    assert (mirrored.neighbours, mirrored.chains) == (fresh.neighbours, fresh.chains)
    assert mirrored.neighbours != before[0]
