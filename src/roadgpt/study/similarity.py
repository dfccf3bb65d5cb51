"""How alike two roads are, in the criteria of the thesis' survey, each from 0 to 1.

    turns       the smaller number of turns over the larger
    sequence    1 less the edit distance of left turns, right turns and straights in order, over the longer
    direction   the same of the sides of the turns alone
    length      the shorter over the longer, in plan
    incline     halves with every 2 percentage points between the grades at equal shares of both lengths
    shape       halves with every 5.5 m (root mean square) between the plans at equal shares of both lengths,
                after the best shift and turn
    general     the mean of all six

Two roads are near duplicates where shape and incline are both 0.5 or more and the number of turns is the
same: nobody who sees one after the other would take them for two tests. Mirroring is allowed where asked.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from roadgpt.check.measures import MeasuredFeature, measure
from roadgpt.design.variety import ENOUGH, POINTS, PlanShape, shape_of
from roadgpt.errors import UsageError
from roadgpt.road import Road
from roadgpt.run.sparseness import distances, steps_of

Array = NDArray[np.float64]

HALF_GRADE = 2.0  # percentage points, mean of the differences: what a driver feels as another hill
HALF_SHAPE = ENOUGH  # m RMS: what the planner keeps its roads apart by
STEP = 5.0  # m between the points of a whole road's steps; the competition's are 1 m apart, of 60 m only
CRITERIA = ("turns", "sequence", "direction", "length", "incline", "shape", "general")


@dataclass(frozen=True)
class Similarity:
    """Of two roads, from 0 to 1 each; and the two distances behind it."""

    turns: float
    sequence: float
    direction: float
    length: float
    incline: float
    shape: float
    metres: float
    """Between the plans, root mean square, after the best shift and turn."""
    points: float
    """Percentage points between the grades, on average."""

    @property
    def general(self) -> float:
        """The mean of the six."""
        six = self.turns + self.sequence + self.direction + self.length + self.incline + self.shape
        return six / 6

    @property
    def is_duplicate(self) -> bool:
        """Would nobody take them for two tests?"""
        return self.turns == 1.0 and min(self.shape, self.incline) >= 0.5


@dataclass(frozen=True, eq=False)
class Likeness:
    """What is compared of one road."""

    turns: int
    length: float
    sequence: str
    """Left turns, right turns and straights as the letters L, R and S, in driving order."""
    sides: str
    """The turns alone."""
    shape: PlanShape
    grades: Array
    """Percent, at the middle of so many equal shares of the length as a shape has points."""
    steps: Array
    """Change of direction in degrees and length, every 5 m."""


def likeness(road: Road) -> Likeness:
    """What is compared of a road.

    Raises:
        UsageError: it has no two different points.
    """
    points = road.centreline()
    if len(points) < 2:
        raise UsageError("the road is too short to be compared; give one of some metres")
    s = np.linspace(0.0, road.length, max(2, round(road.length)) + 1)
    line = road.at(s)
    shares = road.length * (np.arange(POINTS) + 0.5) / POINTS
    whole = road.at(np.linspace(0.0, road.length, max(3, round(road.length / STEP)) + 1))
    found = measure(points)
    sequence = "".join(_letter(feature) for feature in found.features)
    return Likeness(
        len(found.turns),
        found.length,
        sequence,
        sequence.replace("S", ""),
        shape_of(s, line[:, 0] + 1j * line[:, 1]),
        100 * np.asarray(road.grade(shares)),
        steps_of(whole[:, :2]),
    )


def similarity(one: Likeness, other: Likeness, mirror: bool = False) -> Similarity:
    """How alike two roads are; shifting and turning are free, and mirroring where it is asked for."""
    metres = plan_apart(one.shape, other.shape, mirror)
    points = float(np.abs(one.grades - other.grades).mean())
    return Similarity(
        turns=_ratio(one.turns, other.turns),
        sequence=_alike(one.sequence, other.sequence, mirror),
        direction=_alike(one.sides, other.sides, mirror),
        length=_ratio(one.length, other.length),
        incline=0.5 ** (points / HALF_GRADE),
        shape=0.5 ** (metres / HALF_SHAPE),
        metres=metres,
        points=points,
    )


def plan_apart(one: PlanShape, other: PlanShape, mirror: bool) -> float:
    """Metres, root mean square, between two plans at equal shares, after the best shift and turn."""
    turned = float(abs(np.vdot(one.shares, other.shares)))
    if mirror:
        turned = max(turned, float(abs(np.vdot(one.shares, other.shares.conj()))))
    square = float(one.spread**2 + other.spread**2 - 2 * turned / POINTS)
    return float(np.sqrt(max(square, 0.0)))


def _ratio(one: float, other: float) -> float:
    return min(one, other) / max(one, other) if max(one, other) > 0 else 1.0


def _letter(feature: MeasuredFeature) -> str:
    return "S" if feature.kind == "straight" else "L" if feature.side == "left" else "R"


@lru_cache(maxsize=100_000)  # many roads have the same few letters
def _alike(one: str, other: str, mirror: bool) -> float:
    if not one and not other:
        return 1.0
    ways = [other, other.translate(str.maketrans("LR", "RL"))] if mirror else [other]
    return max(1 - edits(one, way) / max(len(one), len(other)) for way in ways)


def edits(one: str, other: str) -> int:
    """Letters to add, leave out or exchange to make one word of another (Levenshtein)."""
    row = list(range(len(other) + 1))
    for i, letter in enumerate(one, 1):
        before, row[0] = row[0], i
        for j, against in enumerate(other, 1):
            before, row[j] = row[j], min(row[j] + 1, row[j - 1] + 1, before + (letter != against))
    return row[-1]


@dataclass(frozen=True, eq=False)
class Spread:
    """How different many roads of one description are, each from every other."""

    metres: Array
    """Distances ``(n, n)`` between plans, root mean square; NaN on the diagonal."""
    duplicates: tuple[tuple[int, int], ...]
    """Places of the pairs that nobody would take for two tests."""
    sparseness: float
    """The competition's, of whole roads in steps of 5 m: mean distance to the road that differs most."""
    general: float
    """Mean similarity of all pairs; NaN for fewer than two roads."""

    @property
    def nearest(self) -> Array:
        """Metres from every road to the one most like it, ``(n,)``; NaN where there is no other."""
        if len(self.metres) < 2:
            return np.full(len(self.metres), np.nan)
        return np.asarray(np.nanmin(self.metres, axis=1))


