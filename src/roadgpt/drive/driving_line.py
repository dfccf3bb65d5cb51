"""Computes driving lines, and the controls with which a car follows a driving line. A driving line is the
centre line of the road, shifted sideways by a given offset at every station.

Drivers look up the line every 20 ms. The line is therefore computed once per road and stored as plain lists,
so that a lookup needs no search.

All drivers of RoadGPT follow the same rules in junctions: how fast people turn, where in their lane, and
where they stop."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roadgpt.drive.outlook import limits_of
from roadgpt.drive.view import View
from roadgpt.geometry.curve import LEAST_STRETCH
from roadgpt.road import Road, World
from roadgpt.road.speed_profile import GRAVITY, PathGeometry

STEP = 0.5  # m between stations
BEYOND = 60.0  # m by which the line continues straight beyond the road's end, for drivers that look ahead

NEAREST = 1.0  # m, lower bound of the distance to the point that pure pursuit steers for
LAG = 0.12  # s, response time of engine and brakes; the plan is looked up that far ahead
FULL_THROTTLE = 6.8  # m/s^2 at low speed, of a strong saloon
POWER = 85.0  # W/kg at the wheels
FULL_BRAKE = 13.0  # m/s^2, deceleration of the brakes with unlimited tyre friction
DRAG = 3e-4  # 1/m, aerodynamic drag per mass and speed squared
ROLLING = 0.11  # m/s^2, rolling resistance per mass
GAIN = 1.5  # 1/s, acceleration per speed error
COAST = 0.3  # m/s^2, demanded deceleration up to which the driver lifts the throttle and does not brake


FloatArray = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class DrivingLine(PathGeometry):
    """A driving line: a path with its place. Entry ``i`` of each list belongs to station ``i * step``. The
    lists go on for 60 m beyond the end of the road."""

    offset: list[float]  # offset in metres to the left of the centre line
    x: list[float]  # positions in metres
    y: list[float]
    z: list[float]  # beyond the end of the road, that of its end
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


def stations(road: Road) -> FloatArray:
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


def line_along(road: Road, offset: ArrayLike) -> DrivingLine:
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
    grade, (x, y, z) = road.grade(s), road.at(s, t).T
    inside = stretch, curvature, grade, road.vertical_curvature(s), angle, t, x, y, z, heading
    far = step * np.arange(1, math.ceil(BEYOND / step) + 1)
    x_far, y_far = x[-1] + far * np.cos(heading[-1]), y[-1] + far * np.sin(heading[-1])
    beyond = 1.0, 0.0, grade[-1], 0.0, angle[-1], t[-1], x_far, y_far, z[-1], heading[-1]
    columns = (np.r_[one, np.broadcast_to(two, far.shape)] for one, two in zip(inside, beyond, strict=True))
    return DrivingLine(step, *(column.tolist() for column in columns))


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


SPEED, EXPONENT = 8.6164, 0.3673
"""Speed in km/h at a radius of 1 m, and the exponent with which the speed grows with the radius.

