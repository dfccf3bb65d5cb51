"""Reads the cross-section of a road: lanes, shoulders and road marks beside the centre line, and the
superelevation.

The centre line is the inner edge of the innermost driving lane. Lanes of successive lane sections are joined
in order, beginning with the innermost. A lane narrower than 0.25 m where two sections meet is not joined
there. In sections where a joined lane does not exist, its width is 0.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain, pairwise, repeat, takewhile
from typing import NamedTuple
from xml.etree.ElementTree import Element

from roadgpt.errors import UsageError
from roadgpt.geometry import CubicProfile
from roadgpt.road.opendrive.cubic_rows import Row, closed, combined, constant, limited, value_at
from roadgpt.road.opendrive.lanes import BESIDE, LaneElement, Lanes, Span
from roadgpt.road.opendrive.numbers import number
from roadgpt.road.opendrive.tree import DRIVING
from roadgpt.road.profile import Kind, Lane, Marking, Profile, Width
from roadgpt.road.profile_json import MOST_LANES, MOST_ROWS, STEEPEST, WIDEST

LEAST, MOST = 2.0, 10.0  # m, width of the driven lane
ADJOINS = 1e-3  # m; lanes for oncoming cars that are farther from the centre line lie behind a median
ROUNDING = 1e-6  # m
THIN = 0.25  # m; a lane that is narrower at the end of a section ends or begins there

UNMARKED: Marking = "none"
MARKS: dict[str, Marking] = {
    "solid": "solid",
    "broken": "broken",
    "solid solid": "solid",
    "solid broken": "solid",
    "broken solid": "solid",
    "broken broken": "broken",
    "botts dots": "broken",
    "custom": "solid",
}
"""The marking for each type of road mark that is a line."""

Carry = Callable[[CubicProfile], CubicProfile]
"""A function that converts cubics over the stations of the file to cubics over those of the Road."""


class MarkedLane(NamedTuple):
    """A lane in one lane section. Its XML element, ``node``, contains the road marks at the outer edge."""

    span: Span
    node: Element


class JoinedLane(NamedTuple):
    """A lane of the whole road: it consists of one lane from each lane section in which it exists."""

    kind: Kind
    width: CubicProfile
    parts: list[MarkedLane]
    marking: Marking = UNMARKED
    """The marking at the outer edge."""


@dataclass(frozen=True)
class FileProfile:
    """The cross-section that a file describes, as a function of the station in the file. Left and right are
    as seen in the driving direction of the driven side.
    """

    right: tuple[JoinedLane, ...]
    left: tuple[JoinedLane, ...]
    centre: Marking
    """The marking of the centre line."""
    driven: int
    """Index of the driven lane in ``right``."""
    angle: CubicProfile | None
    remarks: tuple[str, ...]
    """Sentences about properties of the file that were changed."""

    def used(self) -> set[int]:
        """Returns ``id(node)`` for the XML elements ``node`` of all lanes in the cross-section."""
        return {id(part.node) for slot in (*self.right, *self.left) for part in slot.parts}

    def driven_nodes(self) -> list[Element]:
        """Returns the XML element of the driven lane from each lane section in which it exists."""
        return [part.node for part in self.right[self.driven].parts]

    def carried(self, carry: Carry, turned: Carry) -> Profile:
        """Returns the cross-section as a function of the station on the Road. ``carry`` converts the widths,
        and ``turned`` converts the superelevation.
        """
        right, left = (
            tuple(Lane(slot.kind, _plain(carry(slot.width)), slot.marking) for slot in slots)
            for slots in (self.right, self.left)
        )
        angle = None if self.angle is None else turned(self.angle)
        return Profile(left, right, self.driven, self.centre, angle)


def _plain(width: CubicProfile) -> Width:
    """Returns a width as one number if it is constant."""
    return width.coefficients[0][0] if len(width.stations) == 1 else width


class WideLane(NamedTuple):
    """A lane of one section, with its width as a function of the station in the file."""

    element: LaneElement
    width: list[Row]

    def width_at(self, s: float) -> float:
        """Returns the width in metres at one end of the section."""
        return value_at(self.width[0 if s <= self.width[0][0] else -1], s)


class _SectionSide(NamedTuple):
    """The lanes of one section on one side of the centre line, from the inside out."""

    span: Span
    driving: list[WideLane]
    shoulders: list[WideLane]


def read_profile(road: Element, lanes: Lanes) -> FileProfile:
    """Returns the cross-section of a road. Beyond its end, widths and superelevation keep their last values.
    Raises UsageError if a width or the superelevation consists of too many cubics.
    """
    spans = lanes.spans()
    left_sides, remarks = _oncoming(spans)
    right = _joined([_beside(span, _outward(span)) for span in spans], lanes.length)
    left = _joined(left_sides, lanes.length)
    right, left, centre, repainted = _painted(road, spans, right, left)
    driven = _rightmost(right)
    if driven:
        remarks.append(
            f"the car keeps to lane {driven + 1} from the centre line, the rightmost that is "
            f"{LEAST:g} m wide everywhere"
        )
    width, narrowed = _driven_width(right[driven].width, lanes.length)
    right[driven] = right[driven]._replace(width=width)
    angle, flattened = _superelevation(lanes)
    told = (*remarks, *narrowed, *repainted, *flattened)
    return FileProfile(tuple(right), tuple(left), centre, driven, angle, told)


def _outward(span: Span) -> Iterator[WideLane]:
    """Yields the lanes from the centre line outwards on the driven side."""
    lanes = span.section.lanes
    return (
        WideLane(lanes[place], _width(lanes, place, span)) for place in range(span.section.first, len(lanes))
    )


def _inward(span: Span) -> Iterator[WideLane]:
    """Yields the lanes from the centre line towards the side not driven on, except lanes without a width."""
    lanes, others = span.section.lanes, span.section.others
    inner = (
        WideLane(lanes[place], _width(lanes, place, span)) for place in reversed(range(span.section.first))
    )
    beyond = (WideLane(others[place], _width(others, place, span)) for place in range(len(others)))
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
    """Returns the factor that makes the offset of a border positive."""
    return -1.0 if next((row[0] for row in border.coefficients if row[0]), 0.0) < 0 else 1.0


def _beside(span: Span, lanes: Iterator[WideLane]) -> _SectionSide:
    found = list(lanes)
    driving = [*takewhile(lambda each: each.element.kind in DRIVING, found)]
    return _SectionSide(
        span, driving, [*takewhile(lambda each: each.element.kind in BESIDE, found[len(driving) :])]
    )


def _oncoming(spans: Sequence[Span]) -> tuple[list[_SectionSide], list[str]]:
    """Returns the lanes on the other side of the centre line, and a remark if some are left out."""
    sides = [_beside(span, _inward(span)) for span in spans]
    are_there = [any(lane.kind in DRIVING for lane in span.section.others) for span in spans]
    if all(side.driving or not there for side, there in zip(sides, are_there, strict=True)):
        return sides, []
    kept = [side._replace(driving=[], shoulders=[] if side.driving else side.shoulders) for side in sides]
    return kept, ["its lanes for oncoming cars do not adjoin its other lanes; the road is one-way here"]


def _joined(sides: Sequence[_SectionSide], length: float) -> list[JoinedLane]:
    """Returns the lanes of one side, joined over all sections: first driving lanes, then shoulders."""
    spans = [side.span for side in sides]
    driving = _aligned(spans, [side.driving for side in sides])[:MOST_LANES]
    shoulders = _aligned(spans, [side.shoulders for side in sides])[: MOST_LANES - len(driving)]
    return [
        *(_joined_lane("driving", spans, lanes, length) for lanes in driving),
        *(_joined_lane("shoulder", spans, lanes, length) for lanes in shoulders),
    ]


def _aligned(spans: Sequence[Span], sections: Sequence[Sequence[WideLane]]) -> list[dict[int, WideLane]]:
    """Returns the lanes of successive sections, given from the inside out, joined in this order where they
    continue each other. A lane narrower than ``THIN`` where two sections meet is not joined there. Each
    result maps the index of a section to the lane in it.
    """
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
    kind: Kind, spans: Sequence[Span], lanes: Mapping[int, WideLane], length: float
) -> JoinedLane:
    """Returns one lane of the whole road. ``lanes`` maps the index of a section to the lane's part in it."""
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
    return JoinedLane(kind, checked(closed(limited(rows, length, 0.0, WIDEST), length)), parts)


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
        if slot.kind == "driving" and slot.width.extremes()[0] > LEAST - ROUNDING
    ]
    return wide[-1] if wide else 0