def spread(roads: Sequence[Likeness], mirror: bool = True) -> Spread:
    """All pairs of roads; mirrored ones count as alike unless told otherwise."""
    n = len(roads)
    metres, general, twins = np.full((n, n), np.nan), [], []
    furthest = np.zeros(n)
    for i, one in enumerate(roads):
        others = roads[i + 1 :]
        for j, other in enumerate(others, i + 1):
            found = similarity(one, other, mirror)
            metres[i, j] = metres[j, i] = found.metres
            general.append(found.general)
            if found.is_duplicate:
                twins.append((i, j))
        if others:
            apart = distances(one.steps, [other.steps for other in others])
            furthest[i] = max(furthest[i], float(apart.max()))
            furthest[i + 1 :] = np.maximum(furthest[i + 1 :], apart)
    return Spread(
        metres,
        tuple(twins),
        float(furthest.mean()) if n > 1 else float("nan"),
        float(np.mean(general)) if general else float("nan"),
    )


@dataclass(frozen=True)
class Between:
    """How alike the roads of two descriptions are."""

    general: float
    metres: float
    """Of the nearest pair."""
    duplicates: int


def between(ones: Sequence[Likeness], others: Sequence[Likeness], mirror: bool = True) -> Between:
    """Every road of one description with every road of another."""
    found = [similarity(one, other, mirror) for one in ones for other in others]
    if not found:
        return Between(float("nan"), float("nan"), 0)
    return Between(
        float(np.mean([each.general for each in found])),
        min(each.metres for each in found),
        sum(each.is_duplicate for each in found),
    )
