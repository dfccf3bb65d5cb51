"""Reads the lane sections of an OpenDRIVE road, its heights, and the cross-section: lanes, shoulders and road
marks beside the centre line, and the superelevation.

The driven side is the right-hand side, or the left-hand side if driving lanes cover more than twice as much
length there. The inner edge of the innermost driving lane on the driven side becomes the centre line of the
Road.

Lanes of successive lane sections are joined in order, beginning with the innermost. A lane narrower than
0.25 m where two sections meet is not joined there. In sections where a joined lane does not exist, its
width is 0."""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain, groupby, pairwise, repeat, takewhile
from math import inf
from typing import Any, NamedTuple
from xml.etree.ElementTree import Element

import numpy as np

from roadgpt.errors import UsageError
from roadgpt.geometry import CubicProfile, ElevationProfile, GradeProfile, shifted
from roadgpt.geometry.curve import Array
from roadgpt.geometry.elevation import SHORTEST, Row, closed, constant, value_at
from roadgpt.road.opendrive.tree import DRIVING, cubics, number
from roadgpt.road.profile import MOST_LANES, MOST_ROWS, STEEPEST, WIDEST, Kind, Lane, Marking, Profile, Width
from roadgpt.road.world import FRICTIONS, LANE_WIDTHS, SPEEDS

BESIDE = ("shoulder", "border")
EDGES = ("width", "border")  # elements of a lane that state its outer edge
NEAR = 1.0  # m; shorter parts without a driving lane are not reported
MOST_SECTIONS = 5_000
MOST_ACROSS = 200  # lanes on one side of a section


@dataclass(frozen=True)
class LaneElement:
    """One lane of a section, with either its width or its ``border``, the offset of its outer edge."""

    node: Element
    kind: str
    width: CubicProfile | None
    border: CubicProfile | None


@dataclass(frozen=True)
class LaneSection:
    """One lane section, with its lanes on both sides, ordered from the inside out."""

    s: float
    lanes: tuple[LaneElement, ...]  # the lanes on the driven side
    others: tuple[LaneElement, ...]  # the lanes on the side opposite to the driven side
    centre: tuple[Element, ...]  # lane 0, if there is one
    first: int  # index in ``lanes`` of the innermost driving lane; ``len(lanes)`` if there is none

    @property
    def is_driven(self) -> bool:
        """Whether there is a driving lane on the driven side."""
        return self.first < len(self.lanes)


class Span(NamedTuple):
    """A lane section that has a driving lane, with the stations in metres at which it begins and ends."""

    section: LaneSection
    start: float
    end: float


