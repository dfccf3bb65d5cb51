"""Designs of maps: each fault is said in one sentence that names what to do."""

import copy
import json
import math
import random
from typing import Any

import pytest

from network.random_maps import random_map
from network.shared_laws import sentence_of
from roadgpt.check import inspect
from roadgpt.drive import simulate
from roadgpt.errors import UsageError
from roadgpt.network import Route, build_route, road_from_json
from roadgpt.road import World
from roadgpt.road.design import read_design
from tables import rows

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
    return build_route(read_design(data)[0], World())


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
    design = read_design(data)[0]
    assert "route" not in design.to_json()
    assert read_design(design.to_json())[0] == design
    found, whole = build_route(design, World()).on_ground(), built(changed(left_hand=left_hand))
    assert found.to_json()["route"] == []
    assert found.network.junctions == whole.network.junctions  # the map itself is the same
    assert [each.road.length for each in found.network.roads] == [
        each.road.length for each in whole.network.roads
    ]
    assert inspect(found, None, World()) == inspect(whole, None, World()) == ()
    again = road_from_json(json.loads(json.dumps(found.to_json())))
    assert isinstance(again, Route)
    assert again.legs == ()
    assert again.to_json() == found.to_json()


def test_a_map_without_a_route_is_not_driven() -> None:
    with pytest.raises(UsageError, match=r"a map without a route cannot be driven; .*, or take"):
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
    rows(__file__, "a_map_that_is_wrong"),
)  # fmt: skip
def test_a_map_that_is_wrong(fields: dict[str, Any], wanted: str) -> None:
    assert wanted in said(changed(**fields))


@pytest.mark.parametrize("seed", range(24))
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
        design = read_design(data)[0]
        assert design.is_map
        length = build_route(design, World()).length
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
