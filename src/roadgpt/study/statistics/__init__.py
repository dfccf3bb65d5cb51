"""Statistics of studies, on scipy; each equals another library or a published example, as tests show.

counts      chi_squared(table, level=0.05) -> ChiSquared      with expected values, terms, Cramer's V
            exact(table, seed=0) -> Exact                     Fisher, Freeman and Halton
            wilson(k, n, confidence=0.95) -> Interval         of a share
            clopper_pearson(k, n, confidence=0.95) -> Interval
            trend(successes, totals, scores=None) -> Trend    Cochran and Armitage's z, signed
ranks       friedman(ratings) -> Friedman                     rows are people, columns what they rated
            conover(ratings, adjust="holm") -> Array (k, k)   p of every pair of columns after Friedman
            wilcoxon(one, other) -> Paired                    with the matched-pairs rank-biserial correlation
            mann_whitney(one, other) -> Unpaired              with Vargha and Delaney's A12
            spearman(one, other) -> Correlation
agreement   krippendorff(ratings, level="ordinal") -> float   rows are people, columns units; NaN: not rated
bootstrap   bootstrap(groups, confidence=0.95, resamples=10_000, seed=0) -> Estimate    by prompt, not by road

Ratings are numbers; NaN is what nobody rated. Where a test needs complete rows, others are left out. A
question that the data cannot answer (one column, no variation, nobody) gives p = 1 and an effect of 0, or NaN
where there is nothing to tell; it never raises.
"""

from roadgpt.study.statistics.agreement import krippendorff
from roadgpt.study.statistics.bootstrap import Estimate, bootstrap
from roadgpt.study.statistics.counts import ChiSquared, Exact, chi_squared, exact
from roadgpt.study.statistics.ranks import (
    Correlation,
    Friedman,
    Paired,
    Unpaired,
    conover,
    friedman,
    mann_whitney,
    spearman,
    wilcoxon,
)
from roadgpt.study.statistics.shares import Interval, Trend, clopper_pearson, trend, wilson

__all__ = [
    "ChiSquared",
    "Correlation",
    "Estimate",
    "Exact",
    "Friedman",
    "Interval",
    "Paired",
    "Trend",
    "Unpaired",
    "bootstrap",
    "chi_squared",
    "clopper_pearson",
    "conover",
    "exact",
    "friedman",
    "krippendorff",
    "mann_whitney",
    "spearman",
    "trend",
    "wilcoxon",
    "wilson",
]
