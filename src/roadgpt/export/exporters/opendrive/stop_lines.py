"""Writes the lines at which traffic stops or gives way.

Source: ASAM OpenDRIVE 1.8.1, objects of type ``roadMark`` and subtype ``signalLines``. A line across the end
of a road is a rectangle. A line along the ring of a roundabout is curved, and has an outline as well.
"""

import numpy as np

from roadgpt.export.markup import XmlElement
from roadgpt.geometry.curve import Array
from roadgpt.network import Arm, Junction, Network, NetworkRoad
from roadgpt.network.markings import gives_way_to_ring, line_across, line_to_stop_at, road_of_line
from roadgpt.network.passages import STOP_LINE

HIGH = 0.01  # m


def line_object(network: Network, junction: Junction, arm: Arm, number: int) -> tuple[int, XmlElement] | None:
    """Returns the id of the road on which an arm's line lies, and the element ``object`` of the line.

    None if traffic from the arm has no line.

    Args:
        network: The network.
        junction: The junction, which may be one of a roundabout.
        arm: The arm whose traffic stops or gives way.
        number: The id of the object.
    """
    if arm.control in ("priority", "none"):
        return None
    if not gives_way_to_ring(network, junction, arm):
        s, inner, edge = line_across(network, arm)
        size = STOP_LINE, abs(edge - inner)
        return arm.end.road, _object(arm, number, (s, (inner + edge) / 2), size, arm.end.contact == "end")
    line = line_to_stop_at(network, junction, arm)
    if line is None:
        return None
    road = road_of_line(network, junction, arm)
    return road, _curved(network.road(road), line, arm, number)


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
    made = _object(arm, number, (s, t), (length, width), is_along=True)
    outline = made.add("outlines").add("outline", {"id": 0, "closed": "true", "outer": "true"})
    for u, v in turned.tolist():
        outline.add("cornerLocal", {"u": u, "v": v, "z": 0.0, "height": HIGH})
    return made


def _object(
    arm: Arm, number: int, place: tuple[float, float], size: tuple[float, float], is_along: bool
) -> XmlElement:
    """Returns the object of a line with its middle at ``place`` (s, t) and of this ``size`` (length, width),
    both in metres.
    """
    return XmlElement(
        "object",
        {
            "id": str(number),
            "name": "give-way line" if arm.control == "yield" else "stop line",
            "type": "roadMark",
            "subtype": "signalLines",
            "s": place[0],
            "t": place[1],
            "zOffset": 0.0,
            "hdg": 0.0,
            "orientation": "+" if is_along else "-",
            "length": size[0],
            "width": size[1],
            "height": HIGH,
            "dynamic": "no",
        },
    )


def _outline(line: Array) -> Array:
    """Returns the corners ``(2 n, 2)`` of a line, counter-clockwise; the points are along its middle."""
    along = np.gradient(line[:, :2], axis=0)
    to_left = np.column_stack([-along[:, 1], along[:, 0]])
    to_left *= STOP_LINE / 2 / np.linalg.norm(to_left, axis=1, keepdims=True)
    return np.concatenate([line[:, :2] - to_left, line[::-1, :2] + to_left[::-1]])
