"""Reads the roads of an OpenDRIVE file, with all their lanes.

A road of a network has the same lanes from its start to its end. So a road of a map becomes one road for each
stretch of its lane sections that have the same lanes, and these are joined. A connecting road inside a
junction becomes one road for each direction of its traffic; if its lanes change on the way, these roads have
only the lanes that lead all the way through. A road that is read by itself stays one road: its lanes have no
width where the file has no such lane."""

import math
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import groupby, pairwise
from typing import Any, NamedTuple
from xml.etree.ElementTree import Element

import numpy as np

from roadgpt.errors import UsageError
from roadgpt.geometry import CubicProfile, ElevationProfile, GradeProfile
from roadgpt.geometry.elevation import SHORTEST, Row, closed, constant, shifted, value_at
from roadgpt.network.lane_along import added
from roadgpt.network.maps import said_of
from roadgpt.network.stretch import turned
from roadgpt.road import Profile, Road
from roadgpt.road.profile import FASTEST, LINE, MOST_LANES, STEEPEST, WIDEST, Kind, LaneStrip, Marking, Width
from roadgpt.road.road import check_grade
from roadgpt_formats.opendrive.line import PlacedLine, placed_line
from roadgpt_formats.opendrive.tree import DRIVING, MapRemarks, cubics, in_order, number

SHORT = 0.05  # m; a shorter lane section is left out, and the lanes before it go on in those behind it
NO_WIDTH = 1e-3  # m; a lane that is nowhere wider is left out
THIN = 0.25  # m; a lane that is nowhere wider is no lane that a car could use
SAME_HEIGHT = 1e-9  # m, and as a ratio: heights and grades closer than this are treated as equal
STEP = 0.05  # m; a remark is made about a larger step of the height
TOUCHES = 1e-9  # m by which a cubic may be beyond a limit, because of rounding
UNITS = {"m/s": 1.0, "km/h": 3.6, "mph": 3600 / 1609.344}  # per m/s
MOST_CHANGES = 3  # that a sentence lists
BROAD = 0.2  # m; a wider line is reported
UNLINKED = "no lane is linked to those behind it, and lanes with the same ids continue each other"
UNREAD = ("color", "direction", "dynamicLaneDirection", "dynamicLaneType", "level", "roadWorks", "roughness",
          "singleSide", "weight")  # fmt: skip
USUAL = ("", "false", "standard", "white")  # values of these attributes that are not reported, like 0
PLAIN = ("none", "solid", "broken", "solid solid")  # types of road marks that are painted as they are
MARKS: Mapping[str, Marking] = {
    **dict.fromkeys(("solid", "solid broken", "broken solid", "custom"), "solid"),
    **dict.fromkeys(("broken", "broken broken", "botts dots"), "broken"),
    "solid solid": "double",
}
"""The marking for each type of road mark that is a line."""
KINDS: Mapping[str, Kind] = {
    **dict.fromkeys(DRIVING, "driving"),
    "shoulder": "shoulder",
    "stop": "shoulder",
    "border": "border",
    "parking": "parking",
    "biking": "biking",
    "sidewalk": "sidewalk",
    "walking": "sidewalk",
    "median": "median",
    "curb": "curb",
    **dict.fromkeys(("restricted", "bus", "taxi", "HOV"), "restricted"),
    **dict.fromkeys(("tram", "rail"), "rail"),
}
"""What the lanes are for, by their type in the file; lanes of all other types are strips for nothing."""

Pairs = set[tuple[int, int]]
"""Ids of lanes in the file, each with the id of the lane that continues it."""
Slot = dict[int, int]
"""One lane of a road: its ids in the file, by the number of the lane section; it need not be in all."""


class LaneElement(NamedTuple):
    """One lane of a section, with either its width or its ``border``, the offset of its outer edge."""

    id: int
    node: Element
    width: CubicProfile | None
    border: CubicProfile | None

    @property
    def kind(self) -> Kind:
        """What the lane is for."""
        return KINDS.get(self.node.get("type", ""), "none")


