"""Ramps: where straights of different grades meet, joints and grades move until they are measured as asked.

The parabola that joins two grades belongs to both straights. A level one is measured only where the road is
level, so it loses length to a steep neighbour, and the mean grade of the steep one falls.
"""

from collections.abc import Iterator, Sequence
from itertools import pairwise
from math import inf
from typing import NamedTuple

import numpy as np

from roadgpt.brief.words import Range
from roadgpt.check.measures import LEVEL
from roadgpt.design.spans import Span
from roadgpt.geometry.curve import Array
from roadgpt.road.grades import CREST_RADIUS, MOST_OF_SEGMENT

ROUNDS = 8
SHORTEST = 4.0  # m that a move leaves of a straight
STATION = 0.5  # m between the stations that a mean grade is taken from
STEPS = (inf, 16.0, 12.0, 9.0, 6.0)  # m of mean grade at a joint, the longest first; inf: none
HALF_OF_STEP = (1 + MOST_OF_SEGMENT) / 2  # half of what the change takes, step and parabolas, by its length
Inclines = list[tuple[float, float]]
"""Lengths in metres and inclines in percent, in order."""


def eased(spans: Sequence[Span], inclines: Sequence[Inclines], limit: Range) -> list[Inclines]:
    """The inclines with joints moved inside rows of straights, and narrow grades kept on the whole.

    A short and steep straight has no room for the usual parabolas. There a joint gets a short step of the
    mean grade, which bends the profile more, as little as it takes.

    Args:
        spans: of a draft, in driving order.
        inclines: lengths in metres and inclines in percent of each.
        limit: percent that no incline may leave.
    """
    out = [*inclines]
    for first, last in _rows(spans, inclines):
        row = spans[first:last]
        drawn = [inclines[i][0][1] for i in range(first, last)]
        ways = (_settled(row, drawn, limit, step) for step in STEPS)
        best = next((way for way in ways if way.keeps(row)), None) or _settled(row, drawn, limit, inf)
        out[first:last] = best.inclines()
    return out


class _Row(NamedTuple):
    """Straights that follow each other, settled."""

    joints: Array
    """Metres from the start of the row, the end of each straight."""
    grades: Array
    """Percent."""
    edges: Array
    """Metres, where each straight is measured to end."""
    step: float
    """Metres that the change of grade takes at a joint where the usual parabola is longer."""

    def keeps(self, row: Sequence[Span]) -> bool:
        """Is every straight with a promised length measured as steep as promised, as a whole or inside?"""
        means = _means(self.joints, self.grades, self.edges, self.step)
        off = np.diff(self.edges, prepend=0.0) / 4
        inner = _between(
            self.joints,
            self.grades,
            self.step,
            np.concatenate([[0.0], self.edges[:-1]]) + off,
            self.edges - off,
        )
        return all(
            span.grade is None or 0 in span.grade or mean in span.grade or middle in span.grade
            for span, mean, middle in zip(row, means, inner, strict=True)
            if _is_fixed(span)
        )

    def inclines(self) -> list[Inclines]:
        """Lengths and inclines of every straight, the steps at its end included."""
        lengths, out = np.diff(self.joints, prepend=0.0), list[Inclines]()
        usual = _halves(self.joints, self.grades, inf)
        before = 0.0
        for i, (length, grade) in enumerate(zip(lengths.tolist(), self.grades.tolist(), strict=True)):
            after = self.step if i < len(usual) and usual[i] > self.step * HALF_OF_STEP else 0.0
            own = [(length - before - after / 2, grade)]
            if after:
                own.append((after, round(float(self.grades[i : i + 2].mean()), 1)))
            out.append(own)
            before = after / 2
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


def _settled(row: Sequence[Span], drawn: Sequence[float], limit: Range, step: float) -> _Row:
    """Lengths and inclines by which every straight is measured as it was drawn."""
    wanted = np.cumsum([span.length for span in row])
    joints, grades = wanted.copy(), np.array(drawn, dtype=float)
    movable = np.array([_is_fixed(one) or _is_fixed(other) for one, other in pairwise(row)])
    for _ in range(ROUNDS):
        edges = joints.copy()
        edges[:-1] += _shifts(joints, grades, step)
        means = _means(joints, grades, edges, step)
        for i, span in enumerate(row):
            if span.grade and _is_fixed(span) and 0 not in span.grade:
                grades[i] += min(max(means[i], span.grade.lo), span.grade.hi) - means[i]
                grades[i] = min(max(grades[i], span.grade.lo), span.grade.hi)
        grades = np.clip(grades, limit.lo, limit.hi)
        joints[:-1] += np.where(movable, wanted[:-1] - edges[:-1], 0.0)
        joints = _spread(joints)
    grades = np.round(grades, 1)
    edges = joints.copy()
    edges[:-1] += _shifts(joints, grades, step)
    return _Row(joints, grades, edges, step)


def _spread(joints: Array) -> Array:
    """Joints in order, none nearer to the next than SHORTEST, if there is room at all."""
    steps = SHORTEST * np.arange(1, len(joints) + 1)
    up = np.maximum.accumulate(np.maximum(joints - steps, 0.0)) + steps
    most = joints[-1] - SHORTEST * np.arange(len(joints) - 1, -1, -1)
    return np.asarray(np.where(most > steps - SHORTEST, np.minimum(up, most), joints))


def _halves(joints: Array, grades: Array, step: float) -> Array:
    """Half of what the change of grade takes at every inner joint, as ``road.grades`` makes it, or a step."""
    lengths = np.diff(joints, prepend=0.0)
    room = MOST_OF_SEGMENT * np.minimum(lengths[:-1], lengths[1:]) / 2
    usual = np.minimum(CREST_RADIUS * np.abs(np.diff(grades)) / 200, room)
    return np.asarray(np.minimum(usual, step * HALF_OF_STEP))


def _shifts(joints: Array, grades: Array, step: float) -> Array:
    """How far behind its joint the grade changes between climbing, level and falling; 0 where it does not."""
    classes = np.where(np.abs(grades) >= LEVEL, np.sign(grades), 0.0)
    before, after = grades[:-1], grades[1:]
    changes = classes[:-1] != classes[1:]
    edge = LEVEL * (classes[:-1] + classes[1:])  # 0 between climbing and falling
    share = (edge - before) / np.where(changes, after - before, 1.0)
    return np.asarray(np.where(changes, (2 * share - 1) * _halves(joints, grades, step), 0.0))


def _means(joints: Array, grades: Array, edges: Array, step: float) -> Array:
    """Percent, the mean grade of each straight between the places where it is measured to begin and end."""
    return _between(joints, grades, step, np.concatenate([[0.0], edges[:-1]]), edges)


def _between(joints: Array, grades: Array, step: float, first: Array, last: Array) -> Array:
    """Percent, mean grades from some places to others, metres."""
    halves = _halves(joints, grades, step)
    stations = np.sort(np.concatenate([[0.0], joints[:-1] - halves, joints[:-1] + halves, joints[-1:]]))
    values = np.repeat(grades, 2)
    s = np.arange(0.0, joints[-1] + STATION, STATION)
    heights = np.concatenate([[0.0], np.cumsum(np.interp(s[:-1] + STATION / 2, stations, values)) * STATION])
    rises = np.interp(last, s, heights) - np.interp(first, s, heights)
    return np.asarray(rises / np.maximum(last - first, STATION))
