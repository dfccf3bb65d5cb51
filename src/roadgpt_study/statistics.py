"""Computes the statistical tests that only studies and surveys need, with scipy where it provides them.

scipy lacks Cochran and Armitage's trend test, Conover's pairwise comparisons and Krippendorff's alpha. For
Fisher's exact test of large tables it offers only an approximation. Ratings and missing ones are as in
``roadgpt.report.statistics``, and data that cannot answer the question give p = 1."""

from collections.abc import Sequence
from itertools import permutations
from math import nan, prod
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import special, stats

from roadgpt.geometry.curve import Array
from roadgpt.report.statistics import CONFIDENCE, Interval, complete_rows, holm

MOST_TABLES = 2_000_000  # tables with the same sums; if there are more, a sample of them is drawn
DRAWN, FEWEST = 99_999, 999  # number of tables that are drawn: usually, and if they are very large
MOST_CELLS, AT_ONCE = 20_000_000, 2_000_000  # cells of all tables that are drawn, and of those in memory
AS_RARE = 1e-7  # two tables whose log-probabilities differ by less are equally probable
RESAMPLES = 10_000
FEW_ORDERS = 8  # pairs up to which Spearman's test counts every order: 8! are 40,320


class Exact(NamedTuple):
    """Result of Fisher's exact test of a contingency table."""

    p: float
    tables: int  # number of tables that were enumerated or sampled
    is_drawn: bool  # true if tables were sampled at random, False if all tables were enumerated


class Correlation(NamedTuple):
    """Spearman's rank correlation of two columns."""

    rho: float
    p: float
    pairs: int


def bootstrap(groups: Sequence[Sequence[float]]) -> tuple[float, Interval]:
    """Returns the mean of all values, with its 95 % percentile interval from a bootstrap that resamples
    groups; empty groups are left out.

    Roads of one prompt are alike, so whole prompts are resampled. The random seed is fixed."""
    sums, sizes = (np.array([size(group) for group in groups if len(group)], float) for size in (sum, len))
    if not len(sums):
        return nan, Interval(nan, nan)
    value = float(sums.sum() / sizes.sum())
    if len(sums) == 1:
        return value, Interval(value, value)

    def mean(sums: Array, sizes: Array, axis: int) -> Array:
        return np.asarray(sums.sum(axis) / sizes.sum(axis))

    found = stats.bootstrap(
        (sums, sizes), mean, n_resamples=RESAMPLES, paired=True, vectorized=True, method="percentile",
        confidence_level=CONFIDENCE, rng=np.random.default_rng(0),
    )  # fmt: skip
    return value, Interval(*map(float, found.confidence_interval))


def exact(table: ArrayLike) -> Exact:
    """Returns Fisher's exact test of a table of counts ``(rows, columns)``, as extended by Freeman and
    Halton.

    p sums the probabilities of all tables with the same totals that are at most as probable. If the table has
    two rows or columns and there are few such tables, all are enumerated; otherwise they are sampled with a
    fixed seed, as by ``scipy.stats.fisher_exact``, which takes rounding errors for differences."""
    observed = np.asarray(table, int)
    observed = observed[observed.any(axis=1)][:, observed.any(axis=0)]
    if min(observed.shape) < 2:
        return Exact(1.0, 1, is_drawn=False)
    if observed.shape[1] != 2 and observed.shape[0] == 2:
        observed = observed.T
    if observed.shape[1] == 2 and prod(int(row) + 1 for row in observed[:-1].sum(axis=1)) <= MOST_TABLES:
        return _enumerated(observed)
    return _drawn(observed)


def _enumerated(observed: NDArray[np.intp]) -> Exact:
    rows, hits = observed.sum(axis=1), int(observed[:, 0].sum())
    first = np.indices([row + 1 for row in rows[:-1]]).reshape(len(rows) - 1, -1).T
    last = hits - first.sum(axis=1)
    possible = (last >= 0) & (last <= rows[-1])
    column = np.c_[first[possible], last[possible]]
    weight = _log_weight(np.stack([column, rows - column], axis=2))
    share = np.exp(weight - special.logsumexp(weight))
    rare = share[weight <= _log_weight(observed) + AS_RARE]
    return Exact(min(1.0, float(rare.sum())), len(column), is_drawn=False)


