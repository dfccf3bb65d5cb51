"""The surrogate beside scikit-learn's own whole forest, and on laws that are known."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import spearmanr
from sklearn.ensemble import ExtraTreesRegressor

from roadgpt.brief.model import Brief
from roadgpt.campaign.surrogate import FAILED, LEAF, TREES, Surrogate, target_of
from roadgpt.campaign.surrogate_features import NAMES, WINDOWS, hazard_of, surrogate_features_of
from roadgpt.design import draft
from roadgpt.road import Design, Segment, World, build

WORLD = World()


def data(n: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Signs, and a margin that falls with the larger of two of them; besides, a feature of the drive."""
    rng = np.random.default_rng(seed)
    signs = rng.random((n, len(NAMES)))
    margin = 2.0 - 2.2 * np.maximum(signs[:, 1], 0.8 * signs[:, 6])
    return signs, np.c_[margin, 40 * signs[:, 11]]


def test_the_mean_opinion_is_that_of_the_forest() -> None:
    signs, outcomes = data(80, 1)
    fresh, _ = data(30, 2)
    opinions = Surrogate(list(signs), outcomes.tolist()).opinions(list(fresh))
    scale = outcomes.std(axis=0)
    forest = ExtraTreesRegressor(TREES, min_samples_leaf=LEAF, random_state=0)
    forest.fit(signs, (outcomes - outcomes.mean(axis=0)) / scale)
    assert opinions.shape == (TREES, 30, 2)
    assert np.allclose(
        opinions.mean(axis=0), forest.predict(fresh) * scale + outcomes.mean(axis=0), atol=1e-6
    )


def test_it_learns_what_margins_follow() -> None:
    signs, outcomes = data(150, 1)
    fresh, truth = data(200, 2)
    found = Surrogate(list(signs), outcomes.tolist()).opinions(list(fresh)).mean(axis=0)
    assert spearmanr(found[:, 0], truth[:, 0])[0] > 0.85
    assert spearmanr(found[:, 1], truth[:, 1])[0] > 0.7


def test_where_nothing_is_known_its_trees_differ_more() -> None:
    signs, outcomes = data(150, 1)
    narrow = signs[:, 1] < 0.5
    model = Surrogate(list(signs[narrow]), outcomes[narrow].tolist())
    known, _ = data(150, 1)
    there = model.opinions(list(known[narrow]))[..., 0].std(axis=0).mean()
    fresh = model.opinions(list(data(150, 7)[0]))[..., 0].std(axis=0).mean()
    assert fresh > 1.2 * there


@settings(max_examples=10)
@given(st.floats(-2, 2), st.integers(10, 40))
def test_what_is_always_so_is_expected(margin: float, n: int) -> None:
    signs, _ = data(n, 3)
    found = Surrogate(list(signs), [[margin]] * n).opinions(list(signs))
    assert found == pytest.approx(np.full((TREES, n, 1), margin))


def test_the_same_roads_teach_the_same() -> None:
    signs, outcomes = data(60, 5)
    one, other = (Surrogate(list(signs), outcomes.tolist()).opinions(list(signs)) for _ in range(2))
    assert np.array_equal(one, other)


def test_a_failure_counts_as_one_however_early_the_drive_ended() -> None:
    assert target_of(-0.001, True) == FAILED
    assert target_of(0.4, False) == 0.4


def curved(turn: float, radius: float, length: float) -> Design:
    arc = abs(np.radians(turn)) * radius + 4
    return Design(
        starting_point=(50, 50, 1),
        theta=0,
        segments=(
            Segment(distance=length, direction="straight"),
            Segment(
                distance=arc, direction="left" if turn > 0 else "right", turn_degrees=turn,
                radius=radius, transition=4,
            ),
            Segment(distance=30, direction="straight"),
        ),
    )  # fmt: skip


def sign(name: str, design: Design) -> float:
    return float(surrogate_features_of(build(design), WORLD)[NAMES.index(name)])


@given(st.floats(18, 60), st.floats(40, 65), st.sampled_from([-1, 1]))
def test_signs_show_the_lanes_curvature(radius: float, turn: float, hand: int) -> None:
    """The right lane runs 2 m farther out in a left turn, and 2 m farther in in a right one."""
    lane = 1 / (radius + 2 * hand)
    side, other = ("left", "right") if hand > 0 else ("right", "left")
    design = curved(hand * turn, radius, 60)
    assert sign(f"{side}_{WINDOWS[0]}", design) * 0.06 == pytest.approx(lane, rel=0.05)
    assert sign(f"{other}_{WINDOWS[0]}", design) == pytest.approx(0, abs=0.01)
    assert hazard_of([surrogate_features_of(build(design), WORLD)])[0] > 0


def test_where_the_car_is_slow_nothing_counts() -> None:
    """All of the turn lies in the first 25 m."""
    early = curved(40, 20, 1)
    assert sign(f"left_{WINDOWS[0]}", early) < 0.1
    assert sign(f"left_{WINDOWS[0]}", curved(40, 20, 60)) > 0.7


def test_a_run_up_is_the_straight_before_the_tightest_place() -> None:
    assert sign("run_up", curved(-60, 20, 90)) * 50 == pytest.approx(90 - 25, abs=6)


def test_signs_of_any_draft_are_finite_and_small() -> None:
    for seed in range(5):
        found = surrogate_features_of(build(draft(Brief(), WORLD, seed=seed)), WORLD)
        assert found.shape == (len(NAMES),)
        assert np.isfinite(found).all()
        assert np.abs(found).max() < 10
