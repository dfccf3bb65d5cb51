"""Ramps: where straights of different grades meet, joints and grades move until they are measured as asked.

The parabola that joins two grades belongs to both straights. A level one is measured only where the road is
level, so it loses length to a steep neighbour, and the mean grade of the steep one falls.
"""

from collections.abc import Iterator, Sequence
from itertools import pairwise
from math import inf

import numpy as np

from roadgpt.brief.words import Range
from roadgpt.check.measures import LEVEL
from roadgpt.design.spans import Span
from roadgpt.geometry.curve import Array
from roadgpt.road.grades import CREST_RADIUS, MOST_OF_SEGMENT

ROUNDS = 8
SHORTEST = 4.0  # m that a move leaves of a straight
STEP = 0.5  # m, of the stations that a mean grade is taken from
Inclines = list[tuple[float, float]]
"""Lengths in metres and inclines in percent, in order."""


def eased(spans: Sequence[Span], inclines: Sequence[Inclines], limit: Range) -> list[Inclines]:
    """The inclines with joints moved inside rows of straights, and narrow grades kept on the whole.

    Args:
        spans: of a draft, in driving order.
        inclines: lengths in metres and inclines in percent of each.
        limit: percent that no incline may leave.
    """
    out = [*inclines]
    for first, last in _rows(spans, inclines):
        row = spans[first:last]
        lengths, grades = _settled(row, [inclines[i][0][1] for i in range(first, last)], limit)
        out[first:last] = [[pair] for pair in zip(lengths.tolist(), grades.tolist(), strict=True)]
    return out


def _rows(spans: Sequence[Span], inclines: Sequence[Inclines]) -> Iterator[tuple[int, int]]:
    """First and last + 1 of straights that follow each other, where the length of one was asked for."""
    first = 0
    for at in range(len(spans) + 1):
        if at < len(spans) and not spans[at].turn and len(inclines[at]) == 1:
            continue
        if at - first > 1 and any(_is_fixed(span) for span in spans[first:at]):
            yield first, at
        first = at + 1


def _is_fixed(span: Span) -> bool:
    return span.promised is not None and span.promised.hi < inf


def _settled(row: Sequence[Span], drawn: Sequence[float], limit: Range) -> tuple[Array, Array]:
    """Lengths and inclines by which every straight is measured as it was drawn."""
    wanted = np.cumsum([span.length for span in row])
    joints, grades = wanted.copy(), np.array(drawn, dtype=float)
    movable = np.array([_is_fixed(one) or _is_fixed(other) for one, other in pairwise(row)])
    for _ in range(ROUNDS):
        edges = joints.copy()
        edges[:-1] += _shifts(joints, grades)
        means = _means(joints, grades, edges)
        for i, span in enumerate(row):
            if span.grade and _is_fixed(span) and 0 not in span.grade:
                grades[i] += min(max(means[i], span.grade.lo), span.grade.hi) - means[i]
        grades = np.clip(grades, limit.lo, limit.hi)
        joints[:-1] += np.where(movable, wanted[:-1] - edges[:-1], 0.0)
        joints = _spread(joints)
    return np.diff(joints, prepend=0.0), np.round(grades, 1)


def _spread(joints: Array) -> Array:
    """Joints in order, none nearer to the next than SHORTEST, if there is room at all."""
    steps = SHORTEST * np.arange(1, len(joints) + 1)
    up = np.maximum.accumulate(np.maximum(joints - steps, 0.0)) + steps
    most = joints[-1] - SHORTEST * np.arange(len(joints) - 1, -1, -1)
    return np.asarray(np.where(most > steps - SHORTEST, np.minimum(up, most), joints))


def _halves(joints: Array, grades: Array) -> Array:
    """Half the length of the parabola at every inner joint, as ``road.grades`` makes it."""
    lengths = np.diff(joints, prepend=0.0)
    room = MOST_OF_SEGMENT * np.minimum(lengths[:-1], lengths[1:]) / 2
    return np.asarray(np.minimum(CREST_RADIUS * np.abs(np.diff(grades)) / 200, room))


def _shifts(joints: Array, grades: Array) -> Array:
    """How far behind its joint the grade changes between climbing, level and falling; 0 where it does not."""
    classes = np.where(np.abs(grades) >= LEVEL, np.sign(grades), 0.0)
    before, after = grades[:-1], grades[1:]
    changes = classes[:-1] != classes[1:]
    edge = LEVEL * (classes[:-1] + classes[1:])  # 0 between climbing and falling
    share = (edge - before) / np.where(changes, after - before, 1.0)
    return np.asarray(np.where(changes, (2 * share - 1) * _halves(joints, grades), 0.0))


def _means(joints: Array, grades: Array, edges: Array) -> Array:
    """Percent, the mean grade of each straight between the places where it is measured to begin and end."""
    halves = _halves(joints, grades)
    stations = np.sort(np.concatenate([[0.0], joints[:-1] - halves, joints[:-1] + halves, joints[-1:]]))
    values = np.repeat(grades, 2)
    s = np.arange(0.0, joints[-1] + STEP, STEP)
    heights = np.concatenate([[0.0], np.cumsum(np.interp(s[:-1] + STEP / 2, stations, values)) * STEP])
    ends = np.concatenate([[0.0], edges])
    return np.asarray(np.diff(np.interp(ends, s, heights)) / np.maximum(np.diff(ends), STEP))
