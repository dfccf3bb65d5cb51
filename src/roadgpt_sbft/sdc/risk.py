"""Predicts how likely a road is to make the car leave its lane, from the line that the driver plans.

In the competition, BeamNG's AI drives with a risk factor of 1.5 at up to 120 km/h; a test fails if more than
half of the car is outside its lane. The distance between the line that ``beamng_like``, an imitation of this
AI, plans and the middle of the lane predicts recorded failures at least as well as a simulated drive does
(docs/reference/benchmarks.md), in a fortieth of the time. If outcomes of tests are known, logistic regression
weights all features; otherwise the score is only this distance.
"""

import logging
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roadgpt.drive.drivers import beamng_like
from roadgpt.drive.driving_line import stations
from roadgpt.errors import RoadGPTError
from roadgpt.road import Road, World

log = logging.getLogger(__name__)

Array = NDArray[np.float64]

PLAIN = World().changed(map_size=10_000.0, speed_limit=120 / 3.6, oob_tolerance=0.5)
FARTHEST = 20.0  # m, upper bound of the distance from the middle of the lane
LONGEST = 20_000.0  # m, longest road that is examined
SHORTEST = 0.01  # m; closer points count as one
GETTING_GOING = 25.0  # m at the start in which no car is fast enough to fail
ARRIVED = 8.0  # m before the end, where the competition's drive is over
RIDGE = 1.0  # regularisation, which limits the effect of few outcomes
STEPS = 30  # iterations of Newton's method
FEWEST = 20  # known outcomes that are needed for a fit
EXPECTED = 3.0  # failures that a selection should contain: with fewer, 1 in 25 suites contained none at all
FEW = 0.05  # smallest share of tests that is selected
UNTAUGHT = 0.1  # share of tests that is selected if no outcomes are known


class RiskFeatures(NamedTuple):
    """Features of a road; larger values make a failure more likely."""

    near: float
    """Largest predicted distance of the car from the middle of the lane, metres."""
    wander: float
    """Mean predicted distance of the car from the middle of the lane, metres."""
    swing: float
    """Largest change of the planned offset from the middle of the lane, in metres per metre of road."""
    tightest: float
    """Largest curvature, 1/m."""
    bends: float
    """Mean of the absolute curvature, 1/m."""


UNKNOWN = RiskFeatures(*[np.nan] * len(RiskFeatures._fields))
"""Features of a road that cannot be used; all of them are NaN."""


def risk_features(points: Sequence[Sequence[float]], world: World = PLAIN) -> RiskFeatures:
    """Returns the features of a road through these points in metres; UNKNOWN if it cannot be used."""
    try:
        road = Road.through(_apart(points))
        if not road.length < LONGEST:
            raise RoadGPTError(f"it is longer than {LONGEST / 1000:g} km")
        return _features(road, world)
    except (RoadGPTError, ArithmeticError, ValueError) as error:
        log.info("a road cannot be used: %s", error)
        return UNKNOWN


def _features(road: Road, world: World) -> RiskFeatures:
    s, driver = stations(road), beamng_like.BeamngLike()
    bend = np.abs(road.curvature(s))
    aside = driver.offsets(road, world) - world.profile_of(road).middle(s)
    away = np.abs(aside + beamng_like.PURSUIT_CUTS * driver.bend(road, world))
    counts = (s >= GETTING_GOING) & (s <= road.length - ARRIVED)
    away = away[counts] if counts.any() else away
    features = (
        min(away.max(), FARTHEST),
        min(away.mean(), FARTHEST),
        np.abs(np.diff(aside)).max() / s[1],
        min(bend.max(), 1.0),
        min(bend.mean(), 1.0),
    )
    return RiskFeatures(*map(float, features)) if np.isfinite(features).all() else UNKNOWN


def _apart(points: Sequence[Sequence[float]]) -> Array:
    """Returns the points without those that repeat the previous one."""
    table = np.asarray(points, float).reshape(-1, 2)
    keep = np.ones(len(table), bool)
    with np.errstate(invalid="ignore"):
        keep[1:] = np.hypot(*np.diff(table, axis=0).T) > SHORTEST
    kept: Array = table[keep | ~np.isfinite(table).all(axis=1)]
    return kept


@dataclass(frozen=True)
class RiskModel:
    """Computes a risk score from the features of a road."""

    mean: Array
    scale: Array
    weights: Array
    """The weights of the features, in their order, followed by the constant term."""
    share: float | None = None
    """Fraction of failures among the tests with known outcomes, 0 to 1; None if no outcomes are known."""

    def scores(self, features: Sequence[RiskFeatures]) -> Array:
        """Returns the scores ``(n,)`` of n roads, larger ones for riskier roads, and the median for
        UNKNOWN."""
        scores = (_table(features) - self.mean) / self.scale @ self.weights[:-1] + self.weights[-1]
        known = np.isfinite(scores)
        return np.asarray(np.where(known, scores, np.median(scores[known]) if known.any() else 0.0))

    def select(self, features: Sequence[RiskFeatures]) -> list[int]:
        """Returns the indices of the riskiest 5 % of the tests in ascending order, and of more, until three
        failures are expected or the next test is no more likely to fail than the average. ``LINE_ONLY``,
        which uses no outcomes, selects 10 %."""
        scores = self.scores(features)
        first = order(scores)
        if self.share is None:
            count = int(np.ceil(UNTAUGHT * len(scores)))
        else:
            chance = 1 / (1 + np.exp(-np.clip(scores[first], -30, 30)))
            enough = int(np.searchsorted(chance.cumsum(), EXPECTED)) + 1
            likelier = int((chance > self.share).sum())
            count = max(int(np.ceil(FEW * len(scores))), min(enough, likelier))
        return sorted(first[:count].tolist())


ZERO = np.zeros(len(RiskFeatures._fields))
LINE_ONLY = RiskModel(ZERO, ZERO + 1.0, np.r_[1.0, np.zeros(len(RiskFeatures._fields))])
"""The model that uses only the planned line."""


def _table(features: Sequence[RiskFeatures]) -> Array:
    return np.asarray(features, float).reshape(-1, len(RiskFeatures._fields))


def order(scores: Array) -> NDArray[np.intp]:
    """Returns the indices that sort the scores from largest to smallest; equal scores keep their order."""
    return np.argsort(-scores, kind="stable")


def fit_model(features: Sequence[RiskFeatures], failed: Sequence[bool]) -> RiskModel:
    """Fits the weights of the features to the outcomes of tests; LINE_ONLY if fewer than 20 tests have known
    features, or all have the same outcome."""
    table, outcome = _table(features), np.asarray(failed, float)
    known = np.isfinite(table).all(axis=1)
    table, outcome = table[known], outcome[known]
    if len(outcome) < FEWEST or outcome.min() == outcome.max():
        return LINE_ONLY
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
        return LINE_ONLY
    return RiskModel(mean, scale, weights, float(outcome.mean()))
