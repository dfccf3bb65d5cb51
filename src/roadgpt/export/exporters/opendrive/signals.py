"""Writes the signs and lights of junctions, with their stop lines, crosswalks and arrows.

Source: ASAM OpenDRIVE 1.8.1, signals; its catalogue of signals gives type 1000001 for traffic lights. Signs
are those of the German road traffic regulations (StVO): 205 give way, 206 stop, 306 priority road. What is
painted are objects: lines have the type ``roadMark`` and the subtype ``signalLines``; the subtype of an arrow
names its directions. A line across the end of a road is a rectangle. A line along the ring of a roundabout is
curved, and has an outline as well."""

import math
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from roadgpt.export.markup import Value, XmlElement
from roadgpt.geometry.curve import Array
from roadgpt.ground.ground import Span
from roadgpt.network import Arm, Junction, Network, NetworkRoad, RoadEnd
from roadgpt.network.markings import (
    CROSSWALK,
    LENGTH,
    STOP_LINE,
    PaintedArrow,
    arrows,
    gives_way_to_ring,
    line_across,
    line_to_stop_at,
    place_of_sign,
    road_of_line,
)

SIGNS = {
    "stop": ("206", "stop sign", 0.9, 0.9, 2.0),
    "yield": ("205", "give way sign", 0.9, 0.9, 2.0),
    "priority": ("306", "priority road sign", 0.6, 0.6, 2.0),
    "lights": ("1000001", "traffic light", 0.9, 0.3, 2.1),
}
"""Type, name, height and width in metres, and height of the lower edge in metres above the road, of each sign
and of a light."""
HIGH = 0.01  # m
DIRECTIONS = ("straight", "left", "right")
"""The order of the directions in the name of a subtype, such as ``arrowStraightLeft``."""


class Signals:
    """The signs and lights of a network, and what is painted on its roads.

    The ids of signs and lights follow those of roads and junctions. A line has the id of its sign or light.
    After all of these come the ids of the crosswalks, then those of the arrows."""

    def __init__(self, network: Network, spans: Sequence[Span] = ()) -> None:
        # the elements on each road, by the id of the road
        self._signals = defaultdict[int, list[XmlElement]](list)
        self._objects = defaultdict[int, list[XmlElement]](list)
        self._controllers: dict[int, XmlElement] = {}  # by the id of the junction
        self.lights: dict[RoadEnd, int] = {}
        """The ids of the lights."""
        arms = [(junction, arm) for junction in network.junctions for arm in junction.arms]
        controlled = [(junction, arm) for junction, arm in arms if arm.control != "none"]
        first = 1 + max([*(each.id for each in network.roads), *(each.id for each in network.junctions)])
        for number, (junction, arm) in enumerate(controlled, first):
            self._signals[arm.end.road].append(_signal(network.road(arm.end.road), arm, number))
            line = line_object(network, junction, arm, number)
            if line is not None:
                self._objects[line[0]].append(line[1])
            if arm.control == "lights":
                lights = XmlElement("controller", {"id": str(junction.id), "name": f"lights {junction.id}"})
                controller = self._controllers.setdefault(junction.id, lights)
                self.lights[arm.end] = number
                controller.add("control", {"signalId": str(number), "type": "0"})
        crossed = [arm.end for _, arm in arms if arm.crosswalk]
        crossed += [each.before for each in network.continuations if each.crosswalk]
        for number, end in enumerate(crossed, first + len(controlled)):
            self._objects[end.road].append(crosswalk_object(network.road(end.road), end, number))
        painted = arrows(network)
        for number, arrow in enumerate(painted, first + len(controlled) + len(crossed)):
            self._objects[arrow.end.road].append(arrow_object(arrow, number))
        first += len(controlled) + len(crossed) + len(painted)
        # the standard has tunnels before bridges, and both after all objects
        for number, span in enumerate(sorted(spans, key=lambda each: each.kind != "tunnel"), first):
            where: dict[str, Value] = {"s": span.start, "length": span.end - span.start, "id": str(number)}
            about: dict[str, Value] = {"name": f"{span.kind} {number}", "type": "concrete"}
            if span.kind == "tunnel":
                about |= {"type": "standard", "lighting": 1, "daylight": 0}
            self._objects[span.road].append(XmlElement(span.kind, {**where, **about}))

    def on_road(self, road: int) -> Iterator[XmlElement]:
        """Yields the elements ``objects`` and ``signals`` of a road; an empty element is left out."""
        for name, elements in (("objects", self._objects), ("signals", self._signals)):
            if own := elements.get(road):
                yield XmlElement(name, children=own)

    def controllers(self) -> Iterable[XmlElement]:
        """Returns the controller of each junction with lights; a controller has the id of its junction."""
        return self._controllers.values()

    def of_junction(self, junction: int) -> Iterator[XmlElement]:
        """Yields the reference to the controller of a junction; nothing if the junction has no lights."""
        if junction in self._controllers:
            yield XmlElement("controller", {"id": str(junction), "type": "0", "sequence": 0})