Source: NCHRP Report 672, Roundabouts: An Informational Guide, 2nd ed. (2010), equation 6-2 (superelevation
-2 %), in the metric units of the first edition (FHWA-RD-00-067). The equation rests on the side friction that
drivers accept at low speeds: 0.31 at 20 mph and less (Texas, Procedures for Establishing Speed Zones)."""
GENTLE = 200.0  # m, radius from which on nobody slows down inside a junction
EDGE = 1.5  # m, from the middle of a car to the edge of its lane on the fastest path: NCHRP 672, 6.7.2
BLEND = 10.0
"""Metres before and behind a junction over which a planned line changes from the road to the junction. Inside
a junction, a line moves from one side of its lane to the opposite side over twice this distance."""

FRONT = 2.25  # m, from the centre of gravity to the front of RoadGPT's saloon
BEFORE_LINE = 1.0  # m, from the front of the stopped car to the stop line
CREEP = 1.0  # m/s, planned speed at the stopping place: the lowest that is planned
BEHIND = 3  # stations from the stopping place on that keep this speed: drivers look up their plan ahead
EASY_BRAKING = 3.4  # m/s^2, with which most drivers brake easily: AASHTO Green Book, stopping distance


def turning_speed(curvature: float) -> float:
    """Returns the speed in m/s at which people drive through a bend of a junction or roundabout.

    On a radius of 10 m the speed is 20 km/h (lateral acceleration 3.1 m/s^2), on 15 m 23 km/h (2.8 m/s^2), on
    30 m 30 km/h (2.3 m/s^2). Above a radius of 200 m the speed is infinite. ``curvature`` is the
    curvature of the driven line in 1/m."""
    if abs(curvature) * GENTLE < 1:
        return math.inf
    return SPEED / 3.6 / math.pow(abs(curvature), EXPONENT)


def lane_limits(road: Road, world: World, line: DrivingLine) -> list[float]:
    """Returns the speed limit in m/s of the lanes at each station of a line; infinite if they have none."""
    found = [math.inf] * len(line.x)
    for start, limit in limits_of(road, world):
        first = line.place(start)[0]
        found[first:] = [limit] * (len(found) - first)
    return found


def highest_speeds(
    road: Road, world: World, line: DrivingLine, braking: float = math.inf
) -> list[float] | None:
    """Returns the speed in m/s that the limits of lanes, stop signs and the bends of junctions allow, at each
    station of a line.

    Where nothing limits the speed, the speed is infinite, and the result is None if that is everywhere.
    ``braking`` is the largest deceleration in m/s^2 before and inside junctions. By default only stop signs
    limit the deceleration here, and the driver's plan limits it later."""
    ways = road.passages
    if not ways and not limits_of(road, world):
        return None
    found = lane_limits(road, world, line)
    for way in ways:
        first, last = line.place(way.start)[0], line.place(way.end)[0] + 1
        turning = map(turning_speed, line.curvature[first : last + 1])
        found[first : last + 1] = map(min, found[first : last + 1], turning)
        if way.stop_line is not None:
            stop = line.place(way.stop_line - FRONT - BEFORE_LINE)[0]
            for i in range(min(stop + BEHIND, len(found))):
                stopping = math.sqrt(CREEP**2 + 2 * EASY_BRAKING * max(stop - i, 0) * line.step)
                found[i] = min(found[i], stopping)
    for i in range(len(found) - 2, -1, -1):
        slowing = math.sqrt(found[i + 1] ** 2 + 2 * braking * line.step * line.stretch[i])
        found[i] = min(found[i], slowing)
    return found


def share_of_junction(road: Road, s: FloatArray) -> FloatArray:
    """Returns a weight for each station in metres, shape ``(n,)``: 1 inside a junction, 0 far from junctions.

    Within ``BLEND`` metres before and behind a junction, the weight falls smoothly from 1 to 0."""
    share = np.zeros(s.shape)
    for way in road.passages:
        away = np.clip(np.maximum(way.start - s, s - way.end) / BLEND, 0.0, 1.0)
        share = np.maximum(share, (1 - away) ** 2 * (1 + 2 * away))
    return share


def kept_in_lane(
    road: Road, world: World, s: FloatArray, offset: FloatArray, inwards: FloatArray
) -> FloatArray:
    """Returns the offsets of a planned line, changed in junctions so that the car keeps to its lane.

    In a junction the middle of the car stays at least ``EDGE`` metres from both edges of its lane; in a lane
    narrower than ``2 * EDGE``, it stays in the middle of the lane. The line moves sideways over ``2 * BLEND``
    metres, even where the bend into a roundabout is followed at once by the bend of its ring. The line has no
    kinks, and the curvature of the line stays near the curvature of the road.

    Args:
        road: The road or route; without junctions, the offsets are returned unchanged.
        world: The World.
        s: Stations of the line in metres, ``(n,)``.
        offset: Offsets of the line in metres to the left of the centre line, ``(n,)``.
        inwards: Distance in metres between the line and the path of the car, which cuts bends; positive to
            the left, ``(n,)``."""
    if not road.passages:
        return offset
    profile = world.profile_of(road)
    middle, room = profile.middle(s), np.maximum(profile.width(s) / 2 - EDGE, 0.0)
    aside = np.clip(offset + inwards - middle, -room, room) - inwards
    planned = middle + smoothed(aside, float(s[1] - s[0]), BLEND)
    kept: FloatArray = offset + share_of_junction(road, s) * (planned - offset)
    return kept
