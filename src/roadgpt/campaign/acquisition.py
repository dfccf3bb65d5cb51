"""Chooses which candidate roads to drive, based on margins and map cells that a surrogate model predicts.

The search's goal decides how valuable a candidate is:

failures   the higher its predicted probability of failing, the more valuable; cells with few failures so
           far have a higher weight
coverage   the fewer tests its predicted cell has, the more valuable
hardest    the smaller the mean of the predicted margins minus their spread, the more valuable
"""

from collections import Counter
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roadgpt.campaign.model import Goal
from roadgpt.campaign.variation import Candidate
from roadgpt.design.variety import PlanShape, apart
from roadgpt.geometry.curve import Array

ANYWHERE = 0.05  # weight of a failure in a cell with many failures; a first failure weighs about 1


class Predictions(NamedTuple):
    """The surrogate's predictions for n candidates, as arrays ``(trees, n)`` with one row per tree."""

    margins: Array
    """Predicted margins, in metres; negative for a predicted failure."""
    cells: NDArray[np.intp]
    """Predicted cell numbers of the candidates on the feature map."""


def select(
    goal: Goal,
    n: int,
    candidates: Sequence[Candidate],
    expected: Predictions,
    counts: Counter[int],
    least: float,
) -> list[Candidate]:
    """Returns the candidates to drive, the most valuable first. Similar roads are skipped, see ``least``.

    Args:
        goal: what the search looks for.
        n: largest number of candidates to return.
        candidates: the candidate roads to choose from.
        expected: the surrogate's predictions for the candidates.
        counts: number of failures so far in each cell; for the goal "coverage", number of tests.
        least: smallest allowed distance between the shapes of two chosen roads, metres RMS.
    """
    used, index = np.unique(expected.cells, return_inverse=True)
    cells = index.reshape(expected.cells.shape)
    known = np.array([float(counts[int(cell)]) for cell in used])
    weight = (expected.margins <= 0.0).astype(float) if goal != "coverage" else np.ones_like(expected.margins)
    is_left = np.ones(len(candidates), bool)
    out: list[Candidate] = []
    while len(out) < n and is_left.any():
        if goal == "hardest":
            value = expected.margins.std(axis=0) - expected.margins.mean(axis=0)
        else:
            floor = 0.0 if goal == "coverage" else ANYWHERE
            value = (weight * (floor + 1 / (1 + known[cells]))).mean(axis=0)
        best = int(np.argmax(np.where(is_left, value, -np.inf)))
        out.append(candidates[best])
        np.add.at(known, cells[:, best], weight[:, best] / len(weight))
        is_left[best] = False
        is_left &= far_from(candidates, candidates[best].shape, least)
    return out


def far_from(candidates: Sequence[Candidate], shape: PlanShape, least: float) -> NDArray[np.bool_]:
    """Returns a mask ``(n,)``: True for each candidate whose shape is at least ``least`` metres RMS away from
    the given shape.
    """
    if not least or not candidates:
        return np.ones(len(candidates), bool)
    return np.asarray(apart(shape, stacked([one.shape for one in candidates])) >= least)


def dissimilar(candidates: Sequence[Candidate], known: Sequence[PlanShape], least: float) -> list[Candidate]:
    """Returns the candidates whose shape is at least ``least`` metres RMS away from every known shape."""
    if not known or not least:
        return list(candidates)
    others = stacked(known)
    return [one for one in candidates if apart(one.shape, others).min() >= least]


def stacked(shapes: Sequence[PlanShape]) -> PlanShape:
    """Stacks several shapes into one PlanShape; each of its arrays gets a new first axis, the index of the
    shape.
    """
    return PlanShape._make(np.stack(columns) for columns in zip(*shapes, strict=True))


def spread_out(candidates: Sequence[Candidate], n: int, hazard: Array) -> list[Candidate]:
    """Chooses candidates as long as the surrogate has too few drives to learn from.

    The chosen roads are among the half of the candidates that looks hardest, and their features are diverse.

    Args:
        candidates: the roads to choose from.
        n: number of candidates to choose.
        hazard: one number per candidate; the larger, the harder the road looks.
    """
    order = np.argsort(-hazard, kind="stable")[: max(n, (len(candidates) + 1) // 2)]
    signs = np.array([candidates[i].surrogate_features for i in order])
    if len(order) <= n:
        return [candidates[i] for i in order]
    signs = (signs - signs.mean(axis=0)) / np.maximum(signs.std(axis=0), 1e-9)
    chosen = [0]
    away = np.full(len(order), np.inf)
    while len(chosen) < n:
        away = np.minimum(away, ((signs - signs[chosen[-1]]) ** 2).sum(axis=1))
        chosen.append(int(away.argmax()))
    return [candidates[order[i]] for i in chosen]
