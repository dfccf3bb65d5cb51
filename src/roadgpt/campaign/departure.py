"""Predicts where on a road a car will leave its lane; learns from the lane departures on earlier roads.

    stations of driven roads --logistic regression--> chance to leave the lane at a station of a new road

A road is looked at every 3 m. At each of these stations, a few signs describe what the car has just met: how
fast it would enter the bend, the bend itself, and how suddenly the curvature changed. A regression learns the
chance that a car leaves its lane at a station that it has reached. For a new road, the module predicts the
chance that the car fails at all, and the mean of the steering up to the departure.

A drive ends at the lane departure, so the standard deviation of the steering (STD_SA) depends on this place.
With ``lane_centring``, an estimate up to the true place misses STD_SA by 4.5 degrees. The best estimate
without knowledge of this place misses STD_SA by 13 degrees.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from roadgpt.campaign.surrogate_features import (
    ENDING,
    ENTERING,
    GENTLY,
    RoadSamples,
    before,
    lane_curvature,
    moving_mean,
    squared_speed,
    steering_so_far,
)
from roadgpt.geometry.curve import Array
from roadgpt.road import World

FIRST, SPACING = 20.0, 3.0  # m: the first station, and from one to the next
LAGS = (0, 8, 16)  # samples, about 1 m apart, by which a sign lies before the station
SUDDEN = 8  # samples, over which a change of curvature counts
LARGEST = 2.0  # of each sign; beyond it, nothing more is learnt
SCALES = (0.1, 15.0, 0.01)  # of m/s^2, of 1/m, and of m^0.5/s^3, so that signs are about 1
RIDGE = 5.0  # weight of the squared coefficients
STEPS = 12  # of Newton's method, at most
ENOUGH = 1e-4  # of the misfit; a step that gains less is the last
HALVINGS = 12  # of a step that goes too far
BLOCK = 200  # rows that are multiplied at once: so few that no threads are started, which cost more
MOST = 300  # roads to learn from, the latest ones
FEWEST_FAILURES = 5  # failures; with fewer, nothing is learnt
USUAL = -3.0  # logit of the chance to leave the lane at a station, to begin with
RARELY = 30.0  # largest logit


class RoadStations(NamedTuple):
    """A road at m stations."""

    s: Array
    """Stations in metres, ``(m,)``."""
    signs: Array
    """What a car has just met at each station, ``(m, signs)``; the last column is 1."""
    steering: Array
    """Standard deviation of the wheels' angle from the start to each station, radians, ``(m,)``."""


class DepartureForecast(NamedTuple):
    """Predictions for n roads."""

    chance: Array
    """Chance that the car leaves its lane, ``(n,)``."""
    steering: Array
    """Standard deviation of the wheels' angle up to the departure, radians, ``(n,)``: the mean over all
    stations, weighted by the chance of a departure there."""
    likeliest: Array
    """Standard deviation of the wheels' angle up to the likeliest departure, radians, ``(n,)``."""

    def table(self) -> Array:
        """Returns features ``(n, 3)``: ``steering``, ``likeliest`` and ``chance``, each scaled to a magnitude
        of about 1."""
        return np.stack([self.steering / 0.1, self.likeliest / 0.1, self.chance], axis=1)


def stations_of(samples: RoadSamples, world: World) -> RoadStations:
    """Returns the stations of a road; there is at least one."""
    s, lane = samples.s, lane_curvature(samples)
    square = squared_speed(s, lane, world, GENTLY)
    entering = before(square, ENTERING)
    bend = moving_mean(lane, 5)
    rush = entering * moving_mean(lane, 7)
    sudden = (bend - before(bend, SUDDEN)) * entering**1.5
    signs = []
    for values, scale, lags in zip((rush, bend, sudden), SCALES, (LAGS, LAGS[:2], LAGS), strict=True):
        signs += [before(scale * values, lag) for lag in lags]
    places = np.arange(FIRST, max(s[-1] - ENDING, FIRST + 1), SPACING)
    at = np.minimum(np.searchsorted(s, places), len(s) - 1)
    both = np.array(signs).T[at]
    sides = np.clip(np.concatenate([both, -both], axis=1), 0.0, LARGEST)
    speed = np.sqrt(square[at])[:, None] / 20
    columns = [sides, sides**2, speed, np.ones((len(at), 1))]
    return RoadStations(s[at], np.concatenate(columns, axis=1), steering_so_far(s, lane, world)[at])


