"""Steps: small changes of elements, each with what must be measured afterwards.

A step is given ``aims``: the values to write so that the wished ones are measured. They start as the wish
itself and are corrected by what the finished road shows, as a short turn between other slopes, or one with
long clothoids, measures otherwise than it is written.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import ceil, floor, radians
from typing import Literal, Protocol

from roadgpt.brief.model import Side
from roadgpt.design.elements import cut, turn_element
from roadgpt.design.road_elements import RoadElement, RoadElements
from roadgpt.road import Segment, World
from roadgpt.road.design import MAX_TURN

Quantity = Literal["degrees", "radius", "length", "grade"]
Aims = Mapping[tuple[str, Quantity], float]
MILLIMETRE, CENTIMETRE, TENTH = 1000.0, 100.0, 10.0
LEAST = 1.0  # m that a straight segment keeps
RAMP_SHARE = 0.3  # of the arc, of a turn that is written anew without a transition of its own
OTHER: dict[Side | None, Side] = {"left": "right", "right": "left"}


@dataclass(frozen=True, slots=True)
class Goal:
    """What must be measured of a element afterwards: the value to aim at, and what is good enough."""

    element: str
    quantity: Quantity
    aim: float
    low: float
    high: float


class Step(Protocol):
    """A change of elements."""

    @property
    def goals(self) -> tuple[Goal, ...]:
        """What must be measured afterwards."""
        ...

    def apply(self, elements: RoadElements, aims: Aims, world: World) -> RoadElements:
        """The elements with the change."""
        ...


def changed(elements: RoadElements, name: str, change: Callable[[RoadElement], RoadElement]) -> RoadElements:
    """The elements, of which the one of that name is changed."""
    return tuple(change(element) if element.name == name else element for element in elements)


@dataclass(frozen=True, slots=True)
class Bend:
    """Another angle, radius or length of a turn; what is None stays as it is."""

    element: RoadElement
    degrees: float | None = None
    radius: float | None = None
    length: float | None = None
    slack: tuple[float, float, float] = (1.0, 0.05, 0.05)
    """Degrees; shares of radius and length."""

    @property
    def goals(self) -> tuple[Goal, ...]:
        """The values that were given."""
        off, wide, long = self.slack
        out = []
        if self.degrees is not None:
            out.append(
                Goal(self.element.name, "degrees", self.degrees, self.degrees - off, self.degrees + off)
            )
        if self.radius is not None:
            low, high = self.radius * (1 - wide), self.radius * (1 + wide)
            out.append(Goal(self.element.name, "radius", self.radius, low, high))
        if self.length is not None:
            low, high = self.length * (1 - long), self.length * (1 + long)
            out.append(Goal(self.element.name, "length", self.length, low, high))
        return tuple(out)

    def apply(self, elements: RoadElements, aims: Aims, world: World) -> RoadElements:
        """Angles, lengths and radii scaled alike; more segments where one would turn too far."""
        seen, name = self.element.seen, self.element.name
        assert seen is not None
        turn = abs(sum(s.turn_degrees for s in self.element.segments))
        more = 1.0 if self.degrees is None else (turn + aims[name, "degrees"] - seen.degrees) / turn
        wider = 1.0 if self.radius is None else aims[name, "radius"] / seen.radius
        if self.length is not None:
            wider *= aims[name, "length"] / seen.length
        least = max((abs(s.turn_degrees) for s in self.element.segments), default=0.0)
        if least * more > MAX_TURN >= least:
            return changed(elements, name, lambda b: rewritten(b, turn * more, seen.radius * wider))
        return changed(elements, name, lambda b: b.with_segments(scaled(s, more, wider) for s in b.segments))


def scaled(segment: Segment, more: float, wider: float) -> Segment:
    """A segment that turns ``more`` times as far at ``wider`` times the radius; all else in proportion."""
    if not segment.turn_degrees:
        return segment
    degrees = round(segment.turn_degrees * more * TENTH) / TENTH
    more = degrees / segment.turn_degrees
    radius = segment.radius and ceil(segment.radius * wider * CENTIMETRE) / CENTIMETRE
    if radius and segment.radius:
        wider = radius / segment.radius
    exact = segment.distance * more * wider * MILLIMETRE
    ramp = segment.transition
    if ramp:
        ramp = max(floor(ramp * more * wider * TENTH), 1) / TENTH
    return segment.model_copy(
        update={
            "distance": max((ceil(exact) if radius else floor(exact)) / MILLIMETRE, 0.001),
            "turn_degrees": degrees,
            "radius": radius,
            "transition": ramp,
        }
    )


def straight(length: float, incline: float) -> Segment:
    """A straight segment with numbers as they are written."""
    return Segment(distance=round(max(length, 1.0), 1), direction="straight", incline=round(incline, 1))


def rewritten(element: RoadElement, degrees: float, radius: float) -> RoadElement:
    """A turn of a element's side and slope that is written anew."""
    ramps = [s.transition for s in element.segments if s.transition]
    ramp = ramps[0] if ramps else RAMP_SHARE * radius * radians(degrees)
    segments = turn_segments(degrees, 1 if element.side == "left" else -1, radius, ramp, element.incline)
    return element.with_segments(segments)


