"""Decides for all simulators when a drive is over, from the state of the car at every control step."""

import math
from operator import itemgetter

import numpy as np
from numpy.typing import ArrayLike

from roadgpt.drive.drive import COLUMNS, PEDALS, RETURNS, SCRIPT, Box, Ended, FloatArray, Mishap
from roadgpt.drive.lane_position import POSE, MarkingMonitor
from roadgpt.errors import SimulationError
from roadgpt.road import Road, World
from roadgpt.road.road import GOAL

STUCK_TIME = 10.0  # s within which a car must move STUCK_WAY (SBFT)
STUCK_WAY = 1.0  # m
SLOWEST = 2.0  # m/s, mean speed from which the time limit follows
STUCK_AMONG_OTHERS = 120.0  # s; who queues, gives way or waits at a red light stands longer
SLOWEST_AMONG_OTHERS = 1.0  # m/s
AFTER_CONTACT = 3.0  # s that a drive goes on after the car touched somebody
SPARE = 30.0  # s, added to the time limit
ROUNDING = 1e-9  # s, rounding error of times that are multiples of a step

_NAMES = tuple(COLUMNS)
_SEEN = itemgetter(*map(_NAMES.index, ("x", "y", "z", "speed", "s", "outside")))
_POSE = list(map(_NAMES.index, POSE))


class DriveMonitor:
    """Watches one drive along a road, from its first step to its end."""

    def __init__(
        self, road: Road, world: World, box: Box, keep_driving: bool = False, among_others: bool = False
    ) -> None:
        """Prepares the checks with the tolerances of the world. If the world sets ``lane_departure``, the
        front tyres are checked, too. With ``keep_driving``, the car may leave its lane; so may a car among
        others, which may also stand longer and take more time."""
        self.start = world.start_on(road)
        """Station in metres where the car is placed."""
        self.limit = road.length / (SLOWEST_AMONG_OTHERS if among_others else SLOWEST) + SPARE
        """Time in seconds after which the drive ends."""
        self.is_over = False
        """Whether nothing is left to happen, and the car stays where it is."""
        self.touched: float | None = None
        """Time in seconds at which the car first touched somebody; None if it did not."""
        self._length, self._patience = road.length, STUCK_AMONG_OTHERS if among_others else STUCK_TIME
        keep_driving = keep_driving or among_others
        self._tolerance = math.inf if keep_driving else world.limits.oob_tolerance
        self._is_watched = world.limits.lane_departure and not keep_driving
        self._tyres: MarkingMonitor | None = None
        self.keep_to(road, world, box)
        self._since, self._from, self._free_until = 0.0, (math.nan, math.nan), -math.inf

    def ended(self, row: FloatArray, time: float, mishap: Mishap | None) -> Ended | None:
        """Returns how the drive ended at this step, or None if the drive continues.

        Call this method exactly once for every control step, from the first on. ``row`` is the state of the
        car in the order of COLUMNS; its column ``time`` is not used. ``time`` is in seconds since the start.
        """
        x, y, z, speed, s, outside = _SEEN(row.tolist())
        if not math.isfinite(x + y + z + speed + outside):
            raise SimulationError(
                f"the physics became unstable at {time:.2f} s: check the road and the car for "
                "numbers that make no sense"
            )
        if self.touched is not None:
            return "collision" if time >= self.touched + AFTER_CONTACT - ROUNDING else None
        # Within one step the competition checks for the goal, then for motion, then for the lane.
        if self.is_at_goal(x, y, s):
            return "goal"
        if self.is_over:
            return "over"
        if self.is_stuck(x, y, time):
            return "stuck"
        is_free = time <= self._free_until + ROUNDING
        if not is_free and self.is_out(outside, None if self._tyres is None else row[_POSE]):
            return "out_of_lane"
        if mishap:
            return mishap
        return "timeout" if time >= self.limit - ROUNDING else None

    def keep_to(self, road: Road, world: World, box: Box) -> None:
        """Sets the road whose driven lane is the one that the car is to keep to."""
        self._tyres = MarkingMonitor.for_tyres(road, world, box) if self._is_watched else None
        # The end of the lane's inner edge; with one lane in each direction it is that of the centre line.
        profile = world.profile_of(road)
        left, right = profile.lane(road.length)
        self._end = np.asarray(road.at(road.length, right if profile.left_hand else left)).tolist()

    def heed(self, by: str | None, has_end: bool, time: float, dt: float) -> None:
        """Heeds whether the script has the wheel or the pedals, in the step that begins: then the car may
        be outside its lane, and stand as long as the script wants, if that has an end."""
        if by == SCRIPT:
            self._free_until = time + dt + RETURNS
        if by in (SCRIPT, PEDALS) and has_end:
            self._since, self.limit = time + dt, self.limit + dt

    def touch(self, time: float) -> None:
        """Records that the car touches somebody; only the first time counts."""
        self.touched = time if self.touched is None else self.touched

    def is_at_goal(self, x: float, y: float, s: float) -> bool:
        """Returns whether the car has reached the goal at the end of the road.

        The car must be within 8 m of the end of the inner edge of its lane. With one lane in each direction,
        this edge is the centre line.

        In the first half of the road the result is always False, because a road may end near its start. All
        arguments are in metres."""
        return s > self._length / 2 and math.hypot(x - self._end[0], y - self._end[1]) < GOAL

    def is_stuck(self, x: float, y: float, time: float) -> bool:
        """Returns whether the car has moved less than 1 m in the last 10 s, or among others 120 s.

        Call this method once for every control step. ``x`` and ``y`` are in metres, ``time`` in seconds."""
        if not math.hypot(x - self._from[0], y - self._from[1]) < STUCK_WAY:
            self._since, self._from = time, (x, y)
        return time - self._since >= self._patience - ROUNDING

    def is_out(self, outside: float, pose: ArrayLike | None) -> bool:
        """Returns whether the car is out of its lane; ``outside`` is the share (0 to 1) of its box outside.

        If lane departures count, a car with a front tyre beyond a marking is out of its lane, too. ``pose``
        has the values of the columns POSE, shape (6,); it may be None if lane departures do not count."""
        if outside > self._tolerance:
            return True
        return self._tyres is not None and bool(self._tyres.beyond(np.array([pose]))[0] > 0)
