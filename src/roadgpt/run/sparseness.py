"""How much failures differ: the SBFT competition's sparseness.

Each failure is the road from 30 m before to 30 m after the place where the car left its lane, as a row of
steps (change of direction, length). Two rows differ by their weighted Levenshtein distance: leaving out or
adding a step costs 1, and exchanging steps costs (da / (1 + da) + dl / (1 + dl)) / 2 with da in degrees and
dl in metres, or nothing where da < 0.3 and dl < 0.2. Sparseness is the mean, over failures, of the distance
to the one that differs most. Source: the competition's tests_evaluation.py (2024), and the code it calls.
"""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roadgpt.road import Road

Array = NDArray[np.float64]

AROUND = 30.0  # m, before and after the place
EPS_DEGREES = 0.3
EPS_METRES = 0.2


def failure_segment(road: Road, s: float) -> Array:
    """Points ``(n, 2)`` of the centre line, one per metre, from 30 m before station ``s`` to 30 m after."""
    samples = road.sample()
    near = (np.abs(samples.s - s) <= AROUND) & (np.abs(samples.s - s) > EPS_METRES)
    stations = np.sort(np.r_[samples.s[near], np.clip(s, 0.0, road.length)])
    points: Array = road.at(stations)[:, :2]
    return points


def steps_of(points: ArrayLike) -> Array:
    """Steps ``(n - 1, 2)`` between points ``(n, 2)``: change of direction in degrees, length in metres."""
    move = np.diff(np.asarray(points, float), axis=0)
    direction = np.degrees(np.arctan2(move[:, 1], move[:, 0]))
    return np.stack([np.diff(direction, prepend=direction[:1]), np.hypot(*move.T)], axis=-1)


def distances(one: Array, others: list[Array]) -> Array:
    """Weighted Levenshtein distances ``(k,)`` from one row of steps to k others, all at once."""
    wide = max((len(other) for other in others), default=0)
    padded = np.full((len(others), wide, 2), 0.0)
    for row, other in zip(padded, others, strict=True):
        row[: len(other)] = other
    column = np.arange(wide + 1.0)
    dist = np.tile(column, (len(others), 1))
    for i, step in enumerate(one, 1):
        exchanged = dist[:, :-1] + _cost(step, padded)
        best = np.empty_like(dist)
        best[:, 0] = i
        best[:, 1:] = np.minimum(exchanged, dist[:, 1:] + 1)
        # adding steps costs 1 each: the least of all cells to the left, plus the way from there
        dist = np.minimum.accumulate(best - column, axis=1) + column
    return dist[np.arange(len(others)), [len(other) for other in others]]


def _cost(step: Array, others: Array) -> Array:
    turned = np.abs((step[0] - others[..., 0] + 180) % 360 - 180)
    longer = np.abs(step[1] - others[..., 1])
    cost = (turned / (1 + turned) + longer / (1 + longer)) / 2
    return np.where((turned < EPS_DEGREES) & (longer < EPS_METRES), 0.0, cost)


class Spread:
    """Sparseness that grows with every failure, without measuring old pairs again."""

    def __init__(self) -> None:
        self._rows: list[Array] = []
        self._furthest: Array = np.empty(0)

    def add(self, points: ArrayLike) -> None:
        """Take in the segment of one more failure, points ``(n, 2)``."""
        row = steps_of(points)
        if self._rows:
            apart = distances(row, self._rows)
            known = self._furthest if len(self._rows) > 1 else np.zeros(1)
            self._furthest = np.r_[np.maximum(known, apart), apart.max()]
        self._rows.append(row)

    @property
    def mean(self) -> float:
        """NaN for fewer than two failures, as the competition has it."""
        return float(self._furthest.mean()) if len(self._rows) > 1 else math.nan

    @property
    def deviation(self) -> float:
        """Standard deviation; NaN for fewer than two failures."""
        return float(self._furthest.std()) if len(self._rows) > 1 else math.nan