class FileSection(NamedTuple):
    """One lane section of a road, between two stations of the file in metres. If sections beside it were left
    out, it reaches over them with what its own part says, from station ``own[0]`` to ``own[1]``."""

    start: float
    end: float
    own: tuple[float, float]
    left: tuple[LaneElement, ...]  # from the centre line outwards
    right: tuple[LaneElement, ...]
    centre: tuple[Element, ...]

    @property
    def ids(self) -> dict[int, LaneElement]:
        """The lanes by their ids in the file."""
        return {lane.id: lane for lane in (*self.left, *self.right)}

    @property
    def driving(self) -> set[int]:
        """The ids of the lanes that cars may use."""
        return {lane for lane, own in self.ids.items() if own.kind == "driving"}

    def links(self, name: str) -> Pairs:
        """Returns the links of the lanes, as pairs of an own id and the id in the neighbouring section."""
        found: Pairs = set()
        for lane, own in self.ids.items():
            for node in own.node.findall(f"link/{name}"):
                found.add((lane, int(number(node, "id"))))
        return found


class FileSections(NamedTuple):
    """Lane sections of a road, one after another, and which lanes continue each other between them."""

    sections: list[FileSection]
    joints: list[Pairs]


@dataclass
class LaneStretch:
    """Lane sections of a road that have the same lanes."""

    parts: FileSections
    lanes: dict[int, int] = field(default_factory=dict)
    """The ids of the lanes in the network, by their ids in the file."""


@dataclass
class FileRoad:
    """A road of the file."""

    id: str
    node: Element
    junction: str  # the id of its junction; empty if it is no connecting road
    left_hand: bool
    line: PlacedLine
    heights: CubicProfile
    offset: CubicProfile
    angle: CubicProfile | None  # the superelevation in radians, positive where it falls to the right
    is_swapped: bool  # whether the ids of its lanes had the wrong signs
    whole: FileSections
    stretches: list[LaneStretch]
    joints: list[Pairs]  # which lanes continue each other from one stretch to the next
    entry: dict[int, int]  # the lanes of the first stretch, by the ids in the first section of the file
    exit: dict[int, int]  # the same at the end
    speeds: list[tuple[float, float | None]]  # stations in metres, and the speed limit in m/s from there on
    links: tuple[Pairs, Pairs]

    def ends(self, name: str) -> tuple[str, str, str] | None:
        """Returns type, id and contact point of the ``predecessor`` or ``successor``; None without one."""
        node = self.node.find(f"link/{name}")
        if node is None:
            return None
        kind = node.get("elementType", "road")
        return kind, node.get("elementId", ""), node.get("contactPoint", "start")

    def links_at(self, contact: str, other: "FileRoad") -> Pairs:
        """Returns the links of the lanes at an end to those of the ``other`` road, by ids in the file."""
        sign = 1 if self.is_swapped == other.is_swapped else -1
        return {(own, sign * there) for own, there in self.links[0 if contact == "start" else 1]}


