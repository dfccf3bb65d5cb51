"""Writes the lines at which traffic stops or gives way.

Source: ASAM OpenDRIVE 1.8.1, objects of type ``roadMark`` and subtype ``signalLines``. A line across the end
of a road is a rectangle. A line along the ring of a roundabout is curved, and has an outline as well.
"""

import numpy as np

from roadgpt.export.markup import XmlElement
from roadgpt.geometry.curve import Array
from roadgpt.network import Arm, NetworkRoad
from roadgpt.network.passages import STOP_LINE
from roadgpt.road.profile import LINE

HIGH = 0.01  # m


def line_object(member: NetworkRoad, line: Array, arm: Arm, number: int) -> XmlElement:
    """Returns the element ``object`` of a line, with the id ``number``.

    Args:
        member: The road on which the line lies.
        line: Points ``(n, 3)`` in metres along the middle of the line.
        arm: The arm whose traffic stops or gives way there.
        number: The id.
    """
    is_across = member.id == arm.end.road
    is_along = not is_across or arm.end.contact == "end"
    if is_across:  # the paint ends at the edge line, which is part of the lane
        outwards = (line[1] - line[0]) / np.linalg.norm(line[1] - line[0])
        line = np.stack([line[0], line[1] + LINE * outwards])
    corners = _outline(line)
    middle = line if is_across else line[[(len(line) - 1) // 2, len(line) // 2]]  # also from its other end
    x, y = middle[:, :2].mean(axis=0)
    s, t = (float(each) for each in member.road.locate(x, y))
    heading = float(member.road.heading(s))
    # u along the road, v to its left
    turned = (corners - [x, y]) @ np.array(
        [[np.cos(heading), -np.sin(heading)], [np.sin(heading), np.cos(heading)]]
    )
    length, width = np.ptp(turned, axis=0).tolist()
    made = XmlElement(
        "object",
        {
            "id": str(number),
            "name": "give-way line" if arm.control == "yield" else "stop line",
            "type": "roadMark",
            "subtype": "signalLines",
            "s": s,
            "t": t,
            "zOffset": 0.0,
            "hdg": 0.0,
            "orientation": "+" if is_along else "-",
            "length": length,
            "width": width,
            "height": HIGH,
            "dynamic": "no",
        },
    )
    if not is_across:
        outline = made.add("outlines").add("outline", {"id": 0, "closed": "true", "outer": "true"})
        for u, v in turned.tolist():
            outline.add("cornerLocal", {"u": u, "v": v, "z": 0.0, "height": HIGH})
    return made


def _outline(line: Array) -> Array:
    """Returns the corners ``(2 n, 2)`` of a line, counter-clockwise; the points are along its middle."""
    along = np.gradient(line[:, :2], axis=0)
    to_left = np.column_stack([-along[:, 1], along[:, 0]])
    to_left *= STOP_LINE / 2 / np.linalg.norm(to_left, axis=1, keepdims=True)
    return np.concatenate([line[:, :2] - to_left, line[::-1, :2] + to_left[::-1]])
