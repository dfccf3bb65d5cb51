"""The route of whoever does maneuvers: its way, its place on that, and how both lie to whom it meets."""

import math
from dataclasses import dataclass
from typing import NamedTuple

from roadgpt.network.line import GRIP, Line

BEYOND = 50.0  # m off the road: behind a car that stands at its begin, or at its end with something to do
AHEAD = (0.0, 1.0, 2.0, 3.0)  # s, at which bends count for a movement sideways


class Met(NamedTuple):
    """Whom somebody meets, as it is seen from its lane: the station of its middle and its speed in metres and
    seconds, its size, and how far its middle is to the left of the lane's."""

    s: float
    v: float
    length: float
    width: float
    t: float = 0.0


class Meeting(NamedTuple):
    """Two stations in metres that are to be reached at the same time: that of one's middle along one's way,
    and that of the front of whom one meets along its lane."""

    own: float
    its: float


@dataclass(eq=False)
class Course:
    """The place of somebody on a way."""

    lane: Line
    """The lane of whom it meets."""
    way: Line
    length: float
    """That of its box."""
    forward: int
    """1 along its way, -1 against it."""
    is_along: bool
    crosses: bool
    """Whether it stays along that lane, or crosses it."""
    is_in_lane: bool
    """Whether it is in that lane, and not beside it, so that a gap is one from either side."""
    faces: bool
    """Whether it comes towards whom it meets in the same lane, or will."""
    s: float = 0.0
    shift: float = 0.0
    """From a station of its way to that of the lane beside it."""
    meeting: Meeting | None = None
    backs: bool = False
    """Whether it drives there backwards."""

    @property
    def along(self) -> float:
        """The station along the lane of whom it meets."""
        return self.s + self.shift

    def is_there(self, before: bool, beyond: bool) -> bool:
        """Returns whether its box is on its way, or, if that is asked for, BEYOND metres before or beyond."""
        inside = 0.0 if self.way.road_stations is None else self.length / 2 - 0.01
        first, last = (-BEYOND if inside and each else inside for each in (before, beyond))
        return first <= self.s <= self.way.length - last

    def apart(self, met: Met) -> float:
        """Returns how far the front of whom it meets is before where they meet."""
        return self.meeting.its - met.s - met.length / 2 if self.meeting else math.inf

    def gap(self, v: float, met: Met) -> tuple[float, float]:
        """Returns the distance from bumper to bumper to whom it meets, and how fast it grows; of those in
        other lanes, it is negative where they are side by side or behind. Of who crosses, it is that to where
        the paths meet. ``v`` is its own speed."""
        if self.crosses:
            return self.apart(met), -met.v
        apart, away = self.along - met.s, self.forward * v - met.v
        sign = -1 if apart < 0 and self.is_in_lane else 1
        return sign * apart - (self.length + met.length) / 2, sign * away

    def eta(self, v: float, met: Met) -> float:
        """Returns the seconds until whom it meets is where they meet, as fast as both are now."""
        gap, rate = (self.apart(met), -met.v) if self.meeting and not self.faces else self.gap(v, met)
        return gap / max(-rate, 1e-3)

    def sideways(self, v: float, s: float | None = None) -> float:
        """Returns the most in m/s^2 with which it moves sideways from its place or another on."""
        ahead = ((self.s if s is None else s) + self.forward * v * time for time in AHEAD)
        return min(GRIP, *(self.way.room(each, v)[1] for each in ahead))
