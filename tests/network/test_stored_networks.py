"""Networks in road files: those that earlier versions stored are still read, and damage is said."""

import copy
import json
from pathlib import Path
from typing import Any

import pytest

from network.random_designs import random_design
from network.test_lanes_laws import borders, joints
from roadgpt.errors import UsageError
from roadgpt.network import Route, build_route, road_from_json
from roadgpt.road import World, read_design

# written by the commit be863e28, in which a connection had pairs of lanes
OLD = Path(__file__).parent / "golden" / "route_without_lane_links.json"


def restored(data: dict[str, Any]) -> Route:
    route = road_from_json(data)
    assert isinstance(route, Route)
    return route


def connections(data: dict[str, Any]) -> list[dict[str, Any]]:
    return [each for junction in data["network"]["junctions"] for each in junction["connections"]]


def test_a_network_of_an_earlier_version_is_read() -> None:
    data = json.loads(OLD.read_text())
    assert {len(lanes) for each in connections(data) for lanes in each["lanes"]} == {2}
    route = restored(data)
    assert [each.entered.kind for each in route.passages] == ["t_junction", "roundabout"]
    assert route.to_json()["route"] == data["route"]
    assert route.length == pytest.approx(196.8, abs=0.05)
    assert route.network.continuations == ()
    for one, two in joints(route):
        assert borders(*one) == pytest.approx(borders(*two), abs=1e-6)
    again = route.to_json()
    assert restored(again).network.junctions == route.network.junctions


@pytest.mark.parametrize("seed", range(6))
def test_the_third_lane_of_a_link_follows_from_the_other_two(seed: int) -> None:
    data = random_design(seed)
    route = build_route(read_design(data)[0], World())
    stored = route.to_json()
    old = copy.deepcopy(stored)
    for each in connections(old):
        each["lanes"] = [lanes[:2] for lanes in each["lanes"]]
    del old["network"]["continuations"]
    again = restored(json.loads(json.dumps(old)))
    assert again.network.junctions == route.network.junctions
    assert again.to_json() == stored


@pytest.mark.parametrize("lanes", [[[-1]], [[-1, -1, -1, -1]], [["a", -1, -1]], [-1], None, [[-1, -1, 0.5]]])
def test_a_damaged_link_is_refused_in_one_sentence(lanes: Any) -> None:
    data = json.loads(OLD.read_text())
    connections(data)[0]["lanes"] = lanes
    with pytest.raises(UsageError, match=r"^the network cannot be read") as error:
        road_from_json(data)
    assert "\n" not in str(error.value)
