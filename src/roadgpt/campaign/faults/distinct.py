"""Which failures are one and the same fault: clusters of the 60 m of road around the departure.

Two failures are alike where their lanes bend and climb alike from 30 m before the departure to 30 m after it,
lined up at the departure, give or take 8 m. Clusters are grown by complete linkage, so any two failures of
one cluster are alike; the number of clusters is the number of distinct failures.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.cluster.hierarchy import fcluster, linkage
from scipy.spatial.distance import squareform

from roadgpt.campaign.faults.why import lane_curvature
from roadgpt.road import Road, World

Array = NDArray[np.float64]

AROUND = 30.0  # m, the competition's, before and after the departure
STEP = 1.0  # m
SHIFT = 8  # steps that two profiles may be moved against each other
SMOOTHING = 5  # steps, half-width of the Hann window over them: a car is about so long
ALIKE = 1.0  # distance up to which two failures are one fault
BEND = 0.012  # 1/m, root mean square: so different bends count 1 (R 15 m against R 18 m all along)
GRADE = 0.04  # ratio, likewise
COUNT = round(AROUND / STEP)


@dataclass(frozen=True, eq=False)
class Surroundings:
    """How the lane runs around a departure; columns of one length, every metre."""

    bends: Array
    """1/m, smoothed, with ``SHIFT`` steps more at either end; NaN beyond the road."""
    grades: Array
    """Ratios, likewise."""
    kind: str
    """Side and cause: failures of another kind are another fault."""


def surroundings(road: Road, world: World, station: float, kind: str) -> Surroundings:
    """Of a departure at a station, in metres; ``kind`` says side and cause."""
    reach = COUNT + SHIFT + SMOOTHING
    s = station + STEP * np.arange(-reach, reach + 1)
    on = (s >= 0) & (s <= road.length)
    held = np.clip(s, 0.0, road.length)
    bends, grades = np.where(on, lane_curvature(road, world, held), 0.0), road.grade(held)
    inner = on[SMOOTHING:-SMOOTHING]
    return Surroundings(
        np.where(inner, _smoothed(bends), np.nan), np.where(inner, _smoothed(grades), np.nan), kind
    )


def _smoothed(values: Array) -> Array:
    window = np.hanning(2 * SMOOTHING + 3)[1:-1]
    return np.convolve(values, window / window.sum(), mode="valid")


def distances(one: Surroundings, others: Sequence[Surroundings]) -> Array:
    """How far a failure is from others, shape ``(n,)``: 1 where bends or grades differ by their measure.

    Road that only one of the two has counts as straight and level against the other's. Infinite for failures
    of different kinds. The same both ways round.
    """
    if not others:
        return np.empty(0)
    bends, grades = np.stack([o.bends for o in others]), np.stack([o.grades for o in others])
    least = np.full(len(others), np.inf)
    for shift in range(-SHIFT, SHIFT + 1):
        # each takes half of the shift, so that neither of the two is the one that is moved
        first, second = shift // 2, shift // 2 - shift
        apart = _apart(one.bends, bends, first, second) / BEND**2
        apart += _apart(one.grades, grades, first, second) / GRADE**2
        least = np.minimum(least, np.sqrt(apart))
    return np.where([o.kind == one.kind for o in others], least, np.inf)


def _apart(one: Array, others: Array, first: int, second: int) -> Array:
    """Mean square of the difference along the stretch that at least one of the two has."""
    length = len(one) - 2 * SHIFT
    a = one[SHIFT + first : SHIFT + first + length]
    b = others[:, SHIFT + second : SHIFT + second + length]
    known = ~(np.isnan(a) & np.isnan(b))
    gap = np.where(known, np.nan_to_num(a) - np.nan_to_num(b), 0.0)
    return np.asarray((gap**2).sum(axis=1) / known.sum(axis=1))


def faults_of(failures: Sequence[Surroundings], alike: float = ALIKE) -> list[int]:
    """The fault that each failure belongs to, from 0, numbered in order of their first failure."""
    if len(failures) < 2:
        return [0] * len(failures)
    apart = np.zeros((len(failures), len(failures)))
    far = 1e6  # stands for infinity, which linkage does not take
    for i, one in enumerate(failures):
        apart[i, :i] = apart[:i, i] = np.minimum(distances(one, failures[:i]), far)
    grown = fcluster(linkage(squareform(apart), "complete"), alike, "distance")
    numbers: dict[int, int] = {}
    return [numbers.setdefault(int(cluster), len(numbers)) for cluster in grown]
