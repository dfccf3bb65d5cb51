"""Computes driving lines, and the controls with which a car follows a driving line. A driving line is the
centre line of the road, shifted sideways by a given offset at every station.

Drivers look up the line every 20 ms. The line is therefore computed once per road and stored as plain lists,
so that a lookup needs no search."""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roadgpt.drive.view import View
from roadgpt.road.speed_profile import PathGeometry

if TYPE_CHECKING:
    from roadgpt.road import Road

STEP = 0.5  # m between stations
BEYOND = 60.0  # m by which the line continues straight beyond the road's end, for drivers that look ahead
LEAST_STRETCH = 0.2  # lower bound of the metres of line per metre of road, on the inside of a bend

NEAREST = 1.0  # m, lower bound of the distance to the point that pure pursuit steers for
LAG = 0.12  # s, response time of engine and brakes; the plan is looked up that far ahead
FULL_THROTTLE = 6.8  # m/s^2 at low speed, of a strong saloon
POWER = 85.0  # W/kg at the wheels
FULL_BRAKE = 13.0  # m/s^2, deceleration of the brakes with unlimited tyre friction
DRAG = 3e-4  # 1/m, aerodynamic drag per mass and speed squared
ROLLING = 0.11  # m/s^2, rolling resistance per mass
GRAVITY = 9.81  # m/s^2
GAIN = 1.5  # 1/s, acceleration per speed error
COAST = 0.3  # m/s^2, demanded deceleration up to which the driver lifts the throttle and does not brake


FloatArray = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class DrivingLine(PathGeometry):
    """A driving line: a path with its place. Entry ``i`` of each list belongs to station ``i * step``. The
    lists go on for 60 m beyond the end of the road."""

    offset: list[float]  # offset in metres to the left of the centre line
    x: list[float]  # positions along x in metres
    y: list[float]  # positions along y in metres
    heading: list[float]  # heading of the line in radians, continuous (not wrapped)

    def place(self, s: float) -> tuple[int, float]:
        """Returns the index of the last entry at or before station ``s`` in metres, and the position of ``s``
        between that entry (0) and the next (1).

        A station before the line counts as its start, a station beyond the line as its end."""
        at = s / self.step
        last = len(self.x) - 2
        if at <= 0.0:
            return 0, 0.0
        i = int(at)
        return (i, at - i) if i <= last else (last, 1.0)


def stations(road: "Road") -> FloatArray:
    """Returns the stations in metres at which a line is computed, from start to end of the road, shape
    ``(n,)``."""
    return np.linspace(0.0, road.length, max(2, math.ceil(road.length / STEP)) + 1)


def smoothed(values: FloatArray, step: float, half_width: float) -> FloatArray:
    """Returns values, shape ``(n,)``, smoothed with a Hann window; beyond each end the end value is repeated.

    The values are ``step`` metres apart, and the window reaches ``half_width`` metres to both sides."""
    half = max(1, round(half_width / step))
    window = np.hanning(2 * half + 1 + 2)[1:-1]
    held = np.pad(values, half, mode="edge")
    return np.convolve(held, window / window.sum(), mode="valid")


def line_along(road: "Road", offset: ArrayLike) -> DrivingLine:
    """Returns the driving line at an offset in metres to the left of the centre line, one number or one for
    each of ``stations(road)``. On a road with superelevation, it is measured along the surface.

    The line continues straight for 60 m beyond the end of the road."""
    s = stations(road)
    step = float(s[1])
    t = np.broadcast_to(np.asarray(offset, float), s.shape)
    angle = np.zeros(s.shape) if road.profile is None else road.profile.superelevation(s)
    across = t * np.cos(angle)
    turning = np.gradient(across, step)
    along = np.maximum(1 - road.curvature(s) * across, LEAST_STRETCH)
    stretch = np.hypot(along, turning)
    heading = np.unwrap(road.heading(s)) + np.arctan2(turning, along)
    curvature = np.gradient(heading, step) / stretch
    xy = road.at(s, t)[:, :2]
    more = math.ceil(BEYOND / step)
    far = step * np.arange(1, more + 1)[:, None] * [[np.cos(heading[-1]), np.sin(heading[-1])]]
    xy = np.concatenate([xy, xy[-1] + far])
    return DrivingLine(
        step=step,
        stretch=_longer(stretch, more, 1.0),
        curvature=_longer(curvature, more, 0.0),
        grade=_longer(road.grade(s), more, float(road.grade(s[-1]))),
        crest=_longer(road.vertical_curvature(s), more, 0.0),
        superelevation=_longer(angle, more, float(angle[-1])),
        offset=_longer(t, more, t[-1]),
        x=xy[:, 0].tolist(),
        y=xy[:, 1].tolist(),
        heading=_longer(heading, more, heading[-1]),
    )


def _longer(values: FloatArray, more: int, last: float) -> list[float]:
    found: list[float] = values.tolist()
    return found + [float(last)] * more


def pursuit_curvature(line: DrivingLine, view: View, ahead: float) -> float:
    """Returns the curvature in 1/m, left positive, of the circle on which the car reaches the point of the
    line ``ahead`` metres along the road, beginning in the direction of its heading.

    Source: R. C. Coulter, "Implementation of the pure pursuit path tracking algorithm", CMU-RI-TR-92-01
    (1992)."""
    i, share = line.place(view.s + ahead)
    dx = line.x[i] + share * (line.x[i + 1] - line.x[i]) - view.x
    dy = line.y[i] + share * (line.y[i + 1] - line.y[i]) - view.y
    angle = math.atan2(dy, dx) - view.heading
    return 2 * math.sin(angle) / max(math.hypot(dx, dy), NEAREST)


def pedals(line: DrivingLine, speed: list[float], s: float, v: float) -> tuple[float, float]:
    """Returns throttle and brake, 0..1 each, with which a car at station ``s`` and speed ``v`` follows the
    planned speed in m/s at each station of the line: feed-forward from the plan, and feedback on the speed
    error."""
    i, share = line.place(s + LAG * v + 0.5 * line.step)
    here, there = speed[i], speed[i + 1]
    planned = here + share * (there - here)
    needed = planned * (there - here) / (line.step * line.stretch[i])
    return pedals_for(needed + GAIN * (planned - v), line.grade[i], v)


def pedals_for(acceleration: float, grade: float, v: float) -> tuple[float, float]:
    """Returns throttle and brake, 0..1 each, for an acceleration along the road in m/s^2 (negative to slow
    down), on a grade (a ratio) and at the speed ``v`` in m/s."""
    wanted = acceleration + GRAVITY * grade + DRAG * v * v + ROLLING
    if wanted > 0.0:
        return min(wanted / min(FULL_THROTTLE, POWER / max(v, 1.0)), 1.0), 0.0
    return 0.0, min(max(-wanted - COAST, 0.0) / FULL_BRAKE, 1.0)
