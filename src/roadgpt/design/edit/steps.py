"""Steps: small changes of blocks, each with what must be measured afterwards.

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
    """What must be measured of a block afterwards: the value to aim at, and what is good enough."""

    block: str
    quantity: Quantity
    aim: float
    low: float
    high: float


class Step(Protocol):
    """A change of blocks."""

    @property
    def goals(self) -> tuple[Goal, ...]:
        """What must be measured afterwards."""
        ...

    def apply(self, blocks: RoadElements, aims: Aims, world: World) -> RoadElements:
        """The blocks with the change."""
        ...


def changed(blocks: RoadElements, name: str, change: Callable[[RoadElement], RoadElement]) -> RoadElements:
    """The blocks, of which the one of that name is changed."""
    return tuple(change(block) if block.name == name else block for block in blocks)


@dataclass(frozen=True, slots=True)
class Bend:
    """Another angle, radius or length of a turn; what is None stays as it is."""

    block: RoadElement
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
            out.append(Goal(self.block.name, "degrees", self.degrees, self.degrees - off, self.degrees + off))
        if self.radius is not None:
            low, high = self.radius * (1 - wide), self.radius * (1 + wide)
            out.append(Goal(self.block.name, "radius", self.radius, low, high))
        if self.length is not None:
            low, high = self.length * (1 - long), self.length * (1 + long)
            out.append(Goal(self.block.name, "length", self.length, low, high))
        return tuple(out)

    def apply(self, blocks: RoadElements, aims: Aims, world: World) -> RoadElements:
        """Angles, lengths and radii scaled alike; more segments where one would turn too far."""
        seen, name = self.block.seen, self.block.name
        assert seen is not None
        turn = abs(sum(s.turn_degrees for s in self.block.segments))
        more = 1.0 if self.degrees is None else (turn + aims[name, "degrees"] - seen.degrees) / turn
        wider = 1.0 if self.radius is None else aims[name, "radius"] / seen.radius
        if self.length is not None:
            wider *= aims[name, "length"] / seen.length
        least = max((abs(s.turn_degrees) for s in self.block.segments), default=0.0)
        if least * more > MAX_TURN >= least:
            return changed(blocks, name, lambda b: rewritten(b, turn * more, seen.radius * wider))
        return changed(blocks, name, lambda b: b.with_segments(scaled(s, more, wider) for s in b.segments))


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


def rewritten(block: RoadElement, degrees: float, radius: float) -> RoadElement:
    """A turn of a block's side and slope that is written anew."""
    ramps = [s.transition for s in block.segments if s.transition]
    ramp = ramps[0] if ramps else RAMP_SHARE * radius * radians(degrees)
    segments = turn_segments(degrees, 1 if block.side == "left" else -1, radius, ramp, block.incline)
    return block.with_segments(segments)


def turn_segments(
    degrees: float, hand: int, radius: float, ramp: float, incline: float
) -> tuple[Segment, ...]:
    """A turn as the planner writes it."""
    turn = turn_element(degrees, hand, radius, ramp)
    return tuple(cut(turn._replace(incline=round(incline * TENTH) / TENTH)))


@dataclass(frozen=True, slots=True)
class Stretch:
    """Another length of a straight, metres as measured."""

    block: RoadElement
    length: float
    slack: float = 1.0

    @property
    def goals(self) -> tuple[Goal, ...]:
        """The length; a straight that was not to be seen is not measured."""
        if self.length < 10.0 or (self.block.seen is None and self.block.segments):
            return ()
        return (
            Goal(self.block.name, "length", self.length, self.length - self.slack, self.length + self.slack),
        )

    def apply(self, blocks: RoadElements, aims: Aims, world: World) -> RoadElements:
        """The longest segment longer, or all straight ones shorter."""
        seen = self.block.seen
        before = seen.length if seen else self.block.length
        more = aims.get((self.block.name, "length"), self.length) - before
        return changed(blocks, self.block.name, lambda b: stretched(b, more))


