"""Sparseness against the textbook's Levenshtein distance, cell by cell, with the competition's costs."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from roadgpt.run.execution import ExecutionRecord
from roadgpt.run.step_distance import distances, steps_of
from roadgpt_sbft.sparseness import Sparseness, departure

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
    spread = Sparseness()
    for number, points in enumerate(walks):
        spread.add(number, points)
    furthest = [  # among later ones only, as the competition has it
        max(slow_distance(one, other) for other in walks[i + 1 :]) for i, one in enumerate(walks[:-1])
    ]
    assert spread.mean == pytest.approx(np.mean(furthest), abs=1e-9)
    assert spread.deviation == pytest.approx(np.std(furthest), abs=1e-9)


def test_a_curve_and_its_copy_elsewhere_are_the_same() -> None:
    points = np.array(walk(3, 30))
    turn = np.array([[0.0, -1.0], [1.0, 0.0]])
    assert distances(steps_of(points), [steps_of(points @ turn.T + 50)]) == pytest.approx([0.0])


@pytest.mark.parametrize("count", [0, 1])
def test_fewer_than_two_failures_have_no_spread(count: int) -> None:
    spread = Sparseness()
    for _ in range(count):
        spread.add(1, walk(1, 10))
    assert math.isnan(spread.mean)
    assert math.isnan(spread.deviation)


def wave(bend: float, points: int = 12) -> Points:
    """Control points of a road, 12 m apart in x."""
    return [(20.0 + 12.0 * i, 100.0 + 18.0 * math.sin(bend * i)) for i in range(points)]


def record(x: float, y: float, is_oob: bool) -> ExecutionRecord:
    rest = (1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 10.0, 36)
    return ExecutionRecord(
        0.0, [x, y, -27.0], [1.0, 0.0, 0.0], [10.0, 0.0, 0.0], *rest, is_oob, int(is_oob), 0.0, 1.0, 0.0
    )


def driven(road: Points, count: int, aside: float) -> list[ExecutionRecord]:
    """Records 2.4 m apart, so far to the right of the control polyline; out in the last."""
    records = []
    for i in range(count):
        at, share = divmod(i * 2.4 / 12.0, 1.0)
        (ax, ay), (bx, by) = road[int(at)], road[int(at) + 1]
        way = math.hypot(bx - ax, by - ay)
        x, y = ax + share * (bx - ax), ay + share * (by - ay)
        x, y = x + aside * (by - ay) / way, y - aside * (bx - ax) / way
        records.append(record(x, y, i == count - 1))
    return records


FAILED = [
    (wave(0.4), driven(wave(0.4), 30, 3.0)),
    (wave(0.7), driven(wave(0.7), 22, 3.5)),
    (wave(0.9), driven(wave(0.9), 40, 1.0)),
    (wave(0.2), driven(wave(0.2), 8, 3.0)),  # less than 30 m from the start
    (wave(0.5), driven(wave(0.5), 1, 3.0)),  # out at once: nothing before it
    (wave(0.6), driven(wave(0.6), 55, 3.0)),  # at the very end
    (wave(0.6, 3), driven(wave(0.6, 3), 6, 3.0)),  # three control points
    (wave(0.8), driven(wave(0.8), 20, 3.0)[:-1]),  # failed, and never out of its lane
    (wave(1.0), driven(wave(1.0), 33, 4.0)),
]
# What the competition's own OOBAnalyzer.create_summary() says of these tests (its code of November 2024 with
# numpy 1.21.6, scipy 1.7.3, Shapely 1.8.0).
THEIRS = "8,1,7,30.312,  3"


def test_departures_and_their_spread_are_what_the_official_analysis_finds() -> None:
    spread, sides = Sparseness(), []
    for number, (road, records) in enumerate(FAILED, 1):
        found = departure(road, records)
        if found is not None:
            sides.append(found.side)
            if found.segment is not None:
                spread.add(number, found.segment)
    ours = (
        f"{len(sides)},{sides.count('left')},{sides.count('right')},{spread.mean:.3f},{spread.deviation:3.0f}"
    )
    assert ours == THEIRS


def test_a_segment_reaches_30_m_to_either_side_of_the_place() -> None:
    road = [(0.0, 0.0), (40.0, 0.0), (80.0, 0.0), (120.0, 0.0)]
    found = departure(road, [record(x, -3.0, x > 50) for x in (5.0, 20.0, 50.4)])
    assert found is not None
    assert found.side == "right"
    assert found.segment is not None
    assert found.segment[[0, -1], 0] == pytest.approx([21, 80], abs=1.5)
    assert np.abs(found.segment[:, 0] - 50.4).min() < 1e-3


def test_the_order_of_tests_is_by_their_numbers_and_not_by_when_they_came() -> None:
    walks = {number: walk(number, 12) for number in range(6)}
    one, other = Sparseness(), Sparseness()
    for number in (0, 1, 2, 3, 4, 5):
        one.add(number, walks[number])
    for number in (4, 2, 5, 0, 1, 3):
        other.add(number, walks[number])
    assert (one.mean, one.deviation) == pytest.approx((other.mean, other.deviation))
