"""Computes the agreement of raters: Krippendorff's alpha, for any number of raters, with gaps.

Source: Krippendorff, Computing Krippendorff's alpha-reliability (2011).
"""

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

Level = Literal["nominal", "ordinal", "interval"]
Array = NDArray[np.float64]


def krippendorff(ratings: ArrayLike, level: Level = "ordinal") -> float:
    """Returns Krippendorff's alpha: 1 is full agreement, 0 agreement by chance.

    Args:
        ratings: numbers; only units that two or more people rated count.
        level: how far two values are apart: not at all or wholly (nominal), by the ratings that lie between
            them (ordinal), or by their squared difference (interval).

    Returns:
        Alpha; NaN where no unit has two ratings, or all ratings are one value, which nobody can disagree on.
    """
    x = np.atleast_2d(np.asarray(ratings, float))
    rated = np.isfinite(x)
    x = x[:, rated.sum(axis=0) >= 2]
    rated = np.isfinite(x)
    values = np.unique(x[rated])
    if len(values) < 2:
        return float("nan")
    # how often each value stands in each unit: (values, units)
    counts = np.stack([(x == value).sum(axis=0) for value in values]).astype(float)
    people = counts.sum(axis=0)
    pairs = (counts / (people - 1)) @ counts.T - np.diag((counts / (people - 1)).sum(axis=1))
    totals = counts.sum(axis=1)
    apart = _apart(values, totals, level)
    by_chance = (np.outer(totals, totals) * apart).sum() / (totals.sum() - 1)
    return float(1 - (pairs * apart).sum() / by_chance)


def _apart(values: Array, totals: Array, level: Level) -> Array:
    """Squared differences ``(values, values)``."""
    if level == "nominal":
        return 1.0 - np.eye(len(values))
    if level == "interval":
        return (values[:, None] - values[None, :]) ** 2
    middle = np.cumsum(totals) - totals / 2
    return np.asarray((middle[:, None] - middle[None, :]) ** 2, float)
