"""Reads the cross-section of a road: lanes, shoulders and road marks beside the centre line, and the
superelevation.

The centre line is the inner edge of the innermost driving lane. Lanes of successive lane sections are joined
in order, beginning with the innermost. A lane narrower than 0.25 m where two sections meet is not joined
there. In sections where a joined lane does not exist, its width is 0."""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain, groupby, pairwise, repeat, takewhile
from math import inf
from typing import Any, NamedTuple
from xml.etree.ElementTree import Element

import numpy as np

from roadgpt.errors import UsageError
from roadgpt.geometry import CubicProfile, shifted
from roadgpt.geometry.elevation import Cubic
from roadgpt.road.opendrive.lanes import BESIDE, LaneElement, Lanes, Span
from roadgpt.road.opendrive.tree import DRIVING, number
from roadgpt.road.profile import MOST_LANES, MOST_ROWS, STEEPEST, WIDEST, Kind, Lane, Marking, Profile, Width
from roadgpt.road.world import FRICTIONS, LANE_WIDTHS, SPEEDS

Row = tuple[float, Cubic]
"""A station in metres, and the cubic that begins there."""

SAME = 1e-12  # m; two constants closer than this are treated as equal
TOUCHES = 1e-9  # m by which a cubic may be beyond a limit, because of rounding
SHORTEST = 1e-6  # m between two stations
UNITS = {"m/s": 1.0, "km/h": 3.6, "mph": 3600 / 1609.344}  # per m/s
MOST_CHANGES = 3  # that a sentence lists
ADJOINS = 1e-3  # m; lanes for oncoming cars that are farther from the centre line lie behind a median
THIN = 0.25  # m; a lane that is narrower at the end of a section ends or begins there
UNMARKED: Marking = "none"
MARKS: dict[str, Marking] = {
    "solid": "solid",
    "broken": "broken",
    "solid solid": "double",
    "solid broken": "solid",
    "broken solid": "solid",
    "broken broken": "broken",
    "botts dots": "broken",
    "custom": "solid",
}
"""The marking for each type of road mark that is a line."""
Carry = Callable[[CubicProfile], CubicProfile]
"""A function that converts cubics over the stations of the file to cubics over those of the Road."""


def combined(parts: Sequence[tuple[float, CubicProfile]], start: float, end: float) -> list[Row]:
    """Returns the sum of cubics, each times its factor, between two stations in metres, as rows."""
    inner = {s for _, each in parts for s in each.stations if start < s < end}
    stations = [start, *sorted(inner)]
    table = np.zeros((len(stations), 4))
    for factor, each in parts:
        table += factor * each.cubics(np.array(stations))
    return CubicProfile.of_table(stations, table).rows


def value_at(row: Row, s: float) -> float:
    """Returns the value that the cubic of a row has at station ``s``."""
    (a, b, c, d), u = row[1], s - row[0]
    return float(a + u * (b + u * (c + u * d)))


def constant(s: float, value: float) -> Row:
    """Returns a row with a constant cubic that begins at station ``s``."""
    return s, (value, 0.0, 0.0, 0.0)


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
    """Returns the parts of a row inside which its cubic crosses no limit."""
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


def closed(rows: Sequence[Row], length: float) -> CubicProfile:
    """Converts the rows to a CubicProfile of a road of ``length`` metres. Beyond the end of the road, the
    profile keeps its last value. A constant row that repeats the row before is left out."""
    kept: list[Row] = []
    for row in rows:
        if kept and row[0] >= length - SHORTEST:
            break
        if kept and row[0] - kept[-1][0] < SHORTEST:
            kept.pop()
        repeats = kept and _is_constant(kept[-1]) and _is_constant(row)
        if not (repeats and abs(kept[-1][1][0] - row[1][0]) < SAME):
            kept.append(row)
    if not _is_constant(kept[-1]):
        kept.append(constant(length, value_at(kept[-1], length)))
    return CubicProfile.of_rows(kept)


def _is_constant(row: Row) -> bool:
    return not any(row[1][1:])


class MarkedLane(NamedTuple):
    """A lane in one lane section. Its XML element, ``node``, holds what is stated about the lane."""

    span: Span
    node: Element


class Stretch(NamedTuple):
    """A part of the road between two stations in metres, with what is stated there; None if nothing is."""

    start: float
    end: float
    value: Any


