"""Measures how much two lines differ, as the SBFT competition does.

A line is a sequence of steps (change of direction, length). The difference between two lines is the weighted
Levenshtein distance between their sequences: deleting or inserting a step costs 1, and substituting a step
costs (da / (1 + da) + dl / (1 + dl)) / 2, where da (degrees) and dl (metres) are the differences between the
two steps. Substitution costs nothing if da < 0.3 and dl < 0.2.

Source: the competition's tests_evaluation.py (2024), and the code it calls.
"""

import numpy as np
from numpy.typing import ArrayLike

from roadgpt.geometry.curve import Array

EPS_DEGREES = 0.3
EPS_METRES = 0.2


def steps_of(points: ArrayLike) -> Array:
    """Returns steps ``(n - 1, 2)`` between points ``(n, 2)``: turn in degrees, length in metres."""
    move = np.diff(np.asarray(points, float), axis=0)
    direction = np.degrees(np.arctan2(move[:, 1], move[:, 0]))
    return np.stack([np.diff(direction, prepend=direction[:1]), np.hypot(*move.T)], axis=-1)


def distances(one: Array, others: list[Array]) -> Array:
    """Returns weighted Levenshtein distances ``(k,)`` from one sequence of steps to k others, all at once."""
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
        # inserting steps costs 1 each: the least value of any cell to the left plus its distance
        dist = np.minimum.accumulate(best - column, axis=1) + column
    return dist[np.arange(len(others)), [len(other) for other in others]]


def _cost(step: Array, others: Array) -> Array:
    turned = np.abs((step[0] - others[..., 0] + 180) % 360 - 180)
    longer = np.abs(step[1] - others[..., 1])
    cost = (turned / (1 + turned) + longer / (1 + longer)) / 2
    return np.where((turned < EPS_DEGREES) & (longer < EPS_METRES), 0.0, cost)
