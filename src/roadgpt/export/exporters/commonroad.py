"""Exports roads as CommonRoad scenarios (XML 2020a): lanelets, speed limit, and the task to reach the end.

Source: CommonRoad, Documentation of the XML Format, version 2020a. The format can hold heights, but
CommonRoad's planners, road boundaries and plots fail if points have heights (commonroad-io 2024.3), so no
heights are written.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from roadgpt.export.ego import calm_speed, start_of
from roadgpt.export.georeference import LATITUDE, LONGITUDE
from roadgpt.export.lanelets import LaneletPair, lanelet_pairs
from roadgpt.export.markup import XmlElement, number
from roadgpt.export.poses import Poses
from roadgpt.geometry import wrap_angle
from roadgpt.geometry.curve import Array
from roadgpt.road import Road, World

STEP = 0.1  # s
PATIENCE = 2.0  # times the duration of a calm drive to the end
NOWHERE = -999  # GeoNames' number for no place
SPEED_LIMIT = "274"  # the sign's number in Zamunda, CommonRoad's own country, as in Germany


class CommonRoad:
    """CommonRoad scenario 2020a: lanelets in plan view, a speed limit, the task to drive to the end."""

    name = "commonroad"
    suffix = ".cr.xml"

    def save(self, road: Road, path: Path, world: World, poses: Poses | None = None) -> None:
        """Writes the scenario.

        ``poses`` is ignored, because CommonRoad stores drives in a separate solution format.
        """
        path.write_bytes(document(road, world).to_text().encode())


def document(road: Road, world: World) -> XmlElement:
    """Returns the XML document: lanelets, traffic sign and planning problem.

    Lanelets of the right lane are numbered from 1, and those of the left lane follow.

    Raises:
        ExportError: The road has a number that is not finite.
    """
    parts = lanelet_pairs(road, world)
    right, left = range(1, len(parts) + 1), range(len(parts) + 1, 2 * len(parts) + 1)
    sign = 2 * len(parts) + 1
    root = XmlElement(
        "commonRoad",
        {
            "timeStepSize": STEP,
            "commonRoadVersion": "2020a",
            "author": "RoadGPT",
            "affiliation": "RoadGPT",
            "source": "generated",
            "benchmarkID": "ZAM_RoadGPT-1_1_T-1",
            "date": "2026-01-01",  # the same road gives the same bytes
        },
    )
    location = root.add("location")
    location.add("geoNameId", raw=str(NOWHERE))
    location.add("gpsLatitude", raw=number(LATITUDE))
    location.add("gpsLongitude", raw=number(LONGITUDE))
    root.add("scenarioTags").add("rural")
    for i, part in enumerate(parts):
        root.extended(_lanelet(right, i, _forward(part), left[i], sign))
    for i, part in enumerate(reversed(parts)):
        # against the road's direction, so in the order in which they are driven
        root.extended(_lanelet(left[::-1], i, _backward(part), right[len(parts) - 1 - i], sign))
    root.extended(_limit(sign, road.at(0.0, world.profile_of(road).edges(0.0).right), world))
    root.extended(_problem(sign + 1, road, world, goal=right[-1]))
    return root


def _forward(part: LaneletPair) -> tuple[Array, Array]:
    return part.middle, part.right


def _backward(part: LaneletPair) -> tuple[Array, Array]:
    return part.middle[::-1], part.left[::-1]


def _lanelet(chain: Sequence[int], i: int, bounds: tuple[Array, Array], beside: int, sign: int) -> XmlElement:
    """Returns the i-th lanelet of a chain. Traffic beside its left bound drives in the opposite direction."""
    out = XmlElement("lanelet", {"id": chain[i]})
    for name, points, mark in zip(("leftBound", "rightBound"), bounds, ("dashed", "solid"), strict=True):
        bound = out.add(name)
        for point in points[:, :2].tolist():
            bound.extended(_point(point))
        bound.add("lineMarking", raw=mark)
    if i > 0:
        out.add("predecessor", {"ref": chain[i - 1]})
    if i < len(chain) - 1:
        out.add("successor", {"ref": chain[i + 1]})
    out.add("adjacentLeft", {"ref": beside, "drivingDir": "opposite"})
    out.add("laneletType", raw="country")
    out.add("userOneWay", raw="vehicle")
    out.add("trafficSignRef", {"ref": sign})
    return out


def _limit(id_: int, place: Array, world: World) -> XmlElement:
    out = XmlElement("trafficSign", {"id": id_})
    told = out.add("trafficSignElement")
    told.add("trafficSignID", raw=SPEED_LIMIT)
    told.add("additionalValue", raw=number(round(world.speed_limit, 6)))
    out.add("position").extended(_point(place[:2].tolist()))
    out.add("virtual", raw="true")
    return out


def _problem(id_: int, road: Road, world: World, goal: int) -> XmlElement:
    """Returns the planning problem: from rest to the last lanelet, within twice the time of a calm drive."""
    start = start_of(road)
    place = np.round(road.at(start, world.profile_of(road).middle(start)), 6)
    out = XmlElement("planningProblem", {"id": id_})
    state = out.add("initialState")
    state.add("position").extended(_point(place[:2].tolist()))
    heading = float(np.round(wrap_angle(road.heading(start)), 9))
    values = {"orientation": heading, "time": 0, "velocity": 0, "yawRate": 0, "slipAngle": 0}
    for name, value in values.items():
        state.add(name).add("exact", raw=number(value))
    state = out.add("goalState")
    time = state.add("time")
    time.add("intervalStart", raw="0")
    steps = int(np.ceil((PATIENCE * road.length / calm_speed(road, world) + 10.0) / STEP))
    time.add("intervalEnd", raw=str(steps))
    state.add("position").add("lanelet", {"ref": goal})
    return out


def _point(values: Sequence[float]) -> XmlElement:
    out = XmlElement("point")
    for name, value in zip("xy", values, strict=True):
        out.add(name, raw=number(value))
    return out