def file_road(node: Element, remarks: MapRemarks) -> FileRoad | None:
    """Returns a road of the file, or None if it has no lane that cars may use. Raises UsageError if its line
    or its lanes cannot be read."""
    road_id = node.get("id", "?")[:40]
    where = f"road {road_id}"
    in_order(node, remarks, where)
    for holder in (*node.findall("signals"), *node.findall("objects")):
        for each in [*holder]:
            try:
                number(each, "s")
            except UsageError as error:
                holder.remove(each)
                remarks.add(f"left out: what has no place: {str(error).partition(';')[0]}", where)
    is_swapped = _signed(node, remarks, where)
    line = placed_line(node, remarks, where)
    length = float(line.of_file[-1])
    sections = _sections(node, float(line.of_file[0]), length)
    if not any(section.driving for section in sections):
        remarks.add("left out: roads without a lane for cars", where)
        return None
    if any(lane.get("type") == "bidirectional" for lane in node.findall("lanes/laneSection/*/lane")):
        what = "lanes for both directions are driven in one only here, that of their side of the road"
        remarks.add(what, where)
    heights = cubics(node.findall("elevationProfile/elevation"), "s") or CubicProfile.constant(0.0)
    check_grade(heights, length)
    if jump := _jump(heights, length):
        remarks.add("its height jumps", where, jump)
    if len(node.findall("lanes/laneSection/*/lane")) > sum(
        len(each.ids) + len(each.centre) for each in sections
    ):
        remarks.add("several lanes of a section have the same id, and the last of them is taken", where)
    if not all(_linked(one, two) for one, two in pairwise(sections)):
        remarks.add(UNLINKED, where)
    whole, entry, leaving = _long_enough(sections)
    junction = node.get("junction", "-1")
    return FileRoad(
        road_id,
        node,
        "" if junction in ("-1", "") else junction,
        node.get("rule", "RHT") == "LHT",
        line,
        heights,
        cubics(node.findall("lanes/laneOffset"), "s") or CubicProfile.constant(0.0),
        cubics(node.findall("lateralProfile/superelevation"), "s"),
        is_swapped,
        whole,
        *_stretches(whole),
        entry,
        leaving,
        [
            (number(each, "s", 0.0), speed_of(found, remarks, where))
            for each in node.findall("type")
            if (found := each.find("speed")) is not None
        ],
        (sections[0].links("predecessor"), sections[-1].links("successor")),
    )


def _signed(road: Element, remarks: MapRemarks, where: str) -> bool:
    """Gives the lanes of each side ids of the sign that they must have, also in their links; returns whether
    all lanes had the other one."""
    wrong, right = 0, 0
    for side, sign in (("left", 1), ("right", -1)):
        for holder in road.findall(f"lanes/laneSection/{side}"):
            for lane in holder.findall("lane"):
                own = sign * int(number(lane, "id"))
                wrong, right = wrong + (own < 0), right + (own > 0)
                if own == 0:
                    holder.remove(lane)
                    remarks.add("left out: lanes beside the centre line that have its id, 0", where)
                for each in (lane, *lane.findall("link/*")) if own < 0 else ():
                    each.set("id", str(-int(number(each, "id"))))
    if wrong:
        what = "ids of its lanes have the wrong sign for their side, which is changed"
        remarks.add(f"{what}: left lanes have positive ones, right lanes negative ones", where)
    return wrong > 0 and not right


def unread(road: Element) -> set[str]:
    """Returns what the elements of a road say that is not used."""
    nodes, marks = [*road.iter()], [*road.iter("roadMark")]
    others = {mark.get("type", "none")[:20] for mark in marks} - {*PLAIN}
    found = {f"what road marks of type {kind} look like" for kind in others}
    found |= {
        f"the attribute {name}"
        for name in UNREAD
        if any(node.get(name, "").strip("0.") not in USUAL for node in nodes)
    }
    if any(node.find("width") is not None and node.find("border") is not None for node in nodes):
        found.add("borders of lanes that have widths")
    if any(number(mark, "width", LINE) > BROAD for mark in marks):
        found.add("the width of broad road marks")
    return found


def left_out(passed: Counter[str], others: Iterable[str], header: Iterable[str]) -> tuple[str, ...]:
    """Returns a sentence about the elements of roads that were not read, by their number, about other
    contents, and about the elements of the header; no sentence if there are none."""
    parts = [f"{count:,} {what}{'s' * (count > 1 and what[-1] != '>')}" for what, count in passed.items()]
    parts += [*others, *(f"<{name}> of the map" for name in header)]
    return (f"left out: {', '.join(sorted(parts))}",) if parts else ()


def _jump(heights: CubicProfile, length: float) -> str:
    """Returns the largest step in height in words; nothing if no step is larger than 5 cm."""
    worst, where = 0.0, 0.0
    for s, end in pairwise(heights.stations):
        if end < length:
            step = abs(float(heights.height(end) - heights.height(np.nextafter(end, s))))
            worst, where = max((worst, where), (step, end))
    return f"by {worst:.2f} m at s = {where:.1f}" if worst > STEP else ""


