"""Extreme places, between the samples as well; scipy looks for them its own way."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import minimize_scalar

from network.ruled import findings
from roadgpt.check.extremes import lowest, steepest, tightest
from roadgpt.geometry import GradeProfile, Piece, PieceCurve
from roadgpt.road import Road, World

WORLD = World()
LEVEL = GradeProfile(0.0, (0.0, 1.0), (0.0, 0.0))
grades = st.lists(st.floats(-0.2, 0.2), min_size=2, max_size=6)


def test_a_bend_between_two_samples_is_too_tight() -> None:
    peak = (Piece(40.2), Piece(0.3, 0.0, 1 / 10), Piece(0.3, 1 / 10, 0.0), Piece(41.2))
    road = Road(PieceCurve(50, 50, 0, peak), LEVEL)
    assert np.abs(road.sample().curvature).max() < 1 / WORLD.limits.min_radius
    assert tightest(road) == pytest.approx((40.5, 0.1))
    assert findings("too_tight", road, WORLD)


def test_a_ramp_between_two_samples_is_too_steep() -> None:
    profile = GradeProfile(0.0, (0.0, 40.2, 40.5, 40.8, 80.0), (0.0, 0.0, -0.3, 0.0, 0.0))
    road = Road(PieceCurve(50, 50, 0, (Piece(80.0),)), profile)
    assert np.abs(road.sample().grade).max() < WORLD.limits.max_grade
    assert steepest(road) == pytest.approx((40.5, -0.3))
    assert findings("too_steep", road, WORLD)


def test_a_sag_between_two_samples_is_below_the_floor() -> None:
    vertex = WORLD.site.z_floor - 0.001
    profile = GradeProfile(vertex + 0.5 * 40.5 * 0.1, (0.0, 81.0), (-0.1, 0.1))
    road = Road(PieceCurve(50, 50, 0, (Piece(81.0),)), profile)
    assert lowest(profile, 81.0) == pytest.approx((40.5, vertex))
    assert findings("below_floor", road, WORLD)


@given(grades, st.floats(20, 100))
@settings(max_examples=60)
def test_no_place_is_lower_than_the_lowest(values: list[float], length: float) -> None:
    stations = np.linspace(0.0, length, len(values))
    profile = GradeProfile(3.0, tuple(stations), tuple(values))
    s, z = lowest(profile, length)
    assert profile.height(s) == pytest.approx(z)
    found = [
        minimize_scalar(lambda at: float(profile.height(at)), bounds=ends, method="bounded").fun
        for ends in pairwise(stations)
    ]
    ends = profile.height(stations)
    assert z == pytest.approx(min(*found, *ends), abs=1e-6)
