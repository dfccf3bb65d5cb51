"""Computes the statistical tests and confidence intervals for reports of studies and surveys, with scipy
where it provides them.

scipy lacks Cochran and Armitage's trend test, Conover's pairwise comparisons, Holm's correction, and
Krippendorff's alpha. For Fisher's exact test of large tables and Wilcoxon's test of tied ratings, scipy
offers only approximations. The tests in ``tests/authorities`` compare each function with other libraries,
published examples or enumerations.

Ratings are arrays ``(people, columns)`` of numbers; NaN marks a missing rating, and tests that need complete
rows leave out incomplete rows. If the data cannot answer the question (one column, no variation, no people),
a test returns p = 1 and an effect of 0 or NaN; it never raises an error."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import permutations
from math import nan, prod
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import special, stats

Array = NDArray[np.float64]

LEVEL = 0.05  # of all tests: differences with a smaller p count as significant
CONFIDENCE = 0.95  # of all intervals
FEW = 5.0  # Cochran (1954): an expected count below this is small
MOST_SMALL = 0.2  # share of small expected counts that the chi-squared test tolerates, if none is below 1
MOST_TABLES = 2_000_000  # tables with the same sums; if there are more, a sample of them is drawn
DRAWN, FEWEST = 99_999, 999  # number of tables that are drawn: usually, and if they are very large
MOST_CELLS, AT_ONCE = 20_000_000, 2_000_000  # cells of all tables that are drawn, and of those in memory
AS_RARE = 1e-7  # two tables whose log-probabilities differ by less are equally probable
FEW_SIGNS = 50  # differing pairs up to which Wilcoxon's test counts every way to sign their ranks
FEW_ORDERS = 8  # pairs up to which Spearman's test counts every order: 8! are 40,320
RESAMPLES = 10_000


class Interval(NamedTuple):
    """An interval from ``lo`` to ``hi``."""

    lo: float
    hi: float


@dataclass(frozen=True, eq=False)
class ChiSquared:
    """Pearson's chi-squared test without continuity correction, with its intermediate values."""

    expected: Array  # expected count of each cell
    terms: Array  # (observed - expected)^2 / expected of each cell; 0 where the expected count is 0
    statistic: float
    freedom: int  # degrees of freedom, computed without empty rows and columns
    critical: float
    """Critical value of the statistic at the 5 % level; NaN if there are no degrees of freedom."""
    p: float
    cramers_v: float

    @property
    def is_sound(self) -> bool:
        """Whether Cochran's rule holds: no expected count is below 1, and at most 20 % of the expected counts
        are below 5.

        Empty rows and columns are left out, as in the test. False if there are no degrees of freedom."""
        present = self.expected[self.expected > 0]
        return bool(self.freedom and present.min() >= 1 and (present < FEW).mean() <= MOST_SMALL)


class Exact(NamedTuple):
    """Result of Fisher's exact test of a contingency table."""

    p: float
    tables: int  # number of tables that were enumerated or sampled
    is_drawn: bool  # true if tables were sampled at random, False if all tables were enumerated


class Friedman(NamedTuple):
    """Result of Friedman's test of whether ratings by the same people differ between columns."""

    statistic: float
    freedom: int
    p: float
    kendalls_w: float
    """Kendall's W: 0 if the people do not agree on the ranking of the columns, 1 if they agree completely."""
    people: int  # number of people who rated all columns


class Paired(NamedTuple):
    """Result of Wilcoxon's test of whether two columns of ratings by the same people differ."""

    statistic: float  # rank sum of the positive or of the negative differences, whichever is smaller
    p: float
    effect: float  # matched-pairs rank-biserial correlation; positive if the first column is larger
    pairs: int  # number of people who rated both columns, including people who gave both the same rating


class Correlation(NamedTuple):
    """Spearman's rank correlation of two columns."""

    rho: float
    p: float
    pairs: int


def wilson(k: int, n: int) -> Interval:
    """Returns Wilson's 95 % score interval of the proportion k / n; 0 to 1 if n is 0."""
    return Interval(*stats.binomtest(k, n).proportion_ci(CONFIDENCE, "wilson")) if n else Interval(0.0, 1.0)


def clopper_pearson(k: int, n: int) -> Interval:
    """Returns Clopper and Pearson's exact 95 % interval of the proportion k / n; 0 to 1 if n is 0."""
    return Interval(*stats.binomtest(k, n).proportion_ci(CONFIDENCE, "exact")) if n else Interval(0.0, 1.0)


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


