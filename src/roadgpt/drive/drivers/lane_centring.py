"""A driver under test that steers as production lane centring does, and slows down for the bends that its
camera sees."""

import math
from collections import deque
from dataclasses import dataclass

import numpy as np

from roadgpt.brief.visibility import visual_range
from roadgpt.drive.drivers.reference import Reference
from roadgpt.drive.driving_line import lane_limits, line_along, pedals_for, stations
from roadgpt.drive.keeping_distance import HARDEST, ROLLS, KeepingDistance, slowed
from roadgpt.drive.view import Command, View
from roadgpt.road import Road, World
from roadgpt.road.speed_profile import GRAVITY

EVERY = 2  # control steps from one image to the next: 25 images a second
SPACING = 2.0  # m between the places at which the lane is looked at
SPEED_GAIN = 2.0  # 1/s, acceleration per speed error
LEAST_AHEAD = 1.0  # m; nearer places say nothing about a crest
TAKEN_OVER = 50.0  # m before a junction, from which the person at the wheel drives
GIVEN_BACK = 10.0  # m behind a junction, from which the lane centring steers again
FAST, SLOW, MORE, JERK = 20.0, 5.0, 1.5, 2.5
"""Above FAST m/s cruise control brakes with ``hardest``, which takes JERK m/s^3 to build up; below SLOW with
MORE m/s^2 more, in half of the time: ISO 15622."""
EMERGENCY = 5.0  # m/s^2: where more is needed, emergency braking begins; the least that UN R152 asks for
FULL, BUILD_UP = 0.85 * GRAVITY, 0.6  # m/s^2, s until it is reached: UN R157, Annex 4, Appendix 3, from R152
AWAKE, AWAKE_FOR_OTHERS = 9.5 / 3.6, 19.5 / 3.6
"""m/s, from which on there is emergency braking before vehicles, and before persons: 10 and 20 km/h in UN
R152, less what a test's speed may be off."""
HELD = 6.0  # m/s^2 sideways, up to which a robot can hold path and speed at junctions, as scenes assume
SHORT = 1.0  # m before somebody, where emergency braking wants to stand
STRAIGHT = 1e-6  # 1/m; a smaller curvature limits no speed
TURN = 2 * math.pi