def _sections(node: Element, first: float, last: float) -> list[FileSection]:
    nodes = node.findall("lanes/laneSection")
    if not nodes:
        raise UsageError("it has no lane section")
    starts = [first, *(max(number(each, "s"), first) for each in nodes[1:])]
    found = []
    for each, (start, end) in zip(nodes, pairwise([*starts, last]), strict=True):
        left, right = (lane_elements(each, side, start) for side in ("left", "right"))
        if max(len(left), len(right)) > MOST_LANES:
            raise UsageError(f"it has more than {MOST_LANES} lanes on one side")
        found.append(FileSection(start, end, (start, end), left, right, tuple(each.findall("center/lane"))))
    return found


def lane_elements(section: Element, side: str, s: float) -> tuple[LaneElement, ...]:
    """Returns the lanes on the side "left" or "right" of a section that begins at station ``s``, from the
    inside out."""
    nodes = [(int(number(lane, "id")), lane) for lane in section.findall(f"{side}/lane")]
    return tuple(
        LaneElement(n, lane, *(cubics(lane.findall(tag), "sOffset", s) for tag in ("width", "border")))
        for n, lane in sorted(dict(nodes).items(), key=lambda pair: abs(pair[0]))
    )


def _long_enough(sections: list[FileSection]) -> tuple[FileSections, dict[int, int], dict[int, int]]:
    """Leaves out the sections that are shorter than ``SHORT``; returns the others, and the lanes at both ends
    by their ids in the file."""
    joints = [
        _linked(one, two) or {(lane, lane) for lane in one.ids.keys() & two.ids.keys()}
        for one, two in pairwise(sections)
    ]
    entry, leaving = ({lane: lane for lane in sections[at].ids} for at in (0, -1))
    kept = list(sections)
    n = 0
    while n < len(kept):
        own = kept[n]
        if own.end - own.start >= SHORT or len(kept) == 1:
            n += 1
            continue
        if n == 0:
            entry = _followed(entry, joints[0])
            kept[1] = kept[1]._replace(start=own.start)
            del joints[0]
        elif n == len(kept) - 1:
            leaving = _followed(leaving, {(b, a) for a, b in joints[-1]})
            kept[-2] = kept[-2]._replace(end=own.end)
            del joints[-1]
        else:
            joints[n - 1 : n + 1] = [{(a, d) for a, b in joints[n - 1] for c, d in joints[n] if b == c}]
            kept[n - 1] = kept[n - 1]._replace(end=own.end)
        del kept[n]
    return FileSections(kept, joints), entry, leaving


def _stretches(whole: FileSections) -> tuple[list[LaneStretch], list[Pairs]]:
    """Joins sections that have the same lanes; returns the stretches, and the links between them."""
    stretches, between = [LaneStretch(FileSections([whole.sections[0]], []))], list[Pairs]()
    for joint, (before, section) in zip(whole.joints, pairwise(whole.sections), strict=True):
        same = [(lane, own.kind) for lane, own in before.ids.items()]
        goes_on = same == [(lane, own.kind) for lane, own in section.ids.items()]
        if goes_on and joint >= {(lane, lane) for lane in section.driving} and len(joint) <= len(same):
            stretches[-1].parts.sections.append(section)
            stretches[-1].parts.joints.append(joint)
        else:
            stretches.append(LaneStretch(FileSections([section], [])))
            between.append(joint)
    return stretches, between


def _followed(lanes: dict[int, int], joint: Pairs) -> dict[int, int]:
    onward = dict(joint)
    return {lane: onward[at] for lane, at in lanes.items() if at in onward}


def _linked(one: FileSection, two: FileSection) -> Pairs:
    found = one.links("successor") | {(b, a) for a, b in two.links("predecessor")}
    return {(a, b) for a, b in found if a in one.ids and b in two.ids}


