"""Exports roads and networks as CommonRoad scenarios (XML 2020a): lanelets, speed limit, signs, lights and
intersections, and the task to reach the end.

Source: CommonRoad, Documentation of the XML Format, version 2020a. The format can hold heights, but
CommonRoad's planners, road boundaries and plots fail if points have heights (commonroad-io 2024.3), so no
heights are written."""

from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from math import degrees
from pathlib import Path

import numpy as np

from roadgpt.brief.junctions import side_of
from roadgpt.export.ego import Poses
from roadgpt.export.exporters.opendrive import LATITUDE, LONGITUDE
from roadgpt.export.exporters.opendrive.signals import SIGNS
from roadgpt.export.markup import XmlElement, number
from roadgpt.geometry import wrap_angle
from roadgpt.language.names import Control, Way
from roadgpt.network import Arm, Connection, Junction, Leg, Network, legs_of, network_of
from roadgpt.network.markings import gives_way_to_ring, line_to_stop_at, place_of_sign
from roadgpt.road import Road, World
from roadgpt.road.profile import Marking
from roadgpt_formats.ego import calm_speed
from roadgpt_formats.lanelets import Lanelet, arms_of, lanelets_of

STEP = 0.1  # s
PATIENCE = 2.0  # times the duration of a calm drive to the end
NOWHERE = -999  # GeoNames' number for no place
MARKS: Mapping[Marking, str] = {"solid": "solid", "broken": "dashed", "none": "no_marking", "double": "solid"}
SPEED_LIMIT = "274"  # number of the sign in Germany and in Zamunda, CommonRoad's fictional country
LINES: dict[Control, str] = {"yield": "dashed", "stop": "solid", "lights": "solid"}
"""Type of the line at the end of an arm, by the sign or light of the arm."""
GREEN = 1000  # time steps; duration of the only phase of a light
ORDER: tuple[Way, ...] = ("right", "straight", "left")


class Crossings:
    """Creates the CommonRoad elements of a network's junctions."""

    def __init__(self, network: Network, lanelets: Sequence[Lanelet], first_free: int) -> None:
        """Prepares the elements for all lanelets of a network; ``first_free`` is the first id for signs,
        lights and intersections."""
        self.network, self.first_free = network, first_free
        self.road_of = {each.id: each.road for each in lanelets}
        self.arms = arms_of(network, lanelets)

    @cached_property
    def _signed(self) -> dict[int, tuple[int, Junction, Arm]]:
        signed = [each for each in self.arms if each[1].control != "none"]
        return {
            lanelet.id: (self.first_free + n, junction, arm)
            for n, (junction, arm, incoming) in enumerate(signed)
            for lanelet in incoming
        }

    def line_of(self, lanelet: int) -> Iterator[XmlElement]:
        """Yields the element ``stopLine`` of a lanelet on which traffic stops or gives way; nothing for any
        other lanelet.

        Where traffic gives way to a roundabout, the element has no points, which means that the line is at
        the end of the lanelet."""
        if lanelet not in self._signed:
            return
        _, junction, arm = self._signed[lanelet]
        line = line_to_stop_at(self.network, junction, arm)
        if line is None:
            return
        out = XmlElement("stopLine")
        if not gives_way_to_ring(self.network, junction, arm):
            out.extended(*(point_element(each) for each in np.round(line[:, :2], 4).tolist()))
        out.add("lineMarking", raw=LINES[arm.control])
        yield out

    def references(self, lanelet: int) -> Iterator[XmlElement]:
        """Yields the element by which a lanelet refers to its sign or light; nothing if there is neither."""
        if lanelet in self._signed:
            id_, _, arm = self._signed[lanelet]
            name = "trafficLightRef" if arm.control == "lights" else "trafficSignRef"
            yield XmlElement(name, {"ref": id_})

    def elements(self) -> Iterator[XmlElement]:
        """Yields the signs, the lights and the intersections, in the order that the format requires."""
        placed = [(arm, self._signed[own[0].id][0]) for _, arm, own in self.arms if own[0].id in self._signed]
        yield from (self._sign(arm, id_) for arm, id_ in placed if arm.control != "lights")
        yield from (self._light(arm, id_) for arm, id_ in placed if arm.control == "lights")
        free = self.first_free + len(placed)
        for junction in self.network.junctions:
            own = [(arm, incoming) for each, arm, incoming in self.arms if each is junction]
            made = XmlElement("intersection", {"id": free})
            for n, (arm, incoming) in enumerate(own, 1):
                made.extended(self._way_in(junction, arm, incoming, free + n))
            yield made
            free += len(own) + 1

    def _way_in(self, junction: Junction, arm: Arm, incoming: Sequence[Lanelet], id_: int) -> XmlElement:
        out = XmlElement("incoming", {"id": id_})
        for lanelet in incoming:
            out.add("incomingLanelet", {"ref": lanelet.id})
        to: dict[Way, list[int]] = {side: [] for side in ORDER}
        ways = [each for each in junction.connections if each.incoming == arm.end]
        sides = {each.road: self._side(junction, each) for each in ways}
        for lanelet in incoming:
            for id_ in lanelet.after:
                to[sides[self.road_of[id_]]].append(id_)
        for side in ORDER:
            for id_ in to[side]:
                out.add(f"successors{side.capitalize()}", {"ref": id_})
        return out

    def _side(self, junction: Junction, way: Connection) -> Way:
        """Returns the side to which a connection leads.

        A connection that stays on the ring of a roundabout leads straight on. At a diverge, a connection that
        turns by more than 1 degree leads to the side of this turn."""
        ring = self.network.roundabout_of.get(junction.id)
        if ring is not None and {way.incoming.road, way.outgoing.road} <= {*ring.ring}:
            return "straight"
        road = self.network.road(way.road).road
        turn = degrees(float(road.heading(road.length) - road.heading(0.0)))
        if junction.kind == "diverge" and abs(turn) > 1:
            return "left" if turn > 0 else "right"
        return side_of(turn)

    def _place(self, arm: Arm) -> list[float]:
        member = self.network.road(arm.end.road)
        return [
            round(each, 4) for each in member.road.at(*place_of_sign(member, arm.end.contact))[:2].tolist()
        ]

    def _sign(self, arm: Arm, id_: int) -> XmlElement:
        return _sign(id_, self._place(arm), "false", trafficSignID=SIGNS[arm.control][0])

    def _light(self, arm: Arm, id_: int) -> XmlElement:
        out = XmlElement("trafficLight", {"id": id_})
        out.add("cycle").add("cycleElement").with_texts(duration=str(GREEN), color="green")
        out.add("position").extended(point_element(self._place(arm)))
        return out.with_texts(direction="all", active="true")


