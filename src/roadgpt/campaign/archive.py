"""The archive of a search: a map of road features that holds the best test so far in each of its cells.

The best test is the one with the smallest margin. The cells are a grid along the chosen features
(MAP-Elites, Mouret and Clune 2015) or, where a grid over many features would be mostly empty, the
neighbourhoods of evenly spread centroids (CVT-MAP-Elites, Vassiliades, Chatzilygeroudis and Mouret 2018).
Cells and centroids equal those of pyribs' GridArchive and CVTArchive; the tests compare them.
"""

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Literal, Protocol

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


class _Map(Protocol):
    def cells(self, places: Array) -> Cells: ...


class Archive:
    """A map of features that keeps the best test of every cell, and counts tests and failures per cell."""

    def __init__(self, axes: Sequence[str], cells: int, kind: Literal["grid", "cvt"] = "grid") -> None:
        """Makes an empty archive.

        Args:
            axes: names of the features that span the map.
            cells: number of cells along each axis of a grid, or number of centroids.
            kind: "grid" or "cvt".
        """
        self.axes = tuple(axes)
        bounds = np.array([bounds_of(axis) for axis in axes])
        self._map: _Map = Grid(bounds, cells) if kind == "grid" else Niches(bounds, cells)
        self._best: dict[int, tuple[float, int]] = {}
        self.tests: Counter[int] = Counter()
        self.failures: Counter[int] = Counter()

    def add(self, number: int, features: Mapping[str, float], quality: float, failed: bool) -> None:
        """Adds a test; ignores a test that lacks one of the map's features.

        Args:
            number: number of the test.
            features: the features of the road and its drive, by name.
            quality: how good the test is; larger is better. Of equally good tests the first is kept.
            failed: whether the car left its lane.
        """
        place = np.array([features.get(axis, math.nan) for axis in self.axes])
        if not np.isfinite(place).all():
            return
        cell = int(self._map.cells(place[None])[0])
        self.tests[cell] += 1
        self.failures[cell] += failed
        if cell not in self._best or quality > self._best[cell][0]:
            self._best[cell] = (quality, number)

    def cells(self, places: Array) -> Cells:
        """Returns the cell numbers ``(n,)`` of points ``(n, axes)`` in feature space."""
        return self._map.cells(places)

    def elites(self) -> list[int]:
        """Returns the test number of the best test in each cell, in order of the cell numbers."""
        return [self._best[cell][1] for cell in sorted(self._best)]


class Grid:
    """A map with equally wide cells along each axis; a value out of range is counted in the outermost
    cell.
    """

    def __init__(self, bounds: Array, cells: int) -> None:
        """Takes the bounds ``(axes, 2)``, lower and upper, and the number of cells along each axis."""
        self._low, self._width = bounds[:, 0], bounds[:, 1] - bounds[:, 0]
        self._along = cells

    def cells(self, places: Array) -> Cells:
        """Returns the cell numbers ``(n,)`` of points ``(n, axes)``; the index along the last axis varies
        fastest.
        """
        steps = (self._along * (places - self._low) + EDGE) / self._width
        each = np.clip(steps, 0, self._along - 1).astype(np.intp)
        return np.asarray(each @ self._along ** np.arange(each.shape[1])[::-1], np.intp)


class Niches:
    """A map whose cells are the neighbourhoods of evenly spread centroids."""

    def __init__(self, bounds: Array, cells: int) -> None:
        """Takes the bounds ``(axes, 2)``, lower and upper, and the number of centroids."""
        samples = np.random.default_rng(NICHES_SEED).uniform(
            bounds[:, 0], bounds[:, 1], (SAMPLES, len(bounds))
        )
        self.centroids = centroids_of(samples, cells)
        self._tree = KDTree(self.centroids)

    def cells(self, places: Array) -> Cells:
        """Returns the index ``(n,)`` of the nearest centroid for each of the points ``(n, axes)``."""
        return np.asarray(self._tree.query(places)[1], np.intp)


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