@dataclass(frozen=True)
class Lanes:
    """The lane sections of a road."""

    side: int  # -1 if the driven side is to the right of the reference line, 1 if it is to the left
    sections: tuple[LaneSection, ...]
    offset: CubicProfile | None
    angle: CubicProfile | None
    """The superelevation in radians, positive where the surface falls to the right of the reference line."""
    length: float

    def edge(self, s: Array) -> tuple[Array, Array]:
        """Returns offset and slope of the inner edge of the driving lanes at stations ``s``. The offset is in
        metres to the left of the reference line and is measured in plan; the slope is its change per metre.
        """
        t, slope = self.edge_on_surface(s)
        if self.angle is None:
            return t, slope
        cos, sin = np.cos(self.angle.height(s)), np.sin(self.angle.height(s))
        return t * cos, slope * cos - t * sin * self.angle.grade(s)

    def edge_on_surface(self, s: Array) -> tuple[Array, Array]:
        """Returns offset and slope as ``edge`` does, but measured along the inclined road surface."""
        t, slope = _both(self.offset, s)
        starts = np.array([section.s for section in self.sections])
        index = np.clip(np.searchsorted(starts, s, side="right") - 1, 0, len(starts) - 1)
        for i in np.unique(index):
            section, some = self.sections[i], index == i
            if section.is_driven:
                across, lean = self._outer(section, section.first - 1, s[some])
                t[some] += self.side * across
                slope[some] += self.side * lean
        return t, slope

    def _outer(self, section: LaneSection, last: int, s: Array) -> tuple[Array, Array]:
        """Returns the distance of the outer edge of ``section.lanes[last]`` from lane 0, and its slope."""
        across, lean = np.zeros(len(s)), np.zeros(len(s))
        for lane in section.lanes[: last + 1]:
            if lane.width is None and lane.border is not None:
                across, lean = _both(lane.border, s)
                across, lean = np.abs(across), np.where(across < 0, -lean, lean)
            else:
                more, leaning = _both(lane.width, s)
                across, lean = across + more, lean + leaning
        return across, lean

    def joints(self) -> list[float]:
        """Returns the stations at which the inner edge of the driving lanes may have a kink."""
        found = [section.s for section in self.sections]
        found += self.offset.stations if self.offset else ()
        found += self.angle.stations if self.angle else ()
        for section in self.sections:
            for lane in section.lanes[: section.first]:
                for profile in (lane.width, lane.border):
                    found += profile.stations if profile else ()
        return found

    def spans(self) -> list[Span]:
        """Returns the sections that have a driving lane and a length above 0, in order."""
        ends = [section.s for section in self.sections[1:]] + [self.length]
        starts = [max(section.s, 0.0) for section in self.sections]
        return [
            Span(section, start, end)
            for section, start, end in zip(self.sections, starts, ends, strict=True)
            if section.is_driven and end > start
        ]

    def stretches(self) -> list[tuple[float, float]]:
        """Returns the first and last station in metres of each continuous stretch with a driving lane."""
        found: list[tuple[float, float]] = []
        for _, start, end in self.spans():
            joins = bool(found) and start - found[-1][1] < NEAR
            found = [*found[:-1], (found[-1][0], end)] if joins else [*found, (start, end)]
        return found


def read_lanes(road: Element, length: float) -> Lanes:
    """Returns the lane sections of a road that is ``length`` metres long. Raises UsageError if it has no
    driving lane."""
    nodes = road.findall("lanes/laneSection")
    if not nodes:
        raise UsageError("it has no lane section; add <lanes>")
    if len(nodes) > MOST_SECTIONS:
        raise UsageError(f"it has more than {MOST_SECTIONS:,} lane sections; cut out the part that you need")
    offset = cubics(road.findall("lanes/laneOffset"), "s")
    angle = cubics(road.findall("lateralProfile/superelevation"), "s")
    starts = [number(node, "s") for node in nodes]
    centres = [tuple(node.findall("center/lane")) for node in nodes]
    on_right, on_left = (
        [lane_elements(node, side, s) for node, s in zip(nodes, starts, strict=True)]
        for side in ("right", "left")
    )
    right, left = (
        Lanes(side, tuple(map(_section, starts, lanes, others, centres)), offset, angle, length)
        for side, lanes, others in ((-1, on_right, on_left), (1, on_left, on_right))
    )
    along, against = (sum(end - start for start, end in lanes.stretches()) for lanes in (right, left))
    if along or against:
        return right if along >= against / 2 else left
    kinds = {lane.get("type", "?") for node in nodes for lane in node.findall("left/lane")}
    kinds |= {lane.get("type", "?") for node in nodes for lane in node.findall("right/lane")}
    told = ", ".join(sorted(kinds)[:6]) or "none"
    raise UsageError(f"it has no lane of type driving (its lanes are: {told}); take another road")


def _section(
    s: float, lanes: tuple[LaneElement, ...], others: tuple[LaneElement, ...], centre: tuple[Element, ...]
) -> LaneSection:
    first = next((i for i, lane in enumerate(lanes) if lane.kind in DRIVING), len(lanes))
    return LaneSection(s, lanes, others, centre, first)


