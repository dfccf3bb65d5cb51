"""How likely a road is to make the car leave its lane: from a drive in the embedded simulator.

The competition's car is BeamNG's AI at risk 1.5 and up to 120 km/h; a test fails where more than half of the
car is outside its lane. Ours is ``beamng_like`` at the limit of its tyres, up to the same speed. Where it is
known how tests ended, all signs are weighed by that (logistic regression); else the drive alone counts.
"""

import logging
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roadgpt.drive import simulate
from roadgpt.drive.drivers.beamng_like import BeamngLike
from roadgpt.errors import RoadGPTError
from roadgpt.road import Road, World
from roadgpt.verdict import judge

log = logging.getLogger(__name__)

Array = NDArray[np.float64]

SPEED_LIMIT = 120 / 3.6  # m/s
TOLERANCE = 0.5  # share of the car outside its lane
DARING = 0.95  # g in bends: all that dry asphalt gives
FARTHEST = 3.0  # m: margins beyond say no more
SHORTEST = 0.01  # m between points; closer ones are one
RIDGE = 1.0  # of the regression, so that few outcomes do not decide it all
STEPS = 30  # of Newton's method
FEWEST = 20  # known outcomes from which something is learnt
UNTAUGHT = 1 / 3  # share of tests that are selected where no outcome is known; 38 % failed in 2025
FEW = 0.1  # share of tests that are selected where none seems likely to fail

PLAIN = World(map_size=10_000.0, speed_limit=SPEED_LIMIT, oob_tolerance=TOLERANCE)


class Signs(NamedTuple):
    """What is seen of a road; the larger the likelier to fail."""

    near: float
    """-margin, metres: above 0 where the car left its lane."""
    tightest: float
    """Largest curvature, 1/m."""
    bends: float
    """Mean curvature, whichever hand, 1/m."""
    turned: float
    """Changes of direction altogether, radians."""
    length: float
    """Metres."""


UNKNOWN = Signs(0.0, 0.0, 0.0, 0.0, 0.0)


def signs_of(points: Sequence[Sequence[float]], world: World = PLAIN) -> Signs:
    """Signs of a road of control points, in metres. A road that cannot be driven lies in the middle."""
    try:
        road = Road.through(_apart(points))
        samples = road.sample()
    except RoadGPTError as error:
        log.info("a road cannot be used: %s", error)
        return UNKNOWN
    bend = np.abs(samples.curvature)
    mean = float(bend.mean())
    return Signs(
        _near(road, world), min(float(bend.max()), 1.0), mean, mean * road.length, min(road.length, 5000.0)
    )


def _near(road: Road, world: World) -> float:
    try:
        drive = simulate(road, world, BeamngLike(risk=DARING), keep_driving=True)
        margin = judge(road, drive, world).margin
    except Exception as error:  # whatever breaks down on a road costs what is known of it
        log.info("a road cannot be driven: %s", error)
        return 0.0
    return float(np.clip(-margin, -FARTHEST, FARTHEST)) if np.isfinite(margin) else 0.0


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
    threshold: float | None = None
    """Above it a test is expected to fail; None where nobody knows."""

    def scores(self, signs: Sequence[Signs]) -> Array:
        """The larger the likelier to fail, ``(n,)``."""
        table = (np.asarray(signs, float).reshape(-1, len(Signs._fields)) - self.mean) / self.scale
        return np.asarray(table @ self.weights[:-1] + self.weights[-1])

    def worth(self, signs: Sequence[Signs]) -> list[int]:
        """Indices of tests that are expected to fail; of the likeliest tenth where none is, and of the
        likeliest third where nobody knows."""
        scores = self.scores(signs)
        share = FEW
        chosen: list[int] = []
        if self.threshold is None:
            share = UNTAUGHT
        else:
            chosen = np.flatnonzero(scores > self.threshold).tolist()
        return chosen or sorted(order(scores)[: int(np.ceil(share * len(scores)))].tolist())


ZERO = np.zeros(len(Signs._fields))
BY_DRIVE = Weighing(ZERO, ZERO + 1.0, np.r_[1.0, np.zeros(len(Signs._fields))])
"""The drive alone."""


def order(scores: Array) -> NDArray[np.intp]:
    """Indices from the largest score to the least; equal ones as they came."""
    return np.argsort(-scores, kind="stable")


def learnt(signs: Sequence[Signs], failed: Sequence[bool]) -> Weighing:
    """Signs weighed so that they tell failures; the drive alone where there is too little to learn from."""
    outcome = np.asarray(failed, float)
    if len(outcome) < FEWEST or outcome.min() == outcome.max():
        return BY_DRIVE
    table = np.asarray(signs, float)
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
        return BY_DRIVE
    return Weighing(mean, scale, weights, _threshold(design @ weights, outcome))


def _threshold(scores: Array, outcome: Array) -> float:
    """Where failures and passes part best: the largest difference of their shares above it."""
    ranked = order(scores)
    failures = np.cumsum(outcome[ranked]) / outcome.sum()
    passes = np.cumsum(1 - outcome[ranked]) / (1 - outcome).sum()
    best = int(np.argmax(failures - passes))
    below = scores[ranked[best + 1]] if best + 1 < len(scores) else scores[ranked[best]] - 1.0
    return float((scores[ranked[best]] + below) / 2)
