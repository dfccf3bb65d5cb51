"""Reads the cross-section of a road: lanes and shoulders beside the centre line, and the superelevation.

The centre line is the inner edge of the innermost driving lane. Lanes of successive lane sections are joined
in order, beginning with the innermost. A lane narrower than 0.25 m where two sections meet is not joined
there. In sections where a joined lane does not exist, its width is 0.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import takewhile
from typing import NamedTuple

from roadgpt.errors import UsageError
from roadgpt.geometry import CubicProfile
from roadgpt.road.opendrive.cubic_rows import Row, closed, combined, constant, limited, rows_of, value_at
from roadgpt.road.opendrive.lanes import BESIDE, LaneElement, Lanes, Span
from roadgpt.road.opendrive.marks import MarkedLane, has_marks, marking
from roadgpt.road.opendrive.tree import DRIVING, Node
from roadgpt.road.profile import Kind, Lane, Marking, Profile, Width
from roadgpt.road.profile_json import MOST_LANES, MOST_ROWS, STEEPEST, WIDEST

LEAST, MOST = 2.0, 10.0  # m, width of the driven lane
ADJOINS = 1e-3  # m; lanes for oncoming cars that are farther from the centre line lie behind a median
ROUNDING = 1e-6  # m
THIN = 0.25  # m; a lane that is narrower at the end of a section ends or begins there

Carry = Callable[[CubicProfile], CubicProfile]
"""A function that converts cubics over the stations of the file to cubics over those of the Road."""


class JoinedLane(NamedTuple):
    """A lane of the whole road: it consists of one lane from each lane section in which it exists."""

    kind: Kind
    width: CubicProfile
    parts: list[MarkedLane]


@dataclass(frozen=True)
class LaneMarkings:
    """The markings of a cross-section."""

    right: tuple[Marking, ...]
    """The markings at the outer edges of the lanes on the right."""
    centre: Marking
    left: tuple[Marking, ...]


@dataclass(frozen=True)
class FileProfile:
    """The cross-section that a file describes, as a function of the station in the file. Left and right are
    as seen in the driving direction of the driven side.
    """

    right: tuple[JoinedLane, ...]
    left: tuple[JoinedLane, ...]
    markings: LaneMarkings
    driven: int
    """Index of the driven lane in ``right``."""
    angle: CubicProfile | None
    remarks: tuple[str, ...]
    """Sentences about properties of the file that were changed."""

    def used(self) -> set[int]:
        """Returns ``id(node)`` for the XML elements ``node`` of all lanes in the cross-section."""
        return {id(part.node) for slot in (*self.right, *self.left) for part in slot.parts}

    def driven_nodes(self) -> list[Node]:
        """Returns the XML element of the driven lane from each lane section in which it exists."""
        return [part.node for part in self.right[self.driven].parts]

    def carried(self, carry: Carry, turned: Carry) -> Profile:
        """Returns the cross-section as a function of the station on the Road.

        Args:
            carry: Function that converts lane widths from stations of the file to stations of the Road.
            turned: Function that does the same for the superelevation.
        """
        right, left = (
            tuple(
                Lane(slot.kind, _plain(carry(slot.width)), mark)
                for slot, mark in zip(slots, marks, strict=True)
            )
            for slots, marks in ((self.right, self.markings.right), (self.left, self.markings.left))
        )
        angle = None if self.angle is None else turned(self.angle)
        return Profile(left, right, self.driven, self.markings.centre, angle)


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


def read_profile(road: Node, lanes: Lanes) -> FileProfile:
    """Returns the cross-section of a road. Beyond the road's end, widths and superelevation keep their last
    values.

    Raises:
        UsageError: A width or the superelevation consists of too many cubics.
    """
    spans = lanes.spans()
    left_sides, remarks = _oncoming(spans)
    right = _joined([_beside(span, _outward(span)) for span in spans], lanes.length)
    left = _joined(left_sides, lanes.length)
    markings, repainted = _markings(road, spans, right, left)
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
    return FileProfile(tuple(right), tuple(left), markings, driven, angle, told)


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
    """Returns the lanes of successive sections, joined where they continue each other, from the inside out.

    A lane that is narrower than ``THIN`` where two sections meet is not joined there. The other lanes are
    joined in order, from the inside out. Each result maps the index of a section to the lane in it.

    Args:
        spans: The sections.
        sections: The lanes of each section from the inside out.
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
    """Returns the cubics unchanged if a RoadGPT road file can hold as many.

    Raises:
        UsageError: There are more than ``MOST_ROWS`` cubics.
    """
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
    kept = closed(limited(rows_of(width), length, LEAST, MOST), length)
    least, most = kept.extremes()
    is_constant = most - least < ROUNDING
    taken = f"{least:.2f} m everywhere" if is_constant else f"{least:.2f} to {most:.2f} m"
    return kept, [f"its lane is {low:.2f} to {high:.2f} m wide, and is taken as {taken}"]


def _superelevation(lanes: Lanes) -> tuple[CubicProfile | None, list[str]]:
    """Returns the superelevation (None for a level road), and a remark if it had to be limited."""
    if lanes.angle is None:
        return None, []
    rows = rows_of(lanes.angle)
    angle = checked(closed(limited(rows, lanes.length, -STEEPEST, STEEPEST), lanes.length))
    if not any(any(cubic) for cubic in angle.coefficients):
        return None, []
    steepest = max(abs(each) for each in closed(rows, lanes.length).extremes())
    if steepest < STEEPEST + ROUNDING:
        return angle, []
    told, most = math.degrees(steepest), math.degrees(STEEPEST)
    return angle, [f"its superelevation is up to {told:.1f} degrees, and is taken as {most:.1f} at most"]


def _markings(
    road: Node, spans: Sequence[Span], right: Sequence[JoinedLane], left: Sequence[JoinedLane]
) -> tuple[LaneMarkings, list[str]]:
    """Returns the markings, and a remark if they differ from those in the file."""
    if not has_marks(road):
        along, against = (sum(slot.kind == "driving" for slot in side) for side in (right, left))
        usual = Profile.of(along, against, shoulder=0.0)
        sides = (_padded(usual.right, len(right)), _padded(usual.left, len(left)))
        said = "it has no road marks in its file; the usual ones are painted here"
        return LaneMarkings(sides[0], usual.centre_marking, sides[1]), [said]
    on_right, on_left = ([marking(slot.parts) for slot in side] for side in (right, left))
    centre = marking([MarkedLane(span, _inner(span)) for span in spans if span.section.centre])
    changes = any(changed for _, changed in (*on_right, *on_left, centre))
    said = "its road marks change along the road; the most frequent ones are painted here"
    marks = LaneMarkings(tuple(m for m, _ in on_right), centre[0], tuple(m for m, _ in on_left))
    return marks, [said] if changes else []


def _padded(lanes: Sequence[Lane], count: int) -> tuple[Marking, ...]:
    """Returns the markings of driving lanes, and none for the shoulders beside them."""
    marks: list[Marking] = [lane.marking for lane in lanes]
    missing: list[Marking] = ["none"] * (count - len(lanes))
    return (*marks, *missing)


def _inner(span: Span) -> Node:
    """Returns the XML element of the lane whose outer edge is the centre line.

    Lanes without a width and without road marks are skipped, as far as lane 0.
    """
    section = span.section
    for place in reversed(range(section.first)):
        lane = section.lanes[place]
        if lane.node.all("roadMark") or _is_wide(_width(section.lanes, place, span), span.end):
            return lane.node
    return section.centre[0]
