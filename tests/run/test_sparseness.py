"""Sparseness against the textbook's Levenshtein distance, cell by cell, with the competition's costs."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from roadgpt.road import Road
from roadgpt.run.sparseness import Spread, distances, failure_segment, steps_of

Points = list[tuple[float, float]]


def slow_steps(points: Points) -> list[tuple[float, float]]:
    steps, before = [], None
    for (ax, ay), (bx, by) in itertools.pairwise(points):
        direction = math.atan2(by - ay, bx - ax)
        steps.append(
            (
                math.degrees(direction - (direction if before is None else before)),
                math.dist((ax, ay), (bx, by)),
            )
        )
        before = direction
    return steps


def slow_distance(one: Points, other: Points) -> float:
    s, t = slow_steps(one), slow_steps(other)
    table = [[float(i + j) if 0 in (i, j) else 0.0 for j in range(len(t) + 1)] for i in range(len(s) + 1)]
    for i, (angle, length) in enumerate(s, 1):
        for j, (other_angle, other_length) in enumerate(t, 1):
            turned = abs((angle - other_angle + 180) % 360 - 180)
            longer = abs(length - other_length)
            cost = (
                0.0 if turned < 0.3 and longer < 0.2 else (turned / (1 + turned) + longer / (1 + longer)) / 2
            )
            table[i][j] = min(table[i - 1][j] + 1, table[i][j - 1] + 1, table[i - 1][j - 1] + cost)
    return table[-1][-1]


def walk(seed: int, count: int) -> Points:
    rng = np.random.default_rng(seed)
    heading = np.cumsum(rng.normal(0, 0.3, count)) + rng.uniform(0, 6)
    length = rng.choice([1.0, 1.1, 2.0], count)
    moves = np.stack([length * np.cos(heading), length * np.sin(heading)], axis=-1)
    return [(float(x), float(y)) for x, y in np.cumsum(moves, axis=0)]


@settings(max_examples=30)
@given(st.lists(st.tuples(st.integers(0, 999), st.integers(2, 25)), min_size=2, max_size=5))
def test_all_at_once_is_one_by_one(drawn: list[tuple[int, int]]) -> None:
    first, *rest = [walk(seed, count) for seed, count in drawn]
    found = distances(steps_of(first), [steps_of(other) for other in rest])
    assert found == pytest.approx([slow_distance(first, other) for other in rest], abs=1e-9)


@settings(max_examples=20)
@given(st.lists(st.tuples(st.integers(0, 999), st.integers(2, 20)), min_size=2, max_size=6))
def test_the_spread_that_grows_is_the_mean_of_the_largest_distances(drawn: list[tuple[int, int]]) -> None:
    walks = [walk(seed, count) for seed, count in drawn]
    spread = Spread()
    for points in walks:
        spread.add(points)
    furthest = [
        max(slow_distance(one, other) for j, other in enumerate(walks) if j != i)
        for i, one in enumerate(walks)
    ]
    assert spread.mean == pytest.approx(np.mean(furthest), abs=1e-9)
    assert spread.deviation == pytest.approx(np.std(furthest), abs=1e-9)


def test_a_curve_and_its_copy_elsewhere_are_the_same() -> None:
    points = np.array(walk(3, 30))
    turn = np.array([[0.0, -1.0], [1.0, 0.0]])
    assert distances(steps_of(points), [steps_of(points @ turn.T + 50)]) == pytest.approx([0.0])


@pytest.mark.parametrize("count", [0, 1])
def test_fewer_than_two_failures_have_no_spread(count: int) -> None:
    spread = Spread()
    for _ in range(count):
        spread.add(walk(1, 10))
    assert math.isnan(spread.mean)
    assert math.isnan(spread.deviation)


def test_a_segment_reaches_30_m_to_either_side_of_the_place() -> None:
    road = Road.through([[0, 0], [60, 0], [120, 0]])
    assert failure_segment(road, 50.4)[[0, -1], 0] == pytest.approx([21, 80], abs=1.0)
    middle = failure_segment(road, 50.4)
    assert np.abs(middle[:, 0] - 50.4).min() < 1e-6
    assert failure_segment(road, 10.0)[0, 0] == pytest.approx(0.0, abs=1e-6)
    assert (
        np.linalg.norm(np.diff(middle, axis=0), axis=1).min() > 0.2
    )  # no step so short that its angle is noise
