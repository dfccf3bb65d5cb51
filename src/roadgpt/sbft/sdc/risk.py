"""How likely a road is to make the car leave its lane: from the line that its driver plans.

The competition's car is BeamNG's AI at risk 1.5 and up to 120 km/h; a test fails where more than half of the
car is outside its lane. Ours is ``beamng_like``. Nothing is driven: how far its line, and what it cuts inside
of it, lies from the middle of the lane tells recorded failures no worse than a drive does
(docs/reference/benchmarks.md), in a fortieth of the time. Where it is known how tests ended, all signs are
weighed by that (logistic regression); else the line alone counts.
"""

import logging
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roadgpt.drive.drivers.beamng_like import PURSUIT_CUTS, BeamngLike
from roadgpt.drive.driving_line import stations
from roadgpt.errors import RoadGPTError
from roadgpt.road import Road, World

log = logging.getLogger(__name__)

Array = NDArray[np.float64]

PLAIN = World(map_size=10_000.0, speed_limit=120 / 3.6, oob_tolerance=0.5)
FARTHEST = 20.0  # m from the middle of the lane: more says no more
LONGEST = 20_000.0  # m of road that is looked at
SHORTEST = 0.01  # m between points; closer ones are one
GETTING_GOING = 25.0  # m in which no car is fast enough to fail
ARRIVED = 8.0  # m before the end: there the competition's drive is over
RIDGE = 1.0  # of the regression, so that few outcomes do not decide it all
STEPS = 30  # of Newton's method
FEWEST = 20  # known outcomes from which something is learnt
EXPECTED = 3.0  # failures that a selection is to hold: of fewer, one in twenty-five suites had none at all
FEW = 0.05  # share of tests that is selected at least
UNTAUGHT = 0.1  # share of tests that are selected where no outcome is known


class Signs(NamedTuple):
    """What is seen of a road; the larger the likelier to fail."""

    near: float
    """Metres from the middle of the lane to where the car is farthest from it."""
    wander: float
    """Mean of that distance, metres."""
    swing: float
    """How quickly it changes, at most: metres per metre."""
    tightest: float
    """Largest curvature, 1/m."""
    bends: float
    """Mean curvature, whichever hand, 1/m."""


UNKNOWN = Signs(*[np.nan] * len(Signs._fields))
"""Of a road that cannot be used."""


def signs_of(points: Sequence[Sequence[float]], world: World = PLAIN) -> Signs:
    """Signs of a road of control points, in metres; unknown ones of a road that cannot be used."""
    try:
        road = Road.through(_apart(points))
        if not road.length < LONGEST:
            raise RoadGPTError(f"it is longer than {LONGEST / 1000:g} km")
        return _signs(road, world)
    except (RoadGPTError, ArithmeticError, ValueError) as error:
        log.info("a road cannot be used: %s", error)
        return UNKNOWN


def _signs(road: Road, world: World) -> Signs:
    s, driver = stations(road), BeamngLike()
    bend = np.abs(road.curvature(s))
    aside = driver.offsets(road, world) + world.lane_width / 2
    away = np.abs(aside + PURSUIT_CUTS * driver.bend(road, world))
    counts = (s >= GETTING_GOING) & (s <= road.length - ARRIVED)
    away = away[counts] if counts.any() else away
    signs = (
        min(away.max(), FARTHEST),
        min(away.mean(), FARTHEST),
        np.abs(np.diff(aside)).max() / s[1],
        min(bend.max(), 1.0),
        min(bend.mean(), 1.0),
    )
    return Signs(*map(float, signs)) if np.isfinite(signs).all() else UNKNOWN


def _apart(points: Sequence[Sequence[float]]) -> Array:
    """Points without those that repeat the one before."""
    table = np.asarray(points, float).reshape(-1, 2)
    keep = np.ones(len(table), bool)
    with np.errstate(invalid="ignore"):
        keep[1:] = np.hypot(*np.diff(table, axis=0).T) > SHORTEST
    kept: Array = table[keep | ~np.isfinite(table).all(axis=1)]
    return kept


@dataclass(frozen=True)
class Weighing:
    """From signs to one number."""

    mean: Array
    scale: Array
    weights: Array
    """One per sign, and a constant."""
    share: float | None = None
    """Of the known tests, those that failed; None where nobody knows."""

    def scores(self, signs: Sequence[Signs]) -> Array:
        """The larger the likelier to fail, ``(n,)``; what is unknown lies in the middle."""
        scores = (_table(signs) - self.mean) / self.scale @ self.weights[:-1] + self.weights[-1]
        known = np.isfinite(scores)
        return np.asarray(np.where(known, scores, np.median(scores[known]) if known.any() else 0.0))

    def worth(self, signs: Sequence[Signs]) -> list[int]:
        """Indices of the tests to select, so that the largest share of them fails: the likeliest ones.

        A twentieth of them; or more, until three failures are expected, as long as a test is likelier to fail
        than most. Where nobody knows what to expect, the likeliest tenth.
        """
        scores = self.scores(signs)
        first = order(scores)
        if self.share is None:
            count = int(np.ceil(UNTAUGHT * len(scores)))
        else:
            chance = 1 / (1 + np.exp(-np.clip(scores[first], -30, 30)))
            enough = int(np.searchsorted(chance.cumsum(), EXPECTED)) + 1
            likelier = int((chance > self.share).sum())
            count = max(int(np.ceil(FEW * len(scores))), min(enough, likelier))
        return sorted(first[:count].tolist())


ZERO = np.zeros(len(Signs._fields))
BY_LINE = Weighing(ZERO, ZERO + 1.0, np.r_[1.0, np.zeros(len(Signs._fields))])
"""The planned line alone."""


def _table(signs: Sequence[Signs]) -> Array:
    return np.asarray(signs, float).reshape(-1, len(Signs._fields))


def order(scores: Array) -> NDArray[np.intp]:
    """Indices from the largest score to the least; equal ones as they came."""
    return np.argsort(-scores, kind="stable")


def learnt(signs: Sequence[Signs], failed: Sequence[bool]) -> Weighing:
    """Signs weighed so that they tell failures; the line alone where there is too little to learn from."""
    table, outcome = _table(signs), np.asarray(failed, float)
    known = np.isfinite(table).all(axis=1)
    table, outcome = table[known], outcome[known]
    if len(outcome) < FEWEST or outcome.min() == outcome.max():
        return BY_LINE
    mean, scale = table.mean(axis=0), np.maximum(table.std(axis=0), 1e-9)
    design = np.c_[(table - mean) / scale, np.ones(len(table))]
    penalty = RIDGE * np.diag(np.r_[np.ones(design.shape[1] - 1), 1e-6])
    weights = np.zeros(design.shape[1])
    for _ in range(STEPS):
        chance = 1 / (1 + np.exp(-np.clip(design @ weights, -30, 30)))
        spread = np.maximum(chance * (1 - chance), 1e-6)
        slope = design.T @ (outcome - chance) - penalty @ weights
        weights = weights + np.linalg.solve(design.T @ (spread[:, None] * design) + penalty, slope)
    if not np.isfinite(weights).all():
        return BY_LINE
    return Weighing(mean, scale, weights, float(outcome.mean()))
