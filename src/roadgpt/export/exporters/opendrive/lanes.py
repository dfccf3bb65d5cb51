"""Writes the cross-section of a road: all lanes with their widths and markings, and the superelevation.

id     2     |    1    |    -1    |    -2          a road with one lane in each direction
    shoulder | against |  along   | shoulder
                       0
"""

from collections.abc import Iterator, Mapping, Sequence

from roadgpt.export.exporters.opendrive.heights import rows
from roadgpt.export.markup import XmlElement
from roadgpt.geometry import CubicProfile
from roadgpt.road import Road, World
from roadgpt.road.profile import LINE, Lane, Marking, Width

DASH, GAP = 4.0, 8.0  # m, middle line outside of towns (Germany, RMS-1)
NO_SHOULDER = 1e-3  # m; narrower shoulders are left out


LaneLinks = Mapping[int, tuple[int, int]]
"""For the id of a lane of a connecting road, the ids of the lanes before and after it."""


def lanes(road: Road, world: World, links: LaneLinks | None = None) -> XmlElement:
    """Returns the OpenDRIVE element ``lanes`` with all lanes, shoulders and road markings.

    Args:
        road: The road.
        world: The World, which gives the lanes of a road without its own, the speed limit and the friction.
        links: The links of the lanes of a connecting road in a junction, where it is stated that there are no
            markings; None for any other road.
    """
    profile, section = world.profile_of(road), XmlElement("laneSection", {"s": 0})
    left = list(_side(profile.left, 1, road.length, world, links))
    if left:
        section.add("left").extended(*reversed(left))
    section.add("center").extended(_lane(0, "none").extended(*_mark(profile.centre_marking, links)))
    section.add("right").extended(*_side(profile.right, -1, road.length, world, links))
    return XmlElement("lanes").extended(section)


def lateral_profile(road: Road) -> list[XmlElement]:
    """Returns the element ``lateralProfile`` with the superelevation, in a list that is empty for a road
    without superelevation.
    """
    angle = road.profile.superelevation_angle if road.profile is not None else None
    if angle is None:
        return []
    return [XmlElement("lateralProfile").extended(*rows("superelevation", "s", angle, road.length))]


def _side(
    side: Sequence[Lane], sign: int, length: float, world: World, links: LaneLinks | None
) -> Iterator[XmlElement]:
    """Yields the lanes of one side from the centre line outwards; their ids have the given sign."""
    kept = [lane for lane in side if isinstance(lane.width, CubicProfile) or lane.width >= NO_SHOULDER]
    for number, lane in enumerate(kept, 1):
        widths = rows("width", "sOffset", _cubics(lane.width), length)
        made = _lane(sign * number, lane.kind)
        if links is not None and sign * number in links:
            before, after = links[sign * number]
            link = made.add("link")
            link.add("predecessor", {"id": before})
            link.add("successor", {"id": after})
        made.extended(*widths, *_mark(lane.marking, links))
        if lane.kind == "driving":
            made.add(
                "material",
                {"sOffset": 0, "friction": world.site.friction, "surface": "asphalt", "roughness": 0},
            )
            made.add("speed", {"sOffset": 0, "max": speed_kmh(world), "unit": "km/h"})
        yield made


def _cubics(width: Width) -> CubicProfile:
    """Returns a width as cubics from station 0 on; before its first station, a width is constant."""
    if not isinstance(width, CubicProfile):
        return CubicProfile((0.0,), ((width, 0.0, 0.0, 0.0),))
    if width.stations[0] <= 0:
        return width
    first = (width.coefficients[0][0], 0.0, 0.0, 0.0)
    return CubicProfile((0.0, *width.stations), (first, *width.coefficients))


def _lane(number: int, kind: str) -> XmlElement:
    return XmlElement("lane", {"id": number, "type": kind, "level": "false"})


def _mark(kind: Marking, links: LaneLinks | None) -> list[XmlElement]:
    """Returns the road marking at the outer edge of a lane.

    Where there is none, the list is empty; inside junctions, the marking "none" is written, because some
    programs would draw a line there.
    """
    if kind == "none":
        blank = XmlElement("roadMark", {"sOffset": 0, "type": "none", "color": "standard"})
        return [] if links is None else [blank]
    mark = XmlElement(
        "roadMark",
        {
            "sOffset": 0,
            "type": kind,
            "weight": "standard",
            "color": "white",
            "material": "standard",
            "width": LINE,
            "laneChange": "both" if kind == "broken" else "none",
        },
    )
    length, space = (DASH, GAP) if kind == "broken" else (DASH + GAP, 0.0)
    line = {"length": length, "space": space, "tOffset": 0, "sOffset": 0, "width": LINE}
    mark.add("type", {"name": kind, "width": LINE}).add("line", line)
    return [mark]


def speed_kmh(world: World) -> float:
    """Returns the speed limit in km/h, rounded to six decimals."""
    return round(world.limits.speed_limit * 3.6, 6)
