"""Finds the stored failures of a campaign or of runs, and groups them by the similarity of the 60 m of road
around each lane departure; no road is driven.

Two failures are alike if their lanes have similar curvature and grade from 30 m before the departure to 30 m
after it. The lanes are aligned at the departures; the comparison allows a shift of up to 8 m. Clusters grow
by complete linkage, so any two failures of one cluster are alike; ``groups_of`` describes an exception for
more than 1000 failures. Each cluster is a group of similar failures; several groups may be one fault, see
``remedy``.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.cluster.hierarchy import fcluster, linkage
from scipy.spatial.distance import cdist, squareform

from roadgpt.campaign.faults.reason import Manner, lane_curvature, manner_of
from roadgpt.campaign.folder_record import open_record
from roadgpt.campaign.model import NumberedTest
from roadgpt.campaign.record import Record
from roadgpt.errors import RoadGPTError
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
    grades: Array  # smoothed grade as a ratio, at the same stations; NaN beyond the ends of the road
    kind: str  # cause and side of the failure, driver, simulator and world as text; a group has one kind


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
    """Returns the distances ``(len(some), len(others))`` between the failures of two lists: the root of the
    sum of the squared RMS differences in curvature, in units of ``BEND``, and in grade, in units of
    ``GRADE``. Beyond its ends, a road counts as straight and level; failures of different ``kind`` are
    infinitely apart."""
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

    Two failures of a group are at most ``alike`` apart. At most ``most`` are clustered at a time; each later
    one joins the group whose most typical failure is nearest and alike, and those that join none are
    clustered next.
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
    if len(some) < 2:
        return np.zeros(len(some), int)
    far = 1e6  # stands for infinity, which linkage does not take
    apart = np.minimum(between(some, some), far)
    apart = (apart + apart.T) / 2
    np.fill_diagonal(apart, 0.0)
    return np.asarray(fcluster(linkage(squareform(apart), "complete"), alike, "distance"), np.intp) - 1


def typical(members: Sequence[Surroundings]) -> list[int]:
    """Returns the indices of the failures of one group by their sum of squared distances to the others, the
    smallest first. Of more than 1000 failures, only the first 1000 are compared and returned."""
    some = members[:MOST]
    squares = between(some, some) ** 2
    return [int(i) for i in np.argsort(np.round(squares.sum(axis=1), 9), kind="stable")]


AT_ONCE = 500  # tests that are read from a store with one query


@dataclass(frozen=True, eq=False)
class LocatedFailure:
    """A failure, and where on the road it occurred."""

    name: NumberedTest
    around: Surroundings
    system: str
    """Text that identifies driver, simulator and world; failures with different texts are never joined."""
    manner: Manner
    station: float  # station of the failure, metres along the road
    outside: float | None  # largest share of the car that was outside its lane at one time, 0 to 1
    beyond: float | None  # largest distance of the car's body beyond the lane marking, metres


def failures_of(folder: Path, most: int | None = None, cell: str = "") -> tuple[list[LocatedFailure], int]:
    """Returns the failures of a run, a folder of runs, or a campaign, cell by cell: at most ``most``, evenly
    spread. The number beside them also counts those left out, and those whose road cannot be built."""
    with open_record(folder) as record:
        names = record.query(
            "SELECT cell, number FROM tests WHERE outcome = 'FAIL' AND (? = '' OR cell = ?) "
            "ORDER BY cell, number",
            (cell, cell),
        )
        some = [NumberedTest(*names[at]) for at in _spread(len(names), most)]
        return [*_located(record, some)], len(names)


def _spread(count: int, most: int | None) -> Sequence[int]:
    if most is None or count <= most:
        return range(count)
    return [int(at) for at in np.linspace(0, count - 1, most)]


def _located(record: Record, some: Sequence[NumberedTest]) -> Iterator[LocatedFailure]:
    """Yields those of the failures, which are sorted by cell, whose road can be built."""
    cells = {cell.name: cell for cell in record.cells()}
    for name, tests in groupby(some, key=lambda each: each.cell):
        cell, every = cells[name], [each.number for each in tests]
        world, setup = cell.request.world, cell.request.setup
        system = f"{setup.driver} {setup.simulator} {setup.keep_driving} {world.model_dump_json()}"
        for start in range(0, len(every), AT_ONCE):
            numbers = every[start : start + AT_ONCE]
            where = f"tests.number IN ({', '.join('?' * len(numbers))})"
            for its in record.results(name, where, numbers):
                try:
                    road = record.road(cell, its)
                except RoadGPTError:  # the version that made the road could build it; this one cannot
                    continue
                if road is None:
                    continue
                world, station = cell.request.world, its.at_s or 0.0
                whose = f"{system} {its.handed_to or ''}"
                around = surroundings(road, world, station, f"{its.cause} {its.side} {whose}")
                manner = manner_of(road, world, station, its.cause, its.side)
                test = NumberedTest(name, its.number)
                yield LocatedFailure(test, around, whose, manner, station, its.max_oob, its.beyond)
