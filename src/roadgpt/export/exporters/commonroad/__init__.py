"""Exports roads and networks as CommonRoad scenarios (XML 2020a): lanelets, speed limit, signs, lights and
intersections, and the task to reach the end.

Source: CommonRoad, Documentation of the XML Format, version 2020a. The format can hold heights, but
CommonRoad's planners, road boundaries and plots fail if points have heights (commonroad-io 2024.3), so no
heights are written.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from roadgpt.export.ego import calm_speed, start_of
from roadgpt.export.exporters.commonroad.crossings import Crossings, point_element
from roadgpt.export.georeference import LATITUDE, LONGITUDE
from roadgpt.export.lanelets import ONLY, Lanelet, lanelets_of
from roadgpt.export.markup import XmlElement, number
from roadgpt.export.poses import Poses
from roadgpt.geometry import wrap_angle
from roadgpt.geometry.curve import Array
from roadgpt.network import Route
from roadgpt.road import Road, World
from roadgpt.road.profile import Marking

STEP = 0.1  # s
PATIENCE = 2.0  # times the duration of a calm drive to the end
NOWHERE = -999  # GeoNames' number for no place
MARKS: Mapping[Marking, str] = {"solid": "solid", "broken": "dashed", "none": "no_marking", "double": "solid"}
SPEED_LIMIT = "274"  # number of the sign in Germany and in Zamunda, CommonRoad's fictional country


class CommonRoad:
    """CommonRoad scenario 2020a: lanelets in plan view, a speed limit, and the task to drive to the end."""

    name = "commonroad"
    suffix = ".cr.xml"
    holds_junctions = True
    needs_route = True
    lacks = ("heights", "superelevation")

    def save(self, road: Road, path: Path, world: World, poses: Poses | None = None) -> None:
        """Writes the scenario.

        ``poses`` is ignored, because CommonRoad stores drives in a separate solution format.
        """
        path.write_bytes(document(road, world).to_text().encode())


def document(road: Road, world: World) -> XmlElement:
    """Returns the XML document: lanelets, signs, lights, intersections and planning problem.

    Lanelets are numbered road by road and lane by lane: first the lanes in the direction of the road, from
    the centre line outwards, then the oncoming lanes.

    Raises:
        ExportError: A road has a number that is not finite.
    """
    lanelets = lanelets_of(road, world)
    sign = len(lanelets) + 1
    root = XmlElement(
        "commonRoad",
        {
            "timeStepSize": STEP,
            "commonRoadVersion": "2020a",
            "author": "RoadGPT",
            "affiliation": "RoadGPT",
            "source": "generated",
            "benchmarkID": "ZAM_RoadGPT-1_1_T-1",
            "date": "2026-01-01",  # fixed, so that the same road gives the same bytes
        },
    )
    location = root.add("location")
    location.add("geoNameId", raw=str(NOWHERE))
    location.add("gpsLatitude", raw=number(LATITUDE))
    location.add("gpsLongitude", raw=number(LONGITUDE))
    root.add("scenarioTags").add("rural")
    junctions = Crossings(road.network, lanelets, sign + 2) if isinstance(road, Route) else None
    for each in lanelets:
        root.extended(_lanelet(each, sign, junctions))
    edges = world.profile_of(road).edges(0.0)
    side = edges.left if world.profile_of(road).left_hand else edges.right
    root.extended(_limit(sign, road.at(0.0, side), world))
    if junctions is not None:
        root.extended(*junctions.elements())
    root.extended(_problem(sign + 1, road, world, _goal(road, world, lanelets)))
    return root


def _goal(road: Road, world: World, lanelets: Sequence[Lanelet]) -> int:
    """Returns the id of the last lanelet of the lane that the tested car drives."""
    if isinstance(road, Route):
        number, lane = road.legs[-1]
    else:
        profile = world.profile_of(road)
        number, lane = ONLY, profile.along_ids[profile.driven]
    return [each.id for each in lanelets if (each.road, each.lane) == (number, lane)][-1]


def _lanelet(lanelet: Lanelet, sign: int, junctions: Crossings | None) -> XmlElement:
    """Returns a lanelet, with left and right as seen by drivers; ``sign`` is the id of the speed limit."""
    out = XmlElement("lanelet", {"id": lanelet.id})
    for name, bound in (("leftBound", lanelet.left), ("rightBound", lanelet.right)):
        element = out.add(name)
        for point in bound.points[:: 1 if lanelet.is_along else -1, :2].tolist():
            element.extended(point_element(point))
        element.add("lineMarking", raw=MARKS[bound.marking])
    for name, others in (("predecessor", lanelet.before), ("successor", lanelet.after)):
        for other in others:
            out.add(name, {"ref": other})
    for name, neighbour in zip(("adjacentLeft", "adjacentRight"), lanelet.beside, strict=True):
        if neighbour is not None:
            id_, is_same = neighbour
            out.add(name, {"ref": id_, "drivingDir": "same" if is_same else "opposite"})
    if junctions is not None:
        out.extended(*junctions.line_of(lanelet.id))
    out.add("laneletType", raw="country")
    out.add("userOneWay", raw="vehicle")
    out.add("trafficSignRef", {"ref": sign})
    if junctions is not None:
        out.extended(*junctions.references(lanelet.id))
    return out


def _limit(id_: int, place: Array, world: World) -> XmlElement:
    out = XmlElement("trafficSign", {"id": id_})
    told = out.add("trafficSignElement")
    told.add("trafficSignID", raw=SPEED_LIMIT)
    told.add("additionalValue", raw=number(round(world.limits.speed_limit, 6)))
    out.add("position").extended(point_element(place[:2].tolist()))
    out.add("virtual", raw="true")
    return out


def _problem(id_: int, road: Road, world: World, goal: int) -> XmlElement:
    """Returns the planning problem: to drive from rest to the last lanelet. The time limit is 10 s plus twice
    the time that a calm driver needs for the road at constant speed."""
    start = start_of(road)
    place = np.round(road.at(start, world.profile_of(road).middle(start)), 6)
    out = XmlElement("planningProblem", {"id": id_})
    state = out.add("initialState")
    state.add("position").extended(point_element(place[:2].tolist()))
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
