"""The parts that move whoever does maneuvers, without any actor, scene or tested car: laws of motion."""

import math
from typing import Any, cast

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from roadgpt.brief.scene import Action
from roadgpt.network.line import Line
from roadgpt.traffic.course import Course, Met
from roadgpt.traffic.lateral import SHARPEST, Lateral
from roadgpt.traffic.longitudinal import Longitudinal, reach
from roadgpt.traffic.maneuver import Maneuver
from roadgpt.traffic.triggers import Triggers

LANE = Line.through(np.linspace((0.0, 0.0, 0.0), (2000.0, 0.0, 0.0), 4001))
LENGTH = 4.0  # m
speeds, pulls, seconds = st.floats(0.0, 40.0), st.floats(0.5, 4.0), st.floats(0.1, 10.0)


def course() -> Course:
    return Course(LANE, LANE, LENGTH, 1, is_along=True, crosses=False, is_in_lane=True, faces=False)


def driver(v: float, place: Course | None = None) -> Longitudinal:
    return Longitudinal(place or course(), Lateral(), "car", cruise=v, v=v)


@given(v=speeds, goal=speeds, pull=pulls, time=seconds)
def test_a_speed_comes_to_its_goal_with_a_constant_acceleration(
    v: float, goal: float, pull: float, time: float
) -> None:
    moved = driver(v)
    moved.goal = goal
    gone = moved.step(time, pull)
    every = np.linspace(0.0, time, 20_001)
    slow = np.sign(goal - v) * np.minimum(pull * every, abs(goal - v)) + v
    assert moved.v == pytest.approx(slow[-1])
    assert gone == pytest.approx(np.trapezoid(slow, every), abs=1e-4)
    assert moved.course.s == pytest.approx(gone) == pytest.approx(reach(time, v, goal, pull))


@given(ahead=st.floats(5.0, 80.0), share=st.floats(0.1, 0.9))
def test_nobody_drives_into_who_stands_ahead(ahead: float, share: float) -> None:
    moved = driver(math.sqrt(2 * 4.0 * (ahead - 2.0)) * share)  # it brakes with 4 m/s2
    for _ in range(300):
        moved.ahead = ahead - moved.course.s, 0.0
        moved.step(0.1, moved.pull)
        assert moved.course.s < ahead - 0.9  # half of a usual gap at rest is left
        assert moved.v**2 <= 2 * 4.0 * (ahead - moved.course.s)  # from which it can stop


@given(by=st.floats(-4.0, 4.0), lasts=st.floats(2.0, 8.0), v=st.floats(20.0, 40.0))
def test_a_movement_sideways_is_half_a_cosine_wave(by: float, lasts: float, v: float) -> None:
    place, moved, steps = course(), Lateral(0.5), 40
    moved.slide_to(0.5 + by, lasts)
    t, slopes = [], []
    for _ in range(steps):
        moved.step(place, 0.0, v, v * lasts / steps, lasts / steps)
        t.append(moved.t)
        slopes.append(moved.slope)
    wave = 0.5 + by / 2 * (1 - np.cos(np.pi * np.arange(1, steps + 1) / steps))
    assert t == pytest.approx(wave)
    assert max(map(abs, slopes)) * v == pytest.approx(math.pi / 2 * abs(by) / lasts)
    assert moved.slide is None


def test_who_is_slow_takes_longer_sideways_and_who_stands_stays() -> None:
    moved = Lateral()
    moved.slide_to(3.5, 3.5)
    peak = math.pi / 2
    assert moved.left(SHARPEST * peak) == pytest.approx(3.5)
    assert moved.left(SHARPEST * peak / 4) == pytest.approx(14.0)
    moved.step(course(), 0.0, 0.0, 0.0, 1.0)
    assert moved.t == 0.0


@given(
    condition=st.sampled_from(["gap", "headway", "ttc", "time", "distance"]),
    v=st.floats(15.0, 30.0), its=st.floats(1.0, 12.0), share=st.floats(0.1, 0.9),
)  # fmt: skip
def test_a_maneuver_begins_when_its_condition_holds(
    condition: str, v: float, its: float, share: float
) -> None:
    met, place = Met(100.0, its, 6.0, 2.0), course()
    gap = 100.0 - (LENGTH + 6.0) / 2
    aims = {"gap": gap, "headway": gap / v, "ttc": gap / (v - its), "time": 8.0, "distance": 40.0}
    n = {condition: aims[condition] * share}
    triggers = Triggers(place, cast(Any, None), Lateral(), driver(v, place), met, events={}, waits=False)
    wait = triggers.wait(Maneuver(Action(what="brake"), n))
    now = gap - (v - its) * wait  # bumper to bumper, when it begins
    holds = {"gap": now, "headway": now / v, "ttc": now / (v - its), "time": wait, "distance": its * wait}
    assert holds[condition] == pytest.approx(n[condition])
