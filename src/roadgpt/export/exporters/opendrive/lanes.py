r"""Writes two lanes and their shoulders, with the constant widths of the World.

id      2      |    1    |    -1    |   -2
     shoulder  | against |  driven  | shoulder     the markings: solid, broken in the middle, solid
                         0
"""

from roadgpt.export.markup import XmlElement
from roadgpt.road import World
from roadgpt.road.profile import LINE

DASH, GAP = 4.0, 8.0  # m, middle line outside of towns (Germany, RMS-1)
NO_SHOULDER = 1e-3  # m; narrower shoulders are left out


def lanes(world: World) -> XmlElement:
    """Returns the OpenDRIVE element ``lanes`` with both lanes, the shoulders and the road markings."""
    section = XmlElement("laneSection", {"s": 0})
    section.add("left").extended(*_shoulder(2, world), _driving(1, world))
    section.add("center").extended(_middle())
    section.add("right").extended(_driving(-1, world), *_shoulder(-2, world))
    return XmlElement("lanes").extended(section)


def _lane(number: int, kind: str) -> XmlElement:
    return XmlElement("lane", {"id": number, "type": kind, "level": "false"})


def _width(metres: float) -> XmlElement:
    return XmlElement("width", {"sOffset": 0, "a": metres, "b": 0, "c": 0, "d": 0})


def _mark(kind: str, change: str) -> XmlElement:
    mark = XmlElement(
        "roadMark",
        {
            "sOffset": 0,
            "type": kind,
            "weight": "standard",
            "color": "white",
            "material": "standard",
            "width": LINE,
            "laneChange": change,
        },
    )
    length, space = (DASH, GAP) if kind == "broken" else (DASH + GAP, 0.0)
    line = {"length": length, "space": space, "tOffset": 0, "sOffset": 0, "width": LINE}
    mark.add("type", {"name": kind, "width": LINE}).add("line", line)
    return mark


def _middle() -> XmlElement:
    return _lane(0, "none").extended(_mark("broken", "both"))


def _driving(number: int, world: World) -> XmlElement:
    lane = _lane(number, "driving").extended(_width(world.lane_width), _mark("solid", "none"))
    lane.add("material", {"sOffset": 0, "friction": world.friction, "surface": "asphalt", "roughness": 0})
    lane.add("speed", {"sOffset": 0, "max": speed_kmh(world), "unit": "km/h"})
    return lane


def _shoulder(number: int, world: World) -> list[XmlElement]:
    """Returns the shoulder, firm ground at the height of the road; nothing where it has no width."""
    width = world.verge
    return [_lane(number, "shoulder").extended(_width(width))] if width >= NO_SHOULDER else []


def speed_kmh(world: World) -> float:
    """Returns the speed limit in km/h, rounded to six decimals."""
    return round(world.speed_limit * 3.6, 6)
