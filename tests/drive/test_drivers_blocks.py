"""What drivers are built from: the line, the planned speed, the pedals."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from roadgpt.drive import View
from roadgpt.drive.driving_line import line_along, pursuit_curvature, stations
from roadgpt.geometry import GradeProfile, Piece, PieceCurve
from roadgpt.road import Road, World
from roadgpt.road.speed_profile import SLOWEST, DrivingLimits, plan_speed

LIMITS = DrivingLimits(lateral=0.6, braking=0.6, traction=0.5, speed=30.0, power=1e9)


def road_of(*pieces: Piece, grade: float = 0.0) -> Road:
    plan = PieceCurve(0.0, 0.0, 0.3, pieces)
    return Road(plan, GradeProfile(0.0, (0.0, plan.length), (grade, grade)))


def circle(radius: float, grade: float = 0.0) -> Road:
    return road_of(Piece(100.0, 1 / radius, 1 / radius), grade=grade)


@given(
    radius=st.floats(15, 200),
    hand=st.sampled_from([-1, 1]),
    s=st.floats(5, 60),
    ahead=st.floats(3, 20),
    t=st.floats(-3, 3),
    turned=st.floats(-0.5, 0.5),
)
def test_the_pursued_circle_leaves_along_the_car_and_meets_the_line(
    radius: float, hand: int, s: float, ahead: float, t: float, turned: float
) -> None:
    road = circle(hand * radius)
    line = line_along(road, -2.0)
    x, y, z = road.at(s, t).tolist()
    heading = float(road.heading(s)) + turned
    view = View(0, x, y, z, heading, 10, 0, s, t, road, World(), 0, 0.02, 10, 0)
    bend = pursuit_curvature(line, view, ahead)
    aim = road.at(s + ahead, -2.0)[:2]
    # A circle through the car whose tangent there is the heading: its middle is 1 / bend to the left.
    left = np.array([-math.sin(heading), math.cos(heading)])
    off = aim - [x, y]
    chord = float(off @ off)
    assert bend * chord == pytest.approx(2 * float(off @ left), abs=0.02 * math.sqrt(chord))


def bends(k: list[float]) -> Road:
    """Pieces of 20 m whose curvatures run from each number to the next."""
    return road_of(*[Piece(20.0, a, b) for a, b in itertools.pairwise(k)])


@given(radius=st.floats(15, 200), hand=st.sampled_from([-1, 1]), t=st.floats(-4, 4))
def test_beside_a_circle_runs_a_circle(radius: float, hand: int, t: float) -> None:
    line = line_along(circle(hand * radius), t)
    n = len(stations(circle(hand * radius)))
    assert line.curvature[n // 2] == pytest.approx(1 / (hand * radius - t), rel=1e-6)
    assert line.stretch[n // 2] == pytest.approx(1 - hand * t / radius, rel=1e-6)


def test_a_line_lies_where_the_road_says_and_heads_along_its_points() -> None:
    road = bends([0.0, 0.03, 0.0, -0.04, 0.0])
    s = stations(road)
    offset = -2 + 1.5 * np.sin(s / 12)
    line = line_along(road, offset)
    n = len(s)
    points = np.column_stack([line.x, line.y])
    assert points[:n] == pytest.approx(road.at(s, offset)[:, :2])
    chord = np.diff(points, axis=0)
    between = (np.array(line.heading)[1:] + np.array(line.heading)[:-1]) / 2
    assert np.unwrap(np.arctan2(chord[:, 1], chord[:, 0])) == pytest.approx(between, abs=0.01)
    turned = np.sum(np.array(line.curvature[:n]) * np.array(line.stretch[:n])) * line.step
    assert turned == pytest.approx(line.heading[n - 1] - line.heading[0], abs=0.01)
    # behind the end: straight on, evenly
    assert np.diff(chord[n:], axis=0) == pytest.approx(0.0, abs=1e-9)
    assert len(points) * line.step > road.length + 55


def test_a_crest_takes_load_and_a_dip_gives_it() -> None:
    line = line_along(circle(40.0), 0.0)
    n = len(line.x)
    flat, crest, dip = (
        plan_speed(replace(line, crest=[c] * n), replace(LIMITS, traction=2.0))[100]
        for c in (0.0, -0.004, 0.004)
    )
    assert crest < flat < dip
    # v^2 k = 0.6 (g + v^2 c)
    assert crest**2 == pytest.approx(0.6 * 9.81 / (1 / 40 + 0.6 * 0.004), rel=1e-3)
    straight = replace(line, curvature=[0.0] * n, crest=[-0.02] * n)
    assert plan_speed(straight, replace(LIMITS, traction=2.0))[100] ** 2 == pytest.approx(
        0.6 * 9.81 / 0.02, rel=1e-3
    )


def test_braking_starts_earlier_downhill() -> None:
    def where(grade: float) -> float:
        road = road_of(Piece(150.0), Piece(60.0, 1 / 15, 1 / 15), grade=grade)
        line = line_along(road, 0.0)
        plan = np.array(plan_speed(line, replace(LIMITS, speed=20.0)))
        return float(np.flatnonzero(plan[: int(150 / line.step)] > 19.99)[-1] * line.step)

    corner2 = 0.6 * 9.81 * 15
    assert where(0.0) == pytest.approx(150 - (400 - corner2) / (2 * 0.6 * 9.81), abs=1.0)
    assert where(-0.1) == pytest.approx(150 - (400 - corner2) / (2 * (0.6 - 0.1) * 9.81), abs=1.5)
    assert where(0.1) > where(0.0) > where(-0.1)


@settings(max_examples=15, deadline=None)
@given(k=st.lists(st.floats(-1 / 15, 1 / 15), min_size=3, max_size=8), limit=st.floats(8, 30))
def test_the_planned_speed_is_allowed_everywhere_and_limited_by_something(
    k: list[float], limit: float
) -> None:
    road = bends(k)
    line = line_along(road, -2.0)
    limits = replace(LIMITS, speed=limit)
    plan = np.array(plan_speed(line, limits))
    bend, way = np.abs(line.curvature), line.step * np.array(line.stretch)
    cap = np.minimum(limit, np.sqrt(0.6 * 9.81 / np.maximum(bend, 1e-9)))
    assert (plan <= np.maximum(cap, SLOWEST) + 1e-9).all()
    gained = np.diff(plan**2) / 2
    assert (gained <= 0.5 * 9.81 * way[1:] + 1e-9).all()
    assert (-gained <= 0.6 * 9.81 * way[:-1] + 1e-9).all()
    # each station is at its cap, or as fast as its neighbour and the ellipse let it be
    used = np.minimum(plan**2 * bend / (0.6 * 9.81), 1.0)
    left = np.sqrt(1 - used**2) * 9.81
    at_cap = plan >= cap - 1e-6
    pulled = np.r_[False, gained >= 0.5 * left[:-1] * way[1:] - 0.35]
    braked = np.r_[-gained >= 0.6 * left[1:] * way[:-1] - 0.35, False]
    started = np.arange(len(plan)) == 0
    assert (at_cap | pulled | braked | started).all()


def test_the_engine_bounds_the_forward_sweep() -> None:
    line = line_along(road_of(Piece(200.0)), 0.0)
    weak = plan_speed(line, replace(LIMITS, power=50.0, traction=0.7))
    i = 300
    gained = (weak[i + 1] ** 2 - weak[i] ** 2) / 2 / line.step
    assert gained == pytest.approx(50.0 / weak[i], rel=0.01)
