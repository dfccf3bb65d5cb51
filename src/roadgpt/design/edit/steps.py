"""Defines the steps of an edit.

A step sets the desired values of elements, and stores in ``RoadElement.asked`` the ranges in which the
measured values must lie. ``design.fit`` then adjusts the elements that have a requirement, if the road would
violate a rule, or if measured values lie outside these ranges.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import atan2, ceil, cos, degrees, floor, hypot, pi, radians, sin
from typing import NamedTuple, Protocol

import numpy as np

from roadgpt.brief.model import OTHER_SIDE, Side
from roadgpt.brief.outline import Feature, both
from roadgpt.brief.ranges import Range
from roadgpt.design.elements import turn_segments
from roadgpt.design.road_elements import FREE_STRAIGHT, RoadElement, RoadElements, gap, joined, with_inclines
from roadgpt.errors import UsageError
from roadgpt.road import Design, Segment, World, build
from roadgpt.road.design import MAX_TURN

MILLIMETRE, CENTIMETRE, TENTH = 1000.0, 100.0, 10.0
HUNDREDTH = 100.0  # per degree
DECIMALS = 6  # of the start of a reversed road and its direction
LEAST = 1.0  # m that a straight segment keeps
TRANSITION_SHARE = 0.3  # of the arc, of a turn that is written anew without a transition of its own
SEPARATE = 18.0  # m between turns to the same side, so that they are seen as two
HIDDEN = 9.0  # m between turns to the same side at which they are measured as two, without a straight
WIDEST = 250.0  # m: a turn of a larger radius is hardly seen as one
CLEARLY, FURTHER = 0.45, 1.6  # least and greatest accepted share of a change without a number ('sharper')


class EditStep(Protocol):
    """One change to the elements of a road."""

    def apply(self, elements: RoadElements, world: World) -> RoadElements:
        """Returns the elements after the change."""
        ...


EditCandidate = tuple[EditStep, ...]
"""Steps that together make one change."""


def changed(elements: RoadElements, name: str, change: Callable[[RoadElement], RoadElement]) -> RoadElements:
    """Returns the elements, with ``change`` applied to the element called ``name``."""
    return tuple(change(element) if element.name == name else element for element in elements)


class Wanted(NamedTuple):
    """A value to aim at, and the range in which the measured value may lie."""

    aim: float
    room: Range

    def nearer_to(self, now: float) -> "Wanted":
        """Returns the same range with a new aim: halfway between the old aim and the value in the range that
        is nearest to ``now``.
        """
        return Wanted((self.aim + min(max(now, self.room.lo), self.room.hi)) / 2, self.room)

    @classmethod
    def near(cls, aim: float, slack: float) -> "Wanted":
        """Returns a value to aim at, with a tolerance of ``slack`` in both directions."""
        return cls(aim, Range(aim - slack, aim + slack))

    @classmethod
    def towards(cls, now: float, aim: float) -> "Wanted":
        """Returns ``aim`` with a range from 0.45 to 1.6 times the change from ``now`` to ``aim``."""
        ends = now + CLEARLY * (aim - now), now + FURTHER * (aim - now)
        return cls(aim, Range(min(ends), max(ends)))

    @classmethod
    def not_away(cls, now: float, aim: float) -> "Wanted":
        """Returns ``aim`` with a range from no change to 1.6 times the change from ``now`` to ``aim``."""
        ends = now, now + FURTHER * (aim - now)
        return cls(aim, Range(0.99 * min(ends), 1.01 * max(ends)))


@dataclass(frozen=True, slots=True)
class Adjust:
    """Gives one element new values; a value stays as it is if the field for it is None."""

    element: RoadElement
    degrees: Wanted | None = None
    radius: Wanted | None = None
    length: Wanted | None = None
    grade: Wanted | None = None
    """The mean grade in percent."""

    def milder(self) -> "Adjust":
        """Returns the same step with aims nearer to the present measurements of the element.

        The aim of the grade and all ranges stay the same.
        """
        seen = self.element.seen
        if seen is None:
            return self
        return replace(
            self,
            degrees=self.degrees and self.degrees.nearer_to(seen.degrees),
            radius=self.radius and self.radius.nearer_to(seen.radius),
            length=self.length and self.length.nearer_to(seen.length),
        )

    def apply(self, elements: RoadElements, world: World) -> RoadElements:
        """Returns the elements, with new values for ``self.element``; the ranges of these values become its
        requirement.
        """
        return changed(elements, self.element.name, lambda now: self._applied(now, world))

    def _applied(self, now: RoadElement, world: World) -> RoadElement:
        if self.element.is_turn and not self.element.degrees:  # a spline bends before and behind its turns
            raise UsageError(f"{self.element.name} is made by no segment of the road, but by its spline")
        if now.kind != self.element.kind:
            raise UsageError(f"{self.element.name} is to go and to be changed at once")
        if self.grade:
            now = with_grade(now, self.grade.aim, world)
        if self.element.is_turn:
            now = self._bent(now)
        elif self.length:
            seen = self.element.seen
            more = self.length.aim - (seen.length if seen else self.element.length)
            now = stretched(now, self.element.length + more - now.length)
        asked = self._asked()
        return replace(now, asked=both(now.asked, asked) if now.asked else asked)

    def _asked(self) -> Feature:
        degrees, radius, length, grade = (
            wanted and wanted.room for wanted in (self.degrees, self.radius, self.length, self.grade)
        )
        if not self.element.is_turn:
            return Feature("straight", "straight", None, None, None, length, grade)
        return Feature("turn", "turn", None, degrees, radius, length, grade)

    def _bent(self, now: RoadElement) -> RoadElement:
        """Returns the turn with scaled angles, lengths and radii.

        It is split into more segments if one would turn by more than 70 degrees.
        """
        before, seen = self.element, self.element.seen
        assert seen is not None
        turn = abs(now.degrees)
        more = (abs(before.degrees) + self.degrees.aim - seen.degrees) / turn if self.degrees else 1.0
        wider = self.radius.aim / seen.radius if self.radius else 1.0
        if self.length:
            wider *= self.length.aim / seen.length
        wider *= (before.length / abs(before.degrees)) / (now.length / turn)
        if abs(more - 1) < 1e-9 and abs(wider - 1) < 1e-9:
            return now
        most = max((abs(s.turn_degrees) for s in now.segments), default=0.0)
        if most * more > MAX_TURN >= most:
            return rewritten(now, turn * more, seen.radius * wider)
        return now.with_segments(scaled(s, more, wider) for s in now.segments)


def with_grade(element: RoadElement, grade: float, world: World) -> RoadElement:
    """Returns the element with another mean grade, in percent.

    Its inclines are scaled if all of them already climb or fall as the new grade does; otherwise they become
    equal.
    """
    limit = 100 * world.limits.max_grade - 0.2
    aim = float(np.clip(grade, -limit, limit))
    inclines = np.array([s.incline for s in element.segments])
    mean = element.incline
    if abs(mean) >= 1 and (inclines * np.sign(mean) > 0.5).all() and aim * mean > 0:
        inclines = np.clip(inclines * aim / mean, -limit, limit)
    else:
        inclines = np.full(len(inclines), aim)
    return element.with_segments(with_inclines(element.segments, inclines))


def scaled(segment: Segment, more: float, wider: float) -> Segment:
    """Returns a segment with its angle multiplied by ``more`` and its radius by ``wider``."""
    if not segment.turn_degrees:
        return segment
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


def rewritten(element: RoadElement, degrees: float, radius: float) -> RoadElement:
    """Returns a turn with a new angle and radius; its side and mean incline stay the same."""
    transitions = [s.transition for s in element.segments if s.transition]
    transition = transitions[0] if transitions else TRANSITION_SHARE * radius * radians(degrees)
    segments = turn_segments(
        degrees, 1 if element.side == "left" else -1, radius, transition, element.incline
    )
    return element.with_segments(segments)


def stretched(element: RoadElement, more: float) -> RoadElement:
    """Returns a gap whose straight segments are longer by ``more`` metres in total."""
    straight = [i for i, s in enumerate(element.segments) if not s.turn_degrees]
    if not straight:
        new = Segment(distance=max(round(more * TENTH) / TENTH, LEAST), direction="straight")
        return element.with_segments((*element.segments, new))
    segments = list(element.segments)
    longest = max(straight, key=lambda i: segments[i].distance)
    if segments[longest].distance + more >= max(0.5 * segments[longest].distance, LEAST):
        segments[longest] = _with_distance(segments[longest], segments[longest].distance + more)
    else:
        whole = sum(segments[i].distance for i in straight)
        share = max((whole + more) / whole, 0.02)
        for i in straight:
            segments[i] = _with_distance(segments[i], segments[i].distance * share)
    return element.with_segments(segments)


def _with_distance(segment: Segment, distance: float) -> Segment:
    distance = max(round(distance * 100) / 100, min(LEAST, segment.distance))
    return segment.model_copy(update={"distance": distance})


@dataclass(frozen=True, slots=True)
class RoadLength:
    """Requires the length of the whole road, in metres, to lie in a range; other steps decide which elements
    may change for this.
    """

    room: Range

    def apply(self, elements: RoadElements, world: World) -> RoadElements:
        """Returns the elements unchanged."""
        return elements


@dataclass(frozen=True, slots=True)
class Mirror:
    """Mirrors some elements, or the whole road."""

    names: frozenset[str] | None = None
    """Names of the elements to mirror; None for all elements."""

    def apply(self, elements: RoadElements, world: World) -> RoadElements:
        """Returns the elements, with the named ones mirrored."""
        return tuple(flipped(e) if self.names is None or e.name in self.names else e for e in elements)


def flipped(element: RoadElement) -> RoadElement:
    """Returns the mirror image of an element."""
    return replace(
        element,
        side=element.side and OTHER_SIDE[element.side],
        segments=tuple(_mirrored(s) for s in element.segments),
    )


def _mirrored(segment: Segment) -> Segment:
    if not segment.turn_degrees or segment.direction == "straight":
        return segment
    side = OTHER_SIDE[segment.direction]
    return segment.model_copy(update={"direction": side, "turn_degrees": -segment.turn_degrees})


@dataclass(frozen=True, slots=True)
class Become:
    """Replaces an element by a gap (an element that is no turn) with these segments; without segments,
    removes the element.
    """

    element: RoadElement
    segments: Sequence[Segment] = ()

    def apply(self, elements: RoadElements, world: World) -> RoadElements:
        """Returns the elements with a gap in place of ``self.element``."""
        gap = replace(
            self.element, kind="gap", side=None, seen=None, segments=tuple(self.segments), asked=FREE_STRAIGHT
        )
        return changed(elements, self.element.name, lambda _: gap)


def with_room(elements: RoadElements, before: RoadElements) -> RoadElements:
    """Returns the elements, with straights inserted between turns to the same side that are too close.

    No straight is inserted if the two turns already followed each other, to the same sides, before the edit.
    """
    known = {_pair(one, other) for one, other in pairwise(b for b in before if b.kind == "turn")}
    out: list[RoadElement] = []
    last: RoadElement | None = None
    metres = 0.0
    for element in elements:
        if element.kind == "turn":
            is_new = last is not None and last.side == element.side and _pair(last, element) not in known
            if is_new and metres < SEPARATE - 2:
                out.append(gap(f"room before {element.name}", round(SEPARATE - metres, 1), element.incline))
            last, metres = element, 0.0
        else:
            metres += element.length
        out.append(element)
    return tuple(out)


def _pair(one: RoadElement, other: RoadElement) -> tuple[str, Side | None, str, Side | None]:
    return one.name, one.side, other.name, other.side


def started(
    design: Design,
    after: RoadElements,
    before: RoadElements,
    world: World,
    is_mirrored: bool,
    is_reversed: bool,
) -> Design:
    """Returns the design with the segments of the elements after the steps.

    A reversed road starts where the road ended, and heads the opposite way. If elements were added at the
    start, the start moves so that the rest of the road stays where it was.
    """
    segments = joined(after)
    if is_reversed:
        return _started_at_end(design, segments)
    x, y, z = design.starting_point
    if is_mirrored:
        theta = (180 - design.theta) % 360
        return Design(
            starting_point=(world.site.map_size - x, y, z), theta=round(theta, 6), segments=segments
        )
    old = {element.name for element in before}
    front: list[Segment] = []
    for element in after:
        if element.name in old:
            break
        front += element.segments
    if not front:
        return design.model_copy(update={"segments": segments})
    lead = build(Design(starting_point=(0.0, 0.0, 0.0), theta=0.0, segments=tuple(front)))
    end, turned = lead.at(lead.length), float(lead.heading(lead.length))
    theta = radians(design.theta) - turned
    far, way = hypot(end[0], end[1]), atan2(end[1], end[0]) + theta
    start = (x - far * cos(way), y - far * sin(way), z - float(end[2]))
    return Design(
        starting_point=(round(start[0], 2), round(start[1], 2), round(start[2], 2)),
        theta=round(degrees(theta) * HUNDREDTH) / HUNDREDTH % 360,
        segments=segments,
    )


def _started_at_end(design: Design, segments: tuple[Segment, ...]) -> Design:
    """Returns a Design with these segments that starts at the end of ``design``'s road and heads the
    opposite way.
    """
    road = build(design)
    x, y, z = (round(float(value), DECIMALS) for value in road.at(road.length))
    theta = degrees(float(road.heading(road.length)) + pi) % 360
    return Design(starting_point=(x, y, z), theta=round(theta, DECIMALS) % 360, segments=segments)