@dataclass(eq=False)
class LaneCentring:
    """Keeps to the middle of its lane with limited lateral acceleration; knows only what its camera sees.

    It represents the lane centring and adaptive cruise control of production cars (SAE level 2). It imitates
    no particular car, and was not compared with any car. docs/explanation/drivers.md says where each
    value comes from.

    The camera sees the middle of the lane up to ``sight`` metres ahead. The view ends earlier at a crest, or
    where the middle is more than ``aside`` metres from the car's axis. A tight bend leaves the image early,
    so the car slows down for it late. It then needs more lateral acceleration than its steering gives, and
    leaves its lane on the outside of the bend.

    Lane centring is not made for the turns of junctions (comma.ai's openpilot lists intersections among its
    limitations, because its steering torque is limited). So from 50 m before a junction or roundabout until
    10 m behind it, the person at the wheel drives, as the driver ``reference`` does, or as ``robot`` if the
    scene says so and it can hold its speed there. The person drives on if the car is still too fast for the
    bends that the camera sees.
    Emergency braking stays the car's: then the pedals are, too, and the person steers.

    Cruise control keeps 1.5 s to vehicles in the path up to 150 m ahead, and brakes with at most
    ``hardest``, below 20 m/s with up to 1.5 m/s^2 more. ISO 15622 asks for at least 0.8 s, and allows
    3.5 m/s^2 and 2.5 m/s^3 above 20 m/s, 5 m/s^2 and 5 m/s^3 below 5 m/s. Where not touching somebody in the
    path takes more than 5 m/s^2, emergency braking begins, and reaches 0.85 g after 0.6 s. UN R152 asks for
    at least 5 m/s^2, before vehicles from 10, before persons from 20 to 60 km/h; here it also acts above.
    Limits: persons, animals and things count only for emergency braking, and from ``sight`` metres on; fast
    cars may touch what stands there, which R152 allows above about 40 km/h. The warning that R152 asks for
    has no effect, because nobody is simulated who would heed it. Below these speeds the person at the wheel
    brakes for everybody, and always for red lights. A robot does not, and sets the speed of the scene;
    after an emergency braking ``reference`` is at the wheel.

    Args:
        strength: largest lateral acceleration that the steering gives, in m/s^2.
        jerk: fastest change of the lateral acceleration, in m/s^3.
        aim: lateral acceleration to which the cruise control slows down for a bend that it sees, in m/s^2.
        slowest: speed below which the cruise control does not slow down for bends, in m/s.
        braking: deceleration with which the cruise control plans to slow down, in m/s^2.
        hardest: largest deceleration, in m/s^2.
        acceleration: largest acceleration, in m/s^2.
        lag: time from the image to the steering, in seconds.
        sight: how far ahead the camera sees the lane, in metres; in fog, the visual range if that is less.
        aside: how far to either side the camera sees the lane, in metres.
        eye_height: height of the camera above the road, in metres.
        headway: time in which an error is corrected, in seconds.
        nearest: shortest distance in which an error is corrected, in metres.
        drift: offset to the outside of a bend per curvature of the lane, in m^2.
        wheelbase: wheelbase in metres."""

    name = "lane_centring"

    strength: float = 2.86
    jerk: float = 5.0
    aim: float = 1.9
    slowest: float = 20 / 3.6
    braking: float = 2.5
    hardest: float = 3.5
    acceleration: float = 2.0
    lag: float = 0.2
    sight: float = 40.0
    aside: float = 5.0
    eye_height: float = 1.3
    headway: float = 1.0
    nearest: float = 6.0
    drift: float = 5.0
    wheelbase: float = 2.83

    def start(self, road: Road, world: World, seed: int) -> None:
        """Computes the middle of the lane, and forgets the last road."""
        self._by_person = [(way.start - TAKEN_OVER, way.end + GIVEN_BACK) for way in road.passages]
        square = world.first_speed**2
        self._is_robot = bool(world.scene.person and not world.scene.parks) and all(
            square * np.abs(road.curvature(np.arange(way.start, way.end))).max() < HELD
            for way in road.passages
        )
        self._next, self._is_person = Reference(), False
        self._person = self._next
        if self._is_robot:
            from roadgpt.drive.drivers.robot import Robot

            self._person = Robot()
        self.handed_to: str | None = None
        if self._by_person:
            for each in {self._person, self._next}:
                each.start(road, world, seed)
        self._line = line_along(road, world.profile_of(road).middle(stations(road)))
        self._most = world.driven_speed
        self._speed_limit = world.first_speed if self._is_robot else self._most
        self._lane_limits = lane_limits(road, world, self._line)
        self._sight = min(self.sight, visual_range(world.scene, "lane"))
        self._steps, self._bend, self._lateral, self._speed = 0, 0.0, 0.0, self._speed_limit
        self._waiting: deque[float] = deque()
        self._distance, self._is_emergency, self._braking = KeepingDistance(self._line), False, 0.0

    def steer(self, view: View) -> Command:
        """Steers by the image of ``lag`` seconds ago, and drives as fast as the bends in sight allow.

        Near junctions, the person at the wheel steers, and drives but for emergency braking."""
        command = self._centred(view)
        is_near = any(first <= view.s <= last for first, last in self._by_person)
        self._is_person = is_near or (self._is_person and view.speed > self._speed)
        self.handed_to = self._person.name if self._is_person else None
        if not self._is_person:
            return command
        person = self._person.steer(view)
        return command._replace(steer=person.steer) if self._is_emergency else person

    def _centred(self, view: View) -> Command:
        if self._steps % EVERY == 0:
            self._look(view)
        self._steps += 1
        square = max(view.speed, self.slowest) ** 2
        most = self.jerk * view.dt
        change = min(max(self._bend * square - self._lateral, -most), most)
        self._lateral = min(max(self._lateral + change, -self.strength), self.strength)
        self._waiting.append(self._lateral / square)
        has_waited = len(self._waiting) * view.dt > self.lag
        bend = self._waiting.popleft() if has_waited else 0.0
        wanted = min(max(SPEED_GAIN * (self._speed - view.speed), -self.hardest), self.acceleration)
        here, _ = self._line.place(view.s)
        command = Command(
            math.atan(self.wheelbase * bend), *pedals_for(wanted, self._line.grade[here], view.speed)
        )
        if not (view.others or view.lights):
            self._is_emergency = False
            return command
        return slowed(self._line, view, command, self._allowed(view))

    def _allowed(self, view: View) -> float:
        """Returns the acceleration in m/s^2 that others in the path and red lights allow."""
        v, count = view.speed, len(view.others)
        rows = self._distance.ahead(view)
        gap, along, follows, vehicles = (rows[:count] if self._is_robot else rows).T
        is_vehicle = vehicles > 0
        closing = np.where(is_vehicle | (gap < self._sight), np.maximum(v - along, 0.0), 0.0)
        closing[count:] = 0.0  # red lights
        needed = closing**2 / 2 / np.maximum(gap - SHORT - closing * BUILD_UP / 2, 0.1)
        is_awake = v > np.where(is_vehicle, AWAKE, AWAKE_FOR_OTHERS)
        if (is_awake & (needed > EMERGENCY)).any():
            self._is_emergency = True
        elif self._is_emergency and (v < ROLLS or not closing[gap < self._sight].any()):
            self._is_emergency = self._is_robot = False
            self._person, self._speed_limit = self._next, self._most
        share = min(max((FAST - v) / (FAST - SLOW), 0.0), 1.0)
        asked, jerk = -FULL, FULL / BUILD_UP
        if not self._is_emergency:
            least = math.inf if self._is_person else float(follows[is_vehicle].min(initial=math.inf))
            asked, jerk = max(least, -self.hardest - MORE * share), JERK * (1 + share)
        self._braking = max(asked, min(self._braking, 0.0) - jerk * view.dt)
        by_hand = math.inf if self._is_robot else float(follows[~is_awake].min(initial=math.inf))
        return min(self._braking, max(by_hand, -HARDEST))

    def _look(self, view: View) -> None:
        seen = self._speeds_in_sight(view)
        if seen:
            self._speed = min(self._speed_limit, *seen)
            self._bend = self._curvature(view, max(self.headway * view.speed, self.nearest))

    def _speeds_in_sight(self, view: View) -> list[float]:
        line, cos, sin = self._line, math.cos(view.heading), math.sin(view.heading)
        eye = line.z[line.place(view.s)[0]] + self.eye_height
        highest, distance, out = -math.inf, 0.0, list[float]()
        while distance <= self._sight:
            i, _ = line.place(view.s + distance)
            dx, dy = line.x[i] - view.x, line.y[i] - view.y
            ahead = dx * cos + dy * sin
            if abs(dy * cos - dx * sin) > self.aside:
                break
            if ahead > LEAST_AHEAD:
                slope = (line.z[i] - eye) / ahead
                if slope < highest:
                    break  # behind a crest
                highest = slope
            there = max(self.aim / max(abs(line.curvature[i]), STRAIGHT), self.slowest**2)
            there = min(there, self._lane_limits[i] ** 2)
            out.append(math.sqrt(there + 2 * self.braking * distance))
            distance += SPACING
        return out

    def _curvature(self, view: View, reach: float) -> float:
        line = self._line
        i, share = line.place(view.s)
        bend = line.curvature[i]
        middle = line.offset[i] + share * (line.offset[i + 1] - line.offset[i])
        heading = line.heading[i] + share * (line.heading[i + 1] - line.heading[i])
        error = view.t - middle + self.drift * bend
        return bend - 2 * (error + reach * math.remainder(view.heading - heading, TURN)) / reach**2