def _signal(member: NetworkRoad, arm: Arm, number: int) -> XmlElement:
    control, end = arm.control, arm.end
    s, t = place_of_sign(member, end.contact)
    kind, name, height, width, above = SIGNS[control]
    dynamic, country = ("yes", "OpenDRIVE") if control == "lights" else ("no", "DE")
    place = {"s": s, "t": t, "zOffset": above, "height": height, "width": width, "dynamic": dynamic}
    meaning = {"country": country, "type": kind, "subtype": "-1", "value": "-1"}
    orientation = "+" if end.contact == "end" else "-"
    about = {"id": str(number), "name": name, **place, "orientation": orientation, **meaning}
    made = XmlElement("signal", about)
    lanes = member.ids_towards(end.contact)
    made.add("validity", {"fromLane": min(lanes), "toLane": max(lanes)})
    return made


def line_object(network: Network, junction: Junction, arm: Arm, number: int) -> tuple[int, XmlElement] | None:
    """Returns the id of the road on which an arm's line lies, and the element ``object`` of the line, with
    the id ``number``. None if traffic from the arm has no line."""
    if arm.control in ("priority", "none"):
        return None
    if not gives_way_to_ring(network, junction, arm):
        s, inner, edge = line_across(network, arm)
        size = STOP_LINE, abs(edge - inner)
        return arm.end.road, _line(arm, number, (s, (inner + edge) / 2), size, arm.end.contact == "end")
    line = line_to_stop_at(network, junction, arm)
    if line is None:
        return None
    road = road_of_line(network, junction, arm)
    return road, _curved(network.road(road), line, arm, number)


def _line(
    arm: Arm, number: int, place: tuple[float, float], size: tuple[float, float], is_along: bool
) -> XmlElement:
    name = "give-way line" if arm.control == "yield" else "stop line"
    kind = {"type": "roadMark", "subtype": "signalLines"}
    return _object(number, name, kind, place, size, "+" if is_along else "-")


def _curved(member: NetworkRoad, line: Array, arm: Arm, number: int) -> XmlElement:
    x, y = line[[(len(line) - 1) // 2, len(line) // 2], :2].mean(axis=0)  # the same from the other end
    s, t = (float(each) for each in member.road.locate(x, y))
    heading = float(member.road.heading(s))
    # u along the road, v to its left
    turned = (_outline(line) - [x, y]) @ np.array(
        [[np.cos(heading), -np.sin(heading)], [np.sin(heading), np.cos(heading)]]
    )
    length, width = np.ptp(turned, axis=0).tolist()
    made = _line(arm, number, (s, t), (length, width), is_along=True)
    return _with_corners(made, turned.tolist())


def _outline(line: Array) -> Array:
    along = np.gradient(line[:, :2], axis=0)
    to_left = np.column_stack([-along[:, 1], along[:, 0]])
    to_left *= STOP_LINE / 2 / np.linalg.norm(to_left, axis=1, keepdims=True)
    return np.concatenate([line[:, :2] - to_left, line[::-1, :2] + to_left[::-1]])


def crosswalk_object(member: NetworkRoad, end: RoadEnd, number: int) -> XmlElement:
    """Returns the crosswalk at the end of a road, with the id ``number``."""
    away = min(CROSSWALK[0] + CROSSWALK[1] / 2, member.road.length)
    s = member.road.length - away if end.contact == "end" else away
    left, right = (float(t) for t in member.profile.edges(s))
    size = CROSSWALK[1], left - right
    made = _object(number, "crosswalk", {"type": "crosswalk"}, (s, (left + right) / 2), size, "none")
    # length and width say the same; CommonRoad's converter reads only the corners
    u, v = CROSSWALK[1] / 2, (left - right) / 2
    return _with_corners(made, ((-u, -v), (-u, v), (u, v), (u, -v)))


def arrow_object(arrow: PaintedArrow, number: int) -> XmlElement:
    """Returns the element ``object`` of an arrow, with the id ``number`` and the heading of the traffic."""
    at_end = arrow.end.contact == "end"
    subtype = "arrow" + "".join(way.capitalize() for way in DIRECTIONS if way in arrow.ways)
    kind, size = {"type": "roadMark", "subtype": subtype}, (LENGTH, arrow.width)
    heading = 0.0 if at_end else math.pi
    made = _object(number, "arrow", kind, (arrow.s, arrow.t), size, "+" if at_end else "-", heading)
    made.add("validity", {"fromLane": arrow.lane, "toLane": arrow.lane})
    return made


def _object(
    number: int,
    name: str,
    kind: dict[str, str],
    place: tuple[float, float],
    size: tuple[float, float],
    orientation: str,
    heading: float = 0.0,
) -> XmlElement:
    """Returns an object with its middle at ``place`` (s, t) and of this ``size`` (length, width), in metres.
    ``kind`` holds its type and subtype."""
    at: dict[str, Value] = {
        "s": place[0],
        "t": place[1],
        "zOffset": 0.0,
        "hdg": heading,
        "orientation": orientation,
    }
    extent: dict[str, Value] = {"length": size[0], "width": size[1], "height": HIGH, "dynamic": "no"}
    return XmlElement("object", {"id": str(number), "name": name, **kind, **at, **extent})


def _with_corners(made: XmlElement, corners: Iterable[Iterable[float]]) -> XmlElement:
    """Adds an outline; its corners are metres along the object and to the left, from its middle."""
    outline = made.add("outlines").add("outline", {"id": 0, "closed": "true", "outer": "true"})
    for u, v in corners:
        outline.add("cornerLocal", {"u": u, "v": v, "z": 0.0, "height": HIGH})
    return made