def _driven_width(width: CubicProfile, length: float) -> tuple[CubicProfile, list[str]]:
    """Returns the width of the driven lane, clamped to its limits, and a remark if this changes the width."""
    low, high = width.extremes()
    if low > LEAST - ROUNDING and high < MOST + ROUNDING:
        return width, []
    kept = closed(limited(width.rows, length, LEAST, MOST), length)
    least, most = kept.extremes()
    is_constant = most - least < ROUNDING
    taken = f"{least:.2f} m everywhere" if is_constant else f"{least:.2f} to {most:.2f} m"
    return kept, [f"its lane is {low:.2f} to {high:.2f} m wide, and is taken as {taken}"]


def _superelevation(lanes: Lanes) -> tuple[CubicProfile | None, list[str]]:
    """Returns the superelevation (None for a level road), and a remark if it had to be limited."""
    if lanes.angle is None:
        return None, []
    rows = lanes.angle.rows
    angle = checked(closed(limited(rows, lanes.length, -STEEPEST, STEEPEST), lanes.length))
    if not any(any(cubic) for cubic in angle.coefficients):
        return None, []
    steepest = max(abs(each) for each in closed(rows, lanes.length).extremes())
    if steepest < STEEPEST + ROUNDING:
        return angle, []
    told, most = math.degrees(steepest), math.degrees(STEEPEST)
    return angle, [f"its superelevation is up to {told:.1f} degrees, and is taken as {most:.1f} at most"]