def lane_elements(section: Element, side: str, s: float) -> tuple[LaneElement, ...]:
    """Returns the lanes on the side "left" or "right" of a section that begins at station ``s``, from the
    inside out. Raises UsageError if there are more than 200."""
    nodes = sorted(section.findall(f"{side}/lane"), key=lambda lane: abs(number(lane, "id")))
    if len(nodes) > MOST_ACROSS:
        raise UsageError(f"its lane section at s = {s:g} has more than {MOST_ACROSS} lanes on one side")
    return tuple(
        LaneElement(lane, lane.get("type", ""), *(cubics(lane.findall(tag), "sOffset", s) for tag in EDGES))
        for lane in nodes
    )


def _both(profile: CubicProfile | None, s: Array) -> tuple[Array, Array]:
    if profile is None:
        return np.zeros(len(s)), np.zeros(len(s))
    return profile.height(s), profile.grade(s)


SAME_HEIGHT = 1e-9  # m, and as a ratio: heights and grades closer than this are treated as equal
CLOSE = 1e-6  # m between the starts of two cubics
STEP = 0.05  # m; a remark is made about a larger step
APART = 1.0  # m between the stations of the heights of a centre line beside the reference line


def elevation(road: Element) -> CubicProfile:
    """Returns the height of a road as a function of its station; 0 if the file states no elevation."""
    return cubics(road.findall("elevationProfile/elevation"), "s") or CubicProfile.constant(0.0)


def plain(profile: CubicProfile, length: float) -> ElevationProfile:
    """Returns a profile of constant grades and parabolas as a GradeProfile, and any other one unchanged."""
    stations = [s for s in profile.stations if s < length - SAME_HEIGHT]
    stations = [0.0, *(s for s in stations if s > SAME_HEIGHT)]
    table = profile.cubics(np.array(stations))
    if np.abs(table[:, 3]).max() > 0:
        return profile
    rows = list(zip(stations, table.tolist(), strict=True))
    for (s, (a, b, c, _)), (end, (z, grade, _, _)) in pairwise(rows):
        u = end - s
        if (
            abs(a + u * (b + u * c) - z) > SAME_HEIGHT * max(1.0, abs(z))
            or abs(b + 2 * u * c - grade) > SAME_HEIGHT
        ):
            return profile
    (s, (_, b, c, _)) = rows[-1]
    grades = (*table[:, 1].tolist(), b + 2 * (length - s) * c)
    return GradeProfile(float(table[0, 0]), (*stations, length), grades)


def jumps(profile: CubicProfile, length: float) -> str | None:
    """Returns a sentence about the largest step in height; None if no step is larger than 5 cm."""
    worst, where = 0.0, 0.0
    for s, end in pairwise(profile.stations):
        if end < length:
            step = abs(float(profile.height(end) - profile.height(np.nextafter(end, s))))
            worst, where = max((worst, where), (step, end))
    return f"its height jumps by {worst:.2f} m at s = {where:.1f}" if worst > STEP else None


def edge_heights(heights: CubicProfile, lanes: Lanes) -> CubicProfile:
    """Returns the heights of the inner edge of the driving lanes, as functions of the station in the file.
    ``heights`` are those of the reference line. The edge has other heights than this line only where the road
    has superelevation and the edge lies beside this line."""
    if lanes.angle is None or not any(any(cubic) for cubic in lanes.angle.coefficients):
        return heights
    even = np.linspace(0.0, lanes.length, max(2, round(lanes.length / APART) + 1))
    joints = [s for s in (*lanes.joints(), *heights.stations) if 0.0 < s < lanes.length]
    s = np.unique(np.r_[even, joints])
    s = s[np.r_[True, np.diff(s) > CLOSE]]
    if np.abs(lanes.edge_on_surface(s)[0]).max() < SAME_HEIGHT:
        return heights
    length = np.diff(s)
    inside = np.minimum(CLOSE, length / 4)
    z0, g0 = _edge_height(heights, lanes, s[:-1] + inside)
    z1, g1 = _edge_height(heights, lanes, s[1:] - inside)
    z0, z1 = z0 - inside * g0, z1 + inside * g1
    rise = (z1 - z0) / length
    c, d = (3 * rise - 2 * g0 - g1) / length, (g0 + g1 - 2 * rise) / length**2
    return CubicProfile.of_table(s[:-1].tolist(), np.column_stack([z0, g0, c, d]))


