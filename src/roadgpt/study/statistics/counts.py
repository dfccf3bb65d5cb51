"""Tests whether the rows of a table of counts differ: chi-squared term by term, and the exact test."""

from dataclasses import dataclass
from math import prod

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import special, stats

from roadgpt.errors import UsageError

Array = NDArray[np.float64]

FEW = 5.0  # Cochran (1954): an expected count below this is small
MOST_SMALL = 0.2  # share of small ones that chi-squared bears, and none below 1
MOST_TABLES = 2_000_000  # that are counted out before tables are drawn instead
DRAWN, FEWEST = 99_999, 999  # tables that are drawn: as a rule, and of the largest tables
MOST_CELLS, AT_ONCE = 20_000_000, 2_000_000  # of all tables that are drawn, and of those in memory
AS_RARE = 1e-7  # relative, two tables whose probabilities differ by less are as rare


@dataclass(frozen=True, eq=False)
class ChiSquared:
    """Pearson's chi-squared test without continuity correction, with its intermediate values."""

    observed: Array
    expected: Array
    terms: Array
    """(observed - expected)^2 / expected of every cell; 0 where the expected count is 0."""
    statistic: float
    freedom: int
    """Degrees of freedom; empty rows and columns do not count."""
    level: float
    critical: float
    """Critical value of the statistic at this level; NaN without a degree of freedom."""
    p: float
    cramers_v: float

    @property
    def rejects(self) -> bool:
        """Whether the rows differ at this level."""
        return self.p < self.level

    @property
    def is_sound(self) -> bool:
        """Whether Cochran's rule holds: no expected count is below 1, and at most a fifth are below 5.

        Empty rows and columns are left out, as in the test.
        """
        present = self.expected[self.expected > 0]
        return bool(self.freedom and present.min() >= 1 and (present < FEW).mean() <= MOST_SMALL)


@dataclass(frozen=True)
class Exact:
    """Result of the exact test of a table."""

    p: float
    tables: int
    """Number of tables that were enumerated or drawn."""
    is_drawn: bool
    """Whether tables were drawn at random, because there were too many to enumerate."""


def chi_squared(table: ArrayLike, level: float = 0.05) -> ChiSquared:
    """Returns Pearson's chi-squared test of a table of counts ``(rows, columns)``.

    Empty rows and columns are left out of the degrees of freedom. If fewer than two of either are left, the
    statistic is 0 and p is 1.

    Raises:
        UsageError: the table is not two-dimensional, or contains a negative or non-finite number.
    """
    observed = _counts(table)
    rows, columns = observed.sum(axis=1), observed.sum(axis=0)
    total = observed.sum()
    expected = np.outer(rows, columns) / (total or 1.0)
    terms = np.divide((observed - expected) ** 2, expected, out=np.zeros_like(expected), where=expected > 0)
    rank = [max(0, int(np.count_nonzero(sums)) - 1) for sums in (rows, columns)]
    freedom = rank[0] * rank[1]
    statistic = float(terms.sum())
    return ChiSquared(
        observed,
        expected,
        terms,
        statistic if freedom else 0.0,
        freedom,
        level,
        float(stats.chi2.isf(level, freedom)) if freedom else float("nan"),
        float(stats.chi2.sf(statistic, freedom)) if freedom else 1.0,
        float(np.sqrt(statistic / (total * min(rank)))) if freedom else 0.0,
    )


def exact(table: ArrayLike, seed: int = 0) -> Exact:
    """Returns Fisher's exact test, or Freeman and Halton's for larger tables.

    p is the share of tables with the same sums that are as rare as this one or rarer.

    Args:
        table: counts ``(rows, columns)``.
        seed: seed of the tables that are drawn if there are too many to enumerate.

    Raises:
        UsageError: as for ``chi_squared``.
    """
    observed = _counts(table)
    observed = observed[observed.sum(axis=1) > 0][:, observed.sum(axis=0) > 0].astype(int)
    if min(observed.shape, default=0) < 2:
        return Exact(1.0, 1, is_drawn=False)
    if observed.shape[1] != 2 and observed.shape[0] == 2:
        observed = observed.T
    rows = observed.sum(axis=1)
    if observed.shape[1] == 2 and prod(int(row) + 1 for row in rows[:-1]) <= MOST_TABLES:
        return _counted(observed)
    return _drawn(observed, seed)


def _counted(observed: NDArray[np.intp]) -> Exact:
    """Enumerates all tables of two columns with the same sums, by their first column."""
    rows, hits = observed.sum(axis=1), int(observed[:, 0].sum())
    first = np.indices([row + 1 for row in rows[:-1]]).reshape(len(rows) - 1, -1).T
    last = hits - first.sum(axis=1)
    there = (last >= 0) & (last <= rows[-1])
    tables = np.c_[first[there], last[there]]
    weight = _log_choices(rows, tables).sum(axis=1)
    own = _log_choices(rows, observed[:, 0]).sum()
    share = np.exp(weight - special.logsumexp(weight))
    return Exact(min(1.0, float(share[weight <= own + AS_RARE].sum())), len(tables), is_drawn=False)


def _drawn(observed: NDArray[np.intp], seed: int) -> Exact:
    """Draws tables with the same sums at random; the observed one counts among them."""
    rng = np.random.default_rng(seed)
    source = stats.random_table(observed.sum(axis=1), observed.sum(axis=0))
    tables = min(DRAWN, max(FEWEST, MOST_CELLS // observed.size))
    own, as_rare, at_once = -special.gammaln(observed + 1.0).sum(), 0, max(1, AT_ONCE // observed.size)
    for first in range(0, tables, at_once):
        many = np.asarray(source.rvs(min(at_once, tables - first), random_state=rng))
        weight = -special.gammaln(many + 1.0).sum(axis=(1, 2))
        as_rare += int(np.count_nonzero(weight <= own + AS_RARE))
    return Exact((as_rare + 1) / (tables + 1), tables, is_drawn=True)


def _log_choices(of: NDArray[np.intp], taken: NDArray[np.intp]) -> Array:
    out = special.gammaln(of + 1.0) - special.gammaln(taken + 1.0) - special.gammaln(of - taken + 1.0)
    return np.asarray(out, float)


def _counts(table: ArrayLike) -> Array:
    counts = np.asarray(table, float)
    if counts.ndim != 2 or not np.isfinite(counts).all() or (counts < 0).any():
        raise UsageError("a table of counts has rows and columns of whole numbers from 0 up")
    return counts
