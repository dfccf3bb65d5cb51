"""Statistics of studies against statsmodels, scikit-posthocs, enumerations and published examples."""

import itertools
import math
import warnings

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy import stats

from roadgpt.report.statistics import (
    chi_squared,
    clopper_pearson,
    friedman,
    holm,
    mcnemar,
    wilcoxon,
    wilson,
)
from roadgpt_study import statistics
from roadgpt_study.statistics import bootstrap, conover, exact, krippendorff, spearman, trend

THESIS = [[88, 12], [57, 43], [37, 63]]
LEFT = [[1, 87], [2, 55], [5, 32]]
NAN = math.nan
# Krippendorff, Computing Krippendorff's alpha-reliability (2011), section C: 4 observers, 12 units
KRIPPENDORFF = [
    [1, 2, 3, 3, 2, 1, 4, 1, 2, NAN, NAN, NAN],
    [1, 2, 3, 3, 2, 2, 4, 1, 2, 5, NAN, 3],
    [NAN, 3, 3, 3, 2, 3, 4, 2, 2, 5, 1, NAN],
    [1, 2, 3, 3, 2, 4, 4, 1, 2, 5, 1, NAN],
]
tables = st.integers(2, 4).flatmap(
    lambda rows: st.lists(st.tuples(st.integers(0, 9), st.integers(0, 9)), min_size=rows, max_size=rows)
)


def test_the_thesis_own_table_term_by_term() -> None:
    """Its table 6.3, and what follows from it."""
    found = chi_squared(THESIS)
    assert found.statistic == pytest.approx(55.3455, abs=1e-4)
    assert found.terms.round(2).tolist() == [[12.32, 18.99], [0.22, 0.34], [9.23, 14.24]]
    assert found.expected.round(2).tolist() == [[60.67, 39.33]] * 3
    assert (found.freedom, round(found.critical, 2)) == (2, 5.99)
    assert found.p == pytest.approx(9.6e-13, rel=0.01)
    assert found.cramers_v == pytest.approx(0.43, abs=0.005)
    assert found.is_sound


def test_the_thesis_drives_need_the_exact_test() -> None:
    found = chi_squared(LEFT)
    assert (round(found.statistic, 2), round(found.p, 3)) == (9.65, 0.008)
    assert not found.is_sound
    assert exact(LEFT).p == pytest.approx(brute_force(LEFT), rel=1e-9)
    assert exact(LEFT).p == pytest.approx(0.0104, abs=5e-5)
    method = stats.MonteCarloMethod(n_resamples=9999, rng=np.random.default_rng(0))
    assert exact(LEFT).p == pytest.approx(stats.fisher_exact(LEFT, method=method).pvalue, abs=0.004)


def brute_force(table: list[list[int]]) -> float:
    """The exact test with whole numbers, by the book."""
    rows, hits = [sum(row) for row in table], sum(row[0] for row in table)

    def ways(first: tuple[int, ...]) -> int:
        return math.prod(math.comb(row, k) for row, k in zip(rows, first, strict=True))

    own, total, rare = ways(tuple(row[0] for row in table)), 0, 0
    for first in itertools.product(*(range(row + 1) for row in rows)):
        if sum(first) == hits:
            total += ways(first)
            rare += ways(first) if ways(first) <= own else 0
    return rare / total


@given(table=tables)
def test_chi_squared_is_that_of_statsmodels_and_the_exact_test_is_right(table) -> None:
    from statsmodels.stats.contingency_tables import Table

    found = chi_squared(table)
    rows, columns = np.sum(table, axis=1), np.sum(table, axis=0)
    assert 0 <= exact(table).p <= 1
    assume((rows > 0).all() and (columns > 0).all())
    other = Table(np.array(table), shift_zeros=False)
    theirs = other.test_nominal_association()
    assert found.statistic == pytest.approx(theirs.statistic, abs=1e-9)
    assert (found.p, found.freedom) == (pytest.approx(theirs.pvalue, abs=1e-12), theirs.df)
    assert found.expected == pytest.approx(other.fittedvalues)
    assert found.terms == pytest.approx(other.resid_pearson**2)
    assert found.cramers_v == pytest.approx(math.sqrt(found.statistic / rows.sum()), abs=1e-9)
    if rows.sum() < 30:
        assert exact(table).p == pytest.approx(brute_force([list(row) for row in table]), abs=1e-9)