def _edge_height(heights: CubicProfile, lanes: Lanes, s: Array) -> tuple[Array, Array]:
    assert lanes.angle is not None
    t, slope = lanes.edge_on_surface(s)
    angle, grade = lanes.angle.height(s), heights.grade(s)
    steep = np.hypot(1.0, grade)
    rise = t * np.sin(angle)
    change = (
        slope * np.sin(angle) + t * np.cos(angle) * lanes.angle.grade(s)
    ) * steep + rise * grade * heights.vertical_curvature(s) / steep
    return heights.height(s) + rise * steep, grade + change


def carried_over(profile: CubicProfile, s: Array, stations: Array) -> CubicProfile:
    """Converts cubic functions of the station in the file to functions of the station on the Road. The two
    stations differ where the centre line is longer or shorter than the reference line.

    ``s`` are increasing stations of the file in metres, ``stations`` the corresponding stations of the Road.
    In between, the conversion is linear."""
    cuts = np.array(profile.stations)
    behind = np.clip(np.searchsorted(s, cuts), 1, len(s) - 1)
    apart = np.minimum(cuts - s[behind - 1], s[behind] - cuts)
    places, s = s, np.sort(np.r_[s, cuts[apart > CLOSE]])
    stations = np.interp(s, places, stations)
    # evaluated in the middle: rounding may put a start just before the cubic that begins there
    half = np.diff(s) / 2
    table = shifted(profile.cubics(s[:-1] + half), -half)
    scale = (np.diff(s) / np.diff(stations))[:, None] ** np.arange(4)
    return CubicProfile.of_table(stations[:-1].tolist(), table * scale)


TOUCHES = 1e-9  # m by which a cubic may be beyond a limit, because of rounding
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
    lanes = span.section.lanes
    return (
        WideLane(lanes[n], width_rows(lanes, n, span.start, span.end))
        for n in range(span.section.first, len(lanes))
    )


def _inward(span: Span) -> Iterator[WideLane]:
    lanes, others = span.section.lanes, span.section.others
    inner = (
        WideLane(lanes[n], width_rows(lanes, n, span.start, span.end))
        for n in reversed(range(span.section.first))
    )
    beyond = (WideLane(others[n], width_rows(others, n, span.start, span.end)) for n in range(len(others)))
    return (each for found in (inner, beyond) for each in found if _is_wide(each.width, span.end))


def _is_wide(rows: list[Row], end: float) -> bool:
    """Returns whether a lane is wider than ``ADJOINS`` somewhere in its section, or has a varying width."""
    return any(any(row[1][1:]) or row[1][0] > ADJOINS for row in rows) or value_at(rows[-1], end) > ADJOINS


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
    section = span.section
    for place in reversed(range(section.first)):
        lane = section.lanes[place]
        if lane.node.findall("roadMark") or _is_wide(
            width_rows(section.lanes, place, span.start, span.end), span.end
        ):
            return lane.node
    return section.centre[0]


def marking(lanes: Iterable[MarkedLane]) -> tuple[Marking, bool]:
    """Returns the marking at the outer edge of a lane, and whether the marking changes along the road. If so,
    the marking with the largest total length is returned. ``lanes`` is the lane in each lane section."""
    marked = stated(lanes, "roadMark", lambda mark: MARKS.get(mark.get("type", "none"), UNMARKED))
    found = longest_first(each._replace(value=each.value or UNMARKED) for each in marked)
    return found[0] if found else UNMARKED, len(found) > 1
