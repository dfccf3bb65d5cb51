"""The road as a person sees it, laid over its segments: which of them make the second turn.

    gap 0 | turn 1 | gap 1 | turn 2 | ... | turn n | gap n

A turn is one of the finished geometry (``check.measures``), so segments of one hand that run into each other
are one turn, and what bends too little belongs to a gap. Gaps may be empty.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Literal

import numpy as np

from roadgpt.brief.model import Side
from roadgpt.check.measures import LEAST_TURN, MeasuredFeature, Measures, measure
from roadgpt.road import Design, Geometry, Segment, build

SEEN = 1.5  # m of a segment within a turn, at least, for it to be a part of the turn


@dataclass(frozen=True, slots=True)
class Block:
    """Segments that are one turn, or lie between two."""

    name: str
    """Of the block, whatever is added or removed around it."""
    kind: Literal["turn", "gap"]
    segments: tuple[Segment, ...]
    side: Side | None = None
    seen: MeasuredFeature | None = None
    """As it was measured before the edit; None of what is new, or too short to be seen."""

    @property
    def length(self) -> float:
        """Metres, as written."""
        return sum(segment.distance for segment in self.segments)

    @property
    def incline(self) -> float:
        """Percent, as written, on average."""
        return sum(s.distance * s.incline for s in self.segments) / max(self.length, 1e-9)

    def with_segments(self, segments: Iterable[Segment]) -> "Block":
        """The same block, made of other segments."""
        return replace(self, segments=tuple(segments))


Blocks = tuple[Block, ...]


def measured(design: Design, geometry: Geometry) -> Measures:
    """What a person sees on the road that grows from a design."""
    return measure(build(design, geometry).centreline())


def blocks_of(design: Design, geometry: Geometry = "arcs") -> tuple[Blocks, Measures]:
    """The blocks of a design, in driving order, and what was measured."""
    found = measured(design, geometry)
    joints = np.concatenate([[0.0], np.cumsum([s.distance for s in design.segments])])
    scale = (
        joints[-1] / found.length
    )  # the measure's chords, and a spline's bends, are not as long as written
    marks: list[tuple[int, int]] = []
    for turn in found.turns:
        first, end = _members(design.segments, joints, turn, scale)
        least = marks[-1][1] if marks else 0
        marks.append((max(first, least), max(end, least)))
    out: list[Block] = []
    edges = [0, *(index for mark in marks for index in mark), len(design.segments)]
    straights = [next((f for f in gap if f.kind == "straight"), None) for gap in found.gaps]
    for number, (first, end) in enumerate(pairwise(edges)):
        own = design.segments[first:end]
        if number % 2:
            turn = found.turns[number // 2]
            out.append(Block(f"turn {number // 2 + 1}", "turn", own, turn.side, turn))
        else:
            out.append(Block(f"gap {number // 2}", "gap", own, None, straights[number // 2]))
    return tuple(out), found


def _members(
    segments: Sequence[Segment], joints: "np.typing.NDArray[np.float64]", turn: MeasuredFeature, scale: float
) -> tuple[int, int]:
    """First segment of a turn, and the one behind its last."""
    low, high = turn.start * scale, turn.end * scale
    hand = 1 if turn.side == "left" else -1
    shared = np.minimum(joints[1:], high) - np.maximum(joints[:-1], low)
    bends = np.array([s.turn_degrees * hand > 0 for s in segments])
    lengths = np.diff(joints)
    inside = bends & (shared > np.minimum(SEEN, 0.5 * lengths))
    if not inside.any():
        inside = np.arange(len(segments)) == int(np.argmax(np.where(bends, shared, -np.inf)))
    which = np.flatnonzero(inside)
    return int(which[0]), int(which[-1]) + 1


def joined(blocks: Sequence[Block]) -> tuple[Segment, ...]:
    """All segments in driving order."""
    return tuple(segment for block in blocks for segment in block.segments)


def is_turn(degrees: float) -> bool:
    """Would so many degrees be seen as a turn?"""
    return abs(degrees) >= LEAST_TURN
