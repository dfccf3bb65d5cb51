"""Measures how similar two roads are, by criteria of the thesis' survey, each from 0 to 1.

    turns       the smaller number of turns divided by the larger one
    sequence    1 - d / n, where d is the edit distance between the two sequences of left turns, right turns
                and straights, and n is the length of the longer sequence
    direction   the same as sequence, with left and right turns only
    length      the shorter length in plan divided by the longer one
    incline     1 for equal grades; each 2 percentage points of mean difference in grade halves the value;
                grades are compared at equal fractions of each road's length
    shape       1 for equal centre lines in plan view; each 5.5 m of root mean square distance halves the
                value; points are compared at equal fractions of the length, after the best shift and rotation
    general     the mean of these six

Two roads are near duplicates if their numbers of turns are equal and shape and incline are both at least 0.5:
a person who sees both would consider them to be the same test. Mirror images count as similar only if the
caller asks for it."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import combinations
from math import nan

import numpy as np

from roadgpt.check.measures import measure
from roadgpt.design.variety import ENOUGH, POINTS, PlanShape, shape_of
from roadgpt.errors import UsageError
from roadgpt.geometry.curve import Array
from roadgpt.network import refuse_without_route
from roadgpt.road import Road
from roadgpt.run.step_distance import distances, steps_of

HALF_GRADE = 2.0  # percentage points, mean difference; a driver feels that it is a different hill
HALF_SHAPE = ENOUGH  # m RMS: the smallest distance that the planner keeps between its roads
STEP = 5.0  # m, step length for whole roads; the competition compares 60 m of road in steps of 1 m


@dataclass(frozen=True)
class Similarity:
    """How similar two roads are: six criteria from 0 to 1, and the two distances from which ``shape`` and
    ``incline`` are computed."""

    turns: float
    sequence: float
    direction: float
    length: float
    incline: float
    shape: float
    metres: float
    """Root mean square distance between the roads in plan view after the best shift and rotation, metres."""
    points: float  # mean absolute difference between the grades of the two roads, percentage points

    @property
    def general(self) -> float:
        """The mean of the six criteria."""
        six = self.turns + self.sequence + self.direction + self.length + self.incline + self.shape
        return six / 6

    @property
    def is_duplicate(self) -> bool:
        """True if the two roads are near duplicates."""
        return self.turns == 1.0 and min(self.shape, self.incline) >= 0.5


@dataclass(frozen=True, eq=False)
class Likeness:
    """The properties of a road by which it is compared with other roads."""

    length: float  # length in plan, metres
    sequence: str  # left turns, right turns and straights in driving order, as the letters L, R and S
    shape: PlanShape
    grades: Array  # grades in percent ``(80,)``, in the middle of 80 equal parts of the road
    steps: Array  # change of direction (degrees) and length (metres) of each step of 5 m, ``(n, 2)``

    @property
    def sides(self) -> str:
        """The turns of ``sequence`` without the straights, as the letters L and R."""
        return self.sequence.replace("S", "")


def likeness(road: Road) -> Likeness:
    """Returns the properties of a road by which it is compared with other roads."""
    points = road.centreline()
    if len(points) < 2:
        raise UsageError("the road is too short to be compared; give one of some metres")
    s = np.linspace(0.0, road.length, max(2, round(road.length)) + 1)
    line = road.at(s)
    shares = road.length * (np.arange(POINTS) + 0.5) / POINTS
    whole = road.at(np.linspace(0.0, road.length, max(3, round(road.length / STEP)) + 1))
    found = measure(points)
    return Likeness(
        found.length,
        "".join((feature.side or "straight")[0].upper() for feature in found.features),
        shape_of(s, line[:, 0] + 1j * line[:, 1]),
        100 * np.asarray(road.grade(shares)),
        steps_of(whole[:, :2]),
    )


def similarity(one: Likeness, other: Likeness, mirror: bool = False) -> Similarity:
    """Returns how similar two roads are; neither their position nor their orientation matters. If ``mirror``
    is True, a road and its mirror image count as the same."""
    turned = float(abs(np.vdot(one.shape.shares, other.shape.shares)))
    if mirror:
        turned = max(turned, float(abs(np.vdot(one.shape.shares, other.shape.shares.conj()))))
    square = float(one.shape.spread**2 + other.shape.spread**2 - 2 * turned / POINTS)
    metres = float(np.sqrt(max(square, 0.0)))
    points = float(np.abs(one.grades - other.grades).mean())
    return Similarity(
        turns=_ratio(len(one.sides), len(other.sides)),
        sequence=_alike(one.sequence, other.sequence, mirror),
        direction=_alike(one.sides, other.sides, mirror),
        length=_ratio(one.length, other.length),
        incline=0.5 ** (points / HALF_GRADE),
        shape=0.5 ** (metres / HALF_SHAPE),
        metres=metres,
        points=points,
    )


def _ratio(one: float, other: float) -> float:
    return min(one, other) / max(one, other) if max(one, other) > 0 else 1.0


@lru_cache(maxsize=100_000)  # many roads have the same few letters
def _alike(one: str, other: str, mirror: bool) -> float:
    if not one and not other:
        return 1.0
    ways = [other, other.translate(str.maketrans("LR", "RL"))] if mirror else [other]
    return max(1 - edits(one, way) / max(len(one), len(other)) for way in ways)


def edits(one: str, other: str) -> int:
    """Returns the Levenshtein distance of two words."""
    row = list(range(len(other) + 1))
    for i, letter in enumerate(one, 1):
        before, row[0] = row[0], i
        for j, against in enumerate(other, 1):
            before, row[j] = row[j], min(row[j] + 1, row[j - 1] + 1, before + (letter != against))
    return row[-1]


@dataclass(frozen=True, eq=False)
class Spread:
    """How different the roads of one description are."""

    metres: Array
    """Root mean square distances ``(n, n)`` between n roads in plan view, metres; NaN on the diagonal."""
    duplicates: tuple[tuple[int, int], ...]  # pairs of indices of roads that are near duplicates
    sparseness: float
    """Sparseness as in the SBFT competition: for each road the distance to the most different road,
    averaged over all roads. The roads are compared in steps of 5 m."""
    general: float  # mean of ``Similarity.general`` over all pairs of roads; NaN for fewer than two roads

    @property
    def nearest(self) -> Array:
        """For each of two or more roads the smallest distance to another road, metres ``(n,)``."""
        return np.asarray(np.nanmin(self.metres, axis=1))


def spread(roads: Sequence[Likeness], mirror: bool = True) -> Spread:
    """Compares all pairs of roads; ``mirror`` is as for ``similarity``."""
    n = len(roads)
    found = {(i, j): similarity(roads[i], roads[j], mirror) for i, j in combinations(range(n), 2)}
    metres, apart = np.full((n, n), np.nan), np.zeros((n, n))
    for (i, j), pair in found.items():
        metres[i, j] = metres[j, i] = pair.metres
    for i in range(n - 1):
        apart[i, i + 1 :] = distances(roads[i].steps, [other.steps for other in roads[i + 1 :]])
    return Spread(
        metres,
        tuple(pair for pair, each in found.items() if each.is_duplicate),
        float(np.maximum(apart, apart.T).max(axis=1).mean()) if found else nan,
        float(np.mean([each.general for each in found.values()])) if found else nan,
    )


def compare(one: Road, other: Road, mirror: bool = False) -> Similarity:
    """Returns how similar two roads are, by the criteria of the survey in RoadGPT's thesis. With ``mirror``,
    a road and its mirror image count as the same."""
    for road in (one, other):
        refuse_without_route(road, "compared")
    return similarity(likeness(one), likeness(other), mirror)
