"""The field ``edge`` of lanes: the line at their outer edges, in the network, in OpenDRIVE and pictures."""

import xml.etree.ElementTree as ET
from typing import Any

import pytest

from network.changing import WORLD, design
from roadgpt.export.exporters.opendrive import document
from roadgpt.network import Route, build_route
from roadgpt.road import read_design

CROSSING = {"kind": "crossroads", "take": "straight", "crosswalk": True}
BOTH = ((1, "broken"), (2, None), (-1, "broken"), (-2, None))
"""The lanes of the first road from the centre line outwards; None where the field decides."""


def made(edge: str | None, place: dict[str, Any] = CROSSING, **lanes: Any) -> dict[str, Any]:
    """A design whose roads have these edges, and two lanes in each direction if nothing else is said."""
    given = {"forward": 2, "backward": 2, **lanes, **({"edge": edge} if edge else {})}
    return {**design(100.0, place, 100.0), "lanes": given}


def route_of(data: dict[str, Any]) -> Route:
    return build_route(read_design(data)[0], WORLD)


def marks(route: Route, road: int) -> dict[int, str]:
    """The markings of the driving lanes of a road in OpenDRIVE, by lane; "none" where there is none."""
    (element,) = ET.fromstring(document(route, WORLD).to_text()).findall(f"road[@id='{road}']")
    lanes = [lane for lane in element.iter("lane") if lane.attrib["type"] == "driving"]
    found = {int(lane.attrib["id"]): lane.find("roadMark") for lane in lanes}
    return {number: "none" if mark is None else mark.attrib["type"] for number, mark in found.items()}


@pytest.mark.parametrize("left_hand", [False, True])
@pytest.mark.parametrize(
    ("edge", "wanted"), [(None, "solid"), ("solid", "solid"), ("broken", "broken"), ("none", "none")]
)
def test_the_outer_edges_of_a_road_have_this_line(edge: str | None, wanted: str, left_hand: bool) -> None:
    route = route_of({**made(edge), "left_hand": left_hand})
    assert marks(route, route.legs[0].road) == {lane: mark or wanted for lane, mark in BOTH}
    assert marks(route, route.legs[-1].road) == {lane: mark or wanted for lane, mark in BOTH}
    assert route.profile is not None
    right = route.profile.along[len([n for n in route.profile.along if n.kind == "driving"]) - 1]
    assert right.marking == wanted


@pytest.mark.parametrize("kind", ["merge", "diverge"])
def test_the_lane_beside_a_ramp_has_the_edges_of_its_road(kind: str) -> None:
    route = route_of(made("none", {"kind": kind, "take": "main"}, backward=0))
    beside = next(road.id for road in route.network.roads_outside if road.profile.count == (3, 0))
    assert marks(route, beside) == {-1: "broken", -2: "broken", -3: "none"}
