"""Reads the cross-section of a road: lanes, shoulders and road marks beside the centre line, and the
superelevation.

The centre line is the inner edge of the innermost driving lane. Lanes of successive lane sections are joined
in order, beginning with the innermost. A lane narrower than 0.25 m where two sections meet is not joined
there. In sections where a joined lane does not exist, its width is 0.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain, repeat, takewhile
from math import inf
from typing import NamedTuple
from xml.etree.ElementTree import Element

from roadgpt.errors import UsageError
from roadgpt.geometry import CubicProfile
from roadgpt.road.opendrive.cubic_rows import Row, closed, combined, constant, limited, value_at
from roadgpt.road.opendrive.lanes import BESIDE, LaneElement, Lanes, Span
from roadgpt.road.opendrive.stated import MarkedLane, longest_first, stated
from roadgpt.road.opendrive.tree import DRIVING
from roadgpt.road.profile import Kind, Lane, Marking, Profile, Width
from roadgpt.road.profile_json import MOST_LANES, MOST_ROWS, STEEPEST, WIDEST
from roadgpt.road.world import LANE_WIDTHS

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

    def parts(self) -> tuple[list[MarkedLane], list[MarkedLane]]:
        """Returns the driven lane in each lane section in which it exists, and all further lanes."""
        driven = self.right[self.driven]
        others = [slot for slot in (*self.right, *self.left) if slot is not driven]
        return driven.parts, [part for slot in others for part in slot.parts]

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
    right = _joined([_beside(span, _outward(span)) for span in spans], lanes.length, remarks)
    left = _joined(left_sides, lanes.length, remarks)
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


def _beside(span: Span, lanes: Iterator[WideLane]) -> _SectionSide:
    found = list(lanes)
    driving = [*takewhile(lambda each: each.element.kind in DRIVING, found)]
    shoulders = [*takewhile(lambda each: each.element.kind in BESIDE, found[len(driving) :])]
    return _SectionSide(span, driving, shoulders)


def _oncoming(spans: Sequence[Span]) -> tuple[list[_SectionSide], list[str]]:
    """Returns the lanes on the other side of the centre line, and a remark if some are left out."""
    sides = [_beside(span, _inward(span)) for span in spans]
    are_there = [any(lane.kind in DRIVING for lane in span.section.others) for span in spans]
    if all(side.driving or not there for side, there in zip(sides, are_there, strict=True)):
        return sides, []
    kept = [side._replace(driving=[], shoulders=[] if side.driving else side.shoulders) for side in sides]
    return kept, ["its lanes for oncoming cars do not adjoin its other lanes; the road is one-way here"]


def _joined(sides: Sequence[_SectionSide], length: float, remarks: list[str]) -> list[JoinedLane]:
    """Returns the lanes of one side, joined over all sections: first driving lanes, then shoulders."""
    spans = [side.span for side in sides]
    driving = _aligned(spans, [side.driving for side in sides])[:MOST_LANES]
    shoulders = _aligned(spans, [side.shoulders for side in sides])[: MOST_LANES - len(driving)]
    return [
        *(_joined_lane("driving", spans, lanes, length, remarks) for lanes in driving),
        *(_joined_lane("shoulder", spans, lanes, length, remarks) for lanes in shoulders),
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
    kind: Kind, spans: Sequence[Span], lanes: Mapping[int, WideLane], length: float, remarks: list[str]
) -> JoinedLane:
    """Returns a lane of the whole road. ``lanes`` maps the index of a section to the lane's part in it."""
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
    the marking with the largest total length is returned. ``lanes`` is the lane in each lane section.
    """
    marked = stated(lanes, "roadMark", lambda mark: MARKS.get(mark.get("type", "none"), UNMARKED))
    found = longest_first(each._replace(value=each.value or UNMARKED) for each in marked)
    return found[0] if found else UNMARKED, len(found) > 1
