"""How somebody changes its speed along its course."""

import math
from collections.abc import Mapping

from roadgpt.language.names import ActorKind
from roadgpt.language.table import ROAD_USERS
from roadgpt.network.line import LEAST_GRIP
from roadgpt.traffic.actor import STEP, STILL
from roadgpt.traffic.course import Course, Met
from roadgpt.traffic.following import HARDEST, JAM, idm
from roadgpt.traffic.lateral import Lateral
from roadgpt.traffic.maneuver import CHANGE, FAST, starting

PULL = ROAD_USERS["car"].pull or 0.0
FIRM = 7.0  # m/s^2, the hardest with which one brakes behind others in its lane
EASY = 4.0  # m/s^2, with which the tested car can stop before who stands or is slow


class Longitudinal:
    """A speed in m/s, negative backwards, that changes to a goal with a constant acceleration, as far as
    friction, bends and who is ahead allow."""

    def __init__(
        self, course: Course, lateral: Lateral, kind: ActorKind, cruise: float, v: float, told: float = 0.0
    ) -> None:
        self.course, self.lateral, self.kind = course, lateral, kind
        self.cruise, self.told, self.is_slowed = cruise, told, False
        """The speed that it is to have when it meets somebody, that which it is told to have, and whether a
        bend was too tight for that."""
        self.v = self.goal = v
        self.pull = CHANGE
        self.ahead: tuple[float, float] | None = None
        """How far it is to who is ahead of it on its way, in metres, and how fast that moves as it does."""

    def starts(self, n: Mapping[str, float]) -> tuple[float, float]:
        """Returns the speed that it comes to from rest by the numbers of a maneuver, and its acceleration."""
        goal = n.get("to", self.cruise)
        return goal, min(abs(n.get("accel", starting(self.kind, goal))), self.room(True, 0.0))

    def room(self, is_faster: bool, s: float | None = None) -> float:
        """Returns the most in m/s^2 with which friction and grade let it become faster or slower at its place
        or another, beside what the bend and its movement sideways take."""
        course = self.course
        left, _, falls = course.way.room(course.s if s is None else s, self.v, self.lateral.taken)
        return max(left - falls * course.forward * (1 if is_faster else -1), LEAST_GRIP)

    def bend(self, told: float) -> float:
        """Becomes as slow as the bend at its place needs, which is noted where it is ``told`` to be faster.
        Returns how many metres it drives per metre of its way."""
        stretch, fastest = self.course.way.bend(self.course.s, self.lateral.t, self.course.forward)
        self.is_slowed |= fastest < min(self.v, told) - STILL
        self.v = min(self.v, fastest)
        return stretch

    def most(self) -> float:
        """Returns with how many m/s^2 it can come to its goal."""
        return math.inf if self.goal == self.v else self.room(self.goal > self.v)

    def follow(self, met: Met, headway: float) -> None:
        """Chooses how it keeps a headway in seconds to whom it meets."""
        pull = idm(self.v, FAST, self.course.gap(self.v, met)[0], met.v, PULL, CHANGE, headway)
        self.goal, self.pull = (FAST if pull > 0 else 0.0), max(min(abs(pull), HARDEST), 1e-6)

    def step(self, time: float, pull: float) -> float:
        """Changes the speed by ``pull`` and moves it along its course for some seconds. Returns how many
        metres it went."""
        course, before, speeds_up = self.course, self.v, min(time, abs(self.goal - self.v) / pull)
        self.v += math.copysign(pull * speeds_up, self.goal - self.v)
        if speeds_up < time:
            self.v = self.goal
        stretch = self.bend(self.told if course.way is course.lane else 0.0)
        if self.ahead is not None:
            (gap, speed), most = self.ahead, self.room(False)
            safe = speed * abs(speed) + 2 * min(EASY, most) * max(gap - abs(self.v) * STEP - JAM / 2, 0.0)
            safe = max(math.sqrt(max(safe, 0.0)), abs(before) - min(FIRM, most) * time)
            if safe < abs(self.v):
                self.v, speeds_up = math.copysign(safe, self.v), time
        gone = (before + self.v) / 2 * speeds_up + self.v * (time - speeds_up)
        course.s += course.forward * gone / stretch
        return gone


def reach(time: float, speed: float, goal: float, pull: float) -> float:
    """Returns how far one comes in some seconds whose speed changes to ``goal`` with ``pull``."""
    changes = min(time, abs(goal - speed) / max(pull, 1e-9))
    last = speed + math.copysign(pull * changes, goal - speed)
    return (speed + last) / 2 * changes + last * (time - changes)