def _drawn(observed: NDArray[np.intp]) -> Exact:
    rng = np.random.default_rng(0)
    source = stats.random_table(observed.sum(axis=1), observed.sum(axis=0))
    tables = min(DRAWN, max(FEWEST, MOST_CELLS // observed.size))
    own, as_rare, at_once = _log_weight(observed), 0, max(1, AT_ONCE // observed.size)
    for first in range(0, tables, at_once):
        many = np.asarray(source.rvs(min(at_once, tables - first), random_state=rng))
        as_rare += int(np.count_nonzero(_log_weight(many) <= own + AS_RARE))
    return Exact((as_rare + 1) / (tables + 1), tables, is_drawn=True)


def _log_weight(tables: NDArray[Any]) -> Array:
    return np.asarray(-special.gammaln(tables + 1.0).sum(axis=(-2, -1)))


def trend(successes: Sequence[int], totals: Sequence[int]) -> tuple[float, float]:
    """Returns z and the two-sided p of Cochran and Armitage's test for a trend in the success rate from group
    to group; z is positive if the rate rises.

    z is r * sqrt(n - 1), where n is the number of all trials, and r is the correlation between the success of
    a trial (0 or 1) and the number of its group, with all totals held fixed."""
    k, n = np.asarray(successes, float), np.asarray(totals, float)
    x = np.arange(len(k), dtype=float)
    total = float(n.sum())
    if total < 2:
        return 0.0, 1.0
    share, middle = k.sum() / total, (n * x).sum() / total
    variance = share * (1 - share) * (n * (x - middle) ** 2).sum() * total / (total - 1)
    if variance <= 0:
        return 0.0, 1.0
    z = float(((k - n * share) * x).sum() / np.sqrt(variance))
    return z, float(2 * stats.norm.sf(abs(z)))


def conover(ratings: ArrayLike) -> Array:
    """Returns p-values ``(k, k)`` of Conover's test for each pair of the k rated columns, with Holm's
    correction.

    Sources: Conover, Practical nonparametric statistics, 3rd edition (1999), 5.8; Holm (1979)."""
    x = complete_rows(np.asarray(ratings, float))
    people, columns = x.shape
    out = np.ones((columns, columns))
    ranks = stats.rankdata(x, axis=1)
    spread = ((ranks - (columns + 1) / 2) ** 2).sum()
    if people < 2 or spread <= 0:
        return out
    sums, freedom = ranks.sum(axis=0), (people - 1) * (columns - 1)
    apart = ((sums - people * (columns + 1) / 2) ** 2).sum() / people
    error = 2 * people * (spread - apart) / freedom
    one, other = np.triu_indices(columns, 1)
    difference = np.abs(sums[one] - sums[other])
    if error <= 1e-12 * spread:  # all people ordered the columns alike: every difference is beyond doubt
        p = np.where(difference > 0, 0.0, 1.0)
    else:
        p = 2 * stats.t.sf(difference / np.sqrt(error), freedom)
    out[one, other] = out[other, one] = holm(p)
    return out


def spearman(one: ArrayLike, other: ArrayLike) -> Correlation:
    """Returns Spearman's rank correlation of two columns, two-sided; rho is NaN if a column is constant.

    For up to 8 pairs, p is exact, by all orders of the second column; for more, it is scipy's."""
    x, y = complete_rows(np.column_stack([np.ravel(one), np.ravel(other)])).T
    if len(x) < 3 or not np.ptp(x) or not np.ptp(y):
        return Correlation(nan, 1.0, len(x))
    found = stats.spearmanr(x, y)
    p = _ordered(x, y) if len(x) <= FEW_ORDERS else float(found.pvalue)
    return Correlation(float(found.statistic), p, len(x))


def _ordered(x: Array, y: Array) -> float:
    """Returns the share of all orders of y whose correlation with x is as strong as this one or stronger."""
    one, other = (ranks - ranks.mean() for ranks in (stats.rankdata(x), stats.rankdata(y)))
    orders = np.array(list(permutations(range(len(y)))))
    return float((np.abs(other[orders] @ one) >= abs(other @ one) - 1e-9).mean())


def krippendorff(ratings: ArrayLike) -> float:
    """Returns Krippendorff's alpha of ordinal ratings ``(people, units)``; NaN marks missing ratings.

    The distance between two values is the number of ratings between them, plus half of those that equal one
    of them. 1 is full agreement, 0 is agreement by chance, NaN that no disagreement is possible. Source:
    Krippendorff, Computing Krippendorff's alpha-reliability (2011)."""
    x = np.asarray(ratings, float)
    x = x[:, np.isfinite(x).sum(axis=0) >= 2]
    values = np.unique(x[np.isfinite(x)])
    if len(values) < 2:
        return nan
    counts = np.stack([(x == value).sum(axis=0) for value in values]).astype(float)  # (values, units)
    weighted = counts / (counts.sum(axis=0) - 1)
    pairs = weighted @ counts.T - np.diag(weighted.sum(axis=1))
    totals = counts.sum(axis=1)
    apart = np.subtract.outer(*2 * [np.cumsum(totals) - totals / 2]) ** 2
    by_chance = (np.outer(totals, totals) * apart).sum() / (totals.sum() - 1)
    return float(1 - (pairs * apart).sum() / by_chance)