def stated(lanes: Iterable[MarkedLane], tag: str, read: Callable[[Element], Any]) -> list[Stretch]:
    """Returns what the records ``tag`` of a lane state, in order along the road. ``read`` reads a record."""
    out: list[Stretch] = []
    for span, lane in lanes:
        nodes = lane.findall(tag)
        starts = [span.section.s + number(node, "sOffset", 0.0) for node in nodes]
        held = [span.start, *(min(max(start, span.start), span.end) for start in starts), span.end]
        out += map(Stretch, held, held[1:], [None, *map(read, nodes)])
    return out


def longest_first(stretches: Iterable[Stretch]) -> list[Any]:
    """Returns the values that are stated, that of the longest part of the road first."""
    lengths: dict[Any, float] = {}
    for start, end, value in stretches:
        if value is not None and end > start:
            lengths[value] = lengths.get(value, 0.0) + end - start
    return sorted(lengths, key=lambda value: -lengths[value])


def speed_limit(
    road: Element, lanes: Sequence[Sequence[MarkedLane]], length: float, remarks: list[str]
) -> float | None:
    """Returns the speed limit of the driven lane in m/s; that of the road where the lane states none. The
    first of ``lanes`` are the driven lane in each lane section, the others all further lanes."""

    def read(node: Element | None) -> float | None:
        if node is None or node.get("max") is None:
            return None
        if (unit := node.get("unit", "m/s")) not in UNITS:
            remarks.append(f"a speed limit is in '{unit[:20]}', and is taken as one in m/s")
        is_none = node.get("max") in ("no limit", "undefined")
        return 0.0 if is_none else number(node, "max") / UNITS.get(unit, 1.0)

    def said(limit: float) -> str:
        return f"{limit * 3.6:.4g} km/h" if limit else "0, or of no limit,"

    own, others = (stated(each, "speed", read) for each in lanes)
    types = road.findall("type")
    starts = [0.0, *(min(max(number(node, "s", 0.0), 0.0), length) for node in types), length]
    general = [*map(Stretch, starts, starts[1:], [None, *(read(node.find("speed")) for node in types)])]
    usual = next(iter(longest_first(general)), None)
    filled = [each._replace(value=usual) if each.value is None else each for each in own]
    found = filled if longest_first(own) else general
    return _one("speed limit", found, [*general, *others], said, SPEEDS, remarks)


def friction(lanes: Sequence[Sequence[MarkedLane]], remarks: list[str]) -> float | None:
    """Returns the friction coefficient of the driven lane; see ``speed_limit``."""

    def read(node: Element) -> float | None:
        return number(node, "friction") if "friction" in node.attrib else None

    found, beside = (stated(each, "material", read) for each in lanes)
    return _one("friction", found, beside, "{:g}".format, FRICTIONS, remarks)


def _one(
    what: str,
    found: list[Stretch],
    beside: list[Stretch],
    said: Callable[[float], str],
    limits: tuple[float, float],
    remarks: list[str],
) -> float | None:
    """Returns the value that holds for the longest part of the driven lane, within its limits."""
    for row in (found, beside):
        for n, (s, _, value) in enumerate(row):
            if value is not None and value <= 0:
                remarks.append(f"a {what} of {said(value)} at s = {s:g} m is not used")
                row[n] = row[n]._replace(value=None)
    values = longest_first(found)
    used = min(max(values[0], limits[0]), limits[1]) if values else None
    if used is not None and used != values[0]:
        where = next(each.start for each in found if each.value == values[0])
        remarks.append(f"its {what} of {said(values[0])} at s = {where:g} m is taken as {said(used)}")
    parts = groupby((each for each in found if each.end > each.start), lambda each: each.value)
    firsts = [next(group) for _, group in parts]
    texts = ["none" if each.value is None else said(each.value) for each in firsts]
    steps = [f"to {text} at s = {each.start:g} m" for each, text in zip(firsts, texts, strict=True)][1:]
    if used is not None and steps:
        more = f" and so on ({len(steps)} changes)" if len(steps) > MOST_CHANGES else ""
        changes = f"changes from {texts[0]} {', '.join(steps[:MOST_CHANGES])}{more}"
        remarks.append(f"its {what} {changes}; {said(used)} is used everywhere")
    if further := [value for value in longest_first(beside) if value not in values]:
        listed = " and ".join(map(said, further[:MOST_CHANGES]))
        remarks.append(f"a {what} of {listed} is stated for other lanes, or the whole road, and is not used")
    return used


