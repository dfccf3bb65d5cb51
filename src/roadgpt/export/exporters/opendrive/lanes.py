"""Writes the cross-section of a road: all lanes with their widths and markings, and the superelevation.

id     2     |    1    |    -1    |    -2          a road with one lane in each direction
    shoulder | against |  along   | shoulder
                       0
With traffic on the left, lanes with positive ids lead along the road."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache, cached_property

from roadgpt.export.exporters.opendrive.reference_line import elevations, level_height, rows
from roadgpt.export.markup import Value, XmlElement
from roadgpt.geometry import CubicProfile
from roadgpt.road import Road, World
from roadgpt.road.profile import DASH, DOUBLE, GAP, LINE, LaneStrip, Marking, Profile, as_cubics

NO_SHOULDER = 1e-3  # m; narrower shoulders are left out


LaneLinks = Mapping[int, tuple[int | None, int | None]]
"""Maps the id of a lane to the ids of the lanes of other roads before and after it; None if there is none."""


@dataclass(frozen=True)
class RoadParts:
    """Creates the XML elements that roads of one file share. Equal elements are created only once."""

    world: World
    _made: dict[object, XmlElement] = field(default_factory=dict)
    _level: dict[float, XmlElement] = field(default_factory=dict)
    _surfaces: dict[tuple[float | None, float | None], tuple[XmlElement, ...]] = field(default_factory=dict)

    @property
    def _speed_limit(self) -> float | None:
        return self.world.limits.speed_limit if self.world.limits.limit_stated else None

    @cached_property
    def road_type(self) -> XmlElement:
        """The element ``type`` with the speed limit."""
        made = XmlElement("type", {"s": 0, "type": "rural"}, is_shared=True)
        return made.extended(*_speed(self._speed_limit))

    def heights(self, road: Road) -> XmlElement:
        """Returns the element ``elevationProfile`` of a road. Level roads of one height share one element."""
        level = level_height(road)
        if level is None or level not in self._level:
            made = XmlElement("elevationProfile", is_shared=level is not None).extended(*elevations(road))
            if level is None:
                return made
            self._level[level] = made
        return self._level[level]

    def lanes(self, road: Road, links: LaneLinks, is_inside: bool) -> XmlElement:
        """Returns the OpenDRIVE element ``lanes`` with all lanes, shoulders and road markings.

        ``is_inside`` says whether the road is a connecting road in a junction. Lanes without a marking then
        get the marking "none"."""
        profile = self.world.profile_of(road)
        length = None if _is_constant(profile) else road.length
        own = (profile.left, profile.right, profile.centre_marking, profile.offset)
        key = (*own, length, tuple(links.items()), is_inside)
        if key not in self._made:
            self._made[key] = self._lanes(profile, road.length, links, is_inside)
        return self._made[key]

    def _lanes(self, profile: Profile, length: float, links: LaneLinks, is_inside: bool) -> XmlElement:
        section = XmlElement("laneSection", {"s": 0})
        left = list(self._side(profile.left, 1, length, links, is_inside))
        right = list(self._side(profile.right, -1, length, links, is_inside))
        if left:
            section.add("left").extended(*reversed(left))
        section.add("center").extended(_lane(0, "none").extended(*_mark(profile.centre_marking, is_inside)))
        if right:
            section.add("right").extended(*right)
        offset = rows("laneOffset", "s", as_cubics(profile.offset), length) if profile.offset != 0 else []
        return XmlElement("lanes", is_shared=True).extended(*offset, section)

    def _side(
        self, side: Sequence[LaneStrip], sign: int, length: float, links: LaneLinks, is_inside: bool
    ) -> Iterator[XmlElement]:
        kept = [lane for lane in side if isinstance(lane.width, CubicProfile) or lane.width >= NO_SHOULDER]
        for index, lane in enumerate(kept, 1):
            number = sign * index
            widths = rows("width", "sOffset", as_cubics(lane.width), length)
            made = _lane(number, lane.kind)
            before, after = links.get(number, (None, None))
            if before is not None or after is not None:
                link = made.add("link")
                for name, other in (("predecessor", before), ("successor", after)):
                    if other is not None:
                        link.add(name, {"id": other})
            rules = self._driven_on(lane.speed_limit, lane.friction) if lane.kind == "driving" else ()
            yield made.extended(*widths, *_mark(lane.marking, is_inside), *rules)

    def _driven_on(self, limit: float | None, friction: float | None) -> tuple[XmlElement, ...]:
        """Returns the surface and the speed limit of a lane; None for those of the World."""
        if (limit, friction) not in self._surfaces:
            own = self.world.site.friction if friction is None else friction
            surface: dict[str, Value] = {"sOffset": 0, "friction": own, "surface": "asphalt", "roughness": 0}
            limited = self._speed_limit if limit is None else limit
            self._surfaces[limit, friction] = (
                XmlElement("material", surface, is_shared=True),
                *_speed(limited, sOffset=0),
            )
        return self._surfaces[limit, friction]


def _speed(limit: float | None, **place: Value) -> Iterator[XmlElement]:
    if limit is not None:
        told: dict[str, Value] = {**place, "max": round(limit * 3.6, 6), "unit": "km/h"}
        yield XmlElement("speed", told, is_shared=True)


def _is_constant(profile: Profile) -> bool:
    widths = [profile.offset, *(lane.width for lane in (*profile.left, *profile.right))]
    return not any(isinstance(width, CubicProfile) for width in widths)


def lateral_profile(road: Road) -> list[XmlElement]:
    """Returns a list with the element ``lateralProfile``; an empty list for a road without
    superelevation."""
    angle = road.profile.superelevation_angle if road.profile is not None else None
    if angle is None:
        return []
    return [XmlElement("lateralProfile").extended(*rows("superelevation", "s", angle, road.length))]


def _lane(number: int, kind: str) -> XmlElement:
    return XmlElement("lane", {"id": number, "type": kind, "level": "false"})


@cache
def _mark(kind: Marking, is_inside: bool) -> tuple[XmlElement, ...]:
    """Returns the road marking at the outer edge of a lane.

    A lane without a marking has no such element. Only inside junctions, the marking "none" is written for
    this lane, because some programs would draw a line there."""
    if kind == "none":
        blank: dict[str, Value] = {"sOffset": 0, "type": "none", "color": "standard"}
        return (XmlElement("roadMark", blank, is_shared=True),) if is_inside else ()
    name, change = "solid solid" if kind == "double" else kind, "both" if kind == "broken" else "none"
    looks: dict[str, Value] = {"weight": "standard", "color": "white", "material": "standard", "width": LINE}
    mark = XmlElement("roadMark", {"sOffset": 0, "type": name, **looks, "laneChange": change}, is_shared=True)
    length, space = (DASH, GAP) if kind == "broken" else (DASH + GAP, 0.0)
    made = mark.add("type", {"name": name, "width": LINE})
    for t in (DOUBLE / 2, -DOUBLE / 2) if kind == "double" else (0,):
        made.add("line", {"length": length, "space": space, "tOffset": t, "sOffset": 0, "width": LINE})
    return (mark,)
