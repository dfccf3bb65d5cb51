"""The surrogate: its forest beside scikit-learn's, and laws that are known."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from sklearn.datasets import make_friedman1, make_friedman3, make_regression
from sklearn.ensemble import ExtraTreesRegressor
from sklearn.metrics import r2_score

from campaign.quick import features_of_road
from roadgpt.road import Design, Segment, World, build
from roadgpt_search.surrogate import (
    LEAF,
    NAMES,
    TREES,
    WINDOWS,
    grow,
    hazard_of,
)

WORLD = World()


def data(n: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Features, and a margin that falls with the larger of two of them; besides, a feature of the drive."""
    rng = np.random.default_rng(seed)
    signs = rng.random((n, len(NAMES)))
    margin = 2.0 - 2.2 * np.maximum(signs[:, 1], 0.8 * signs[:, 6])
    return signs, np.c_[margin, 40 * signs[:, 11]]


DATA = {
    "friedman 1": lambda n, seed: make_friedman1(n, 10, noise=1.0, random_state=seed),
    "friedman 3": lambda n, seed: make_friedman3(n, noise=0.1, random_state=seed),
    "linear": lambda n, seed: make_regression(n, 15, n_informative=5, noise=20.0, random_state=seed),
    "margins": lambda n, seed: (data(n, seed)[0], data(n, seed)[1][:, 0]),
}
SAME = 0.015  # of the mean R^2 of ten forests each; single forests differ by 0.02 from seed to seed


@pytest.mark.parametrize(
    ("name", "n"), [("friedman 1", 40), ("friedman 3", 40), ("linear", 40), ("margins", 200)]
)
def test_the_forest_is_as_good_as_scikit_learns(name: str, n: int) -> None:
    """The mean R^2 on 300 fresh samples; five data sets each."""
    ours, theirs = [], []
    for seed in range(5):
        x, y = DATA[name](n + 300, seed)
        y = (y - y[:n].mean()) / y[:n].std()
        forest = grow(x[:n], y[:n, None], TREES, LEAF, seed)
        ours.append(r2_score(y[n:], forest.predict(x[n:]).mean(axis=0)[:, 0]))
        model = ExtraTreesRegressor(TREES, min_samples_leaf=LEAF, random_state=seed).fit(x[:n], y[:n])
        theirs.append(r2_score(y[n:], model.predict(x[n:])))
    assert np.mean(theirs) > 0.3
    assert abs(np.mean(ours) - np.mean(theirs)) < SAME


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
    return float(features_of_road(build(design), WORLD)[NAMES.index(name)])


@given(st.floats(18, 60), st.floats(40, 65), st.sampled_from([-1, 1]))
def test_signs_show_the_lanes_curvature(radius: float, turn: float, hand: int) -> None:
    """The right lane runs 2 m farther out in a left turn, and 2 m farther in in a right one."""
    lane = 1 / (radius + 2 * hand)
    side, other = ("left", "right") if hand > 0 else ("right", "left")
    design = curved(hand * turn, radius, 60)
    assert sign(f"{side}_{WINDOWS[0]}", design) * 0.06 == pytest.approx(lane, rel=0.05)
    assert sign(f"{other}_{WINDOWS[0]}", design) == pytest.approx(0, abs=0.01)
    assert hazard_of([features_of_road(build(design), WORLD)])[0] > 0
