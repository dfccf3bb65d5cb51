r"""Computes the horizontal alignment of a Design: converts each segment to lines, arcs and clothoids.

The curvature of a turning segment changes from an entry value to its own value, and then to an exit value:

    curvature   own   ____arc____
                     /           \
           entry ___/             \___ exit
                clothoid      clothoid

The entry or exit value is 0 where the neighbouring segment is straight or turns the other way. Where both
segments turn the same way, the value is the smaller of their own curvatures, so that the two segments form
one longer turn. The prompt in the RoadGPT thesis asks language models to build turns of more than 70 degrees
in this way.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

from roadgpt.geometry import Piece
from roadgpt.road.design import Segment

TRANSITION_SHARE = 0.25  # share of the distance, for each clothoid whose length the design leaves open
LONGEST_TRANSITION = 12.0  # m, for a clothoid whose length the design leaves open
MOST_TRANSITION = 0.45  # share of the distance, for each clothoid of a turn without a given radius
ROUNDS = 60  # of the fixed-point iteration; each brings neighbouring curvatures closer
SETTLED = 1e-12  # 1/m
EQUAL = 1e-9  # 1/m; curvatures closer than this need no clothoid between them


class _TurnSpec(NamedTuple):
    """The turn that a segment specifies; lengths are in metres.

    ``turn`` is the absolute angle in radians; ``hand`` is 1 for a left turn, -1 for a right turn.
    """

    distance: float
    turn: float
    ramp: float
    radius: float | None
    hand: float


class _TurnLayout(NamedTuple):
    """A turn's own curvature, and the lengths of its clothoid, arc, clothoid and unused straight."""

    own: float
    first: float
    arc: float
    last: float
    spare: float


def pieces_of(segments: Sequence[Segment]) -> list[Piece]:
    """Returns the lines, arcs and clothoids of all segments in order.

    Every segment keeps its length and its change of heading exactly. A radius that the segment states is kept
    if the turn fits into this length and at most one of the neighbouring segments turns the same way.
    """
    bends = [_bend(segment) for segment in segments]
    joints = _settled_joints(bends)
    out: list[Piece] = []
    for segment, bend, entry, exit_ in zip(segments, bends, joints, joints[1:], strict=False):
        out += _pieces(bend, entry, exit_) if bend else [Piece(segment.distance)]
    return out


def _bend(segment: Segment) -> _TurnSpec | None:
    turn = math.radians(segment.turn_degrees)
    if abs(turn) < 1e-9:
        return None
    ramp = segment.transition or min(TRANSITION_SHARE * segment.distance, LONGEST_TRANSITION)
    return _TurnSpec(segment.distance, abs(turn), ramp, segment.radius, math.copysign(1.0, turn))


def _settled_joints(bends: Sequence[_TurnSpec | None]) -> list[float]:
    """Returns the curvatures at the start, between segments and at the end, by fixed-point iteration."""
    joints = [0.0] * (len(bends) + 1)
    meets = [i for i in range(1, len(bends)) if _same_hand(bends[i - 1], bends[i])]
    for _ in range(ROUNDS if meets else 0):
        own = [_solve(b, joints[i], joints[i + 1]).own if b else 0.0 for i, b in enumerate(bends)]
        moved = max(abs(min(own[i - 1], own[i]) - joints[i]) for i in meets)
        for i in meets:
            joints[i] = min(own[i - 1], own[i])
        if moved < SETTLED:
            break
    return joints


def _same_hand(one: _TurnSpec | None, other: _TurnSpec | None) -> bool:
    return one is not None and other is not None and one.hand == other.hand


def _solve(bend: _TurnSpec, entry: float, exit_: float) -> _TurnLayout:
    """Returns the layout whose lengths add up to the segment's distance and which turns by its angle."""
    if bend.radius and 0 in (entry, exit_):
        kept = _with_radius(bend, 1 / bend.radius, entry, exit_)
        if kept:
            return kept
    ramp = min(bend.ramp, MOST_TRANSITION * bend.distance)
    own = (bend.turn - (entry + exit_) * ramp / 2) / (bend.distance - ramp)
    return _TurnLayout(own, ramp, bend.distance - 2 * ramp, ramp, 0.0)


def _with_radius(bend: _TurnSpec, own: float, entry: float, exit_: float) -> _TurnLayout | None:
    """Returns the layout whose arc has the curvature ``own``; None if the distance is too short for it, or if
    the curvature at a joint is larger.
    """
    first = bend.ramp if entry < own - EQUAL else 0.0
    last = bend.ramp if exit_ < own - EQUAL else 0.0
    turned = first * (own + entry) / 2 + last * (own + exit_) / 2
    shrink = min(1.0, bend.turn / turned) if turned else 1.0
    first, last, arc = first * shrink, last * shrink, (bend.turn - turned * shrink) / own
    spare = bend.distance - first - last - arc
    fits = spare > -1e-6 and own >= max(entry, exit_)
    return _TurnLayout(own, first, arc, last, max(spare, 0.0)) if fits else None


def _pieces(bend: _TurnSpec, entry: float, exit_: float) -> list[Piece]:
    """Returns clothoid, arc and clothoid; the remaining length is straight, at ends with a curvature of 0."""
    shape = _solve(bend, entry, exit_)
    free = (entry == 0) + (exit_ == 0)
    k, k_in, k_out = bend.hand * shape.own, bend.hand * entry, bend.hand * exit_
    return [
        Piece(shape.spare / free if entry == 0 else 0.0),
        Piece(shape.first, k_in, k),
        Piece(shape.arc, k, k),
        Piece(shape.last, k, k_out),
        Piece(shape.spare / free if exit_ == 0 else 0.0),
    ]