def turn_segments(
    degrees: float, hand: int, radius: float, ramp: float, incline: float
) -> tuple[Segment, ...]:
    """A turn as the planner writes it."""
    turn = turn_element(degrees, hand, radius, ramp)
    return tuple(cut(turn._replace(incline=round(incline * TENTH) / TENTH)))


@dataclass(frozen=True, slots=True)
class Stretch:
    """Another length of a straight, metres as measured."""

    element: RoadElement
    length: float
    slack: float = 1.0

    @property
    def goals(self) -> tuple[Goal, ...]:
        """The length; a straight that was not to be seen is not measured."""
        if self.length < 10.0 or (self.element.seen is None and self.element.segments):
            return ()
        return (
            Goal(
                self.element.name, "length", self.length, self.length - self.slack, self.length + self.slack
            ),
        )

    def apply(self, elements: RoadElements, aims: Aims, world: World) -> RoadElements:
        """The longest segment longer, or all straight ones shorter."""
        seen = self.element.seen
        before = seen.length if seen else self.element.length
        more = aims.get((self.element.name, "length"), self.length) - before
        return changed(elements, self.element.name, lambda b: stretched(b, more))


def stretched(element: RoadElement, more: float) -> RoadElement:
    """A gap with so many metres more of straight road."""
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
    """The segment on another slope, percent."""
    rounded = round(float(incline) * TENTH) / TENTH
    return segment if rounded == segment.incline else segment.model_copy(update={"incline": rounded})


@dataclass(frozen=True, slots=True)
class Flip:
    """A turn to the other side."""

    element: RoadElement
    goals: tuple[Goal, ...] = ()

    def apply(self, elements: RoadElements, aims: Aims, world: World) -> RoadElements:
        """All that bends, bends the other way."""
        return changed(elements, self.element.name, flipped)


def flipped(element: RoadElement) -> RoadElement:
    """The mirror image of a element."""
    return replace(
        element, side=OTHER.get(element.side), segments=tuple(_mirrored(s) for s in element.segments)
    )


def _mirrored(segment: Segment) -> Segment:
    if not segment.turn_degrees:
        return segment
    side = OTHER[segment.direction if segment.direction != "straight" else None]
    return segment.model_copy(update={"direction": side, "turn_degrees": -segment.turn_degrees})


@dataclass(frozen=True, slots=True)
class FlipAll:
    """The mirror image of the whole road."""

    goals: tuple[Goal, ...] = ()

    def apply(self, elements: RoadElements, aims: Aims, world: World) -> RoadElements:
        """Every turn, and what bends between them."""
        return tuple(flipped(element) for element in elements)


@dataclass(frozen=True, slots=True)
class Become:
    """A element becomes a gap of these segments, or vanishes."""

    element: RoadElement
    segments: Sequence[Segment] = ()
    goals: tuple[Goal, ...] = ()

    def apply(self, elements: RoadElements, aims: Aims, world: World) -> RoadElements:
        """Turns turn into gaps."""
        return changed(
            elements,
            self.element.name,
            lambda b: replace(b, kind="gap", side=None, seen=None, segments=tuple(self.segments)),
        )


@dataclass(frozen=True, slots=True)
class Insert:
    """New elements before the element of that name, or at the end where it is empty."""

    before: str
    elements: RoadElements
    goals: tuple[Goal, ...] = ()
    split: str = ""
    """The gap that is split in two first; its second half is what the new elements stand before."""
    index: int = 0
    """Segments of its first half; 0 halves the longest one."""

    def apply(self, elements: RoadElements, aims: Aims, world: World) -> RoadElements:
        """The new elements in their place, on the slope that is aimed at."""
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
