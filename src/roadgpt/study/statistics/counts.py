"""Do rows of a table of counts differ? Chi-squared, term by term, and the exact test beside it."""

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
    """Pearson's test of independence, without continuity correction, with all that leads to it."""

    observed: Array
    expected: Array
    terms: Array
    """(observed - expected)^2 / expected of every cell; 0 where nothing is expected."""
    statistic: float
    freedom: int
    """Degrees; rows and columns without a count are not counted."""
    level: float
    critical: float
    """What the statistic must exceed at this level; NaN without a degree of freedom."""
    p: float
    cramers_v: float

    @property
    def rejects(self) -> bool:
        """Do the rows differ, at this level?"""
        return self.p < self.level

    @property
    def is_sound(self) -> bool:
        """Cochran's rule: no expected count below 1, and at most a fifth below 5.

        Empty rows and columns are left out, as in the test.
        """
        told = self.expected[self.expected > 0]
        return bool(self.freedom and told.min() >= 1 and (told < FEW).mean() <= MOST_SMALL)


@dataclass(frozen=True)
class Exact:
    """The exact test of a table."""

    p: float
    tables: int
    """How many were counted out, or drawn."""
    is_drawn: bool
    """Drawn at random, from a seed, where there were too many to count out."""


def chi_squared(table: ArrayLike, level: float = 0.05) -> ChiSquared:
    """Pearson's chi-squared of counts ``(rows, columns)``.

    Rows and columns without a count tell nothing and are left out of the degrees of freedom; where fewer than
    two of either are left, the statistic is 0 and p is 1.

    Raises:
        UsageError: it is no table, or holds a negative or broken number.
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
    """Fisher's exact test, after Freeman and Halton for larger tables: the share of tables with the same sums
    that are as rare as this one or rarer.

    Args:
        table: counts ``(rows, columns)``.
        seed: of the tables that are drawn, where there are too many to count out.

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
    """All tables of two columns with the same sums, told by their first column."""
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
    """Tables with the same sums, drawn; this one counts among them."""
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
