"""The spline through points, as RoadGPT and the competition draw it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from roadgpt.errors import UsageError
from roadgpt.geometry import SplineCurve, SplineProfile, interpolate

BENT = [[10.0, 20.0, 0.0], [60.0, 20.0, 2.0], [100.0, 60.0, 6.0], [150.0, 60.0, 5.0], [180.0, 100.0, 0.0]]


def test_stations_are_arc_length() -> None:
    curve = SplineCurve.through(BENT)
    s = np.linspace(0, curve.length, 20_001)
    steps = np.hypot(*np.diff(curve.at(s), axis=0).T)
    assert steps.sum() == pytest.approx(curve.length, rel=1e-7)
    assert np.ptp(steps) < 1e-8


def test_it_passes_through_its_points() -> None:
    curve = SplineCurve.through(BENT)
    on = curve.at(np.linspace(0, curve.length, 40_001))
    for point in BENT:
        assert np.hypot(*(on - point[:2]).T).min() < 0.01


def test_heading_and_curvature_follow_the_points() -> None:
    curve = SplineCurve.through(BENT)
    s = np.linspace(1, curve.length - 1, 500)
    step = 1e-3
    tangent = (curve.at(s + step) - curve.at(s - step)) / (2 * step)
    assert np.cos(curve.heading(s)) == pytest.approx(tangent[:, 0], abs=1e-5)
    assert np.sin(curve.heading(s)) == pytest.approx(tangent[:, 1], abs=1e-5)
    bend = (curve.heading(s + step) - curve.heading(s - step)) / (2 * step)
    assert curve.curvature(s) == pytest.approx(bend, abs=1e-5)


def test_the_heights_follow_the_points() -> None:
    profile = SplineProfile(SplineCurve.through(BENT))
    s = np.linspace(1, profile.curve.length - 1, 300)
    step = 1e-3
    slope = (profile.height(s + step) - profile.height(s - step)) / (2 * step)
    bend = (profile.grade(s + step) - profile.grade(s - step)) / (2 * step)
    assert profile.grade(s) == pytest.approx(slope, abs=1e-6)
    assert profile.vertical_curvature(s) == pytest.approx(bend, abs=1e-5)
    assert profile.height(0.0) == pytest.approx(0.0, abs=1e-9)


def test_sixty_metres_give_a_point_a_metre_and_short_roads_twenty() -> None:
    assert len(interpolate([[0.0, 0.0], [60.0, 0.0]])) == 61
    assert len(interpolate([[0.0, 0.0], [5.0, 0.0]])) == 21
    assert np.hypot(*np.diff(interpolate([[0.0, 0.0], [60.0, 0.0]]), axis=0).T) == pytest.approx(1, abs=2e-3)


@given(st.integers(20, 400))
def test_the_points_run_from_the_first_to_the_last_or_one_beyond(length: int) -> None:
    """For some lengths numpy's arange oversteps by one, which the competition inherits."""
    points = interpolate([[0.0, 0.0], [float(length), 0.0]])
    assert len(points) in (length + 1, length + 2)
    assert points[length][0] == pytest.approx(length, abs=1e-3)
    assert len(points) == len(np.arange(0, 1 + 1 / length, 1 / length))


@pytest.mark.parametrize(
    "points", [[[1.0, 2.0]], [[1.0, 2.0], [1.0, 2.0]], [[1, 2], [3, 4], [3, 4], [5, 6], [9, 9]]]
)
def test_points_that_make_no_curve_are_refused_in_a_sentence(points: list[list[float]]) -> None:
    with pytest.raises(UsageError, match="points"):
        interpolate(points)
