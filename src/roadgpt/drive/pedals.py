"""Converts a planned speed to throttle and brake."""

from roadgpt.drive.driving_line import DrivingLine

LAG = 0.12  # s, response time of engine and brakes; the plan is looked up that far ahead
FULL_THROTTLE = 6.8  # m/s^2 at low speed, of a strong saloon
POWER = 85.0  # W/kg at the wheels
FULL_BRAKE = 13.0  # m/s^2, deceleration of the brakes with unlimited tyre friction
DRAG = 3e-4  # 1/m, aerodynamic drag per mass and speed squared
ROLLING = 0.11  # m/s^2, rolling resistance per mass
GRAVITY = 9.81  # m/s^2
GAIN = 1.5  # 1/s, acceleration per speed error
COAST = 0.3  # m/s^2, demanded deceleration up to which the driver lifts the throttle and does not brake


def pedals(line: DrivingLine, speed: list[float], s: float, v: float) -> tuple[float, float]:
    """Returns throttle and brake, 0..1 each, that follow a speed plan by feed-forward and feedback on the
    speed error.

    Args:
        line: the driving line.
        speed: planned speed in m/s at each station of the line.
        s: station of the car, metres.
        v: speed of the car, m/s.
    """
    i, share = line.place(s + LAG * v + 0.5 * line.step)
    here, there = speed[i], speed[i + 1]
    planned = here + share * (there - here)
    needed = planned * (there - here) / (line.step * line.stretch[i])
    wanted = needed + GAIN * (planned - v)
    wanted += GRAVITY * line.grade[i] + DRAG * v * v + ROLLING
    if wanted > 0.0:
        return min(wanted / min(FULL_THROTTLE, POWER / max(v, 1.0)), 1.0), 0.0
    return 0.0, min(max(-wanted - COAST, 0.0) / FULL_BRAKE, 1.0)