def chi_squared(table: ArrayLike) -> ChiSquared:
    """Returns Pearson's chi-squared test of a table of counts ``(rows, columns)``.

    Empty rows and columns are left out of the test. If fewer than two rows or fewer than two columns are
    left, the statistic is 0 and p is 1."""
    observed = np.asarray(table, int)
    expected = stats.contingency.expected_freq(observed) if observed.any() else observed.astype(float)
    terms = np.divide((observed - expected) ** 2, expected, out=np.zeros_like(expected), where=expected > 0)
    present = observed[observed.any(axis=1)][:, observed.any(axis=0)]
    if min(present.shape) < 2:
        return ChiSquared(expected, terms, 0.0, 0, nan, 1.0, 0.0)
    found = stats.chi2_contingency(present, correction=False)
    statistic, p, freedom = float(found.statistic), float(found.pvalue), int(found.dof)
    cramers_v = float(stats.contingency.association(present, method="cramer"))
    return ChiSquared(
        expected, terms, statistic, freedom, float(stats.chi2.isf(LEVEL, freedom)), p, cramers_v
    )


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


def friedman(ratings: ArrayLike) -> Friedman:
    """Returns Friedman's test of ratings ``(people, 3 or more)``, corrected for ties. For ratings of 0 and 1
    it is Cochran's Q test."""
    x = _complete(np.asarray(ratings, float))
    people, columns = x.shape
    if people < 2 or not np.ptp(x, axis=1).any():  # or all people rated all columns alike
        return Friedman(0.0, columns - 1, 1.0, 0.0, people)
    found = stats.friedmanchisquare(*x.T)
    statistic = float(found.statistic)
    return Friedman(statistic, columns - 1, float(found.pvalue), statistic / (people * (columns - 1)), people)


def conover(ratings: ArrayLike) -> Array:
    """Returns p-values ``(k, k)`` of Conover's test for each pair of the k rated columns, with Holm's
    correction.

    Sources: Conover, Practical nonparametric statistics, 3rd edition (1999), 5.8; Holm (1979)."""
    x = _complete(np.asarray(ratings, float))
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


def holm(p: ArrayLike) -> Array:
    """Returns p-values ``(tests,)`` with Holm's correction for the number of tests."""
    found = np.asarray(p, float)
    order = np.argsort(found, kind="stable")
    scaled = np.minimum(np.maximum.accumulate(found[order] * np.arange(len(order), 0, -1)), 1.0)
    return scaled[np.argsort(order, kind="stable")]


def mcnemar(one: int, other: int) -> float:
    """Returns the two-sided p of McNemar's exact test for the two counts of pairs that differ."""
    return float(stats.binomtest(one, one + other).pvalue) if one + other else 1.0


def wilcoxon(one: ArrayLike, other: ArrayLike) -> Paired:
    """Returns Wilcoxon's two-sided signed-rank test of two columns ``(people,)``.

    People who gave both columns the same rating are left out. For up to 50 others, p is exact, even if
    differences are tied; for more, it is scipy's approximation."""
    x, y = _complete(np.column_stack([np.ravel(one), np.ravel(other)])).T
    moved = (x - y)[x != y]
    if not len(moved):
        return Paired(0.0, 1.0, 0.0, len(x))
    ranks = stats.rankdata(np.abs(moved))
    up, down = float(ranks[moved > 0].sum()), float(ranks[moved < 0].sum())
    if len(moved) <= FEW_SIGNS:
        p = _signed(ranks, min(up, down))
    else:
        p = float(stats.wilcoxon(moved, method="approx").pvalue)
    return Paired(min(up, down), p, (up - down) / (up + down), len(x))


def _signed(ranks: Array, smaller: float) -> float:
    """Returns the exact two-sided p: twice the share of sign patterns with this sum or a smaller one."""
    ways = np.ones(1)  # to reach each sum of doubled ranks, which are whole numbers even with ties
    for rank in np.rint(2 * ranks).astype(int):
        ways = np.r_[ways, np.zeros(rank)] + np.r_[np.zeros(rank), ways]
    return min(1.0, float(2 * ways[: round(2 * smaller) + 1].sum() / ways.sum()))


def spearman(one: ArrayLike, other: ArrayLike) -> Correlation:
    """Returns Spearman's rank correlation of two columns, two-sided; rho is NaN if a column is constant.

    For up to 8 pairs, p is exact, by all orders of the second column; for more, it is scipy's."""
    x, y = _complete(np.column_stack([np.ravel(one), np.ravel(other)])).T
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


def _complete(x: Array) -> Array:
    return np.asarray(x[np.isfinite(x).all(axis=1)], float)