def _slots(parts: FileSections, side: int) -> list[Slot]:
    """Returns the lanes on one side, 1 for the left, from the centre line outwards. A lane that continues
    none of the section before is one of its own, or goes on where a lane of its kind has ended; strips on
    which cars do not drive need no link for that."""
    slots, kinds = list[Slot](), list[Kind]()
    for n, section in enumerate(parts.sections):
        place, linked = 0, {a for a, _ in parts.joints[n - 1]} if n else set()
        for lane, own in ((lane, own) for lane, own in section.ids.items() if lane * side > 0):
            before = {a for a, b in parts.joints[n - 1] if b == lane} if n else set()
            fits = [k for k in range(place, len(slots)) if kinds[k] == own.kind]
            found = next((k for k in fits if slots[k].get(n - 1) in before), None)
            if found is None and place in fits:
                last = slots[place].get(n - 1)
                is_free = last is None or (last not in linked and own.kind != "driving")
                found = place if is_free else None
            if found is None:
                found = place
                slots.insert(place, {})
                kinds.insert(place, own.kind)
            slots[found][n] = lane
            place = found + 1
    return slots


def speed_of(node: Element, remarks: MapRemarks, where: str) -> float | None:
    """Returns the speed limit in m/s of an element ``speed``; None if it states none."""
    text = node.get("max")
    if text is None:
        return None
    if (unit := node.get("unit", "m/s")) not in UNITS:
        remarks.add(f"a speed limit is in '{unit[:20]}', and is taken as one in m/s", where)
    is_none = text in ("no limit", "undefined")
    value = 0.0 if is_none else number(node, "max") / UNITS.get(unit, 1.0)
    return _usable(value, "speed limit", remarks, where)


def _usable(value: float, what: str, remarks: MapRemarks, where: str) -> float | None:
    if 0 < value <= FASTEST:
        return value
    said = said_of(what, value) if value else f"0{', or of no limit,' * (what == 'speed limit')}"
    remarks.add(f"a {what} of {said} is not used", where)
    return None


def combined(parts: Sequence[tuple[float, CubicProfile]], start: float, end: float) -> list[Row]:
    """Returns the sum of cubics, each times its factor, between two stations in metres, as rows."""
    inner = {s for _, each in parts for s in each.stations if start < s < end}
    stations = [start, *sorted(inner)]
    table = np.zeros((len(stations), 4))
    for factor, each in parts:
        table += factor * each.cubics(np.array(stations))
    return CubicProfile.of_table(stations, table).rows


def limited(rows: Sequence[Row], end: float, low: float, high: float) -> list[Row]:
    """Returns the rows with their values clamped to the range from ``low`` to ``high``. The last row ends at
    station ``end`` in metres. The result is exact: a row is cut where its cubic crosses a limit."""
    out: list[Row] = []
    ends = [*(s for s, _ in rows[1:]), end]
    for row, stop in zip(rows, ends, strict=True):
        for start, until in _cuts(row, stop, low, high):
            value = value_at(row, (start + until) / 2)
            if low - TOUCHES <= value <= high + TOUCHES:
                a, b, c, d = shifted(np.array(row[1]), start - row[0]).tolist()
                out.append((start, (a, b, c, d)) if start > row[0] else row)
            else:
                out.append(constant(start, low if value < low else high))
    return out


def _cuts(row: Row, end: float, low: float, high: float) -> list[tuple[float, float]]:
    start, (a, b, c, d) = row
    reach = end - start
    swing = reach * (abs(b) + reach * (abs(c) + reach * abs(d)))
    if (low <= a - swing and a + swing <= high) or (b, c, d) == (0.0, 0.0, 0.0):
        return [(start, end)]
    places = {start, end}
    for limit in (low, high):
        for root in np.roots([d, c, b, a - limit]):
            if abs(root.imag) < TOUCHES and SHORTEST < root.real < reach - SHORTEST:
                places.add(start + float(root.real))
    return [*pairwise(sorted(places))]


def width_rows(lanes: Sequence[LaneElement], place: int, start: float, end: float) -> list[Row]:
    """Returns the width of the lane with this index in ``lanes``, from a station to another, in metres."""
    lane = lanes[place]
    parts: list[tuple[float, CubicProfile]] = []
    if lane.width is not None:
        parts.append((1.0, lane.width))
    elif lane.border is not None:
        parts.append((_sign(lane.border), lane.border))
        for inner in reversed(lanes[:place]):
            if inner.width is not None:
                parts.append((-1.0, inner.width))
            elif inner.border is not None:
                parts.append((-_sign(inner.border), inner.border))
                break
    return combined(parts, start, end)


