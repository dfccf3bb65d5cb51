"""The competition's features against plain loops written from their definition, and on known shapes."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from roadgpt.run.execution import ExecutionRecord, features_of


def circle(radius: float, count: int = 2000, turn: float = 2 * math.pi) -> np.ndarray:
    angle = np.linspace(0, turn, count)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=-1)


def record(steering: float, oob_distance: float) -> ExecutionRecord:
    zero = [0.0, 0.0, 0.0]
    return ExecutionRecord(
        0.0, zero, zero, zero, steering, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0, False, 0, 0.0, oob_distance, 0.0
    )


def slow_curvature(points: list[tuple[float, float]]) -> float:
    """Heron's area and the law of sines, one window after another."""
    largest = 0.0
    for i in range(len(points) - 5):
        a, b, c = (math.dist(points[i + m], points[i + n]) for m, n in ((0, 2), (2, 4), (0, 4)))
        half = (a + b + c) / 2
        area = math.sqrt(max(half * (half - a) * (half - b) * (half - c), 0.0))
        largest = max(largest, 4 * area / (a * b * c))
    return largest


def slow_coverage(points: list[tuple[float, float]]) -> float:
    bins = set()
    for (ax, ay), (bx, by) in itertools.pairwise(points):
        angle = math.degrees(math.acos(max(-1.0, min(1.0, (by - ay) / math.dist((ax, ay), (bx, by))))))
        bins.add(int(angle // (360 / 25)))
    return len(bins) / 26


@pytest.mark.parametrize("radius", [14.5, 30.0, 90.0])
def test_a_circle_has_the_curvature_of_its_radius_and_covers_half(radius: float) -> None:
    found = features_of(circle(radius))
    assert found["MAX_CURV"] == pytest.approx(1 / radius, rel=1e-4)
    assert (
        found["DIR_COV"] == 0.5
    )  # of 25 bins up to 360 degrees arccos reaches 13, and 13 / 26 is their score


def test_a_straight_has_no_curvature_and_one_direction() -> None:
    points = np.stack([np.zeros(30), np.arange(30.0)], axis=-1)
    assert features_of(points) == {"MAX_CURV": 0.0, "DIR_COV": pytest.approx(1 / 26, abs=1e-6)}


def test_heights_do_not_matter() -> None:
    flat = circle(30, 90, 2.0)
    hilly = np.c_[flat, np.linspace(0, 20, 90)]
    assert features_of(flat) == features_of(hilly)


@given(st.integers(0, 10_000), st.integers(8, 60))
def test_random_walks_agree_with_plain_loops(seed: int, count: int) -> None:
    rng = np.random.default_rng(seed)
    heading = np.cumsum(rng.normal(0, 0.1, count)) + rng.uniform(0, 6)
    points = np.cumsum(np.stack([np.cos(heading), np.sin(heading)], axis=-1), axis=0)
    found = features_of(points)
    listed = [(float(x), float(y)) for x, y in points]
    assert found["MAX_CURV"] == pytest.approx(slow_curvature(listed), abs=2e-4)
    assert found["DIR_COV"] == pytest.approx(slow_coverage(listed), abs=1e-6)


def test_the_drive_s_features_are_those_of_its_records() -> None:
    records = [record(2.0, 1.0), record(4.0, 1.5), record(6.0, -0.5), record(8.0, 2.0)]
    found = features_of(circle(40, 50, 1.0), records)
    assert found["STD_SA"] == pytest.approx(math.sqrt(5), abs=1e-6)
    assert found["MEAN_LP"] == pytest.approx(1.0)
    assert found["MAX_LP"] == 2.0


def test_two_records_are_no_drive() -> None:
    found = features_of(circle(40, 50, 1.0), [record(0.0, 1.0), record(0.0, 1.0)])
    assert set(found) == {"MAX_CURV", "DIR_COV"}
