"""Steps: small changes of elements, each with what must be measured afterwards.

A step is given ``aims``: the values to write so that the wished ones are measured. They start as the wish
itself and are corrected by what the finished road shows, as a short turn between other slopes, or one with
long clothoids, measures otherwise than it is written.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import ceil, floor, radians
from typing import Literal, Protocol

import numpy as np

from roadgpt.brief.model import OTHER_SIDE
from roadgpt.brief.words import LEAST_STRAIGHT
from roadgpt.design.elements import cut, turn_element
from roadgpt.design.road_elements import RoadElement, RoadElements
from roadgpt.road import Segment, World
from roadgpt.road.design import MAX_TURN

Quantity = Literal["degrees", "radius", "length", "grade"]
Aims = Mapping[tuple[str, Quantity], float]
MILLIMETRE, CENTIMETRE, TENTH = 1000.0, 100.0, 10.0
LEAST = 1.0  # m that a straight segment keeps
TRANSITION_SHARE = 0.3  # of the arc, of a turn that is written anew without a transition of its own


@dataclass(frozen=True, slots=True)
class Goal:
    """What must be measured of an element afterwards: the value to aim at, and what is good enough."""

    element: str
    """Its name; empty for the whole road."""
    quantity: Quantity
    aim: float
    low: float
    high: float


class EditStep(Protocol):
    """A change of elements."""

    @property
    def goals(self) -> tuple[Goal, ...]:
        """What must be measured afterwards."""
        ...

    def apply(self, elements: RoadElements, aims: Aims, world: World) -> RoadElements:
        """Returns the elements with the change."""
        ...


def changed(elements: RoadElements, name: str, change: Callable[[RoadElement], RoadElement]) -> RoadElements:
    """Returns the elements, with ``change`` applied to the element called ``name``."""
    return tuple(change(element) if element.name == name else element for element in elements)


@dataclass(frozen=True, slots=True)
class Adjust:
    """Gives one element other measures; what is None stays as it is."""

    element: RoadElement
    degrees: float | None = None
    radius: float | None = None
    length: float | None = None
    grade: tuple[float, float, float] | None = None
    """Percent: the value to aim at, and the two ends of what is good enough."""
    slack: tuple[float, float] = (1.0, 0.05)
    """Degrees, and share of the radius, by which it may miss."""
    length_slack: float = 1.0
    """Metres of length by which it may miss."""

    @property
    def goals(self) -> tuple[Goal, ...]:
        """The wanted measures that can be seen on the finished road."""
        is_hidden = self.element.seen is None and bool(self.element.segments)
        return tuple(
            goal
            for goal in self._wanted()
            if (self.element.seen is not None if goal.quantity == "grade" else not is_hidden)
            and (goal.quantity != "length" or self.element.is_turn or goal.aim >= LEAST_STRAIGHT)
        )

    def _wanted(self) -> Iterator[Goal]:
        name, (off, wide) = self.element.name, self.slack
        pairs: tuple[tuple[Quantity, float | None, float], ...] = (
            ("degrees", self.degrees, off),
            ("radius", self.radius, wide * (self.radius or 0.0)),
            ("length", self.length, self.length_slack),
        )
        for quantity, aim, by in pairs:
            if aim is not None:
                yield Goal(name, quantity, aim, aim - by, aim + by)
        if self.grade:
            aim, *ends = self.grade
            yield Goal(name, "grade", aim, min(ends), max(ends))

    def apply(self, elements: RoadElements, aims: Aims, world: World) -> RoadElements:
        """Returns the elements, of which this one is bent, stretched or sloped."""
        name = self.element.name
        values = {goal.quantity: aims.get((name, goal.quantity), goal.aim) for goal in self._wanted()}
        grade = values.pop("grade", None)
        if grade is not None:
            elements = changed(elements, name, lambda e: _sloped(e, grade, world))
        if values and self.element.is_turn:
            return changed(elements, name, lambda e: _bent(e, self.element, values))
        if values:
            seen = self.element.seen
            more = values["length"] - (seen.length if seen else self.element.length)
            return changed(elements, name, lambda e: stretched(e, more))
        return elements


def _bent(element: RoadElement, before: RoadElement, values: Mapping[Quantity, float]) -> RoadElement:
    """Angles, lengths and radii scaled alike; more segments where one would turn too far."""
    seen = before.seen
    assert seen is not None
    turn = abs(before.degrees)
    more = (turn + values["degrees"] - seen.degrees) / turn if "degrees" in values else 1.0
    wider = values["radius"] / seen.radius if "radius" in values else 1.0
    if "length" in values:
        wider *= values["length"] / seen.length
    least = max((abs(s.turn_degrees) for s in before.segments), default=0.0)
    if least * more > MAX_TURN >= least:
        return rewritten(element, turn * more, seen.radius * wider)
    return element.with_segments(scaled(s, more, wider) for s in element.segments)


def _sloped(element: RoadElement, grade: float, world: World) -> RoadElement:
    """Inclines in proportion where they all go the same way, else all alike."""
    limit = 100 * world.max_grade - 0.2
    aim = float(np.clip(grade, -limit, limit))
    inclines = np.array([s.incline for s in element.segments])
    mean = element.incline
    if abs(mean) >= 1 and (inclines * np.sign(mean) > 0.5).all() and aim * mean > 0:
        wanted = np.clip(inclines * aim / mean, -limit, limit)
    else:
        wanted = np.full(len(inclines), aim)
    return element.with_segments(with_incline(s, g) for s, g in zip(element.segments, wanted, strict=True))


def scaled(segment: Segment, more: float, wider: float) -> Segment:
    """Returns a segment that turns ``more`` times as far at ``wider`` times the radius."""
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


def straight(length: float, incline: float) -> Segment:
    """Returns a straight segment with its numbers rounded as they are written."""
    return Segment(distance=round(max(length, 1.0), 1), direction="straight", incline=round(incline, 1))


def rewritten(element: RoadElement, degrees: float, radius: float) -> RoadElement:
    """Returns a turn that has the element's side and slope and is written anew."""
    transitions = [s.transition for s in element.segments if s.transition]
    transition = transitions[0] if transitions else TRANSITION_SHARE * radius * radians(degrees)
    segments = turn_segments(
        degrees, 1 if element.side == "left" else -1, radius, transition, element.incline
    )
    return element.with_segments(segments)


