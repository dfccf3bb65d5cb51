"""Writes what is painted before junctions: stop lines, give-way lines, crosswalks and arrows.

Source: ASAM OpenDRIVE 1.8.1, objects. Lines have the type ``roadMark`` and the subtype ``signalLines``; the
subtype of an arrow names its directions. A line across the end of a road is a rectangle. A line along the
ring of a roundabout is curved, and has an outline as well.
"""

import math
from collections.abc import Iterable

import numpy as np

from roadgpt.export.markup import XmlElement
from roadgpt.geometry.curve import Array
from roadgpt.network import Arm, Junction, Network, NetworkRoad, RoadEnd
from roadgpt.network.arrows import LENGTH, PaintedArrow
from roadgpt.network.markings import gives_way_to_ring, line_across, line_to_stop_at, road_of_line
from roadgpt.network.passages import CROSSWALK, STOP_LINE

HIGH = 0.01  # m
DIRECTIONS = ("straight", "left", "right")
"""The order of the directions in the name of a subtype, such as ``arrowStraightLeft``."""


def line_object(network: Network, junction: Junction, arm: Arm, number: int) -> tuple[int, XmlElement] | None:
    """Returns the id of the road on which an arm's line lies, and the element ``object`` of the line, with
    the id ``number``. None if traffic from the arm has no line.
    """
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
    """Returns the object of a line with the points ``line``, ``(n, 3)``, on the road into a ring."""
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
    """Returns the corners ``(2 n, 2)`` of a line, counter-clockwise; the points are along its middle."""
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
    """Returns an object with its middle at ``place`` (s, t) and of this ``size`` (length, width), both in
    metres. ``kind`` holds its type and subtype.
    """
    return XmlElement(
        "object",
        {
            "id": str(number),
            "name": name,
            **kind,
            "s": place[0],
            "t": place[1],
            "zOffset": 0.0,
            "hdg": heading,
            "orientation": orientation,
            "length": size[0],
            "width": size[1],
            "height": HIGH,
            "dynamic": "no",
        },
    )


def _with_corners(made: XmlElement, corners: Iterable[Iterable[float]]) -> XmlElement:
    """Adds an outline; its corners are metres along the object and to the left, from its middle."""
    outline = made.add("outlines").add("outline", {"id": 0, "closed": "true", "outer": "true"})
    for u, v in corners:
        outline.add("cornerLocal", {"u": u, "v": v, "z": 0.0, "height": HIGH})
    return made