def test_tables_too_many_to_count_are_drawn_from_a_seed(monkeypatch: pytest.MonkeyPatch) -> None:
    counted = exact(LEFT)
    monkeypatch.setattr(statistics, "MOST_TABLES", 1)
    drawn = exact(LEFT)
    assert drawn.is_drawn
    assert drawn == exact(LEFT)
    assert drawn.p == pytest.approx(counted.p, abs=4 * math.sqrt(counted.p / drawn.tables))
    assert exact([[3, 1, 4], [1, 5, 9], [2, 6, 5]]).is_drawn


@given(n=st.integers(1, 400), share=st.floats(0, 1))
def test_intervals_are_those_of_statsmodels(n, share) -> None:
    from statsmodels.stats.proportion import proportion_confint

    k = round(n * share)
    for ours, name in ((wilson, "wilson"), (clopper_pearson, "beta")):
        low, high = proportion_confint(k, n, 0.05, method=name)
        low, high = np.nan_to_num(low, nan=0.0), np.nan_to_num(high, nan=1.0)
        assert ours(k, n) == pytest.approx((low, high), abs=1e-9)


def test_published_intervals() -> None:
    """Wilson, of the thesis' drives; Clopper and Pearson, of 10 of 10: Hanley and Lippman-Hand's rule."""
    assert wilson(8, 182) == pytest.approx((0.0224, 0.0843), abs=1e-4)
    assert clopper_pearson(10, 10).lo == pytest.approx(0.025 ** (1 / 10))
    assert wilson(0, 0) == clopper_pearson(0, 0) == (0, 1)


@given(table=tables)
def test_trend_is_that_of_statsmodels(table) -> None:
    from statsmodels.stats.contingency_tables import Table

    rows, columns = np.sum(table, axis=1), np.sum(table, axis=0)
    assume((rows > 0).all() and (columns > 0).all())
    z, p = trend([row[0] for row in table], rows.tolist())
    # in their table the first row counts misses, and scores go up along the columns
    other = Table(np.array(table)[:, ::-1].T, shift_zeros=False)
    theirs = other.test_ordinal_association(row_scores=np.arange(2), col_scores=np.arange(len(table)))
    assert z == pytest.approx(theirs.zscore, abs=1e-9)
    assert p == pytest.approx(theirs.pvalue, abs=1e-9)


def test_the_trend_of_the_thesis() -> None:
    assert trend([88, 57, 37], [100] * 3)[0] == pytest.approx(-7.37, abs=0.005)
    assert trend([100, 100], [100, 100]) == (0, 1)


ratings = st.integers(0, 2**32 - 1).map(
    lambda seed: np.random.default_rng(seed).integers(1, 6, (8, 4)).astype(float)
)


@settings(max_examples=8)
@given(x=ratings)
def test_friedman_and_conover_are_theirs(x) -> None:
    import scikit_posthocs

    found = friedman(x)
    ranks = stats.rankdata(x, axis=1)
    agreed = ranks.sum(axis=0).var() / (ranks.var() * len(x) ** 2)  # Kendall's W, by its definition
    assert (found.kendalls_w, found.statistic) == pytest.approx((agreed, agreed * 8 * 3))
    assert found.p == pytest.approx(
        math.erfc(math.sqrt(found.statistic / 2))
        + math.sqrt(2 * found.statistic / math.pi) * math.exp(-found.statistic / 2)
    )  # chi-squared with 3 degrees of freedom
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        other = scikit_posthocs.posthoc_conover_friedman(x, p_adjust="holm").to_numpy()
    assert conover(x) == pytest.approx(other, abs=1e-9)


