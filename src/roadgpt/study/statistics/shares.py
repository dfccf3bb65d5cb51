"""Computes intervals of shares k of n, and tests whether shares rise or fall from group to group."""

from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np
from scipy import stats


class Interval(NamedTuple):
    """An interval from ``lo`` to ``hi``."""

    lo: float
    hi: float


class Trend(NamedTuple):
    """Result of the trend test: z above 0 if shares rise with the scores of the groups."""

    z: float
    p: float
    """Two-sided p-value."""


def wilson(k: int, n: int, confidence: float = 0.95) -> Interval:
    """Returns Wilson's score interval of the share k of n; 0 to 1 if n is 0."""
    return _interval(k, n, confidence, "wilson")


def clopper_pearson(k: int, n: int, confidence: float = 0.95) -> Interval:
    """Returns Clopper and Pearson's exact interval of the share k of n; 0 to 1 if n is 0."""
    return _interval(k, n, confidence, "exact")


def _interval(k: int, n: int, confidence: float, method: Literal["exact", "wilson"]) -> Interval:
    if n == 0:
        return Interval(0.0, 1.0)
    found = stats.binomtest(k, n).proportion_ci(confidence, method)
    return Interval(float(found.low), float(found.high))


def trend(successes: Sequence[int], totals: Sequence[int], scores: Sequence[float] | None = None) -> Trend:
    """Returns Cochran and Armitage's test for trend, with the variance for fixed sums.

    Args:
        successes: number of successes in each group.
        totals: number of trials in each group.
        scores: scores of the groups; None: 0, 1, 2, ...
    """
    k, n = np.asarray(successes, float), np.asarray(totals, float)
    x = np.arange(len(k), dtype=float) if scores is None else np.asarray(scores, float)
    total = float(n.sum())
    if total < 2:
        return Trend(0.0, 1.0)
    share, middle = k.sum() / total, (n * x).sum() / total
    variance = share * (1 - share) * (n * (x - middle) ** 2).sum() * total / (total - 1)
    if variance <= 0:
        return Trend(0.0, 1.0)
    z = float(((k - n * share) * x).sum() / np.sqrt(variance))
    return Trend(z, float(2 * stats.norm.sf(abs(z))))
