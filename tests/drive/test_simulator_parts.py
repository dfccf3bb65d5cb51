"""Laws of the tyre, the road's surface and the lane, each on its own."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from road_parts import road_of
from roadgpt.drive.sampled_road import locate_on, sample_road
from roadgpt.drive.simulators.mujoco.car import ETK_LIKE, tables
from roadgpt.drive.simulators.mujoco.dynamics import (
    AT,
    WHEEL_STATE,
    _ground_contact,
    esc_torques,
    tyre_forces,
)
from roadgpt.drive.simulators.mujoco.vehicle import plane
from roadgpt.export.ego import CAR

TYRE = ETK_LIKE.front.tyre
LOAD = ETK_LIKE.static_wheel_load(ETK_LIKE.front)
_, AXLES = tables(ETK_LIKE)


def steady(slip_x, slip_y, load=LOAD, friction=1.0, speed=20.0, camber=0.0):
    """Forces once the slips have built up; slip_x is (rolling - forward) / forward."""
    x = y = 0.0
    for _ in range(2000):
        fx, fy, x, y = tyre_forces(
            AXLES[0], friction, load, camber, speed, -slip_y * speed, speed * (1 + slip_x), x, y, 0.002
        )
    return fx, fy


def magic_formula(slip, stiffness, peak, shape, bend):
    """The textbook form, Pacejka (4.6): D sin(C atan(Bx - E(Bx - atan Bx)))."""
    b = stiffness / (shape * peak)
    return peak * np.sin(shape * np.arctan(b * slip - bend * (b * slip - np.arctan(b * slip))))


@pytest.mark.parametrize("slip", [-0.3, -0.05, 0.002, 0.03, 0.1, 0.5])
def test_pure_slips_follow_the_textbook(slip):
    fx, fy = steady(slip, 0.0)
    expected = magic_formula(
        slip,
        TYRE.slip_stiffness * LOAD,
        TYRE.peak_friction_x * LOAD,
        TYRE.shape_factor_x,
        TYRE.curvature_factor_x,
    )
    assert (fx, fy) == (pytest.approx(expected, rel=1e-6), pytest.approx(0.0, abs=1e-9))
    fx, fy = steady(0.0, slip)
    expected = magic_formula(
        slip,
        TYRE.cornering_stiffness * LOAD,
        TYRE.peak_friction_y * LOAD,
        TYRE.shape_factor_y,
        TYRE.curvature_factor_y,
    )
    assert (fx, fy) == (pytest.approx(0.0, abs=1e-9), pytest.approx(expected, rel=1e-6))


@given(
    st.floats(-1.0, 1.0),
    st.floats(-1.0, 1.0),
    st.floats(200.0, 9000.0),
    st.floats(0.2, 1.2),
    st.floats(3.0, 40.0),
)
@settings(max_examples=60, deadline=None)
def test_no_force_leaves_the_friction_ellipse(slip_x, slip_y, load, friction, speed):
    fx, fy = steady(slip_x, slip_y, load, friction, speed)
    fade = 1 - TYRE.friction_load_sensitivity * (load / LOAD - 1)
    used = math.hypot(
        fx / (friction * TYRE.peak_friction_x * fade * load),
        fy / (friction * TYRE.peak_friction_y * fade * load),
    )
    assert used <= 1 + 1e-9
    if abs(slip_x) > 1e-3:
        assert fx * slip_x > 0
    if abs(slip_y) > 1e-3:
        assert fy * slip_y > 0


def test_a_heavier_tyre_grips_more_but_less_than_in_proportion():
    once, twice = steady(0.0, 0.3, LOAD)[1], steady(0.0, 0.3, 2 * LOAD)[1]
    assert 1.6 * once < twice < 1.95 * once


def test_a_slip_builds_up_over_the_relaxation_length():
    x = y = 0.0
    speed, dt = 20.0, 0.002
    steps = round(TYRE.relaxation_length_y / (speed * dt))
    for _ in range(steps):
        _, _, x, y = tyre_forces(AXLES[0], 1.0, LOAD, 0.0, speed, -0.05 * speed, speed, x, y, dt)
    assert y == pytest.approx(0.05 * (1 - math.exp(-1)), rel=0.05)


def test_esc_brakes_the_wheel_that_turns_the_car_back():
    car = tables(ETK_LIKE)[0][0]
    without = tables(replace(ETK_LIKE, esc_gain=0.0))[0][0]
    left_front, right_front, *_, kept = esc_torques(car, 20.0, 0.6, 0.3)  # oversteer in a left turn
    assert (left_front, right_front > 0, kept < 1) == (0.0, True, True)
    left_front, right_front, *_ = esc_torques(car, 20.0, -0.6, -0.3)
    assert (left_front > 0, right_front) == (True, 0.0)
    *_, left_rear, right_rear, kept = esc_torques(car, 20.0, 0.1, 0.5)  # understeer in a left turn
    assert (left_rear > 0, right_rear, kept < 1) == (True, 0.0, True)
    assert esc_torques(car, 20.0, 0.31, 0.3) == (0.0, 0.0, 0.0, 0.0, 1.0)
    assert esc_torques(without, 20.0, 2.0, 0.3) == (0.0, 0.0, 0.0, 0.0, 1.0)


ROAD = road_of(
    (40, 0, 6),
    (30, 60, -4),
    (25, 0, -12),
    (35, -70, 9),
    (45, 50, 15),
    (30, 0, 0),
    start=(60, 60, 3),
    theta=25,
)
RIBBON = sample_road(ROAD)


def on_ribbon(x, y, near):
    return locate_on(RIBBON.table, RIBBON.first, RIBBON.step, x, y, near)


@given(st.floats(0.0, 1.0), st.floats(-7.0, 7.0), st.floats(-2.0, 2.0))
@settings(max_examples=100, deadline=None)
def test_the_ribbon_knows_the_road(share, t, off):
    s = share * ROAD.length
    x, y, z = ROAD.at(s, t).tolist()
    s_found, t_found, height, slope, lateral, heading = locate_on(
        RIBBON.table, RIBBON.first, RIBBON.step, x, y, s + off
    )
    assert s_found == pytest.approx(s, abs=5e-4)
    assert t_found == pytest.approx(t, abs=1e-4)
    assert height == pytest.approx(z, abs=1e-4)
    assert lateral == 0.0
    assert math.remainder(heading - float(ROAD.heading(s)), math.tau) == pytest.approx(0.0, abs=1e-3)
    # The slope along a line beside the centre line: the same rise over a shorter or longer way.
    crowd = 1 - float(ROAD.curvature(s_found)) * t
    assert slope * crowd == pytest.approx(float(ROAD.grade(s)), abs=2e-3)


def test_the_ribbon_goes_straight_on_at_both_ends():
    for s, along in ((0.0, -10.0), (ROAD.length, 10.0)):
        heading, grade = float(ROAD.heading(s)), float(ROAD.grade(s))
        x, y, z = ROAD.at(s).tolist()
        place = on_ribbon(x + along * math.cos(heading), y + along * math.sin(heading), s + along / 2)
        assert place[:3] == pytest.approx((s + along, 0.0, z + along * grade), abs=1e-6)


def test_files_speak_of_the_car_that_drives() -> None:
    told, driven = CAR, ETK_LIKE
    assert (told.length, told.width, told.height) == (driven.length, driven.width, driven.overall_height)
    assert (told.front_axle, told.rear_axle, told.middle) == (
        driven.front.position,
        driven.rear.position,
        driven.box_offset,
    )
    assert (told.mass, told.gravity_height, told.track, told.lock) == (
        driven.mass,
        driven.cg_height,
        driven.front.track_width,
        driven.max_steer_angle,
    )
    assert told.wheel == 2 * driven.unloaded_radius


@settings(max_examples=15, deadline=None)
@given(st.floats(-0.3, 0.3), st.sampled_from([1, -1]))
def test_a_wheel_at_the_rim_has_the_ground_that_is_under_its_tyre(beyond, side):
    """Counted over 1,001 strips of the tyre, on a road from 4 m left to 3 m right."""
    car, wheel = tables(ETK_LIKE)[0][0], np.zeros(WHEEL_STATE)
    ground = plane()._ground._replace(rims=np.array([[4.0, -3.0]] * 3))
    wheel[AT], y = ground.sampled.length / 2, (4.0 + beyond if side == 1 else -3.0 - beyond)
    strips = y + np.linspace(-0.5, 0.5, 1001) * ETK_LIKE.tyre_width
    share = np.mean((strips < 4.0) & (strips > -3.0))
    assert _ground_contact(car, ground, wheel, np.array([0.0, y, 0.3]))[2] == pytest.approx(share, abs=0.002)
