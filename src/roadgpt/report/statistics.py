"""Computes the statistical tests and confidence intervals for reports, with scipy where it provides them.

scipy lacks Holm's correction; for Wilcoxon's test of tied ratings it offers only an approximation. The tests
in ``tests/authorities`` compare each function with other libraries, published examples or enumerations.

Ratings are arrays ``(people, columns)`` of numbers; NaN marks a missing rating, and tests that need complete
rows leave out incomplete rows. If the data cannot answer the question (one column, no variation, no people),
a test returns p = 1 and an effect of 0 or NaN; it never raises an error."""

from dataclasses import dataclass
from math import nan
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy import stats

from roadgpt.geometry.curve import Array

LEVEL = 0.05  # of all tests: differences with a smaller p count as significant
CONFIDENCE = 0.95  # of all intervals
FEW = 5.0  # Cochran (1954): an expected count below this is small
MOST_SMALL = 0.2  # share of small expected counts that the chi-squared test tolerates, if none is below 1
FEW_SIGNS = 50  # differing pairs up to which Wilcoxon's test counts every way to sign their ranks


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


def wilson(k: int, n: int) -> Interval:
    """Returns Wilson's 95 % score interval of the proportion k / n; 0 to 1 if n is 0."""
    return Interval(*stats.binomtest(k, n).proportion_ci(CONFIDENCE, "wilson")) if n else Interval(0.0, 1.0)


def clopper_pearson(k: int, n: int) -> Interval:
    """Returns Clopper and Pearson's exact 95 % interval of the proportion k / n; 0 to 1 if n is 0."""
    return Interval(*stats.binomtest(k, n).proportion_ci(CONFIDENCE, "exact")) if n else Interval(0.0, 1.0)


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


def friedman(ratings: ArrayLike) -> Friedman:
    """Returns Friedman's test of ratings ``(people, 3 or more)``, corrected for ties. For ratings of 0 and 1
    it is Cochran's Q test."""
    x = complete_rows(np.asarray(ratings, float))
    people, columns = x.shape
    if people < 2 or not np.ptp(x, axis=1).any():  # or all people rated all columns alike
        return Friedman(0.0, columns - 1, 1.0, 0.0, people)
    found = stats.friedmanchisquare(*x.T)
    statistic = float(found.statistic)
    return Friedman(statistic, columns - 1, float(found.pvalue), statistic / (people * (columns - 1)), people)


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
    x, y = complete_rows(np.column_stack([np.ravel(one), np.ravel(other)])).T
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


def complete_rows(x: Array) -> Array:
    """Returns the rows without a missing rating."""
    return np.asarray(x[np.isfinite(x).all(axis=1)], float)