def _painted(
    road: Element, spans: Sequence[Span], right: Sequence[JoinedLane], left: Sequence[JoinedLane]
) -> tuple[list[JoinedLane], list[JoinedLane], Marking, list[str]]:
    """Returns the lanes with their markings and the marking of the centre line, and a remark if they differ
    from those in the file.
    """
    if has_marks(road):
        found = [[marking(slot.parts) for slot in side] for side in (right, left)]
        centre, centre_changes = marking([MarkedLane(s, _inner(s)) for s in spans if s.section.centre])
        changes = centre_changes or any(changed for side in found for _, changed in side)
        said = "its road marks change along the road; the most frequent ones are painted here"
        marks = [[mark for mark, _ in side] for side in found]
    else:
        usual = Profile.of(
            *(sum(slot.kind == "driving" for slot in side) for side in (right, left)), shoulder=0.0
        )
        said, changes = "it has no road marks in its file; the usual ones are painted here", True
        centre, marks = (
            usual.centre_marking,
            [[lane.marking for lane in side] for side in (usual.right, usual.left)],
        )
    on_right, on_left = (
        [slot._replace(marking=mark) for slot, mark in zip(side, chain(own, repeat(UNMARKED)), strict=False)]
        for side, own in zip((right, left), marks, strict=True)
    )
    return on_right, on_left, centre, [said] if changes else []


def _inner(span: Span) -> Element:
    """Returns the XML element of the lane whose outer edge is the centre line.

    Lanes without a width and without road marks are skipped, as far as lane 0.
    """
    section = span.section
    for place in reversed(range(section.first)):
        lane = section.lanes[place]
        if lane.node.findall("roadMark") or _is_wide(_width(section.lanes, place, span), span.end):
            return lane.node
    return section.centre[0]


def has_marks(road: Element) -> bool:
    """Returns whether the file contains a road mark for this road."""
    return any(
        road.findall(f"lanes/laneSection/{side}/lane/roadMark") for side in ("left", "center", "right")
    )


def marking(lanes: Iterable[MarkedLane]) -> tuple[Marking, bool]:
    """Returns the marking at the outer edge of a lane, and whether the marking changes along the road. If so,
    the marking with the largest total length is returned. ``lanes`` is the lane in each lane section.
    """
    lengths: dict[Marking, float] = {}
    for span, lane in lanes:
        marks = sorted(lane.findall("roadMark"), key=lambda mark: number(mark, "sOffset", 0.0))
        starts = [span.section.s + number(mark, "sOffset", 0.0) for mark in marks]
        starts = [min(max(start, span.start), span.end) for start in starts]
        before = (starts[0] if starts else span.end) - span.start
        kinds = [MARKS.get(mark.get("type", "none"), "none") for mark in marks]
        reaches = [end - start for start, end in pairwise([*starts, span.end])]
        for kind, reach in zip(["none", *kinds], [before, *reaches], strict=True):
            lengths[kind] = lengths.get(kind, 0.0) + reach
    found = sorted((kind for kind, reach in lengths.items() if reach > 0), key=lambda kind: -lengths[kind])
    return (found[0] if found else "none"), len(found) > 1
