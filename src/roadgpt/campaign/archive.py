"""The archive of a search: a map of road features that holds the best test so far in each of its cells.

The best test is the one with the smallest margin. The cells are a grid along the chosen features
(MAP-Elites, Mouret and Clune 2015) or, where a grid over many features would be mostly empty, the
neighbourhoods of evenly spread centroids (CVT-MAP-Elites, Vassiliades, Chatzilygeroudis and Mouret 2018).
Cells and centroids equal those of pyribs' GridArchive and CVTArchive; the tests compare them.
"""

import math
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from roadgpt.campaign.behaviour import bounds_of
from roadgpt.geometry.curve import Array

NICHES_SEED = 0  # of the centroids: they belong to the map, not to a search
SAMPLES = 20_000  # random points on the map; the centroids are the centres of their clusters
MOST_ROUNDS = 300  # of k-means
SETTLED = 1e-4  # of the samples' variance: k-means ends when the squared moves of all centroids sum to less
EDGE = 1e-6  # added to a feature times the number of cells, so that rounding puts no edge into the cell below

Cells = NDArray[np.intp]
CellsOf = Callable[[Array], Cells]
"""Returns the cell numbers ``(n,)`` of points ``(n, axes)`` in feature space."""


class Archive:
    """A map of features that keeps the best test of every cell, and counts tests and failures per cell."""

    def __init__(self, axes: Sequence[str], cells: int, kind: Literal["grid", "cvt"] = "grid") -> None:
        """Makes an empty archive of the features ``axes``; ``cells`` is the number of cells along each axis
        of a grid, or the number of centroids."""
        self.axes = tuple(axes)
        bounds = np.array([bounds_of(axis) for axis in axes])
        self.cells: CellsOf = grid(bounds, cells) if kind == "grid" else niches(bounds, cells)
        self._best: dict[int, tuple[float, int]] = {}
        self.tests: Counter[int] = Counter()
        self.failures: Counter[int] = Counter()

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


def grid(bounds: Array, along: int) -> CellsOf:
    """Returns a map with ``along`` equally wide cells along each axis, between the lower and upper ``bounds``
    ``(axes, 2)``. Values beyond the bounds belong to the outermost cells. The cell numbers vary fastest along
    the last axis."""
    low, width = bounds[:, 0], bounds[:, 1] - bounds[:, 0]

    def cells_of(places: Array) -> Cells:
        each = np.clip((along * (places - low) + EDGE) / width, 0, along - 1).astype(np.intp)
        return np.asarray(np.ravel_multi_index(tuple(each.T), (along,) * len(bounds)), np.intp)

    return cells_of


def niches(bounds: Array, count: int) -> CellsOf:
    """Returns a map whose cells are the neighbourhoods of ``count`` evenly spread centroids."""
    rng = np.random.default_rng(NICHES_SEED)
    samples = rng.uniform(bounds[:, 0], bounds[:, 1], (SAMPLES, len(bounds)))
    tree = KDTree(centroids_of(samples, count))
    return lambda places: np.asarray(tree.query(places)[1], np.intp)


def centroids_of(samples: Array, count: int) -> Array:
    """Computes ``count`` centroids ``(count, axes)`` of samples ``(n, axes)`` with Lloyd's k-means algorithm.

    Initialisation and stopping rule are those of scikit-learn's ``k_means`` with ``init="random"``, which
    pyribs uses. The cells of an archive are therefore the same as in earlier versions of RoadGPT, which used
    pyribs.
    """
    middle = samples.mean(axis=0)
    points = samples - middle
    weights = np.full(len(points), 1.0) / len(points)
    drawn = np.random.RandomState(NICHES_SEED).choice(len(points), count, replace=False, p=weights)
    centroids, nearest = points[drawn], np.full(len(points), -1)
    least = SETTLED * points.var(axis=0).mean()
    for _ in range(MOST_ROUNDS):
        before, nearest = nearest, np.asarray(KDTree(centroids).query(points)[1])
        members = np.bincount(nearest, minlength=count)
        sums = [np.bincount(nearest, column, count) for column in points.T]
        moved = np.where(
            members[:, None] > 0, np.stack(sums, -1) / np.maximum(members, 1)[:, None], centroids
        )
        shift, centroids = ((moved - centroids) ** 2).sum(), moved
        if np.array_equal(nearest, before) or shift <= least:
            break
    return np.asarray(centroids + middle)
