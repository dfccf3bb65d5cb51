"""Draws one angle and radius for turns that must be alike, and one length for straights that must be."""

from collections.abc import Sequence
from dataclasses import replace
from math import inf, radians

from roadgpt.brief.outline import Feature
from roadgpt.brief.ranges import Range
from roadgpt.brief.words import LEAST_STRAIGHT
from roadgpt.check.likeness import LikeGroup, like_groups, like_straights
from roadgpt.design.draw import (
    ANY_TURN,
    LEAD,
    SEPARATE,
    DraftTask,
    drawn_straight,
    drawn_target,
    drawn_turn,
    free_straight,
    inside,
    longest_turn,
    narrowed_turns,
)
from roadgpt.design.sequence import TurnSequence

ANGLE_SPREAD = 0.4  # degrees by which the angles of like turns may differ from the one that was drawn
SPREAD = 0.01  # share by which radii and lengths may differ
JOIN_MEAN = 14.0  # m by which a straight between like turns exceeds its least length on average
FILLED = (0.5, 1.0)  # share of what the turns leave of the required length that like straights fill
NARROW = 1.25  # ratio of the ends of a range that was given as one number, which needs no drawing


def with_like_parts(order: TurnSequence, task: DraftTask) -> TurnSequence:
    """Returns the sequence with narrow ranges for turns and straights that must be alike.

    ``check.likeness`` says which these are. The other turns and straights are left as they are.

    Raises:
        DesignError: a turn cannot have the required angle or radius.
    """
    turns = [*order.turns]
    for group in like_groups(turns):
        angles, radii = _like_turn(group, len(turns), task)
        for place in group:
            turns[place] = replace(turns[place], degrees=angles, radius=radii)
    gaps = [[*gap] for gap in order.gaps]
    arcs = sum(_arc(turn) for turn in turns)
    for group in like_straights(gaps):
        length = _like_length(group, gaps, arcs, task)
        for place in group:
            named = gaps[place][0] if gaps[place] else group.common
            gaps[place] = [replace(named, length=length)]
    return TurnSequence(tuple(turns), tuple(map(tuple, gaps)))


def _like_turn(group: LikeGroup, turns: int, task: DraftTask) -> tuple[Range, Range]:
    """Returns the narrow ranges of angle and radius of a group of like turns."""
    (turn,) = narrowed_turns([group.common], task)
    span = turn.degrees or ANY_TURN
    if task.outline.turning and len(group) == turns:
        share = drawn_target(task.outline.turning, task.rng) / turns
        if share in (group.common.degrees or Range()):
            span = Range(share, share)
            turn = replace(turn, degrees=span)
    angle = span.lo + float(task.rng.random()) * (1 - 0.9 * task.haste) * (span.hi - span.lo)
    longest = longest_turn(turns, task) * (1 - 0.6 * task.haste)
    made = drawn_turn(turn, angle, longest, task)
    angle = abs(made.turn)
    return (
        Range(angle - ANGLE_SPREAD, angle + ANGLE_SPREAD),
        Range(made.radius * (1 - SPREAD), made.radius * (1 + SPREAD)),
    )


def _arc(turn: Feature) -> float:
    """Returns the length in metres that a turn is likely to have."""
    angles, radii = turn.degrees or ANY_TURN, turn.radius or Range(2 * LEAD, 2 * LEAD)
    radius = radii.lo if radii.hi == inf else (radii.lo + radii.hi) / 2
    return radians((angles.lo + angles.hi) / 2) * radius


def _like_length(group: LikeGroup, gaps: Sequence[Sequence[Feature]], arcs: float, task: DraftTask) -> Range:
    """Returns the narrow range of lengths of a group of like straights, in metres."""
    span = group.common.length
    if span and span.lo > 0 and span.hi < NARROW * span.lo:
        return span
    is_even = span is None
    least = SEPARATE if is_even else inside((span or Range(LEAST_STRAIGHT)).lo)
    length = (
        free_straight(least, JOIN_MEAN, task)
        if is_even
        else drawn_straight(group.common, LEAD, JOIN_MEAN, task)
    )
    asked = task.outline.length
    if asked and asked.hi < inf:
        others = [place for place in range(len(gaps)) if place not in group]
        rest = sum(SEPARATE + sum(each.length.lo for each in gaps[at] if each.length) for at in others)
        left = (max(asked.lo, 0.0) + asked.hi) / 2 - arcs - rest
        length = max(left / len(group) * float(task.rng.uniform(*FILLED)), least)
    length = min(length, (span or Range()).hi * (1 - SPREAD))
    return Range((1 - SPREAD) * length, (1 + SPREAD) * length)