def _sign(border: CubicProfile) -> float:
    return -1.0 if next((row[0] for row in border.coefficients if row[0]), 0.0) < 0 else 1.0


def plain(profile: CubicProfile, length: float) -> ElevationProfile:
    """Returns a profile of constant grades and parabolas as a GradeProfile, and any other one as cubics, both
    up to a length in metres."""
    stations = [s for s in profile.stations if s < length - SAME_HEIGHT]
    stations = [0.0, *(s for s in stations if s > SAME_HEIGHT)]
    table = profile.cubics(np.array(stations))
    a, b, c, d = table.T
    u = np.diff([*stations, length])
    z, grades = a + u * (b + u * c), b + 2 * u * c
    steps = np.abs(z[:-1] - a[1:]) / np.maximum(1.0, np.abs(a[1:]))
    if np.any(d) or max([0.0, *steps, *np.abs(grades[:-1] - b[1:])]) > SAME_HEIGHT:
        return CubicProfile.of_table(stations, table)
    return GradeProfile(float(a[0]), (*stations, length), (*b.tolist(), float(grades[-1])))


def _reaching(rows: list[Row], start: float) -> list[Row]:
    """Returns rows of which the first one begins at another station, with the same cubic."""
    (s, cubic), *rest = rows
    a, b, c, d = shifted(np.array(cubic), start - s).tolist()
    return [(start, (a, b, c, d)), *rest]


def _constant(width: CubicProfile) -> Width:
    varies = len(width.stations) > 1 or any(width.coefficients[0][1:])
    return width if varies else width.coefficients[0][0]


def _sum(terms: Sequence[tuple[float, Width]], length: float) -> Width:
    total = added(terms, length)
    return _constant(closed(total.rows, length)) if isinstance(total, CubicProfile) else total


class Stated(NamedTuple):
    """A part of a lane between two stations in metres, with what is stated there; None if nothing is."""

    start: float
    end: float
    value: Any


Nodes = Sequence[tuple[float, float, Element]]
"""The XML elements of a lane, with the stations in metres between which each holds."""


def stated(lanes: Nodes, tag: str, read: Callable[[Element], Any]) -> list[Stated]:
    """Returns what the records ``tag`` of a lane state, in order along the road. ``read`` reads a record."""
    out: list[Stated] = []
    for start, end, lane in lanes:
        nodes = lane.findall(tag)
        starts = [start + number(node, "sOffset", 0.0) for node in nodes]
        held = [start, *(min(max(each, start), end) for each in starts), end]
        out += map(Stated, held, held[1:], [None, *map(read, nodes)])
    return out


def longest_first(stretches: Iterable[Stated]) -> list[Any]:
    """Returns the values that are stated, that of the longest part of the road first."""
    lengths: dict[Any, float] = {}
    for start, end, value in stretches:
        if value is not None and end > start:
            lengths[value] = lengths.get(value, 0.0) + end - start
    return sorted(lengths, key=lambda value: -lengths[value])


