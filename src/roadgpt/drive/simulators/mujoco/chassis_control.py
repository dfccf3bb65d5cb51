"""Models the systems between the driver's pedals and the wheels: ABS, traction control and a simple ESC."""

import math
from typing import Any

from roadgpt.drive.compiled import inlined

LETS_GO = 12.0  # 1/s, maximum rate at which a valve closes
COMES_BACK = 5.0  # 1/s, maximum rate at which it opens
SLOWEST_ABS = 1.5  # m/s, below which wheels may lock
SLOWEST_ESC = 5.0  # m/s, below which the ESC does nothing
TOLERANCE = 0.06  # rad/s of yaw rate error that the ESC ignores
TOLERANCE_SHARE = 0.10  # of the expected yaw rate, ignored on top of that
ESC_LAG = 0.12  # s, lag of the expected yaw rate behind the steering
ESC_MOST = 2500.0  # Nm at one wheel
CUT = 4.0  # s/rad, share of throttle removed per yaw rate error
FRICTION_USED = 0.95  # share of the friction that the expected yaw rate may need


@inlined
def slip_valve(opening: float, slip: float, limit: float, dt: float) -> float:
    """Returns the share of the torque, 0 to 1, that ABS or traction control lets pass after a time step of
    ``dt`` seconds. ``opening`` is the share before the step; the share decreases while ``slip`` exceeds
    ``limit``."""
    if limit <= 0.0:
        return 1.0
    rate = 20.0 * (limit - slip) / limit
    rate = min(max(rate, -LETS_GO), COMES_BACK)
    return min(max(opening * (1.0 + rate * dt), 0.02), 1.0)


@inlined
def expected_yaw_rate(
    car: Any, friction: float, speed: float, steer: float, before: float, dt: float
) -> float:
    """Returns the yaw rate in rad/s that the ESC expects for the steering angle. The friction limits this yaw
    rate, and a lag delays it; ``before`` is the value one time step earlier."""
    wanted = speed * math.tan(steer) / (car.wheelbase + car.esc_understeer_gradient * speed * speed)
    most = FRICTION_USED * friction * 9.81 / max(speed, 1.0)
    wanted = min(max(wanted, -most), most)
    now: float = before + (wanted - before) * dt / (ESC_LAG + dt)
    return now


@inlined
def esc_torques(
    car: Any, speed: float, yaw_rate: float, expected: float
) -> tuple[float, float, float, float, float]:
    """Returns the ESC's braking torques in Nm (left front, right front, left rear, right rear) and the share
    of the throttle, 0 to 1, that the ESC allows."""
    excess = yaw_rate - expected
    beyond = abs(excess) - TOLERANCE - TOLERANCE_SHARE * abs(expected)
    if car.esc_gain <= 0.0 or speed < SLOWEST_ESC or beyond <= 0.0:
        return 0.0, 0.0, 0.0, 0.0, 1.0
    torque = min(car.esc_gain * beyond, ESC_MOST)
    kept = max(1.0 - CUT * beyond, 0.0)
    turns_left = expected > 0.0 if abs(expected) > 0.02 else yaw_rate > 0.0
    too_far = excess > 0.0 if turns_left else excess < 0.0
    if too_far:  # oversteer: braking the outer front wheel turns the car back
        if turns_left:
            return 0.0, torque, 0.0, 0.0, kept
        return torque, 0.0, 0.0, 0.0, kept
    if turns_left:  # understeer: braking the inner rear wheel turns the car in
        return 0.0, 0.0, 0.5 * torque, 0.0, kept
    return 0.0, 0.0, 0.0, 0.5 * torque, kept
