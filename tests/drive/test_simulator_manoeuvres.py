"""The default car on flat ground: published ranges of saloon cars, and laws of mechanics.

Ranges are general knowledge about saloons of 200 to 250 kW (road tests; M. Mitschke, H. Wallentowitz,
Dynamik der Kraftfahrzeuge; BeamNG's recordings of its ETK 800 for the launch), written down before the car
was tuned.
"""

import math
from dataclasses import replace

import numpy as np
import pytest

from roadgpt.drive.simulators.mujoco import ETK_LIKE, plane
from roadgpt.drive.simulators.mujoco.dynamics import FY, LOAD

G = 9.81
KMH = 1 / 3.6


def rolling(speed_kmh, friction=1.0, car=ETK_LIKE):
    vehicle = plane(friction, car=car)
    vehicle.put(2500.0, 0.0, speed_kmh * KMH)
    return vehicle


def cruise(vehicle, speed_kmh, steer):
    """One control step of a speed controller with a fixed steering angle."""
    want = 0.6 * (speed_kmh * KMH - vehicle.see()["vx"])
    vehicle.move(steer, min(max(want, 0.0), 1.0), min(max(-0.2 * want, 0.0), 1.0))
    return vehicle.see()


def stopping_distance(speed_kmh, friction):
    vehicle = rolling(speed_kmh, friction)
    start = vehicle.see()["x"]
    while vehicle.see()["vx"] > 0.02:
        vehicle.move(0.0, 0.0, 1.0)
    return vehicle.see()["x"] - start


def steady_turn(speed_kmh, steer, friction=1.0):
    vehicle = rolling(speed_kmh, friction)
    for step in range(300):
        seen = cruise(vehicle, speed_kmh, steer * min(step / 50, 1.0))
    return vehicle, seen


def test_full_throttle():
    vehicle = plane()
    launch, seen = [], vehicle.see()
    while seen["vx"] < 100 * KMH:
        vehicle.move(0.0, 1.0, 0.0)
        seen = vehicle.see()
        launch.append(seen["ax"])
    assert 6.0 <= seen["time"] <= 7.0  # s to 100 km/h
    assert 6.5 <= max(launch) <= 7.2  # m/s^2, BeamNG recordings: 6.7 to 7.2
    assert abs(seen["y"]) < 1e-6


@pytest.mark.parametrize(
    ("friction", "shortest", "longest"), [(1.0, 36.0, 40.0), (0.6, 56.0, 68.0), (0.35, 95.0, 118.0)]
)
def test_full_braking_from_100(friction, shortest, longest):
    assert shortest <= stopping_distance(100, friction) <= longest


def test_abs_lets_the_car_steer_while_it_brakes():
    turned = {}
    for name, car in (("with", ETK_LIKE), ("without", replace(ETK_LIKE, abs_slip_threshold=0.0))):
        vehicle = rolling(80, car=car)
        for _ in range(75):
            vehicle.move(0.08, 0.0, 1.0)
        turned[name] = abs(vehicle.see()["y"])
    assert turned["with"] > 3 * turned["without"]
    assert turned["with"] > 2.0


def test_lateral_limit():
    vehicle = rolling(80)
    most = 0.0
    for step in range(700):
        seen = cruise(vehicle, 80, 0.014 * step * 0.02)
        most = max(most, seen["yaw_rate"] * seen["vx"] / G)
    assert 0.85 <= most <= 0.95
    assert not vehicle.mishap


def test_understeer_and_roll_gradients():
    rows = []
    for steer in (0.015, 0.022, 0.03):  # to 0.4 g
        _, seen = steady_turn(80, steer)
        lateral = seen["yaw_rate"] * seen["vx"] / G
        rows.append((lateral, steer - ETK_LIKE.wheelbase * seen["yaw_rate"] / seen["vx"], seen["roll"]))
    lateral, extra, roll = np.array(rows).T
    assert 1.0 <= math.degrees(np.polyfit(lateral, extra, 1)[0]) <= 2.5  # deg/g
    assert 3.0 <= math.degrees(np.polyfit(lateral, roll, 1)[0]) <= 6.0  # deg/g


def test_step_steer_answers_like_a_saloon():
    vehicle = rolling(80)
    history = [cruise(vehicle, 80, 0.0 if step < 10 else 0.035)["yaw_rate"] for step in range(160)]
    final = np.mean(history[-20:])
    rise = next(step for step, rate in enumerate(history) if rate > 0.9 * final) - 10
    assert 0.1 <= rise * 0.02 <= 0.4  # s
    assert 0.0 <= max(history) / final - 1 <= 0.20


