"""Exports roads as CommonRoad scenarios (XML 2020a): lanelets, speed limit, and the task to reach the end.

Source: CommonRoad, Documentation of the XML Format, version 2020a. The format can hold heights, but
CommonRoad's planners, road boundaries and plots fail if points have heights (commonroad-io 2024.3), so no
heights are written.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from roadgpt.export.ego import calm_speed, start_of
from roadgpt.export.georeference import LATITUDE, LONGITUDE
from roadgpt.export.lanelets import LaneletSection, lanelet_sections
from roadgpt.export.markup import XmlElement, number
from roadgpt.export.poses import Poses
from roadgpt.geometry import wrap_angle
from roadgpt.geometry.curve import Array
from roadgpt.road import Road, World
from roadgpt.road.profile import Marking

STEP = 0.1  # s
PATIENCE = 2.0  # times the duration of a calm drive to the end
NOWHERE = -999  # GeoNames' number for no place
MARKS: Mapping[Marking, str] = {"solid": "solid", "broken": "dashed", "none": "no_marking", "double": "solid"}
SPEED_LIMIT = "274"  # the sign's number in Zamunda, CommonRoad's own country, as in Germany


class CommonRoad:
    """CommonRoad scenario 2020a: lanelets in plan view, a speed limit, and the task to drive to the end."""

    name = "commonroad"
    suffix = ".cr.xml"

    def save(self, road: Road, path: Path, world: World, poses: Poses | None = None) -> None:
        """Writes the scenario.

        ``poses`` is ignored, because CommonRoad stores drives in a separate solution format.
        """
        path.write_bytes(document(road, world).to_text().encode())


def document(road: Road, world: World) -> XmlElement:
    """Returns the XML document: lanelets, traffic sign and planning problem.

    Lanelets are numbered lane by lane: first the lanes in the direction of the road, from the centre line
    outwards, then the oncoming lanes.

    Raises:
        ExportError: The road has a number that is not finite.
    """
    sections = lanelet_sections(road, world)
    forward, backward = world.profile_of(road).count
    lanes = [*range(-1, -forward - 1, -1), *range(1, backward + 1)]
    places = [(n, lane) for lane in lanes for n, each in enumerate(sections) if lane in each.lanes]
    ids = {place: number for number, place in enumerate(places, 1)}
    sign = len(ids) + 1
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
    for lane in lanes:
        for n in range(len(sections)) if lane < 0 else reversed(range(len(sections))):  # as they are driven
            if (n, lane) in ids:
                root.extended(_lanelet(ids, n, lane, sections[n], sign))
    driven = -1 - world.profile_of(road).driven
    goal = max(number for (_, lane), number in ids.items() if lane == driven)
    root.extended(_limit(sign, road.at(0.0, world.profile_of(road).edges(0.0).right), world))
    root.extended(_problem(sign + 1, road, world, goal))
    return root


def _lanelet(
    ids: Mapping[tuple[int, int], int], n: int, lane: int, section: LaneletSection, sign: int
) -> XmlElement:
    """Returns the lanelet of a lane in the n-th section, as seen in its direction of driving.

    Args:
        ids: The ids of all lanelets by section and lane.
        n: Index of the section.
        lane: Number of the lane, as in OpenDRIVE.
        section: The section.
        sign: Id of the sign with the speed limit.
    """
    out = XmlElement("lanelet", {"id": ids[n, lane]})
    way = 1 if lane < 0 else -1
    for name, bound in zip(("leftBound", "rightBound"), section.bounds_of(lane), strict=True):
        element = out.add(name)
        for point in bound.points[::way, :2].tolist():
            element.extended(_point(point))
        element.add("lineMarking", raw=MARKS[bound.marking])
    for name, place in (("predecessor", (n - way, lane)), ("successor", (n + way, lane))):
        if place in ids:
            out.add(name, {"ref": ids[place]})
    at = section.lanes.index(lane)
    for name, neighbour in (("adjacentLeft", at + way), ("adjacentRight", at - way)):
        if 0 <= neighbour < len(section.lanes):
            beside = section.lanes[neighbour]
            direction = "same" if beside * lane > 0 else "opposite"
            out.add(name, {"ref": ids[n, beside], "drivingDir": direction})
    out.add("laneletType", raw="country")
    out.add("userOneWay", raw="vehicle")
    out.add("trafficSignRef", {"ref": sign})
    return out


def _limit(id_: int, place: Array, world: World) -> XmlElement:
    out = XmlElement("trafficSign", {"id": id_})
    told = out.add("trafficSignElement")
    told.add("trafficSignID", raw=SPEED_LIMIT)
    told.add("additionalValue", raw=number(round(world.limits.speed_limit, 6)))
    out.add("position").extended(_point(place[:2].tolist()))
    out.add("virtual", raw="true")
    return out


def _problem(id_: int, road: Road, world: World, goal: int) -> XmlElement:
    """Returns the planning problem: to drive from rest to the last lanelet. The time limit is 10 s plus twice
    the time that a calm driver needs for the road at constant speed."""
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
