"""Tests by ranks whether ratings or measurements differ: paired, unpaired, and more than two columns."""

from dataclasses import dataclass
from itertools import permutations
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import stats

Array = NDArray[np.float64]

FEW_SIGNS = 50  # pairs that differ, up to which every way to sign their ranks is counted
FEW_ORDERS = 8  # pairs of a correlation, up to which every order is counted: 8! are 40,320


@dataclass(frozen=True)
class Friedman:
    """Result of Friedman's test: whether columns differ that the same people rated."""

    statistic: float
    freedom: int
    p: float
    kendalls_w: float
    """Kendall's W: 0 if people do not agree on the order of the columns, 1 if all agree."""
    people: int
    """Number of people who rated all columns."""


@dataclass(frozen=True)
class Paired:
    """Result of Wilcoxon's test: whether two columns differ that the same people rated."""

    statistic: float
    """The smaller sum of signed ranks."""
    p: float
    effect: float
    """Matched-pairs rank-biserial correlation, above 0 where the first is larger."""
    pairs: int
    """Number of pairs without a gap, equal ones included."""


@dataclass(frozen=True)
class Unpaired:
    """Result of Mann and Whitney's test: whether two groups differ."""

    statistic: float
    """U of the first group."""
    p: float
    a12: float
    """Vargha and Delaney's A12: how often the first group is larger, ties count half."""


@dataclass(frozen=True)
class Correlation:
    """Spearman's rank correlation of two columns."""

    rho: float
    p: float
    pairs: int


def friedman(ratings: ArrayLike) -> Friedman:
    """Returns Friedman's test of ratings ``(people, columns)``, corrected for ties; drops rows with gaps."""
    x = _complete(ratings)
    people, columns = x.shape
    if people < 2 or columns < 2:
        return Friedman(0.0, max(columns - 1, 0), 1.0, 0.0, people)
    ranks = stats.rankdata(x, axis=1)
    spread = _spread(ranks)
    if spread <= 0:  # everyone rated all columns alike
        return Friedman(0.0, columns - 1, 1.0, 0.0, people)
    apart = float(((ranks.sum(axis=0) - people * (columns + 1) / 2) ** 2).sum())
    statistic = apart * (columns - 1) / spread
    p = float(stats.chi2.sf(statistic, columns - 1))
    return Friedman(statistic, columns - 1, p, statistic / (people * (columns - 1)), people)


def conover(ratings: ArrayLike, adjust: Literal["holm", "none"] = "holm") -> Array:
    """Returns p ``(k, k)`` of every pair of columns of ratings ``(people, k)``, by Conover's test.

    Args:
        ratings: rows with a gap are left out.
        adjust: "holm" for all pairs together, or "none".

    Source: Conover, Practical nonparametric statistics, 3rd edition (1999), 5.8.
    """
    x = _complete(ratings)
    people, columns = x.shape
    out = np.ones((columns, columns))
    if people < 2 or columns < 2:
        return out
    ranks = stats.rankdata(x, axis=1)
    sums, spread = ranks.sum(axis=0), _spread(ranks)
    if spread <= 0:
        return out
    apart = ((sums - people * (columns + 1) / 2) ** 2).sum() / people
    freedom = (people - 1) * (columns - 1)
    error = 2 * people * (spread - apart) / freedom
    one, other = np.triu_indices(columns, 1)
    difference = np.abs(sums[one] - sums[other])
    if error <= 1e-12 * spread:  # all ordered the columns alike: any difference is beyond doubt
        p = np.where(difference > 0, 0.0, 1.0)
    else:
        p = 2 * stats.t.sf(difference / np.sqrt(error), freedom)
    out[one, other] = out[other, one] = _holm(p) if adjust == "holm" else p
    return out


def _spread(ranks: Array) -> float:
    """Returns the sum of squared ranks around their mean, over all people."""
    people, columns = ranks.shape
    return float((ranks**2).sum() - people * columns * (columns + 1) ** 2 / 4)


