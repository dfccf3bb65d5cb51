"""Superelevation: its size after CD 109, its run-in, and the surface, against a rotation matrix of scipy."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from roadgpt.geometry import GradeProfile, Piece, PieceCurve
from roadgpt.road import CrossSection, Limits, Road, World

SPEED = 50 / 3.6


def bend(radius: float, run_in: float = 30.0, arc: float = 40.0, grade: float = 0.0) -> Road:
    """Returns a road of straight, clothoid, arc, clothoid and straight; a negative radius turns right."""
    k = 1 / radius
    pieces = (Piece(30.0), Piece(run_in, 0.0, k), Piece(arc, k, k), Piece(run_in, k, 0.0), Piece(30.0))
    plan = PieceCurve(100.0, 120.0, 0.3, pieces)
    return Road(plan, GradeProfile(5.0, (0.0, plan.length), (grade, grade)))


@pytest.mark.parametrize(
    ("radius", "percent"),
    # CD 109 by hand: 50^2 / (2.828 * 400) = 2.21; 50^2 / (2.828 * 150) = 5.89; from R = 126.3 m on, 7
    [(400.0, 2.21), (150.0, 5.89), (127.0, 6.96), (100.0, 7.0), (20.0, 7.0)],
)
def test_a_bend_has_the_superelevation_of_the_design_guide(radius: float, percent: float) -> None:
    for side in (1, -1):
        road = World(section=CrossSection(bank="auto"), limits=Limits(speed_limit=SPEED)).lay(
            bend(side * radius)
        )
        assert road.profile is not None
        angles = road.profile.superelevation(np.array([10.0, 70.0, 80.0, 100.0, 165.0]))
        assert 100 * np.tan(angles[1:4]) == pytest.approx(-side * percent, abs=0.01)
        assert angles[[0, 4]] == pytest.approx(0.0, abs=1e-12)


@given(
    side=st.sampled_from([-1, 1]),
    radius=st.floats(20, 400),
    grade=st.floats(-0.15, 0.15),
    ratio=st.floats(0.01, 0.12),
    s=st.floats(0, 160),
    t=st.floats(-14, 14),
)
def test_the_surface_is_that_of_three_rotations(
    side: int, radius: float, grade: float, ratio: float, s: float, t: float
) -> None:
    road = World(section=CrossSection(bank=ratio)).lay(bend(side * radius, grade=grade))
    assert road.profile is not None
    angle = float(road.profile.superelevation(s))
    # OpenDRIVE: heading, pitch and roll about the axes as they are then; pitch is positive downhill.
    turned = Rotation.from_euler("ZYX", [float(road.heading(s)), -math.atan(grade), angle])
    assert road.at(s, t) == pytest.approx(road.at(s) + turned.apply([0.0, t, 0.0]), abs=1e-9)


@given(
    radius=st.floats(30, 400), grade=st.floats(-0.15, 0.15), ratio=st.floats(0, 0.12),
    s=st.floats(1, 150), t=st.floats(-14, 14),
)  # fmt: skip
def test_a_point_of_the_surface_is_located_where_it_was_put(
    radius: float, grade: float, ratio: float, s: float, t: float
) -> None:
    road = World(section=CrossSection(bank=ratio)).lay(bend(radius, grade=grade))
    x, y, _ = road.at(s, t)
    found = road.locate(x, y)
    assert [float(found[0]), float(found[1])] == pytest.approx([s, t], abs=1e-5)


def test_the_run_in_lies_on_the_clothoid_and_has_no_kink() -> None:
    road = World(section=CrossSection(bank="auto"), limits=Limits(speed_limit=SPEED)).lay(bend(50.0))
    assert road.profile is not None
    s = np.linspace(0.0, road.length, 4001)
    angles = road.profile.superelevation(s)
    rate = np.gradient(angles, s)
    assert np.abs(np.gradient(rate, s)).max() < 0.002  # rad/m^2; a ramp with kinks would have 0.09 here
    ramp = (s > 30.0) & (s < 60.0)
    assert (np.diff(angles[ramp]) < 0).all()
    assert np.abs(angles[(s < 30.0) | (s > 160.0)]).max() < 1e-12


def test_a_jump_of_curvature_is_run_in_on_both_sides_of_it() -> None:
    plan = PieceCurve(0.0, 0.0, 0.0, (Piece(60.0), Piece(60.0, 0.02, 0.02), Piece(60.0)))
    road = World(section=CrossSection(bank="auto")).lay(
        Road(plan, GradeProfile(0.0, (0.0, 180.0), (0.0, 0.0)))
    )
    assert road.profile is not None
    s = np.linspace(0.0, 180.0, 1801)
    angles = road.profile.superelevation(s)
    # 7 % of a half carriageway of 4 m is 28 cm: 28 m at 1 %, half of them before the bend begins
    assert angles[s <= 46.0] == pytest.approx(0.0, abs=1e-9)
    assert angles[(s >= 74.1) & (s <= 105.9)] == pytest.approx(-math.atan(0.07))
    assert float(road.profile.superelevation(60.0)) == pytest.approx(-math.atan(0.07) / 2)


def test_a_short_clothoid_is_run_in_beside_it_too_as_far_as_there_is_room() -> None:
    road = World(section=CrossSection(bank="auto")).lay(bend(40.0, run_in=8.0, arc=10.0))
    assert road.profile is not None
    angles = road.profile.superelevation(np.array([19.9, 20.1, 43.0, 65.9, 66.1]))
    # 28 m are needed: 8 on the clothoid and 10 before it, but only 5, the half of the arc, behind it
    assert angles == pytest.approx([0.0, 0.0, -math.atan(0.07), 0.0, 0.0], abs=1e-4)
    assert angles[1] < angles[0] == 0.0
