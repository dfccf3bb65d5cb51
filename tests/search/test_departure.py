"""Where a car will leave its lane: the regression beside scikit-learn's, and a car with a known rule."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sklearn.linear_model import LogisticRegression
from sklearn.metrics import roc_auc_score

from roadgpt.road import World
from roadgpt_search.surrogate import (
    RIDGE,
    DepartureModel,
    RoadSamples,
    RoadStations,
    logistic,
    stations_of,
)

WORLD = World()
TIGHT = 0.04  # 1/m


def samples(length: int, bends: list[tuple[int, float]]) -> RoadSamples:
    """A flat road with bends of 30 m, each with its first station and its curvature."""
    s = np.linspace(0.0, length, length + 1)
    curvature = np.zeros(len(s))
    for at, bend in bends:
        curvature[(s >= at) & (s < at + 30)] = bend
    return RoadSamples(s, curvature, np.zeros(len(s)), np.zeros(len(s)))


def winding(seed: int) -> tuple[RoadStations, float | None]:
    """A road of four bends, and where a car leaves it that leaves every bend of more than TIGHT to the left,
    8 m after its start."""
    rng = np.random.default_rng(seed)
    bends = [(40 + 50 * i, float(rng.uniform(-0.06, 0.06))) for i in range(4)]
    ends = [at + 8.0 for at, bend in bends if bend > TIGHT]
    return stations_of(samples(250, bends), WORLD), min(ends, default=None)


def test_it_learns_where_a_car_leaves_its_lane() -> None:
    """After 120 roads: which of 120 others it leaves, and the steering up to there."""
    roads, ends = zip(*(winding(seed) for seed in range(240)), strict=True)
    found = DepartureModel(roads[:120], ends[:120]).predict(roads[120:])
    left = np.array([end is not None for end in ends[120:]])
    assert 30 < left.sum() < 90
    assert roc_auc_score(left, found[:, 2]) > 0.97
    true = [
        road.steering[np.searchsorted(road.s, end)]
        for road, end in zip(roads[120:], ends[120:], strict=True)
        if end is not None
    ]
    whole = [road.steering[-1] for road, one in zip(roads[120:], left, strict=True) if one]
    for guess in (found[:, 0] / 10, found[:, 1] / 10):
        assert np.median(np.abs(guess[left] - true)) < 0.6 * np.median(np.abs(np.array(whole) - true))


@settings(max_examples=15, deadline=None)
@given(st.integers(2, 400), st.lists(st.floats(-0.07, 0.07), max_size=4), st.integers(0, 99))
def test_predictions_lie_between_what_is_possible(length: int, bends: list[float], seed: int) -> None:
    road = stations_of(samples(length, [(10 + 60 * i, bend) for i, bend in enumerate(bends)]), WORLD)
    model = DepartureModel(*map(list, zip(*(winding(seed + i) for i in range(20)), strict=True)))  # type: ignore[arg-type]
    found = model.predict([road, winding(seed)[0]])
    assert np.all((found[:, 2] >= 0) & (found[:, 2] <= 1 + 1e-9))
    assert road.steering.min() - 1e-9 <= found[0, 0] / 10 <= road.steering.max() + 1e-9
    assert np.isclose(found[0, 1] / 10, road.steering, atol=1e-12).any()
    alone = model.predict([road])
    assert alone[0] == pytest.approx(found[0])


def test_the_regression_is_that_of_scikit_learn() -> None:
    rng = np.random.default_rng(3)
    rows = np.c_[rng.normal(size=(400, 5)) * (1.0, 0.2, 3.0, 1.0, 1.0), np.ones(400)]
    leaves = (rng.random(400) < 1 / (1 + np.exp(1.5 - 2 * rows[:, 0] + rows[:, 2]))).astype(float)
    scale = rows[:, :-1].std(axis=0)
    theirs = LogisticRegression(C=1 / RIDGE, tol=1e-8).fit(rows[:, :-1] / scale, leaves)
    ours = logistic(rows, leaves)
    assert ours[:-1] * scale == pytest.approx(theirs.coef_[0], abs=1e-3)
    assert ours[-1] == pytest.approx(theirs.intercept_[0], abs=1e-3)