class JoinedLane(NamedTuple):
    """A lane of the whole road: it consists of one lane from each lane section in which it exists."""

    kind: Kind
    width: CubicProfile
    parts: list[MarkedLane]
    marking: Marking = UNMARKED  # the marking at the outer edge


@dataclass(frozen=True)
class FileProfile:
    """The cross-section that a file describes, as a function of the station in the file. Left and right are
    as seen in the driving direction of the driven side."""

    right: tuple[JoinedLane, ...]
    left: tuple[JoinedLane, ...]
    centre: Marking  # the marking of the centre line
    driven: int  # index of the driven lane in ``right``
    angle: CubicProfile | None
    remarks: tuple[str, ...]  # sentences about properties of the file that were changed

    def used(self) -> set[int]:
        """Returns ``id(node)`` for the XML elements ``node`` of all lanes in the cross-section."""
        return {id(part.node) for slot in (*self.right, *self.left) for part in slot.parts}

    def parts(self) -> tuple[list[MarkedLane], list[MarkedLane]]:
        """Returns the driven lane in each lane section in which it exists, and all further lanes."""
        driven = self.right[self.driven]
        others = [slot for slot in (*self.right, *self.left) if slot is not driven]
        return driven.parts, [part for slot in others for part in slot.parts]

    def carried(self, carry: Carry, turned: Carry) -> Profile:
        """Returns the cross-section by station of the Road. ``carry`` converts widths, ``turned`` angles."""
        right, left = (
            tuple(Lane(slot.kind, _plain(carry(slot.width)), slot.marking) for slot in slots)
            for slots in (self.right, self.left)
        )
        angle = None if self.angle is None else turned(self.angle)
        return Profile(left, right, self.driven, self.centre, angle)


def _plain(width: CubicProfile) -> Width:
    return width.coefficients[0][0] if len(width.stations) == 1 else width


class WideLane(NamedTuple):
    """A lane of one section, with its width as a function of the station in the file."""

    element: LaneElement
    width: list[Row]

    def width_at(self, s: float) -> float:
        """Returns the width in metres at one end of the section."""
        return value_at(self.width[0 if s <= self.width[0][0] else -1], s)


_SectionSide = tuple[list[WideLane], list[WideLane]]
"""The driving lanes and the shoulders of one section on one side of the centre line, from the inside out."""


def read_profile(road: Element, lanes: Lanes) -> FileProfile:
    """Returns the cross-section of a road. Beyond its end, widths and superelevation keep their last values.
    Raises UsageError if a width or the superelevation consists of too many cubics."""
    spans = lanes.spans()
    left_sides, remarks = _oncoming(spans)
    right = _joined(spans, [_beside(_outward(span)) for span in spans], lanes.length, remarks)
    left = _joined(spans, left_sides, lanes.length, remarks)
    right, left, centre, repainted = _painted(road, spans, right, left)
    driven = _rightmost(right)
    if driven:
        which = f"the rightmost that is {LANE_WIDTHS[0]:g} m wide everywhere"
        remarks.append(f"the car keeps to lane {driven + 1} from the centre line, {which}")
    width = _kept(right[driven].width.rows, lanes.length, LANE_WIDTHS, "the width of its lane", remarks)
    right[driven] = right[driven]._replace(width=width)
    angle = _superelevation(lanes, remarks)
    return FileProfile(tuple(right), tuple(left), centre, driven, angle, (*remarks, *repainted))


def _outward(span: Span) -> Iterator[WideLane]:
    """Yields the lanes from the centre line outwards on the driven side."""
    lanes = span.section.lanes
    return (WideLane(lanes[n], _width(lanes, n, span)) for n in range(span.section.first, len(lanes)))


def _inward(span: Span) -> Iterator[WideLane]:
    """Yields the lanes from the centre line towards the side not driven on, except lanes without a width."""
    lanes, others = span.section.lanes, span.section.others
    inner = (WideLane(lanes[n], _width(lanes, n, span)) for n in reversed(range(span.section.first)))
    beyond = (WideLane(others[n], _width(others, n, span)) for n in range(len(others)))
    return (each for found in (inner, beyond) for each in found if _is_wide(each.width, span.end))


