"""Groups the segments of a road into its turns and the straights ("gaps") between them.

    gap 0 | turn 1 | gap 1 | turn 2 | ... | turn n | gap n

``elements_on_road`` uses the turns that are measured on the finished geometry (``check.measures``): segments
that are measured as a single turn form one turn, and a bend that is too slight to be measured as a turn
belongs to a gap."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import accumulate, pairwise
from math import ceil, floor, radians

import numpy as np

from roadgpt.brief.model import OTHER_SIDE, Side
from roadgpt.brief.outline import Feature
from roadgpt.check.measures import MeasuredFeature, RoadMeasures, measure, way
from roadgpt.design.elements import straight, turn_segments
from roadgpt.geometry.curve import Array
from roadgpt.road import Design, Geometry, Segment, build

MILLIMETRE, CENTIMETRE = 1000.0, 100.0  # per metre: distances and radii are rounded to these
TENTH = 10.0  # per degree and per percent
FREE_STRAIGHT = Feature("straight", "straight")
LEAST_SHARED = 1.5  # m of a segment within a turn, at least, for it to be a part of the turn
LEAST = 1.0  # m that a straight segment keeps
TRANSITION_SHARE = 0.3  # of the arc, of a turn that is written anew without a transition of its own


@dataclass(frozen=True, slots=True)
class RoadElement:
    """The segments of one turn, or those between two turns."""

    name: str  # the name of the element; it stays the same when other elements are added or removed
    segments: tuple[Segment, ...]
    side: Side | None = None  # the side to which a turn goes; None for a gap
    first: int = 0  # index of its first segment among all segments of the road
    seen: MeasuredFeature | None = None
    """The measured feature of this element before a change; None if the element is new, was not measured,
    or is too short to be measured as a straight."""
    asked: Feature | None = None  # the requirement that the element must meet; None if there is none
    is_of_arcs: bool = True
    """Whether the road is built of lines, arcs and clothoids, and not as a spline through the joints of its
    segments; then the arc of a turn can be cut in two."""

    @property
    def length(self) -> float:
        """Sum of the distances of its segments, in metres."""
        return sum(segment.distance for segment in self.segments)

    @property
    def incline(self) -> float:
        """Mean grade of its segments in percent, weighted by their lengths."""
        return sum(s.distance * s.incline for s in self.segments) / max(self.length, 1e-9)

    @property
    def degrees(self) -> float:
        """Sum of the angles of its segments in degrees, positive to the left; 0 for a straight."""
        return sum(segment.turn_degrees for segment in self.segments)

    @property
    def members(self) -> range:
        """Indices of its segments among all segments of the road."""
        return range(self.first, self.first + len(self.segments))

    @property
    def is_turn(self) -> bool:
        """Whether the element is a turn."""
        return self.side is not None

    @property
    def may_bend(self) -> bool:
        """Whether its plan may change: it has a requirement, and not only for its grade."""
        asked = self.asked
        return asked is not None and bool(asked.degrees or asked.radius or asked.length or not asked.grade)

    def with_segments(self, segments: Iterable[Segment]) -> "RoadElement":
        """Returns a copy of the element that has these segments."""
        return replace(self, segments=tuple(segments))

    def mirrored(self) -> "RoadElement":
        """Returns the mirror image of the element."""
        own = list(self.segments)
        for n, one in enumerate(own):
            if one.turn_degrees and one.direction != "straight":
                other = {"direction": OTHER_SIDE[one.direction], "turn_degrees": -one.turn_degrees}
                own[n] = one.model_copy(update=other)
        return replace(self, side=self.side and OTHER_SIDE[self.side], segments=tuple(own))

    def with_grade(self, grade: float, limit: float) -> "RoadElement":
        """Returns the element with another mean grade; no incline exceeds ``limit``, both in percent. Its
        inclines are scaled if all of them already climb or fall as the new grade does; otherwise they become
        equal."""
        aim, mean = float(np.clip(grade, -limit, limit)), self.incline
        inclines = np.array([segment.incline for segment in self.segments])
        if abs(mean) >= 1 and (inclines * np.sign(mean) > 0.5).all() and aim * mean > 0:
            inclines = np.clip(inclines * aim / mean, -limit, limit)
        else:
            inclines = np.full(len(inclines), aim)
        return self.with_segments(with_inclines(self.segments, inclines))

    def lengthened(self, metres: float) -> "RoadElement":
        """Returns a gap whose straight segments are longer by so many metres in total."""
        straights = [i for i, segment in enumerate(self.segments) if not segment.turn_degrees]
        if not straights:
            distance = max(round(metres * TENTH) / TENTH, LEAST)
            return self.with_segments((*self.segments, Segment(distance=distance, direction="straight")))
        before = [segment.distance for segment in self.segments]
        longest = max(straights, key=lambda i: before[i])
        after = {longest: before[longest] + metres}
        if after[longest] < max(0.5 * before[longest], LEAST):
            whole = sum(before[i] for i in straights)
            share = max((whole + metres) / whole, 0.02)
            after = {i: before[i] * share for i in straights}
        segments = list(self.segments)
        for i, distance in after.items():
            distance = max(round(distance * CENTIMETRE) / CENTIMETRE, min(LEAST, before[i]))
            segments[i] = segments[i].model_copy(update={"distance": distance})
        return self.with_segments(segments)

    def scaled(self, more: float, wider: float) -> "RoadElement":
        """Returns the element with its angles multiplied by ``more`` and its radii by ``wider``."""
        return self.with_segments(_scaled(s, more, wider) if s.turn_degrees else s for s in self.segments)

    def rewritten(self, degrees: float, radius: float) -> "RoadElement":
        """Returns a turn with a new angle and radius; its side and its mean incline, or the inclines on both
        sides of a crest or a dip in its middle, stay the same."""
        transition = next((segment.transition for segment in self.segments if segment.transition), None)
        transition = transition or TRANSITION_SHARE * radius * radians(degrees)
        hand = 1 if self.side == "left" else -1
        has_bump = self.seen is not None and self.seen.slopes
        inclines = [self.segments[end].incline for end in (0, -1)] if has_bump else [self.incline]
        return self.with_segments(turn_segments(degrees, hand, radius, transition, *inclines))


RoadElements = tuple[RoadElement, ...]


def elements_on_road(design: Design, geometry: Geometry = "arcs") -> tuple[RoadElements, RoadMeasures]:
    """Measures the road of a design; returns its turns and the gaps between them, and the measurements."""
    found = measure(build(design, geometry).centreline())
    joints = np.concatenate([[0.0], np.cumsum([s.distance for s in design.segments])])
    # the measure's chords, and a spline's bends, are not as long as written
    scale = joints[-1] / found.length
    marks: list[tuple[int, int]] = []
    for turn in found.turns:
        first, end = _members(design.segments, joints, turn, scale)
        least = marks[-1][1] if marks else 0
        marks.append((max(first, least), max(end, least)))
    out: list[RoadElement] = []
    edges = [0, *(index for mark in marks for index in mark), len(design.segments)]
    straights = [next((f for f in gap if f.kind == "straight"), None) for gap in found.gaps]
    for number, (first, end) in enumerate(pairwise(edges)):
        name = f"turn {number // 2 + 1}" if number % 2 else f"gap {number // 2}"
        seen = found.turns[number // 2] if number % 2 else straights[number // 2]
        side = seen.side if seen and number % 2 else None
        own = design.segments[first:end]
        out.append(RoadElement(name, own, side, first, seen, is_of_arcs=geometry == "arcs"))
    return tuple(out), found


def _members(
    segments: Sequence[Segment], joints: Array, turn: MeasuredFeature, scale: float
) -> tuple[int, int]:
    low, high = turn.start * scale, turn.end * scale
    hand = 1 if turn.side == "left" else -1
    shared = np.minimum(joints[1:], high) - np.maximum(joints[:-1], low)
    bends = np.array([s.turn_degrees * hand > 0 for s in segments])
    lengths = np.diff(joints)
    inside = bends & (shared > np.minimum(LEAST_SHARED, 0.5 * lengths))
    if not inside.any():
        inside = np.arange(len(segments)) == int(np.argmax(np.where(bends, shared, -np.inf)))
    which = np.flatnonzero(inside)
    return int(which[0]), int(which[-1]) + 1


def shows_turns(found: RoadMeasures, elements: Sequence[RoadElement]) -> bool:
    """Returns whether a measured road has the same sequence of left and right turns as the elements."""
    return [turn.side for turn in found.turns] == [one.side for one in elements if one.is_turn]


def shows_slopes(found: RoadMeasures, elements: Sequence[RoadElement]) -> bool:
    """Returns whether each measured turn climbs, falls or is level like its segments, or has the required
    grade. The measured turns must correspond to those of the elements."""
    turns = (one for one in elements if one.is_turn)
    return all(
        way(turn.grade) == way(one.incline)
        or (one.asked is not None and one.asked.grade is not None and turn.grade in one.asked.grade)
        for turn, one in zip(found.turns, turns, strict=True)
    )


def features_of(elements: Sequence[RoadElement], found: RoadMeasures) -> tuple[MeasuredFeature | None, ...]:
    """Returns the measured feature of each element; None for an element without a feature of its own. The
    measured turns must correspond to those of the elements. If there are several elements between two turns,
    the straight measured there is assigned to the longest of them."""
    out: list[MeasuredFeature | None] = [None] * len(elements)
    turns = [i for i, element in enumerate(elements) if element.is_turn]
    for i, turn in zip(turns, found.turns, strict=True):
        out[i] = turn
    for (a, b), gap in zip(pairwise([-1, *turns, len(elements)]), found.gaps, strict=True):
        between = [i for i in range(a + 1, b) if elements[i].segments]
        if between:
            longest = max(between, key=lambda i: elements[i].length)
            out[longest] = next((feature for feature in gap if feature.kind == "straight"), None)
    return tuple(out)


def numbered(elements: RoadElements) -> RoadElements:
    """Returns the elements, each with ``first`` set to the index of its first segment among all segments."""
    firsts = accumulate((len(element.segments) for element in elements), initial=0)
    return tuple(replace(element, first=first) for element, first in zip(elements, firsts, strict=False))


def with_segments(elements: RoadElements, segments: Sequence[Segment]) -> RoadElements:
    """Returns the elements, each segment replaced by the one with the same index in ``segments``."""
    return tuple(element.with_segments(segments[i] for i in element.members) for element in elements)


def with_inclines(segments: Sequence[Segment], grades: Array) -> tuple[Segment, ...]:
    """Returns copies of the segments with the given inclines, in percent and rounded to a tenth. A segment
    whose incline would change by less than 0.05 percentage points is returned as it is."""
    pairs = zip(segments, (np.round(grades * TENTH) / TENTH).tolist(), strict=True)
    return tuple(
        segment if abs(incline - segment.incline) < 0.05 else segment.model_copy(update={"incline": incline})
        for segment, incline in pairs
    )


def _scaled(segment: Segment, more: float, wider: float) -> Segment:
    degrees = round(segment.turn_degrees * more * TENTH) / TENTH
    more = degrees / segment.turn_degrees
    radius = segment.radius and ceil(segment.radius * wider * CENTIMETRE) / CENTIMETRE
    if radius and segment.radius:
        wider = radius / segment.radius
    exact = segment.distance * more * wider * MILLIMETRE
    transition = segment.transition
    if transition:
        transition = max(floor(transition * more * wider * TENTH), 1) / TENTH
    return segment.model_copy(
        update={
            "distance": max((ceil(exact) if radius else floor(exact)) / MILLIMETRE, 0.001),
            "turn_degrees": degrees,
            "radius": radius,
            "transition": transition,
        }
    )


def with_stations(elements: RoadElements) -> Iterator[tuple[RoadElement, float]]:
    """Returns the elements, each with the station in metres at which it begins."""
    starts = accumulate((element.length for element in elements), initial=0.0)
    return zip(elements, starts, strict=False)


def joined(elements: Sequence[RoadElement]) -> tuple[Segment, ...]:
    """Returns the segments of all elements in driving order."""
    return tuple(segment for element in elements for segment in element.segments)


def gap(name: str, length: float, incline: float) -> RoadElement:
    """Returns a new gap that consists of one straight, whose length may be changed."""
    return RoadElement(name, (straight(length, incline),), asked=FREE_STRAIGHT)