class DepartureModel:
    """Knows where a car left its lane on driven roads."""

    def __init__(self, roads: Sequence[RoadStations], failed_at: Sequence[float | None]) -> None:
        """Learns from the last 300 driven roads; ``failed_at`` is the station in metres where the car left
        its lane on each of them, or None."""
        rows, leaves = [], []
        for road, end in zip(roads[-MOST:], failed_at[-MOST:], strict=True):
            reached = road.s < end if end is not None else np.ones(len(road.s), bool)
            reached[0] = True
            rows.append(road.signs[reached])
            leaves.append(np.zeros(len(rows[-1])))
            leaves[-1][-1] = end is not None
        self._weights = logistic(np.concatenate(rows), np.concatenate(leaves))

    def predict(self, roads: Sequence[RoadStations]) -> DepartureForecast:
        """Returns the predictions for n roads."""
        counts = np.array([len(road.s) for road in roads])
        starts = np.cumsum(counts) - counts
        logit = np.concatenate([road.signs @ self._weights for road in roads])
        stays = -np.logaddexp(0.0, np.clip(logit, -RARELY, RARELY))  # logarithm of the chance to stay
        here = np.exp(stays) * np.exp(np.clip(logit, -RARELY, RARELY))
        so_far = np.cumsum(stays) - stays
        so_far -= np.repeat(so_far[starts], counts)
        share = here * np.exp(so_far)
        steering = np.concatenate([road.steering for road in roads])
        chance = np.add.reduceat(share, starts)
        mean = np.add.reduceat(share * steering, starts) / np.maximum(chance, 1e-12)
        ends = starts + counts
        tops = [a + int(share[a:b].argmax()) for a, b in zip(starts, ends, strict=True)]
        return DepartureForecast(chance, mean, steering[tops])


def logistic(rows: Array, leaves: Array) -> Array:
    """Fits ``leaves`` ``(n,)``, 1 where the car left its lane, by a logistic regression on the signs ``rows``
    ``(n, signs)``, whose last column is 1. Returns the coefficients ``(signs,)``. The penalty is RIDGE / 2
    times the sum of the squared coefficients except the last, for columns with a standard deviation of 1.
    """
    scale = rows.std(axis=0)
    scale[scale < 1e-9] = 1.0
    table = rows / scale
    ridge = np.full(table.shape[1], RIDGE)
    ridge[-1] = 0.0
    weights = np.zeros(table.shape[1])
    weights[-1] = USUAL
    blocks = [slice(first, first + BLOCK) for first in range(0, len(table), BLOCK)]
    worst = _misfit(_logits(table, weights, blocks), leaves, weights, ridge)
    for _ in range(STEPS):
        chance = 1 / (1 + np.exp(-np.clip(_logits(table, weights, blocks), -RARELY, RARELY)))
        missed, bent = chance - leaves, chance * (1 - chance) + 1e-9
        slope, curved = ridge * weights, np.diag(ridge)
        for one in blocks:
            slope = slope + table[one].T @ missed[one]
            curved = curved + table[one].T @ (table[one] * bent[one, None])
        step = np.linalg.solve(curved, slope)
        for _ in range(HALVINGS):
            misfit = _misfit(_logits(table, weights - step, blocks), leaves, weights - step, ridge)
            if misfit < worst:
                break
            step = step / 2
        if worst - misfit < ENOUGH:
            break
        weights, worst = weights - step, misfit
    return np.asarray(weights / scale)


def _logits(table: Array, weights: Array, blocks: Sequence[slice]) -> Array:
    return np.concatenate([table[one] @ weights for one in blocks])


def _misfit(logits: Array, leaves: Array, weights: Array, ridge: Array) -> float:
    """Returns what the regression makes small: the surprise at what happened, and the penalty."""
    return float((np.logaddexp(0.0, logits) - leaves * logits).sum() + (ridge * weights**2).sum() / 2)
