"""Arms with road segments of their own: read, written, refused, and built as roads out of the junction."""

import copy
import math
from typing import Any

import numpy as np
import pytest

from network.changing import built, design
from network.shared_laws import sentence_of
from roadgpt.check import inspect
from roadgpt.network import NetworkRoad, Route
from roadgpt.road import Design, Road, Segment, Site, World, build, read_design
from tables import rows

SEGMENTS = {
    "road_segment1": {"distance": 40, "direction": "left", "incline": 3, "turn_degrees": 30},
    "road_segment2": {
        "distance": 50, "direction": "right", "incline": -4, "turn_degrees": -45, "radius": 40,
        "transition": 5, "vertical_radius": 200,
    },
}  # fmt: skip
CURVED = {"angle": -80, **SEGMENTS}
LENGTH = 40 + 50  # m
LEVEL = 0.03 * (
    6 + 250 * 0.03 / 2
)  # m that 6 m of level road and a parabola of 250 m radius take from a climb
EXACT = 1e-9


def data_of(arm: dict[str, Any], **more: Any) -> dict[str, Any]:
    """A crossroads 2 m high, which the route crosses along the x axis; the arm is the first given."""
    junction = {"kind": "crossroads", "take": "straight", "arms": [arm, {"angle": 0}, {"angle": 85}]}
    return {**design(80.0, junction, 60.0, start=(60.0, 250.0, 2.0)), **more}


def arm_of(route: Route, degrees: float) -> tuple[NetworkRoad, str]:
    """The road of the arm with this heading out of the only junction, and its end there."""
    (junction,) = route.network.junctions
    (found,) = [a for a in junction.arms if math.cos(a.direction - math.radians(degrees)) > 1 - EXACT]
    return route.network.road(found.end.road), found.end.contact


def outwards(road: NetworkRoad, contact: str, s: np.ndarray) -> np.ndarray:
    """Points of the road of an arm, by the distance from the junction."""
    return road.road.at(s if contact == "start" else road.road.length - s)


def as_single_road(start: np.ndarray, degrees: float) -> Road:
    """The same segments, as a road on its own."""
    segments = tuple(Segment.model_validate(each) for each in SEGMENTS.values())
    return build(Design(starting_point=tuple(start.tolist()), theta=degrees, segments=segments))


@pytest.mark.parametrize("left_hand", [False, True])
@pytest.mark.parametrize("one_way", [None, "in", "out"])
def test_the_arm_leads_along_its_segments(one_way: str | None, left_hand: bool) -> None:
    arm = CURVED if one_way is None else {**CURVED, "one_way": one_way}
    route = built(data_of(arm, left_hand=left_hand))
    road, contact = arm_of(route, -80)
    assert contact == ("end" if one_way == "in" else "start")
    assert road.road.length == pytest.approx(LENGTH)
    s = np.linspace(0.0, LENGTH, 46)
    found = outwards(road, contact, np.minimum(s, road.road.length))
    (junction,) = route.network.junctions
    assert math.degrees(math.atan2(*(found[0] - junction.node)[1::-1])) == pytest.approx(-80)
    expected = as_single_road(found[0], -80).at(s)
    assert found[:, :2] == pytest.approx(expected[:, :2], abs=EXACT)
    blended = s > 6 + 250 * 0.03
    assert found[blended, 2] == pytest.approx(expected[blended, 2] - LEVEL, abs=EXACT)
    assert inspect(route, None, World(site=Site(map_size=500))) == ()


@pytest.mark.parametrize(
    ("arm", "wanted"),
    rows(__file__, "an_arm_that_is_wrong"),
)  # fmt: skip
def test_an_arm_that_is_wrong(arm: dict[str, Any], wanted: str) -> None:
    assert wanted in sentence_of(built, data_of(arm))


@pytest.mark.parametrize("left_hand", [False, True])
@pytest.mark.parametrize("take", ["right", 1])
def test_the_arm_taken_has_no_segments(take: str | int, left_hand: bool) -> None:
    data = data_of(CURVED, left_hand=left_hand)
    data["junction1"]["take"] = 3 if left_hand and take == 1 else take
    assert sentence_of(built, data) == (
        "junction 1: the arm at -80 degrees is the one that the route takes; its road is that of the "
        "segments behind the junction, so leave out its road segments"
    )


def test_remarks_on_segments_name_the_arm() -> None:
    arm = copy.deepcopy(CURVED)
    arm["road_segment2"]["direction"] = "left"
    arm["road_segment4"] = arm.pop("road_segment1")
    found, remarks = read_design(data_of(arm))
    what = "arm 1 of junction 1: "
    assert remarks == (
        f"{what}segments are numbered 2, 4 instead of 1, 2, 3, ...; they are taken in this order",
        f"{what}segment 2: direction 'left' and turn_degrees -45 disagree; the direction wins: 45",
    )
    assert [each.distance for each in found.junctions[0].arms[0].segments] == [50, 40]