def turn_segments(
    degrees: float, hand: int, radius: float, transition: float, incline: float
) -> tuple[Segment, ...]:
    """Returns the segments of a turn as the planner writes it."""
    turn = turn_element(degrees, hand, radius, transition)
    return tuple(cut(turn._replace(incline=round(incline * TENTH) / TENTH)))


def stretched(element: RoadElement, more: float) -> RoadElement:
    """Returns a gap with its straight road lengthened by ``more`` metres."""
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


def with_incline(segment: Segment, incline: float) -> Segment:
    """Returns the segment with another incline in percent."""
    rounded = round(float(incline) * TENTH) / TENTH
    return segment if rounded == segment.incline else segment.model_copy(update={"incline": rounded})


@dataclass(frozen=True, slots=True)
class Mirror:
    """Mirrors some elements, or the whole road."""

    names: frozenset[str] | None = None
    """Names of the elements to mirror; None for all elements."""
    goals: tuple[Goal, ...] = ()

    def apply(self, elements: RoadElements, aims: Aims, world: World) -> RoadElements:
        """Returns the elements, those of these names bent to the other side."""
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
    """Replaces an element by a gap of these segments, or removes it."""

    element: RoadElement
    segments: Sequence[Segment] = ()
    goals: tuple[Goal, ...] = ()

    def apply(self, elements: RoadElements, aims: Aims, world: World) -> RoadElements:
        """Returns the elements with a gap in place of this one."""
        return changed(
            elements,
            self.element.name,
            lambda b: replace(b, kind="gap", side=None, seen=None, segments=tuple(self.segments)),
        )


@dataclass(frozen=True, slots=True)
class Insert:
    """Inserts new elements before the element of that name, or at the end where the name is empty."""

    before: str
    elements: RoadElements
    goals: tuple[Goal, ...] = ()
    split: str = ""
    """The gap that is split in two first; its second half is what the new elements stand before."""
    index: int = 0
    """Number of segments in the first half of the split gap; 0 halves the gap's longest segment."""

    def apply(self, elements: RoadElements, aims: Aims, world: World) -> RoadElements:
        """Returns the elements with the new ones in their place, on the slope that is aimed at."""
        new = tuple(self._aimed(element, aims) for element in self.elements)
        if self.split:
            return tuple(
                part for b in elements for part in (self._halves(b, new) if b.name == self.split else (b,))
            )
        names = [element.name for element in elements]
        at = names.index(self.before) if self.before else len(elements)
        return (*elements[:at], *new, *elements[at:])

    def _aimed(self, element: RoadElement, aims: Aims) -> RoadElement:
        length, aim = aims.get((element.name, "length")), aims.get((element.name, "grade"))
        if length is not None:
            element = element.with_segments(_with_distance(s, length) for s in element.segments)
        if aim is None:
            return element
        return element.with_segments(with_incline(s, min(max(aim, -14.8), 14.8)) for s in element.segments)

    def _halves(self, element: RoadElement, new: RoadElements) -> RoadElements:
        segments, at = list(element.segments), self.index
        if not at:
            longest = max(range(len(segments)), key=lambda i: segments[i].distance)
            half = round(segments[longest].distance / 2 * MILLIMETRE) / MILLIMETRE
            rest = round((segments[longest].distance - half) * MILLIMETRE) / MILLIMETRE
            one = segments[longest]
            segments[longest : longest + 1] = [
                one.model_copy(update={"distance": half}),
                one.model_copy(update={"distance": rest}),
            ]
            at = longest + 1
        first, second = (
            element.with_segments(segments[:at]),
            replace(element, name=f"{element.name} rest", seen=None),
        )
        return (first, *new, second.with_segments(segments[at:]))
