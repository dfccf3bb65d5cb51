"""The choice of candidates to drive: each goal values them by what the surrogate's trees predict.

failures   a predicted failure counts, the first ones of a cell most
coverage   a test counts less, the more tests its cell has
hardest    the smallest margin that is still likely counts most
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

ANYWHERE = 0.05  # of a first failure in a cell: what one in a cell with many counts


class Predictions(NamedTuple):
    """The predictions of each tree for candidates; both arrays are ``(trees, n)``."""

    margins: Array
    """Metres."""
    cells: NDArray[np.intp]
    """Cells of the map."""


def select(
    goal: Goal,
    n: int,
    candidates: Sequence[Candidate],
    expected: Predictions,
    counts: Counter[int],
    least: float,
) -> list[Candidate]:
    """Returns the candidates to be driven, the most valuable first, with no two alike.

    Args:
        goal: what the search looks for.
        n: number of candidates, at most.
        candidates: to choose from.
        expected: the predictions for them.
        counts: failures by cell so far; for the goal "coverage", tests by cell.
        least: metres RMS that the chosen roads keep from each other.
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
    """Returns which candidates ``(n,)`` are at least so many metres RMS from a shape."""
    if not least or not candidates:
        return np.ones(len(candidates), bool)
    return np.asarray(apart(shape, stacked([one.shape for one in candidates])) >= least)


def dissimilar(candidates: Sequence[Candidate], known: Sequence[PlanShape], least: float) -> list[Candidate]:
    """Returns the candidates that are at least so many metres RMS from every known road."""
    if not known or not least:
        return list(candidates)
    others = stacked(known)
    return [one for one in candidates if apart(one.shape, others).min() >= least]


def stacked(shapes: Sequence[PlanShape]) -> PlanShape:
    """Combines shapes into one PlanShape whose arrays have a first axis more."""
    return PlanShape._make(np.stack(columns) for columns in zip(*shapes, strict=True))


def spread_out(candidates: Sequence[Candidate], n: int, hazard: Array) -> list[Candidate]:
    """Chooses candidates before anything is known: far apart in their features, among those that look hard.

    Args:
        candidates: to choose from.
        n: number of candidates.
        hazard: of each candidate; the larger, the harder the road looks.
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
