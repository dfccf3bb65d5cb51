"""A road is described as it was drawn."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from roadgpt.brief import Brief, sentence
from roadgpt.brief.model import exactly
from roadgpt.check.describing import describe
from roadgpt.check.measures import ups_and_downs
from roadgpt.geometry.curve import Array
from roadgpt.road import Design, Road, Segment, build

ROAD = Design(
    starting_point=(100.0, 20.0, -28.0),
    theta=90.0,
    segments=(
        Segment(distance=60.0, direction="straight", incline=0.0, turn_degrees=0.0),
        Segment(distance=40.0, direction="left", incline=0.0, turn_degrees=60.0),
        Segment(distance=70.0, direction="straight", incline=6.0, turn_degrees=0.0),
    ),
)


def test_turns_and_straights_are_named_in_driving_order() -> None:
    first, turn, last = describe(build(ROAD)).clauses
    assert (first.kind, turn.kind, last.kind) == ("straight", "turn", "straight")
    assert turn.side == "left"
    assert turn.degrees is not None
    assert turn.degrees.lo == pytest.approx(60, abs=1)
    assert first.slope == "flat"
    assert last.slope == "up"


def through(height: Callable[[Array], Array], bend: float = 0.0) -> Brief:
    """A road of 200 m, with this height by station in metres and curvature in 1/m."""
    s = np.arange(0.0, 200.5)
    if bend:
        plan = np.column_stack([np.sin(bend * s), 1 - np.cos(bend * s)]) / bend
    else:
        plan = np.column_stack([s, 0 * s])
    return describe(Road.through(np.column_stack([plan, height(s)])))


def hill(s: Array) -> Array:
    return np.asarray(10.0 - 0.1 * np.abs(s - 100))


def test_a_hill_whose_ends_are_level_with_each_other_is_not_flat() -> None:
    up, down = through(hill).clauses
    assert (up.slope, down.slope) == ("up", "down")
    assert up.incline == down.incline == exactly(10)
    assert "flat" not in sentence(through(hill))


def test_a_steep_end_does_not_hide_in_a_mean_grade() -> None:
    brief = through(lambda s: np.asarray(0.02 * s + 0.1 * np.maximum(s - 150, 0)))
    assert brief.steepest == exactly(12)


@pytest.mark.parametrize("bend", [0.0, 1 / 60])
@pytest.mark.parametrize("grade", [0.0, 0.05, -0.08])
def test_one_grade_all_the_way_is_told_as_one(bend: float, grade: float) -> None:
    brief = through(lambda s: np.asarray(grade * s), bend)
    assert len(brief.clauses) == 1
    assert brief.clauses[0].slope == ("up" if grade > 0 else "down" if grade else "flat")
    assert brief.hills is None
    assert brief.steepest is None


@given(st.lists(st.floats(-0.15, 0.15), min_size=2, max_size=6))
def test_ups_and_downs_make_the_net_height(grades: list[float]) -> None:
    heights = np.r_[0.0, np.cumsum(np.repeat(grades, 20))]
    parts = [float(part) for part in ups_and_downs(heights).split()]
    assert sum(parts) == pytest.approx(heights[-1], abs=0.11)
    assert sum(map(abs, parts)) == pytest.approx(np.abs(np.diff(heights)).sum(), abs=0.21)