def test_esc_keeps_the_nose_ahead_where_the_car_without_it_spins():
    worst = {}
    for name, car in (("with", ETK_LIKE), ("without", replace(ETK_LIKE, esc_gain=0.0))):
        vehicle = rolling(70, car=car)
        slips = []
        for step in range(250):
            vehicle.move(0.25 * math.sin(math.pi * step * 0.02) if step < 100 else 0.0, 0.3, 0.0)
            seen = vehicle.see()
            slips.append(abs(math.atan2(seen["vy"], seen["vx"])))
        worst[name] = math.degrees(max(slips))
    assert worst["with"] < 10.0
    assert worst["without"] > 20.0


@pytest.mark.parametrize("grade", [0.15, -0.15])
def test_brakes_hold_the_car_on_a_hill(grade):
    vehicle = plane(grade=grade)
    start = vehicle.see()
    for _ in range(500):
        vehicle.move(0.0, 0.0, 1.0)
    seen = vehicle.see()
    assert math.dist((seen["x"], seen["y"]), (start["x"], start["y"])) < 1e-4  # m in 10 s
    assert seen["speed"] < 1e-6


def test_without_pedals_it_stays_on_level_ground_and_rolls_off_on_a_hill():
    level, hill = plane(), plane(grade=0.10)
    for _ in range(250):
        level.move(0.0, 0.0, 0.0)
        hill.move(0.0, 0.0, 0.0)
    assert level.see()["speed"] < 1e-6
    # Less the rolling resistance, and the wheels' own inertia, which is that of 49 kg more.
    assert hill.see()["ax"] == pytest.approx(-G * (0.0995 - 0.011) * 1700 / 1749, rel=0.02)


def test_loads_add_up_to_the_weight_and_shift_as_statics_says():
    vehicle, seen = steady_turn(80, 0.04)
    loads = vehicle.wheels[:, LOAD]
    assert loads.sum() == pytest.approx(ETK_LIKE.mass * G, rel=0.01)
    lateral = seen["yaw_rate"] * seen["vx"]
    # Body at its height and wheels at their centres, over one track.
    wheels = 2 * (ETK_LIKE.front.unsprung_mass + ETK_LIKE.rear.unsprung_mass)
    moment = (ETK_LIKE.sprung_mass * ETK_LIKE.cg_height + wheels * 0.312) * lateral
    moment += ETK_LIKE.sprung_mass * G * (ETK_LIKE.cg_height - 0.08) * seen["roll"]  # the body leans out
    shifted = (loads[1] + loads[3] - loads[0] - loads[2]) * ETK_LIKE.front.track_width / 2
    assert shifted == pytest.approx(moment, rel=0.05)
    across = vehicle.wheels[:, FY].sum()
    assert across == pytest.approx(ETK_LIKE.mass * lateral, rel=0.04)


def test_left_is_the_mirror_image_of_right():
    left, right = rolling(60), rolling(60)
    for step in range(150):
        steer = 0.05 * math.sin(step * 0.08)
        left.move(steer, 0.4, 0.1)
        right.move(-steer, 0.4, 0.1)
    one, other = left.see(), right.see()
    for name in ("x", "z", "vx", "speed", "pitch", "ax"):
        assert one[name] == pytest.approx(other[name], abs=1e-6)
    for name in ("y", "vy", "heading", "roll", "yaw_rate", "ay"):
        assert one[name] == pytest.approx(-other[name], abs=1e-6)


def test_the_front_wheels_turn_at_a_limited_rate_and_no_further_than_their_stop():
    vehicle = rolling(30)
    for _ in range(10):
        vehicle.move(9.0, 0.0, 0.0)
    assert vehicle.see()["steer"] == pytest.approx(0.8 * 0.2, abs=1e-9)
    for _ in range(100):
        vehicle.move(9.0, 0.0, 0.0)
    assert vehicle.see()["steer"] == pytest.approx(ETK_LIKE.max_steer_angle, abs=1e-9)


def test_a_slow_circle_is_as_tight_as_the_steering_says():
    vehicle = rolling(8)
    for _ in range(300):
        seen = cruise(vehicle, 8, 0.3)
    assert seen["vx"] / seen["yaw_rate"] == pytest.approx(ETK_LIKE.wheelbase / math.tan(0.3), rel=0.05)