class CommonRoad:
    """CommonRoad scenario 2020a: lanelets in plan view, a speed limit, and the task to drive to the end, if
    there is a route."""

    name = "commonroad"
    suffix = ".cr.xml"
    holds_junctions = True
    lacks = ("heights", "superelevation", "the land around")

    def save(self, road: Road, path: Path, world: World, poses: Poses | None = None) -> None:
        """Writes the scenario.

        ``poses`` is ignored, because CommonRoad stores drives in a separate solution format."""
        path.write_bytes(document(road, world).to_text().encode())


def document(road: Road, world: World) -> XmlElement:
    """Returns the XML document: lanelets, signs, lights, intersections and planning problem.

    Lanelets are numbered road by road and lane by lane: first the lanes in the direction of the road, from
    the centre line outwards, then the oncoming lanes."""
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
    place = {"geoNameId": str(NOWHERE), "gpsLatitude": number(LATITUDE), "gpsLongitude": number(LONGITUDE)}
    root.add("location").with_texts(**place)
    root.add("scenarioTags").add("rural")
    junctions = Crossings(network_of(road, world), lanelets, sign + 2)
    for each in lanelets:
        root.extended(_lanelet(each, sign if world.limits.limit_stated else None, junctions))
    edges = world.profile_of(road).edges(0.0)
    side = edges.left if world.profile_of(road).left_hand else edges.right
    limit = {"trafficSignID": SPEED_LIMIT, "additionalValue": number(round(world.limits.speed_limit, 6))}
    if world.limits.limit_stated:
        root.extended(_sign(sign, road.at(0.0, side)[:2].tolist(), "true", **limit))
    root.extended(*junctions.elements())
    if not road.has_way:
        return root
    last = legs_of(road, world)[-1]
    goal = [each.id for each in lanelets if Leg(each.road, each.lane) == last][-1]
    return root.extended(_problem(sign + 1, road, world, goal))


def _lanelet(lanelet: Lanelet, sign: int | None, junctions: Crossings) -> XmlElement:
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
    out.extended(*junctions.line_of(lanelet.id)).with_texts(laneletType="country", userOneWay="vehicle")
    if sign is not None:
        out.add("trafficSignRef", {"ref": sign})
    return out.extended(*junctions.references(lanelet.id))


def _sign(id_: int, place: Sequence[float], virtual: str, **told: str) -> XmlElement:
    out = XmlElement("trafficSign", {"id": id_})
    out.add("trafficSignElement").with_texts(**told)
    out.add("position").extended(point_element(place))
    return out.with_texts(virtual=virtual)


def _problem(id_: int, road: Road, world: World, goal: int) -> XmlElement:
    """Returns the planning problem: to drive from rest to the last lanelet. The time limit is 10 s plus twice
    the time that a calm driver needs for the road at constant speed."""
    start = world.start_on(road)
    place = np.round(road.at(start, world.profile_of(road).middle(start)), 6)
    out = XmlElement("planningProblem", {"id": id_})
    state = out.add("initialState")
    state.add("position").extended(point_element(place[:2].tolist()))
    heading = float(np.round(wrap_angle(road.heading(start)), 9))
    values = {"orientation": heading, "time": 0, "velocity": 0, "yawRate": 0, "slipAngle": 0}
    for name, value in values.items():
        state.add(name).add("exact", raw=number(value))
    state = out.add("goalState")
    steps = int(np.ceil((PATIENCE * road.length / calm_speed(road, world) + 10.0) / STEP))
    state.add("time").with_texts(intervalStart="0", intervalEnd=str(steps))
    state.add("position").add("lanelet", {"ref": goal})
    return out


def point_element(values: Sequence[float]) -> XmlElement:
    """Returns the element ``point`` with x and y in metres."""
    x, y = map(number, values)
    return XmlElement("point").with_texts(x=x, y=y)