def _holm(p: Array) -> Array:
    order = np.argsort(p, kind="stable")
    scaled = p[order] * np.arange(len(p), 0, -1)
    out = np.empty_like(p)
    out[order] = np.minimum(np.maximum.accumulate(scaled), 1.0)
    return out


def wilcoxon(one: ArrayLike, other: ArrayLike) -> Paired:
    """Returns Wilcoxon's signed-rank test of two columns ``(people,)``, two-sided.

    Exact for up to 50 pairs that differ, ties included, as ratings have many of them: among five raters
    the normal approximation finds a difference where no five can show one. Normal beyond. Equal pairs are
    left out of the ranks.
    """
    x, y = _both(one, other)
    difference = x - y
    moved = difference[difference != 0]
    if not len(moved):
        return Paired(0.0, 1.0, 0.0, len(x))
    ranks = stats.rankdata(np.abs(moved))
    up, down = float(ranks[moved > 0].sum()), float(ranks[moved < 0].sum())
    is_few = len(moved) <= FEW_SIGNS
    p = _signed(ranks, min(up, down)) if is_few else float(stats.wilcoxon(moved, method="approx").pvalue)
    return Paired(min(up, down), p, (up - down) / (up + down), len(x))


def _signed(ranks: Array, smaller: float) -> float:
    """Returns the exact two-sided p: twice the share of sign patterns with this sum or a smaller one."""
    halves = np.rint(2 * ranks).astype(int)  # tied ranks are halves
    ways = np.ones(1)  # that lead to each sum
    for rank in halves:
        ways = np.r_[ways, np.zeros(rank)] + np.r_[np.zeros(rank), ways]
    return min(1.0, float(2 * ways[: round(2 * smaller) + 1].sum() / ways.sum()))


def mann_whitney(one: ArrayLike, other: ArrayLike) -> Unpaired:
    """Returns Mann and Whitney's U test of two groups, two-sided; NaN is left out."""
    x, y = _finite(one), _finite(other)
    if not len(x) or not len(y):
        return Unpaired(0.0, 1.0, 0.5)
    if len(np.unique(np.r_[x, y])) == 1:
        return Unpaired(len(x) * len(y) / 2, 1.0, 0.5)
    found = stats.mannwhitneyu(x, y)
    return Unpaired(float(found.statistic), float(found.pvalue), float(found.statistic) / (len(x) * len(y)))


def spearman(one: ArrayLike, other: ArrayLike) -> Correlation:
    """Returns Spearman's rank correlation of two columns, two-sided; rho is NaN if one of them is constant.

    Exact for up to 8 pairs, ties included, by every order of the second column; Student's t beyond.
    """
    x, y = _both(one, other)
    if len(x) < 3 or len(np.unique(x)) < 2 or len(np.unique(y)) < 2:
        return Correlation(float("nan"), 1.0, len(x))
    found = stats.spearmanr(x, y)
    p = _ordered(x, y) if len(x) <= FEW_ORDERS else float(found.pvalue)
    return Correlation(float(found.statistic), p, len(x))


def _ordered(x: Array, y: Array) -> float:
    """Returns the share of all orders of y whose correlation with x is as strong as this one or stronger."""
    one, other = (ranks - ranks.mean() for ranks in (stats.rankdata(x), stats.rankdata(y)))
    orders = np.array(list(permutations(range(len(y)))))
    return float((np.abs(other[orders] @ one) >= abs(other @ one) - 1e-9).mean())


def _complete(ratings: ArrayLike) -> Array:
    x = np.atleast_2d(np.asarray(ratings, float))
    return np.asarray(x[np.isfinite(x).all(axis=1)])


def _finite(values: ArrayLike) -> Array:
    x = np.asarray(values, float).ravel()
    return np.asarray(x[np.isfinite(x)])


def _both(one: ArrayLike, other: ArrayLike) -> tuple[Array, Array]:
    x, y = np.asarray(one, float).ravel(), np.asarray(other, float).ravel()
    finite = np.isfinite(x) & np.isfinite(y)
    return x[finite], y[finite]