def stretched(block: RoadElement, more: float) -> RoadElement:
    """A gap with so many metres more of straight road."""
    straight = [i for i, s in enumerate(block.segments) if not s.turn_degrees]
    if not straight:
        new = Segment(distance=max(round(more * TENTH) / TENTH, LEAST), direction="straight")
        return block.with_segments((*block.segments, new))
    segments = list(block.segments)
    longest = max(straight, key=lambda i: segments[i].distance)
    if segments[longest].distance + more >= max(0.5 * segments[longest].distance, LEAST):
        segments[longest] = _with_distance(segments[longest], segments[longest].distance + more)
    else:
        whole = sum(segments[i].distance for i in straight)
        share = max((whole + more) / whole, 0.02)
        for i in straight:
            segments[i] = _with_distance(segments[i], segments[i].distance * share)
    return block.with_segments(segments)


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

    block: RoadElement
    goals: tuple[Goal, ...] = ()

    def apply(self, blocks: RoadElements, aims: Aims, world: World) -> RoadElements:
        """All that bends, bends the other way."""
        return changed(blocks, self.block.name, flipped)


def flipped(block: RoadElement) -> RoadElement:
    """The mirror image of a block."""
    return replace(block, side=OTHER.get(block.side), segments=tuple(_mirrored(s) for s in block.segments))


def _mirrored(segment: Segment) -> Segment:
    if not segment.turn_degrees:
        return segment
    side = OTHER[segment.direction if segment.direction != "straight" else None]
    return segment.model_copy(update={"direction": side, "turn_degrees": -segment.turn_degrees})


@dataclass(frozen=True, slots=True)
class FlipAll:
    """The mirror image of the whole road."""

    goals: tuple[Goal, ...] = ()

    def apply(self, blocks: RoadElements, aims: Aims, world: World) -> RoadElements:
        """Every turn, and what bends between them."""
        return tuple(flipped(block) for block in blocks)


@dataclass(frozen=True, slots=True)
class Become:
    """A block becomes a gap of these segments, or vanishes."""

    block: RoadElement
    segments: Sequence[Segment] = ()
    goals: tuple[Goal, ...] = ()

    def apply(self, blocks: RoadElements, aims: Aims, world: World) -> RoadElements:
        """Turns turn into gaps."""
        return changed(
            blocks,
            self.block.name,
            lambda b: replace(b, kind="gap", side=None, seen=None, segments=tuple(self.segments)),
        )


@dataclass(frozen=True, slots=True)
class Insert:
    """New blocks before the block of that name, or at the end where it is empty."""

    before: str
    blocks: RoadElements
    goals: tuple[Goal, ...] = ()
    split: str = ""
    """The gap that is split in two first; its second half is what the new blocks stand before."""
    index: int = 0
    """Segments of its first half; 0 halves the longest one."""

    def apply(self, blocks: RoadElements, aims: Aims, world: World) -> RoadElements:
        """The new blocks in their place, on the slope that is aimed at."""
        new = tuple(self._aimed(block, aims) for block in self.blocks)
        if self.split:
            return tuple(
                part for b in blocks for part in (self._halves(b, new) if b.name == self.split else (b,))
            )
        names = [block.name for block in blocks]
        at = names.index(self.before) if self.before else len(blocks)
        return (*blocks[:at], *new, *blocks[at:])

    def _aimed(self, block: RoadElement, aims: Aims) -> RoadElement:
        length, aim = aims.get((block.name, "length")), aims.get((block.name, "grade"))
        if length is not None:
            block = block.with_segments(_with_distance(s, length) for s in block.segments)
        if aim is None:
            return block
        return block.with_segments(with_incline(s, min(max(aim, -14.8), 14.8)) for s in block.segments)

    def _halves(self, block: RoadElement, new: RoadElements) -> RoadElements:
        segments, at = list(block.segments), self.index
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
            block.with_segments(segments[:at]),
            replace(block, name=f"{block.name} rest", seen=None),
        )
        return (first, *new, second.with_segments(segments[at:]))
