"""Defines the steps of an edit.

A step sets the desired values of elements, and stores in ``RoadElement.asked`` the ranges in which the
measured values must lie. ``design.fit`` then adjusts the elements that have a requirement, if the road would
violate a rule, or if measured values lie outside these ranges."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal, NamedTuple, Protocol

from roadgpt.brief.outline import Feature, both
from roadgpt.brief.ranges import Range
from roadgpt.design.road_elements import FREE_STRAIGHT, RoadElement, RoadElements
from roadgpt.errors import UsageError
from roadgpt.road import Segment, World
from roadgpt.road.design import MAX_TURN

SEPARATE = 18.0  # m between turns to the same side, so that they are seen as two
HIDDEN = 9.0  # m between turns to the same side at which they are measured as two, without a straight
WIDEST = 250.0  # m: a turn of a larger radius is hardly seen as one
OFF_STEEPEST = 0.2  # percentage points from a new incline to the steepest that the rules allow
CLEARLY, FURTHER = 0.45, 1.6  # least and greatest accepted share of a change without a number ('sharper')


class EditStep(Protocol):
    """One change to the elements of a road."""

    def apply(self, elements: RoadElements, world: World) -> RoadElements:
        """Returns the elements after the change."""
        ...


EditCandidate = tuple[EditStep, ...]
"""Steps that together make one change."""


class Wanted(NamedTuple):
    """A value to aim at, and the range in which the measured value may lie."""

    aim: float
    room: Range

    def nearer_to(self, now: float) -> "Wanted":
        """Returns the same range with a new aim: halfway between the old aim and the value in the range that
        is nearest to ``now``."""
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
    """Gives one element new values. The ranges of these values become the requirement of the element. A field
    that is None leaves its value unchanged."""

    element: RoadElement
    degrees: Wanted | None = None
    radius: Wanted | None = None
    length: Wanted | None = None
    grade: Wanted | None = None  # the mean grade in percent

    def milder(self) -> "Adjust":
        """Returns the same step with aims nearer to the present measurements of the element. The aim of the
        grade and all ranges stay the same."""
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
        """Returns the elements, with new values for ``self.element``."""
        name = self.element.name
        return tuple(self._applied(each, world) if each.name == name else each for each in elements)

    def _applied(self, now: RoadElement, world: World) -> RoadElement:
        if self.element.is_turn and not self.element.degrees:  # a spline bends before and behind its turns
            raise UsageError(f"{self.element.name} is made by no segment of the road, but by its spline")
        if now.is_turn != self.element.is_turn:
            raise UsageError(f"{self.element.name} is to go and to be changed at once")
        if self.grade:
            now = now.with_grade(self.grade.aim, 100 * world.limits.max_grade - OFF_STEEPEST)
        if self.element.is_turn:
            now = self._bent(now)
        elif self.length:
            seen = self.element.seen
            more = self.length.aim - (seen.length if seen else self.element.length)
            now = now.lengthened(self.element.length + more - now.length)
        wanted = (self.degrees, self.radius, self.length, self.grade)
        degrees, radius, length, grade = (each and each.room for each in wanted)
        kind: Literal["turn", "straight"] = "turn" if self.element.is_turn else "straight"
        asked = Feature(kind, kind, None, degrees, radius, length, grade)
        return replace(now, asked=both(now.asked, asked) if now.asked else asked)

    def _bent(self, now: RoadElement) -> RoadElement:
        """Returns the turn with scaled angles, lengths and radii, split into more segments if one would turn
        by more than 70 degrees."""
        before, seen = self.element, self.element.seen
        assert seen is not None
        turn = abs(now.degrees)
        more = (abs(before.degrees) + self.degrees.aim - seen.degrees) / turn if self.degrees else 1.0
        already = (now.length / turn) / (before.length / abs(before.degrees))  # by another change
        wide = self.radius.aim / seen.radius if self.radius else already
        if self.length:
            wide *= self.length.aim / seen.length
        wider = wide / already
        if abs(more - 1) < 1e-9 and abs(wider - 1) < 1e-9:
            return now
        most = max((abs(s.turn_degrees) for s in now.segments), default=0.0)
        if most * more > MAX_TURN >= most:
            return now.rewritten(turn * more, seen.radius * wide)
        return now.scaled(more, wider)


@dataclass(frozen=True, slots=True)
class RoadLength:
    """Requires the length of the whole road, in metres, to lie in a range; other steps decide which elements
    may change for this."""

    room: Range

    def apply(self, elements: RoadElements, world: World) -> RoadElements:
        """Returns the elements unchanged."""
        return elements


@dataclass(frozen=True, slots=True)
class Mirror:
    """Mirrors some elements, or the whole road."""

    names: frozenset[str] | None = None  # names of the elements to mirror; None for all elements

    def apply(self, elements: RoadElements, world: World) -> RoadElements:
        """Returns the elements, with the named ones mirrored."""
        return tuple(e.mirrored() if self.names is None or e.name in self.names else e for e in elements)


@dataclass(frozen=True, slots=True)
class Become:
    """Replaces an element by a gap (an element that is no turn) with these segments; without segments,
    removes the element."""

    element: RoadElement
    segments: Sequence[Segment] = ()

    def apply(self, elements: RoadElements, world: World) -> RoadElements:
        """Returns the elements with a gap in place of ``self.element``."""
        gap = replace(self.element, side=None, seen=None, segments=tuple(self.segments), asked=FREE_STRAIGHT)
        return tuple(gap if element.name == gap.name else element for element in elements)
