"""Chooses which candidate roads to drive, based on margins and map cells that a surrogate model predicts.

The search's goal decides how valuable a candidate is:

failures   the higher its predicted probability of failing, the more valuable; cells with few failures so
           far have a higher weight. Every fourth candidate explores: the square root of the probability
           counts, so that roads of a new kind are driven although they will probably pass
coverage   the fewer tests its predicted cell has, the more valuable
hardest    the smaller the mean of the predicted margins minus their standard deviation, the more valuable
boundary   as for failures, but the value peaks near a predicted probability of failing of 0.5
"""

from collections import Counter
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roadgpt.campaign.model import Goal
from roadgpt.design.variety import PlanShape, apart
from roadgpt.geometry.curve import Array

ANYWHERE = 0.008  # weight of a failure in a cell with many failures; a first failure weighs about 1
NOVELTY = 3  # where there are k failures, one more is worth 1 / (1 + k) to this power
EXPLORING = 4  # every so many-th candidate explores
DARING = 0.5  # power of the probability of failing for those that explore
LEAST_TREES = 0.5  # trees that are taken to predict a failure where none does


class Predictions(NamedTuple):
    """The surrogate's predictions for n candidates, as arrays ``(trees, n)`` with one row per tree."""

    margins: Array
    """Predicted margins, in metres; negative for a predicted failure."""
    cells: tuple[NDArray[np.intp], ...]
    """Predicted cell numbers of the candidates, one array for each map."""


def select(goal: Goal, n: int, expected: Predictions, counts: Sequence[Counter[int]]) -> list[int]:
    """Returns the indices of the n most valuable candidates for a goal, the most valuable first. ``counts``
    has one Counter per map: the failures (for the goal "coverage": the tests) so far in each cell."""
    weight = (expected.margins <= 0.0).astype(float) if goal != "coverage" else np.ones_like(expected.margins)
    maps: list[tuple[NDArray[np.intp], Array]] = []
    for cells, of_cells in zip(expected.cells, counts, strict=True):
        used, index = np.unique(cells, return_inverse=True)  # numbered anew, so that counts fit in an array
        maps.append((index.reshape(cells.shape), np.array([float(of_cells[int(cell)]) for cell in used])))
    is_left = np.ones(expected.margins.shape[1], bool)
    out: list[int] = []
    while len(out) < n and is_left.any():
        if goal == "hardest":
            value = expected.margins.std(axis=0) - expected.margins.mean(axis=0)
        else:
            floor = 0.0 if goal == "coverage" else ANYWHERE
            worth = sum(1 / (1 + known[cells]) ** NOVELTY for cells, known in maps) / len(maps)
            value = (weight * (floor + worth)).mean(axis=0)
            if goal == "failures" and len(out) % EXPLORING == EXPLORING - 1:
                chance = np.maximum(weight.mean(axis=0), LEAST_TREES / len(weight))
                value = chance**DARING * np.mean(worth, axis=0)
            if goal == "boundary":
                value *= 1 - weight.mean(axis=0)
        best = int(np.argmax(np.where(is_left, value, -np.inf)))
        out.append(best)
        for cells, known in maps:
            np.add.at(known, cells[:, best], weight[:, best] / len(weight))
        is_left[best] = False
    return out


def is_far(shape: PlanShape, known: PlanShape | None, least: float) -> bool:
    """Returns whether a shape is at least ``least`` metres RMS away from each of the shapes that
    ``stacked`` has combined into ``known``. Also returns True if ``known`` is None or ``least`` is 0.
    """
    return known is None or not least or float(apart(shape, known).min()) >= least


def stacked(shapes: Sequence[PlanShape]) -> PlanShape:
    """Stacks shapes into one PlanShape, whose arrays have the index of the shape as their first axis."""
    return PlanShape._make(np.stack(columns) for columns in zip(*shapes, strict=True))


def spread_out(features: Sequence[Array], n: int, hazard: Array) -> list[int]:
    """Returns the indices of up to n candidates with diverse features, chosen from the half of the
    candidates with the largest ``hazard``. Used until the surrogate has enough drives to learn from.
    """
    order = np.argsort(-hazard, kind="stable")[: max(n, (len(features) + 1) // 2)]
    signs = np.array([features[i] for i in order])
    if len(order) <= n:
        return [int(i) for i in order]
    signs = (signs - signs.mean(axis=0)) / np.maximum(signs.std(axis=0), 1e-9)
    chosen = [0]
    away = np.full(len(order), np.inf)
    while len(chosen) < n:
        away = np.minimum(away, ((signs - signs[chosen[-1]]) ** 2).sum(axis=1))
        chosen.append(int(away.argmax()))
    return [int(order[i]) for i in chosen]
