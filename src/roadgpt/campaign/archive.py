"""The archive of a search: a map of what roads can be like, with the best road so far in every cell.

The best is the one that came nearest to failing. Cells are a grid along the chosen axes, or, where a grid of
many axes would be mostly empty, the neighbourhoods of centres spread evenly (CVT-MAP-Elites, Vassiliades,
Chatzilygeroudis, Mouret 2018). The maps are pyribs'; how many tests and failures fell into a cell is ours.
"""

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from roadgpt.campaign.behaviour import bounds_of
from roadgpt.geometry.curve import Array

NICHES_SEED = 0  # of the centres: they belong to the map, not to a search
SAMPLES = 20_000  # points from which centres are spread
ONLY = 1  # a road is kept as its number


class Archive:
    """Elites of a search, by cell."""

    def __init__(self, axes: Sequence[str], cells: int, kind: Literal["grid", "cvt"] = "grid") -> None:
        """An empty map.

        Args:
            axes: names of features.
            cells: of a grid, along each axis; of niches, altogether.
            kind: a grid, or niches.
        """
        from ribs.archives import CVTArchive, GridArchive

        self.axes = tuple(axes)
        ranges = [bounds_of(axis) for axis in axes]
        self._map: GridArchive | CVTArchive
        if kind == "grid":
            self._map = GridArchive(solution_dim=ONLY, dims=[cells] * len(ranges), ranges=ranges)
        else:
            self._map = CVTArchive(
                solution_dim=ONLY, centroids=cells, ranges=ranges, samples=SAMPLES, seed=NICHES_SEED
            )
        self.tests: Counter[int] = Counter()
        self.failures: Counter[int] = Counter()

    def add(self, number: int, features: Mapping[str, float], quality: float, failed: bool) -> None:
        """Takes in a test; one without all features of the map is left out.

        Args:
            number: of the test.
            features: of road and drive.
            quality: the larger the better; of equals the first is kept.
            failed: did the car leave its lane?
        """
        if any(axis not in features for axis in self.axes):
            return
        place = np.array([features[axis] for axis in self.axes])
        cell = int(self._map.index_of_single(place))
        self.tests[cell] += 1
        self.failures[cell] += failed
        self._map.add_single([float(number)], quality, place)

    def cells(self, places: Array) -> NDArray[np.intp]:
        """Cells ``(n,)`` of places ``(n, axes)``."""
        return np.asarray(self._map.index_of(places), np.intp)

    def elites(self) -> list[int]:
        """Numbers of the best tests of all cells, in order of cell."""
        found = self._map.data(["index", "solution"], return_type="dict")
        order = np.argsort(found["index"])
        return [int(number) for number in found["solution"][order, 0]]
