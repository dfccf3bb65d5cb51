"""Grades that a description tells once and that hold for what follows, and halves of a road with turns."""

import numpy as np
import pytest

from roadgpt.brief.plan import read_plan
from roadgpt.design import draft
from roadgpt.geometry.curve import Array
from roadgpt.road import Design, World, build


def drawn(line: str, seed: int) -> Design:
    """A design of the plan."""
    design = draft(read_plan(line), World(), seed=seed)
    assert isinstance(design, Design)
    return design


def slopes(design: Design) -> tuple[Array, Array]:
    """Stations in m, and the grade in percent at each, from the heights of the built centre line."""
    points = build(design).centreline()
    steps = np.hypot(*np.diff(points[:, :2], axis=0).T)
    return np.cumsum(steps) - steps / 2, 100 * np.diff(points[:, 2]) / steps


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize(("way", "sign"), [("up", 1), ("down", -1)])
def test_a_turn_that_goes_on_falling_or_climbing_keeps_the_grade(way: str, sign: int, seed: int) -> None:
    design = drawn(f"straight {way} len=90 pct=4; turn right {way} deg=90 r=35; straight {way}", seed)
    _, grades = slopes(design)
    assert np.abs(grades - 4 * sign).max() < 0.3


def test_a_grade_of_its_own_is_kept() -> None:
    design = drawn("straight down len=90 pct=3; turn right down pct=8 deg=90; straight flat len=60", 1)
    at, grades = slopes(design)
    assert np.interp(40, at, grades) == pytest.approx(-3, abs=0.3)
    assert grades.min() == pytest.approx(-8, abs=0.5)


def test_a_straight_behind_a_straight_has_another_grade() -> None:
    for seed in range(4):
        design = drawn("straight up len=60 pct=4; straight up len=60; turn left", seed)
        at, grades = slopes(design)
        assert abs(np.interp(20, at, grades) - np.interp(95, at, grades)) > 0.5


@pytest.mark.parametrize("seed", range(6))
def test_halves_of_a_road_with_a_turn_somewhere_are_halves(seed: int) -> None:
    design = drawn("straight up pct=6; straight down pct=3 | turns=1 len=320", seed)
    at, grades = slopes(design)
    assert at[-1] == pytest.approx(320, rel=0.02)
    up, down = at[grades > 4.5], at[grades < -1.5]
    assert up.max() < down.min()
    assert np.ptp(up) == pytest.approx(np.ptp(down), abs=15)