def test_conovers_own_example() -> None:
    """Practical nonparametric statistics, 3rd edition, 5.8, example 1: grasses that homeowners ranked."""
    grass = [
        [4, 3, 2, 1], [4, 2, 3, 1], [3, 1.5, 1.5, 4], [3, 1, 2, 4], [4, 2, 1, 3], [2, 2, 2, 4],
        [1, 3, 2, 4], [2, 4, 1, 3], [3.5, 1, 2, 3.5], [4, 1, 3, 2], [4, 2, 3, 1], [3.5, 1, 2, 3.5],
    ]  # fmt: skip
    found = friedman(grass)
    assert found.statistic == pytest.approx(8.097, abs=5e-4)
    assert found.freedom == 3
    p = conover(grass)
    # its conclusion: the first grass differs from the second and the third, and no others differ; Holm
    # multiplies the smallest of six p by 6, the next by 5, and the third by 4
    assert p[0, 1] / 6 < 0.05
    assert p[0, 2] / 5 < 0.05
    assert p[1, 3] / 4 > 0.05


def test_cochrans_q_of_conovers_own_example() -> None:
    """Practical nonparametric statistics, 3rd edition, 4.6: three sportsmen predict twelve games; Q = 2.8."""
    from statsmodels.stats.contingency_tables import cochrans_q

    right = ["111", "111", "010", "110", "000", "111", "111", "110", "001", "010", "111", "111"]
    table = [[float(one) for one in game] for game in right]
    found = friedman(table)
    assert (found.statistic, found.freedom) == (pytest.approx(2.8), 2)
    assert found.p == pytest.approx(math.exp(-1.4))  # chi-squared with 2 degrees of freedom
    assert found.statistic == pytest.approx(cochrans_q(np.array(table)).statistic)


@given(b=st.integers(0, 40), c=st.integers(0, 40))
def test_mcnemars_exact_test_counts_coins(b, c) -> None:
    ways = [math.comb(b + c, k) for k in range(b + c + 1)]
    assert mcnemar(b, c) == pytest.approx(min(1.0, 2 * sum(ways[: min(b, c) + 1]) / sum(ways)))


@given(p=st.lists(st.floats(0, 1), min_size=1, max_size=8))
def test_holm_is_that_of_statsmodels(p) -> None:
    from statsmodels.stats.multitest import multipletests

    assert holm(p) == pytest.approx(multipletests(p, method="holm")[1])


def test_krippendorffs_own_example() -> None:
    assert krippendorff(KRIPPENDORFF) == pytest.approx(0.815, abs=5e-4)


@given(seed=st.integers(0, 10**6))
def test_alpha_is_one_less_the_ratio_of_disagreements(seed) -> None:
    """By the definition, pair by pair."""
    rng = np.random.default_rng(seed)
    x = rng.integers(1, 5, (4, 6)).astype(float)
    x[rng.random(x.shape) < 0.25] = NAN
    units = [[v for v in column if not math.isnan(v)] for column in x.T]
    units = [unit for unit in units if len(unit) > 1]
    every = [v for unit in units for v in unit]
    assume(len(set(every)) > 1)

    def apart(a: float, b: float) -> float:
        low, high = min(a, b), max(a, b)
        between = sum(low <= v <= high for v in every)
        return (between - (every.count(a) + every.count(b)) / 2) ** 2 if a != b else 0.0

    seen = sum(
        sum(apart(a, b) for a, b in itertools.permutations(unit, 2)) / (len(unit) - 1) for unit in units
    ) / len(every)
    chance = sum(apart(a, b) for a, b in itertools.permutations(every, 2)) / (len(every) * (len(every) - 1))
    assert krippendorff(x) == pytest.approx(1 - seen / chance)


@given(seed=st.integers(0, 10**6), whole=st.booleans())
def test_ranks_with_their_effects(seed, whole) -> None:
    rng = np.random.default_rng(seed)
    x, y = (rng.integers(1, 6, 14).astype(float) if whole else rng.normal(size=14) for _ in range(2))
    assume(np.ptp(x) > 0 and np.ptp(y) > 0 and (x != y).any())
    paired = wilcoxon(x, y)
    ranks = stats.rankdata(np.abs((x - y)[x != y]))
    signed = np.sign((x - y)[x != y])
    assert paired.effect == pytest.approx((ranks * signed).sum() / ranks.sum())
    assert paired.statistic == pytest.approx(min(ranks[signed > 0].sum(), ranks[signed < 0].sum()))
    if not whole:
        assert paired.p == pytest.approx(stats.wilcoxon(x, y, method="exact").pvalue)
    found, rho = spearman(x, y), np.corrcoef(stats.rankdata(x), stats.rankdata(y))[0, 1]
    assert found.rho == pytest.approx(rho)
    assert found.p == pytest.approx(2 * stats.t.sf(abs(rho) * math.sqrt(12 / (1 - rho**2)), 12))