class RoadBuilder:
    """Makes the roads of a network from those of a file."""

    def __init__(self, road: FileRoad, remarks: MapRemarks) -> None:
        self.file, self.remarks, self.name = road, remarks, f"road {road.id}"

    def build(self, parts: FileSections) -> tuple[Road, list[dict[int, int]]]:
        """Returns the road of some sections, and for each section the ids of the lanes in this road by those
        in the file."""
        sections, ids, sides = parts.sections, [dict[int, int]() for _ in parts.sections], []
        start, end = sections[0].start, sections[-1].end
        for side in (1, -1):
            made = list[LaneStrip]()
            slots = _slots(parts, side)
            if len(slots) > MOST_LANES:
                self.remarks.add(f"lanes beyond the first {MOST_LANES} of a side are left out", self.name)
            for slot in slots[:MOST_LANES]:
                lane = self._lane(sections, slot)
                if lane is not None:
                    made.append(lane)
                    for n, own in slot.items():
                        ids[n][own] = side * len(made)
            sides.append(tuple(made))
        offset = list[Row]()
        for each in sections:
            offset += _reaching(combined([(1.0, self.file.offset)], *each.own), each.start)
        centre = [(each.start, each.end, each.centre[0]) for each in sections if each.centre]
        left, right = sides
        along, angle = left if self.file.left_hand else right, None
        if self.file.angle is not None:
            rows, unit = combined([(1.0, self.file.angle)], start, end), (math.degrees(1), "degrees")
            angle = self._limited(rows, start, end, (-STEEPEST, STEEPEST), "its superelevation", unit=unit)
            angle = angle if any(any(cubic) for cubic in angle.coefficients) else None
        driven = max((n for n, lane in enumerate(along) if lane.kind == "driving"), default=0)
        centre_offset = _constant(self.file.line.moved(offset, start, end))
        marking, left_hand = self._marking(centre), self.file.left_hand
        profile = Profile(left, right, driven, marking, angle, centre_offset, left_hand)
        plan = self.file.line.part(start, end)
        heights = self.file.line.moved(combined([(1.0, self.file.heights)], start, end), start, end)
        return Road(plan, plain(heights, plan.length), profile=profile), ids

    def _limited(
        self,
        rows: Sequence[Row],
        start: float,
        end: float,
        limits: tuple[float, float],
        what: str,
        which: str = "",
        unit: tuple[float, str] = (1.0, "m"),
    ) -> CubicProfile:
        """Returns the rows, on the stations of the file, within limits on the stations of the road."""
        if found := closed(rows, end).beyond(*limits):
            value, low, high = (f"{each * unit[0]:.4g}" for each in (found[1], *limits))
            where = f"{which}{value} {unit[1]} at s = {found[0]:.4g} m, outside {low} to {high} {unit[1]}"
            self.remarks.add(f"{what} is limited", self.name, where)
            rows = limited(rows, end, *limits)
        return self.file.line.moved(rows, start, end)

    def _lane(self, sections: Sequence[FileSection], slot: Slot) -> LaneStrip | None:
        rows, start, end = list[Row](), sections[0].start, sections[-1].end
        for n, section in enumerate(sections):
            if n in slot:
                side = section.left if slot[n] > 0 else section.right
                place = [own.id for own in side].index(slot[n])
                rows += _reaching(width_rows(side, place, *section.own), section.start)
            else:
                rows.append(constant(section.start, 0.0))
        parts = [(sections[n].start, sections[n].end, sections[n].ids[slot[n]]) for n in sorted(slot)]
        which = f"lane {slot[min(slot)]}: "
        width = self._limited(rows, start, end, (0.0, WIDEST), "the width of a lane", which)
        widest = width.extremes()[1]
        if widest <= NO_WIDTH:
            return None
        kind, nodes = parts[0][2].kind, [(start, end, own.node) for start, end, own in parts]
        if kind == "driving" and widest <= THIN:
            kind, told = "none", f"a lane for cars that is nowhere wider than {THIN:g} m is a strip here"
            self.remarks.add(told, self.name)
        if kind != "driving":
            if any(node.find(tag) is not None for _, _, node in nodes for tag in ("speed", "material")):
                what = "left out: speed limits and frictions of lanes that are not for cars"
                self.remarks.add(what, self.name)
            return LaneStrip(kind, _constant(width), self._marking(nodes))
        limit, friction = (self._used(nodes, what) for what in ("speed limit", "friction"))
        return LaneStrip(kind, _constant(width), self._marking(nodes), limit, friction)

    def _marking(self, lanes: Nodes) -> Marking:
        """Returns the marking that a lane has on the longest part of its sections."""
        marked = stated(lanes, "roadMark", lambda mark: MARKS.get(mark.get("type", "none"), "none"))
        found: list[Marking] = longest_first(each._replace(value=each.value or "none") for each in marked)
        if len(found) > 1:
            what = "its road marks change along the road, and the most frequent ones are painted"
            self.remarks.add(what, self.name)
        return found[0] if found else "none"

    def _used(self, lanes: Nodes, what: str) -> float | None:
        """Returns the speed limit in m/s, or the friction, that holds for most of a lane."""
        if what == "friction":
            found = stated(lanes, "material", self._friction)
        else:
            own = stated(lanes, "speed", lambda node: speed_of(node, self.remarks, self.name))
            found = self._or_of_road(own)
        groups = groupby((each for each in found if each.end > each.start), lambda each: each.value)
        firsts, values = [next(group) for _, group in groups], longest_first(found)
        if values and len(firsts) > 1:
            steps = [f"to {said_of(what, value)} at s = {s:g} m" for s, _, value in firsts[1:]]
            more = f" and so on ({len(steps)} changes)" if len(steps) > MOST_CHANGES else ""
            first = f"lane {lanes[0][2].get('id', '?')[:10]} from {said_of(what, firsts[0].value)}"
            changes = f"{first} {', '.join(steps[:MOST_CHANGES])}{more}"
            told = f"the {what} of a lane changes on its way, and the one for most of it is taken"
            self.remarks.add(told, self.name, f"{changes}; {said_of(what, values[0])} is taken")
        return values[0] if values else None

    def _or_of_road(self, own: Iterable[Stated]) -> list[Stated]:
        """Returns the speed limits of a lane and, where it states none, those of its road."""
        found = list[Stated]()
        for start, end, value in own:
            cuts = [start, *(s for s, _ in self.file.speeds if start < s < end), end]
            for s, until in pairwise(cuts):
                of_road = next((speed for at, speed in reversed(self.file.speeds) if at <= s), None)
                found.append(Stated(s, until, of_road if value is None else value))
        return found

    def _friction(self, node: Element) -> float | None:
        if "friction" not in node.attrib:
            return None
        return _usable(number(node, "friction"), "friction", self.remarks, self.name)

    def ways(self) -> "list[OneWay]":
        """Returns the roads of a connecting road, one for each direction in which lanes lead through it."""
        road, ids = self.build(self.file.whole)
        side = 1 if self.file.left_hand else -1
        found = [self._way(road, ids, sign, sign == side) for sign in (side, -side)]
        return [way for way in found if way is not None]

    def _way(self, road: Road, ids: Sequence[dict[int, int]], sign: int, is_along: bool) -> "OneWay | None":
        profile = road.profile
        assert profile is not None
        through = set.intersection(*(set(each.values()) for each in ids))
        offset, kept, lanes = profile.offset, dict[int, int](), list[LaneStrip]()
        inside: list[tuple[float, Width]] = []
        for n, lane in enumerate(profile.left if sign > 0 else profile.right, 1):
            if lane.kind != "driving" or sign * n not in through:
                inside.append((1.0, lane.width))
                if lane.kind == "driving":
                    self.remarks.add("left out: lanes that begin or end inside a junction", self.name)
                continue
            gap = _sum(inside, road.length)
            if not lanes:
                offset = _sum([(1.0, offset), (float(sign), gap)], road.length)
            elif gap != 0:
                lanes.append(LaneStrip("none", gap))
            lanes.append(lane)
            kept[sign * n], inside = sign * len(lanes), []
        if not kept:
            return None
        left, right = (tuple(lanes), ()) if sign > 0 else ((), tuple(lanes))
        driven = len(lanes) - 1 if is_along else 0
        own = replace(profile, left=left, right=right, driven=driven, centre_marking="none", offset=offset)
        road = road.with_profile(own)
        at_start, at_end = (
            {lane: kept[there[own]] for lane, own in lanes_at.items() if there.get(own) in kept}
            for lanes_at, there in ((self.file.entry, ids[0]), (self.file.exit, ids[-1]))
        )
        if is_along:
            return OneWay(road, True, at_start, at_end)
        return OneWay(turned(road), False, *({a: -b for a, b in each.items()} for each in (at_start, at_end)))


class OneWay(NamedTuple):
    """A road for one direction of a connecting road, from where its traffic enters the junction."""

    road: Road
    is_along: bool  # whether it leads along the road of the file
    at_start: dict[int, int]  # ids of its lanes, by those in the first section of the file
    at_end: dict[int, int]  # ids of its lanes, by those in the last section of the file
