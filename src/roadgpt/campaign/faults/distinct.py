"""Groups failures by the similarity of the 60 m of road around each lane departure.

Two failures are alike if their lanes have similar curvature and grade from 30 m before the departure to 30 m
after it. The lanes are aligned at the departures; the comparison allows a shift of up to 8 m. Clusters grow
by complete linkage, so any two failures of one cluster are alike; ``groups_of`` describes an exception for
more than 1000 failures. Each cluster is a group of similar failures; several groups may be one fault, see
``told_apart``.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.cluster.hierarchy import fcluster, linkage
from scipy.spatial.distance import cdist, squareform

from roadgpt.campaign.faults.reason import lane_curvature
from roadgpt.geometry.curve import Array
from roadgpt.road import Road, World

AROUND = 30.0  # m, the competition's, before and after the departure
STEP = 1.0  # m
SHIFT = 8  # steps that two profiles may be moved against each other
SMOOTHING = 5  # steps, half-width of the Hann window that smooths profiles: about the length of a car
ALIKE = 1.0  # distance up to which two failures belong to one group
BEND = 0.012  # 1/m, RMS difference in curvature that counts 1 (R 15 m against R 18 m all along)
GRADE = 0.04  # RMS difference in grade, as a ratio, that counts 1
COUNT = round(AROUND / STEP)
MOST = 1000  # failures clustered at a time; comparing all pairs takes 1 s and memory for a million numbers


@dataclass(frozen=True, eq=False)
class Surroundings:
    """The lane around a departure, sampled every metre."""

    bends: Array
    """Smoothed curvature of the lane, 1/m; NaN beyond the ends of the road. The array extends ``SHIFT``
    values beyond the compared part at either end."""
    grades: Array
    """Smoothed grade as a ratio, at the same stations; NaN beyond the ends of the road."""
    kind: str
    """Cause and side of the failure, driver, simulator and world as text; a group has one kind."""


def surroundings(road: Road, world: World, station: float, kind: str) -> Surroundings:
    """Returns the lane around a departure at ``station``, metres along the road."""
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


def between(some: Sequence[Surroundings], others: Sequence[Surroundings]) -> Array:
    """Returns the distances, ``(len(some), len(others))``, between the failures of two lists.

    A distance of 1 is an RMS difference of ``BEND`` in curvature, or of ``GRADE`` in grade; the distance is
    the root of the sum of both squares. Beyond its ends, a road counts as straight and level. If two failures
    differ in ``kind``, their distance is infinite. Distances are symmetric.
    """
    least = np.full((len(some), len(others)), np.inf)
    if not least.size:
        return least
    one, other = _stacked(some), _stacked(others)
    count = one.shape[-1] - 2 * SHIFT
    for shift in range(-SHIFT, SHIFT + 1):
        # each profile is moved by half of the shift, so that distances are symmetric
        starts = SHIFT + shift // 2, SHIFT + shift // 2 - shift
        (bends, grades, beyond), (bends_, grades_, beyond_) = (
            each[..., start : start + count] for each, start in zip((one, other), starts, strict=True)
        )
        apart = (
            cdist(bends, bends_, "sqeuclidean") / BEND**2 + cdist(grades, grades_, "sqeuclidean") / GRADE**2
        )
        # averaged over the stations at which at least one of the two roads exists
        np.minimum(least, apart / (count - beyond @ beyond_.T), out=least)
    kinds, their_kinds = (np.array([each.kind for each in them], object) for them in (some, others))
    alike = np.equal.outer(kinds, their_kinds)
    return np.where(alike, np.sqrt(least), np.inf)


def _stacked(them: Sequence[Surroundings]) -> Array:
    """Returns an array ``(3, n, stations)``: the bends and the grades, both 0 beyond the ends of a road, and
    1 where there is no road."""
    bends, grades = np.stack([each.bends for each in them]), np.stack([each.grades for each in them])
    return np.stack([np.nan_to_num(bends), np.nan_to_num(grades), np.isnan(bends)])


def groups_of(failures: Sequence[Surroundings], alike: float = ALIKE, most: int = MOST) -> list[int]:
    """Returns for each failure the number of its group; groups are numbered from 0 by their first failure.

    Args:
        failures: all failures to group.
        alike: largest distance between two failures of the same group.
        most: largest number of failures to cluster at a time, because clustering compares every pair of them.
            Each later failure joins the group whose most typical failure is nearest, if the distance is at
            most ``alike``. The failures that join no group are clustered next.
    """
    found, left, count = np.full(len(failures), -1), np.arange(len(failures)), 0
    while len(left):
        now, left = left[:most], left[most:]
        some = [failures[i] for i in now]
        grown = _grown(some, alike)
        found[now] = grown + count
        middles = []
        for cluster in range(grown.max() + 1) if len(left) else ():
            members = [each for each, own in zip(some, grown, strict=True) if own == cluster]
            middles.append(members[typical(members)[0]])
        for start in range(0, len(left), most):
            block = left[start : start + most]
            apart = between([failures[i] for i in block], middles)
            near = apart.min(axis=1) <= alike
            found[block[near]] = apart.argmin(axis=1)[near] + count
        left = left[found[left] < 0]
        count += int(grown.max()) + 1
    numbers: dict[int, int] = {}
    return [numbers.setdefault(int(cluster), len(numbers)) for cluster in found]


def _grown(some: Sequence[Surroundings], alike: float) -> NDArray[np.intp]:
    """Returns the cluster of each failure, by complete linkage; clusters are numbered from 0."""
    if len(some) < 2:
        return np.zeros(len(some), int)
    far = 1e6  # stands for infinity, which linkage does not take
    apart = np.minimum(between(some, some), far)
    apart = (apart + apart.T) / 2
    np.fill_diagonal(apart, 0.0)
    return np.asarray(fcluster(linkage(squareform(apart), "complete"), alike, "distance"), np.intp) - 1


def typical(members: Sequence[Surroundings]) -> list[int]:
    """Returns the indices of the failures of one group, the most typical one first.

    The most typical failure has the smallest sum of squared distances to the others. Of more than 1000
    failures, only the first 1000 are compared and returned.
    """
    some = members[:MOST]
    squares = between(some, some) ** 2
    return [int(i) for i in np.argsort(np.round(squares.sum(axis=1), 9), kind="stable")]