@settings(max_examples=25)
@given(seed=st.integers(0, 10**6), pairs=st.integers(1, 9))
def test_few_tied_ratings_are_signed_in_every_way(seed, pairs) -> None:
    """By the definition: of all ways to sign the ranks, those that are as one-sided as this one."""
    difference = np.random.default_rng(seed).integers(-3, 4, pairs)
    assume(difference.any())
    moved = difference[difference != 0]
    ranks = stats.rankdata(np.abs(moved))
    sums = [abs((ranks * signs).sum()) for signs in itertools.product((1, -1), repeat=len(moved))]
    own = abs((ranks * np.sign(moved)).sum())
    assert wilcoxon(difference, np.zeros(pairs)).p == pytest.approx(np.mean(np.array(sums) >= own - 1e-9))


def test_what_few_people_cannot_show() -> None:
    """Of five raters 2 in 32 ways to sign are as one-sided; of three roads 2 in 6 orders as strict."""
    assert wilcoxon([2] * 5, [1] * 5).p == pytest.approx(2 / 32)
    assert wilcoxon([2] * 60, [1] * 60).p < 1e-10
    assert spearman([1, 2, 3], [4, 5, 6]).p == pytest.approx(2 / 6)
    assert spearman([1, 2, 3, 4], [8, 7, 6, 5]).p == pytest.approx(2 / 24)


@settings(max_examples=15)
@given(seed=st.integers(0, 10**6), pairs=st.integers(3, 6))
def test_few_pairs_are_put_in_every_order(seed, pairs) -> None:
    rng = np.random.default_rng(seed)
    x, y = rng.integers(1, 5, (2, pairs)).astype(float)
    assume(np.ptp(x) > 0 and np.ptp(y) > 0)
    rhos = stats.spearmanr(np.column_stack([x, *itertools.permutations(y)])).statistic[0, 1:]
    found = spearman(x, y)
    assert found.p == pytest.approx(np.mean(np.abs(rhos) >= abs(found.rho) - 1e-9))


def test_wilcoxons_own_example_and_darwins_corn() -> None:
    """Cross- and self-fertilised corn (Darwin 1876), as in Siegel and in R's documentation of the test."""
    difference = [49, -67, 8, 16, 6, 23, 28, 41, 14, 29, 56, 24, 75, 60, -48]
    found = wilcoxon(difference, [0] * 15)
    assert found.statistic == 24
    assert found.p == pytest.approx(0.0413, abs=5e-5)
    assert found.effect == pytest.approx((96 - 24) / 120)


def test_prompts_are_drawn_not_roads() -> None:
    """Two prompts that are always alike: drawing them again gives 0, 1/2 or 1, as a coin is thrown twice."""
    assert bootstrap([[1.0] * 50, [0.0] * 50]) == (0.5, (0, 1))
    assert bootstrap([[1.0], []]) == (1, (1, 1))
    assert math.isnan(bootstrap([])[0])


def test_the_bootstrap_is_near_that_of_all_resamples() -> None:
    groups = [[1.0, 0.0, 1.0], [1.0] * 4, [0.0, 0.0, 1.0, 0.0], [0.5], [1.0, 0.2]]
    means = [
        sum(sum(group) for group in drawn) / sum(len(group) for group in drawn)
        for drawn in itertools.product(groups, repeat=len(groups))
    ]
    mean, interval = bootstrap(groups)
    assert mean == pytest.approx(np.mean([value for group in groups for value in group]))
    assert interval == pytest.approx(tuple(np.quantile(means, [0.025, 0.975])), abs=0.02)
