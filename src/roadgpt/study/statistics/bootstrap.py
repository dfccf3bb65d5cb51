"""Computes the confidence interval of a mean by resampling prompts, since roads of one prompt are alike."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from roadgpt.study.statistics.shares import Interval


class Estimate(NamedTuple):
    """A mean with its confidence interval."""

    value: float
    interval: Interval


def bootstrap(
    groups: Sequence[ArrayLike], confidence: float = 0.95, resamples: int = 10_000, seed: int = 0
) -> Estimate:
    """Returns the mean of all values, with the percentile interval of resampling whole groups.

    Args:
        groups: the values of each group, such as the roads of a prompt; empty groups are left out.
        confidence: confidence level of the interval.
        resamples: number of resamples.
        seed: seed of the resampling; the same seed gives the same interval.
    """
    values = [np.asarray(group, float).ravel() for group in groups]
    values = [group for group in values if len(group)]
    if not values:
        return Estimate(float("nan"), Interval(float("nan"), float("nan")))
    sums, sizes = np.array([g.sum() for g in values]), np.array([len(g) for g in values])
    drawn = np.random.default_rng(seed).integers(len(values), size=(resamples, len(values)))
    means = sums[drawn].sum(axis=1) / sizes[drawn].sum(axis=1)
    low, high = np.quantile(means, [(1 - confidence) / 2, (1 + confidence) / 2])
    return Estimate(float(sums.sum() / sizes.sum()), Interval(float(low), float(high)))
