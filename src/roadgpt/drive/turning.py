"""Computes how people drive through junctions: how fast they turn, where in their lane, and where they stop.

All drivers of RoadGPT follow these rules in junctions. On roads without junctions the rules have no effect.
"""

import math
from typing import TYPE_CHECKING

import numpy as np

from roadgpt.drive.driving_line import FULL_BRAKE, DrivingLine, FloatArray, pedals_for, smoothed
from roadgpt.drive.outlook import passages
from roadgpt.drive.view import Command, View

if TYPE_CHECKING:
    from roadgpt.road import Road, World

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
HALTED = 0.05  # m/s, below which the car counts as standing; a verdict asks for less than 0.1
REACH = 4.0  # m before the line, within which the car has to stand, as in CARLA's test of stop signs
LEAST_BRAKE = 0.25  # brake pedal, 0 to 1
NEAR, ROLL_UP = 10.0, 1.0  # m before the line, m/s^2: a car that stops too early there rolls on


def turning_speed(curvature: float) -> float:
    """Returns the speed in m/s at which people drive through a bend of a junction or roundabout.

    On a radius of 10 m the speed is 20 km/h (lateral acceleration 3.1 m/s^2), on 15 m 23 km/h (2.8 m/s^2), on
    30 m 30 km/h (2.3 m/s^2). Above a radius of 200 m the speed is infinite. ``curvature`` is the
    curvature of the driven line in 1/m."""
    if abs(curvature) * GENTLE < 1:
        return math.inf
    return SPEED / 3.6 / math.pow(abs(curvature), EXPONENT)


def highest_speeds(road: "Road", line: DrivingLine, braking: float = math.inf) -> list[float] | None:
    """Returns the speed in m/s that stop signs and the bends of junctions allow, at each station of a line.

    Where nothing limits the speed, the speed is infinite. The result is None on a road without junctions.
    ``braking`` is the largest deceleration in m/s^2 before and inside junctions. By default only stop signs
    limit the deceleration here, and the driver's plan limits it later."""
    ways = passages(road)
    if not ways:
        return None
    found = [math.inf] * len(line.x)
    for way in ways:
        first, last = line.place(way.start)[0], line.place(way.end)[0] + 1
        found[first : last + 1] = map(turning_speed, line.curvature[first : last + 1])
        if way.stop_line is not None:
            stop = line.place(way.stop_line - FRONT - BEFORE_LINE)[0]
            for i in range(min(stop + BEHIND, len(found))):
                stopping = math.sqrt(CREEP**2 + 2 * EASY_BRAKING * max(stop - i, 0) * line.step)
                found[i] = min(found[i], stopping)
    for i in range(len(found) - 2, -1, -1):
        slowing = math.sqrt(found[i + 1] ** 2 + 2 * braking * line.step * line.stretch[i])
        found[i] = min(found[i], slowing)
    return found


def share_of_junction(road: "Road", s: FloatArray) -> FloatArray:
    """Returns a weight for each station in metres, shape ``(n,)``: 1 inside a junction, 0 far from junctions.

    Within ``BLEND`` metres before and behind a junction, the weight falls smoothly from 1 to 0."""
    share = np.zeros(s.shape)
    for way in passages(road):
        away = np.clip(np.maximum(way.start - s, s - way.end) / BLEND, 0.0, 1.0)
        share = np.maximum(share, (1 - away) ** 2 * (1 + 2 * away))
    return share


def kept_in_lane(
    road: "Road", world: "World", s: FloatArray, offset: FloatArray, inwards: FloatArray
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
    if not passages(road):
        return offset
    profile = world.profile_of(road)
    middle, room = profile.middle(s), np.maximum(profile.width(s) / 2 - EDGE, 0.0)
    aside = np.clip(offset + inwards - middle, -room, room) - inwards
    planned = middle + smoothed(aside, float(s[1] - s[0]), BLEND)
    kept: FloatArray = offset + share_of_junction(road, s) * (planned - offset)
    return kept


class StopSigns:
    """Makes a driver stop at the stop signs of a route: the car stops once before each stop line."""

    def __init__(self, road: "Road") -> None:
        """Prepares the stop lines of a route; on a road without stop signs, no command is changed."""
        self._lines = [way.stop_line for way in passages(road) if way.stop_line is not None]

    def obeyed(self, view: View, command: Command) -> Command:
        """Returns the command, changed near a stop line: the car brakes to a stop before the line, and rolls
        on slowly if it has stopped too early."""
        if not self._lines:
            return command
        left = self._lines[0] - view.s - FRONT
        if left > BEFORE_LINE + view.speed * view.dt:
            if left < NEAR and view.speed < CREEP / 2:  # it stopped too early, where its plan still brakes
                grade = float(view.road.grade(view.s))
                return Command(command.steer, *pedals_for(ROLL_UP, grade, view.speed))
            return command
        if (view.speed < HALTED and left < REACH) or left < -REACH:
            del self._lines[0]
            return command
        needed = view.speed**2 / 2 / max(left, BEFORE_LINE / 2)
        return Command(command.steer, 0.0, min(max(needed / FULL_BRAKE, LEAST_BRAKE), 1.0))