def _is_wide(rows: list[Row], end: float) -> bool:
    """Returns whether a lane is wider than ``ADJOINS`` somewhere in its section, or has a varying width."""
    return any(any(row[1][1:]) or row[1][0] > ADJOINS for row in rows) or value_at(rows[-1], end) > ADJOINS


def _width(lanes: Sequence[LaneElement], place: int, span: Span) -> list[Row]:
    """Returns the width of a lane in one section. A border is the offset of the outer edge from lane 0."""
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
    return combined(parts, span.start, span.end)


def _sign(border: CubicProfile) -> float:
    return -1.0 if next((row[0] for row in border.coefficients if row[0]), 0.0) < 0 else 1.0


def _beside(lanes: Iterator[WideLane]) -> _SectionSide:
    found = list(lanes)
    driving = [*takewhile(lambda each: each.element.kind in DRIVING, found)]
    shoulders = [*takewhile(lambda each: each.element.kind in BESIDE, found[len(driving) :])]
    return driving, shoulders


def _oncoming(spans: Sequence[Span]) -> tuple[list[_SectionSide], list[str]]:
    """Returns the lanes on the other side of the centre line, and a remark if some are left out."""
    sides = [_beside(_inward(span)) for span in spans]
    are_there = [any(lane.kind in DRIVING for lane in span.section.others) for span in spans]
    if all(driving or not there for (driving, _), there in zip(sides, are_there, strict=True)):
        return sides, []
    kept = [(list[WideLane](), [] if driving else shoulders) for driving, shoulders in sides]
    return kept, ["its lanes for oncoming cars do not adjoin its other lanes; the road is one-way here"]


def _joined(
    spans: Sequence[Span], sides: Sequence[_SectionSide], length: float, remarks: list[str]
) -> list[JoinedLane]:
    """Returns the lanes of one side, joined over all sections: first driving lanes, then shoulders."""
    driving = _aligned(spans, [lanes for lanes, _ in sides])[:MOST_LANES]
    shoulders = _aligned(spans, [lanes for _, lanes in sides])[: MOST_LANES - len(driving)]
    return [
        *(_joined_lane("driving", spans, lanes, length, remarks) for lanes in driving),
        *(_joined_lane("shoulder", spans, lanes, length, remarks) for lanes in shoulders),
    ]


def _aligned(spans: Sequence[Span], sections: Sequence[Sequence[WideLane]]) -> list[dict[int, WideLane]]:
    """Joins the lanes of successive sections, from the inside out, where they continue each other. A lane
    narrower than ``THIN`` where two sections meet is not joined there. Each result maps the index of a
    section to the lane in it."""
    out: list[dict[int, WideLane]] = []
    for n, (span, lanes) in enumerate(zip(spans, sections, strict=True)):
        ending = [each for each in out if n and n - 1 in each]
        wide = [each for each in ending if each[n - 1].width_at(spans[n - 1].end) > THIN]
        beginning = [place for place, lane in enumerate(lanes) if lane.width_at(span.start) > THIN]
        known = dict(zip(beginning, wide, strict=False))
        free = 0
        for place, lane in enumerate(lanes):
            following = next((each for i, each in known.items() if i >= place), None)
            limit = len(out) if following is None else next(i for i, o in enumerate(out) if o is following)
            if place in known:
                free = limit
            elif free == limit:
                out.insert(free, {})
            out[free][n] = lane
            free += 1
    return out


def _joined_lane(
    kind: Kind, spans: Sequence[Span], lanes: Mapping[int, WideLane], length: float, remarks: list[str]
) -> JoinedLane:
    """``lanes`` maps the index of a section to the lane's part in it."""
    rows: list[Row] = []
    end = 0.0
    for n, span in enumerate(spans):
        if rows and span.start > end:  # no driving lane in between: the width stays
            rows.append(constant(end, value_at(rows[-1], end)))
        rows += lanes[n].width if n in lanes else [constant(span.start, 0.0)]
        end = span.end
    if end < length:
        rows.append(constant(end, value_at(rows[-1], end)))
    parts = [MarkedLane(spans[n], lane.element.node) for n, lane in sorted(lanes.items())]
    name = f"the width of its lane {parts[0].node.get('id', '?')[:10]}"
    return JoinedLane(kind, _kept(rows, length, (0.0, WIDEST), name, remarks), parts)


