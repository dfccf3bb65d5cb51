"""Finds where cars left their lane and measures how much the failures differ, as the SBFT competition does.

Each failure is represented by the road from 30 m before to 30 m after the place where the car left its lane.
The difference between two failures is that of these lines, see ``roadgpt.run.step_distance``.

Source: the competition's tests_evaluation.py (2024), and the code it calls. Its peculiarities are kept, so
that the competition's tools give the same figures for RoadGPT's files:

* sparseness is the mean, over failures, of the largest distance to any failure of a *later* test; the last
  failure has no such distance and is left out;
* a failure whose segment cannot be cut out (its road has fewer than four control points, or the car left its
  lane at the very start) counts as a failure to the right, and is left out of sparseness;
* the interpolated road is interpolated once more, so the 30 m are accurate only to 1 m.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roadgpt.errors import UsageError
from roadgpt.geometry import interpolate
from roadgpt.run import execution, step_distance

Array = NDArray[np.float64]

AROUND = 30.0  # m, before and after the place
LEFT = 2.0  # m, half a lane; a car nearer to the centre line than this left its lane to the left
NODE = 0.55  # m from a node of the road: half the distance between nodes, and a margin for rounding
SAME = 0.01  # m; a node this close to the start of a segment is that start
FEWEST_POINTS = 4  # of a road, for the spline to be a cubic one
DECIMALS = 4  # of the road that is interpolated once more


class Departure(NamedTuple):
    """The place where a car left its lane."""

    side: str  # the side on which the car left its lane: "left" or "right"
    number: int  # index of the first record in which the car was outside its lane
    first: int = 0  # index of the record in which the car entered the segment
    before: Array | None = None
    """The road from the start of the segment to the place where the car left its lane, points ``(n, 2)``;
    None if it cannot be cut out of the road."""
    after: Array | None = None
    """The road from the place where the car left its lane to the end of the segment, points ``(m, 2)``;
    None if it cannot be cut out of the road."""

    @property
    def segment(self) -> Array | None:
        """The whole segment: ``before`` and ``after``, joined; None if they cannot be cut out of the road."""
        return (
            None if self.before is None or self.after is None else np.concatenate((self.before, self.after))
        )


def departure(
    points: ArrayLike,
    records: Sequence[execution.ExecutionRecord],
    before: float = AROUND,
    after: float = AROUND,
) -> Departure | None:
    """Returns where the car left its lane in a failed test, as the competition's analysis finds it, from
    control points of the road, metres, and the execution data; ``before`` and ``after`` are metres of road
    around the place. None if the car did not leave its lane."""
    number = next((i for i, record in enumerate(records) if record.is_oob), None)
    if number is None:
        return None
    unknown = Departure("right", number)
    line, place = _interpolated(points), records[number].pos[:2]
    found = None if line is None else _cut_out(line, place, before, after)
    if line is None or found is None:
        return unknown
    first = _first_record(line, found[0][0], records)
    if first >= number:
        return unknown
    side = "left" if _foot(line, place)[1] < LEFT else "right"
    return Departure(side, number, first, *found)


def _interpolated(points: ArrayLike) -> Array | None:
    plan = np.asarray(points, float)[:, :2]
    if len(plan) < FEWEST_POINTS:
        return None
    try:
        return interpolate(plan, fewest=1, decimals=DECIMALS)
    except UsageError:
        return None


def _cut_out(line: Array, place: Sequence[float], before: float, after: float) -> tuple[Array, Array] | None:
    """Returns ``before`` metres of a line up to its point nearest to a place and ``after`` metres behind it,
    or less where the line ends; None if they cannot be cut out."""
    near, _ = _foot(line, place)
    nodes = np.flatnonzero(np.hypot(*(line - near).T) < NODE)
    if not nodes.size or not nodes[-1]:
        return None
    behind = _first_metres(np.concatenate((line[: nodes[-1]], [near]))[::-1], before)[::-1]
    ahead = _first_metres(line[nodes[-1] :], after) if nodes[-1] < len(line) - 1 else line[:0]
    return None if len(behind) < 2 or len(ahead) == 1 else (behind, ahead)


def _first_metres(line: Array, metres: float) -> Array:
    walked = np.cumsum(np.hypot(*np.diff(line, axis=0).T))
    return line[: 1 + int((walked < metres).sum())]


def _foot(line: Array, place: Sequence[float]) -> tuple[Array, float]:
    start, way = line[:-1], np.diff(line, axis=0)
    square = np.maximum((way**2).sum(axis=1), 1e-12)
    share = np.clip(((place - start) * way).sum(axis=1) / square, 0, 1)
    feet = start + share[:, None] * way
    away = np.hypot(*(feet - place).T)
    nearest = int(away.argmin())
    return feet[nearest], float(away[nearest])


def _first_record(line: Array, start: Array, records: Sequence[execution.ExecutionRecord]) -> int:
    """Returns the index of the first record next to a segment's start; 0 if there is none."""
    for number, record in enumerate(records):
        foot, _ = _foot(line, record.pos[:2])
        close = np.flatnonzero(np.hypot(*(line - foot).T) < NODE)
        at = line[close[0]] if close.size else foot
        if np.hypot(*(at - start)) < SAME:
            return number
    return 0


class Sparseness:
    """The sparseness of failures, updated with each new failure. Distances between earlier failures are
    not computed again."""

    def __init__(self) -> None:
        self._rows: dict[tuple[int, int], Array] = {}
        self._furthest: dict[tuple[int, int], float] = {}

    def add(self, number: int, points: ArrayLike) -> None:
        """Adds a failure: the number of its test, and the points ``(n, 2)`` of its road segment in metres."""
        row = step_distance.steps_of(points)
        apart = step_distance.distances(row, [*self._rows.values()]).tolist()
        key = (number, len(self._rows))
        for other, distance in zip(self._rows, apart, strict=True):
            first = min(key, other)
            self._furthest[first] = max(self._furthest.get(first, 0.0), distance)
        self._rows[key] = row

    @property
    def mean(self) -> float:
        """Mean sparseness; NaN for fewer than two failures, as in the competition's code."""
        return float(np.mean([*self._furthest.values()])) if self._furthest else math.nan

    @property
    def deviation(self) -> float:
        """Standard deviation of the sparseness; NaN for fewer than two failures."""
        return float(np.std([*self._furthest.values()])) if self._furthest else math.nan
