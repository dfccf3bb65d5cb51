"""The archive of a search, and the choice of roads to drive by it.

An archive is a map of road features that holds the test with the smallest margin so far in each of its cells.
The cells are a grid along the chosen features (MAP-Elites, Mouret and Clune 2015), and equal those of pyribs'
GridArchive; the tests compare them.

The search's goal decides how valuable a candidate is, by the margins and cells that a surrogate predicts:

failures   the higher its predicted probability of failing, the more valuable; cells with few failures so
           far have a higher weight. Every fourth candidate explores: the square root of the probability
           counts, so that roads of a new kind are driven although they will probably pass
coverage   the fewer tests its predicted cell has, the more valuable
hardest    the smaller the mean of the predicted margins minus their standard deviation, the more valuable
boundary   as for failures, but the value peaks near a predicted probability of failing of 0.5
"""

import math
from collections import Counter
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from roadgpt.campaign.model import Goal
from roadgpt.design.variety import PlanShape, apart
from roadgpt.geometry.curve import Array
from roadgpt_search.behaviour import bounds_of

EDGE = 1e-6  # added to a feature times the number of cells, so that rounding puts no edge into the cell below

Cells = NDArray[np.intp]


class Archive:
    """A map of features that keeps the best test of every cell, and counts tests and failures per cell."""

    def __init__(self, axes: Sequence[str], along: int) -> None:
        """Makes an empty archive of the features ``axes``, with ``along`` equally wide cells along each."""
        self.axes, self._along = tuple(axes), along
        self._bounds = np.array([bounds_of(axis) for axis in axes])
        self._best: dict[int, tuple[float, int]] = {}
        self.tests: Counter[int] = Counter()
        self.failures: Counter[int] = Counter()

    def cells(self, places: Array) -> Cells:
        """Returns the cell numbers ``(n,)`` of points ``(n, axes)``, also beyond the map; they vary fastest
        along the last axis."""
        low, width = self._bounds[:, 0], self._bounds[:, 1] - self._bounds[:, 0]
        each = np.clip((self._along * (places - low) + EDGE) / width, 0, self._along - 1).astype(np.intp)
        return np.asarray(np.ravel_multi_index(tuple(each.T), (self._along,) * len(self.axes)), np.intp)

    def add(self, number: int, features: Mapping[str, float], quality: float, failed: bool) -> None:
        """Adds a test; ignores a test that lacks one of the map's features. The larger ``quality``, the
        better the test; of equally good tests the first is kept."""
        place = np.array([features.get(axis, math.nan) for axis in self.axes])
        if not np.isfinite(place).all():
            return
        cell = int(self.cells(place[None])[0])
        self.tests[cell] += 1
        self.failures[cell] += failed
        if cell not in self._best or quality > self._best[cell][0]:
            self._best[cell] = (quality, number)

    def elites(self) -> list[int]:
        """Returns the test number of the best test in each cell, in order of the cell numbers."""
        return [self._best[cell][1] for cell in sorted(self._best)]


ANYWHERE = 0.008  # weight of a failure in a cell with many failures; a first failure weighs about 1
NOVELTY = 3  # where there are k failures, one more is worth 1 / (1 + k) to this power
EXPLORING = 4  # every so many-th candidate explores
DARING = 0.5  # power of the probability of failing for those that explore
LEAST_TREES = 0.5  # trees that are taken to predict a failure where none does


def select(
    goal: Goal, n: int, margins: Array, places: Sequence[Cells], counts: Sequence[Counter[int]]
) -> list[int]:
    """Returns the indices of the n most valuable candidates for a goal, the most valuable first.

    Each tree of the surrogate predicts their ``margins``, metres, negative for a failure, and their cells in
    each map, ``places``; both have the shape ``(trees, candidates)``. ``counts`` has one Counter per map: the
    failures (for the goal "coverage": the tests) so far in each cell.
    """
    weight = (margins <= 0.0).astype(float) if goal != "coverage" else np.ones_like(margins)
    maps: list[tuple[Cells, Array]] = []
    for cells, of_cells in zip(places, counts, strict=True):
        used, index = np.unique(cells, return_inverse=True)  # numbered anew, so that counts fit in an array
        maps.append((index.reshape(cells.shape), np.array([float(of_cells[int(cell)]) for cell in used])))
    is_left = np.ones(margins.shape[1], bool)
    out: list[int] = []
    while len(out) < n and is_left.any():
        if goal == "hardest":
            value = margins.std(axis=0) - margins.mean(axis=0)
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
    """Returns whether a shape is at least ``least`` metres RMS away from each of the ``stacked`` shapes
    ``known``."""
    return known is None or not least or float(apart(shape, known).min()) >= least


def stacked(shapes: Sequence[PlanShape]) -> PlanShape:
    """Stacks shapes into one PlanShape, whose arrays have the index of the shape as their first axis."""
    return PlanShape._make(np.stack(columns) for columns in zip(*shapes, strict=True))


def spread_out(features: Sequence[Array], n: int, hazard: Array) -> list[int]:
    """Returns the indices of up to n candidates with diverse features, from the half with the largest
    ``hazard``; for as long as the surrogate has too few drives to learn from."""
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