def checked(cubics: CubicProfile) -> CubicProfile:
    """Returns the cubics unchanged. Raises UsageError if there are more than a RoadGPT road file can hold."""
    if len(cubics.stations) > MOST_ROWS:
        raise UsageError(
            f"one of its lanes has more than {MOST_ROWS:,} widths; cut out the part that you need"
        )
    return cubics


def _rightmost(right: Sequence[JoinedLane]) -> int:
    """Returns the index of the outermost driving lane that is wide enough everywhere; 0 if none is."""
    wide = [
        number
        for number, slot in enumerate(right)
        if slot.kind == "driving" and not slot.width.beyond(LANE_WIDTHS[0], inf)
    ]
    return wide[-1] if wide else 0


def _kept(
    rows: Sequence[Row],
    length: float,
    limits: tuple[float, float],
    what: str,
    remarks: list[str],
    unit: tuple[float, str] = (1.0, "m"),
) -> CubicProfile:
    """Returns the rows as cubics within the limits, and adds a remark if a value had to be limited."""
    whole, (low, high) = checked(closed(rows, length)), limits
    found = whole.beyond(low, high)
    if found is None:
        return whole
    value, least, most = (f"{each * unit[0]:.4g}" for each in (found[1], low, high))
    where = f"at s = {found[0]:.4g} m, outside {least} to {most} {unit[1]}, and is limited to that"
    remarks.append(f"{what} is {value} {unit[1]} {where}")
    return checked(closed(limited(rows, length, low, high), length))


def _superelevation(lanes: Lanes, remarks: list[str]) -> CubicProfile | None:
    if lanes.angle is None:
        return None
    limits, unit = (-STEEPEST, STEEPEST), (math.degrees(1), "degrees")
    angle = _kept(lanes.angle.rows, lanes.length, limits, "its superelevation", remarks, unit)
    return angle if any(any(cubic) for cubic in angle.coefficients) else None


def _painted(
    road: Element, spans: Sequence[Span], right: Sequence[JoinedLane], left: Sequence[JoinedLane]
) -> tuple[list[JoinedLane], list[JoinedLane], Marking, list[str]]:
    """Returns the lanes with their markings, the marking of the centre line, and a remark if some differ."""
    if any(True for _ in road.iter("roadMark")):
        found = [[marking(slot.parts) for slot in side] for side in (right, left)]
        centre, centre_changes = marking([MarkedLane(s, _inner(s)) for s in spans if s.section.centre])
        changes = centre_changes or any(changed for side in found for _, changed in side)
        said = "its road marks change along the road; the most frequent ones are painted here"
        marks = [[mark for mark, _ in side] for side in found]
    else:
        counts = [sum(slot.kind == "driving" for slot in side) for side in (right, left)]
        usual = Profile.of(*counts, shoulder=0.0)
        said, changes = "it has no road marks in its file; the usual ones are painted here", True
        centre = usual.centre_marking
        marks = [[lane.marking for lane in side] for side in (usual.right, usual.left)]
    on_right, on_left = (
        [slot._replace(marking=mark) for slot, mark in zip(side, chain(own, repeat(UNMARKED)), strict=False)]
        for side, own in zip((right, left), marks, strict=True)
    )
    return on_right, on_left, centre, [said] if changes else []


def _inner(span: Span) -> Element:
    """Returns the lane whose outer edge is the centre line, and that has a width or a mark, or lane 0."""
    section = span.section
    for place in reversed(range(section.first)):
        lane = section.lanes[place]
        if lane.node.findall("roadMark") or _is_wide(_width(section.lanes, place, span), span.end):
            return lane.node
    return section.centre[0]


def marking(lanes: Iterable[MarkedLane]) -> tuple[Marking, bool]:
    """Returns the marking at the outer edge of a lane, and whether the marking changes along the road. If so,
    the marking with the largest total length is returned. ``lanes`` is the lane in each lane section."""
    marked = stated(lanes, "roadMark", lambda mark: MARKS.get(mark.get("type", "none"), UNMARKED))
    found = longest_first(each._replace(value=each.value or UNMARKED) for each in marked)
    return found[0] if found else UNMARKED, len(found) > 1
