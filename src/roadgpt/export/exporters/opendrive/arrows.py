"""Writes the arrows that are painted before junctions.

Source: ASAM OpenDRIVE 1.8.1, objects of type ``roadMark``, whose subtype names the arrow.
"""

import math

from roadgpt.export.markup import XmlElement
from roadgpt.network.arrows import LENGTH, PaintedArrow

WORDS = {"left": "Left", "straight": "Straight", "right": "Right"}
ORDER = ("straight", "left", "right")
"""The order of the directions in the name of a subtype, such as ``arrowStraightLeft``."""


def arrow_object(arrow: PaintedArrow, number: int) -> XmlElement:
    """Returns the element ``object`` of an arrow, with the id ``number`` and the heading of the traffic."""
    at_end = arrow.end.contact == "end"
    made = XmlElement(
        "object",
        {
            "id": str(number),
            "name": "arrow",
            "type": "roadMark",
            "subtype": "arrow" + "".join(WORDS[way] for way in ORDER if way in arrow.ways),
            "s": arrow.s,
            "t": arrow.t,
            "zOffset": 0.0,
            "hdg": 0.0 if at_end else math.pi,
            "orientation": "+" if at_end else "-",
            "length": LENGTH,
            "width": arrow.width,
            "height": 0.01,
            "dynamic": "no",
        },
    )
    made.add("validity", {"fromLane": arrow.lane, "toLane": arrow.lane})
    return made
