"""Decides when a drive is over, from the state of the car at every control step."""

import math
from typing import TYPE_CHECKING

import numpy as np

from roadgpt.drive.drive import COLUMNS, Box, Ended, FloatArray
from roadgpt.drive.marking_monitor import POSE, MarkingMonitor
from roadgpt.drive.simulators.mujoco.vehicle import CONTROL
from roadgpt.errors import SimulationError
from roadgpt.road.ends import GOAL, START

if TYPE_CHECKING:
    from roadgpt.road import Road, World

STUCK_TIME = 10.0  # s within which a car must move ... (SBFT)
STUCK_WAY = 1.0  # m ... this far
SLOWEST = 2.0  # m/s, mean speed below which the time runs out
SPARE = 30.0  # s, added to that time

_NAMES = tuple(COLUMNS)
_SEEN = tuple(map(_NAMES.index, ("x", "y", "z", "speed", "s", "outside")))
_POSE = list(map(_NAMES.index, POSE))


class DriveMonitor:
    """Watches one drive along a road, from its first step to its end."""

    def __init__(self, road: "Road", world: "World", box: Box, keep_driving: bool = False) -> None:
        """Prepares the checks.

        Args:
            road: the road.
            world: tolerances; with ``lane_departure`` the front tyres are watched, too.
            box: outline of the car.
            keep_driving: whether the car may leave its lane.
        """
        self.start = min(START, road.length / 2)
        """Station in metres where the car is placed."""
        self._length = road.length
        self._tolerance = math.inf if keep_driving else world.oob_tolerance
        is_watched = world.lane_departure and not keep_driving
        self._tyres = MarkingMonitor.for_tyres(road, world, box) if is_watched else None
        self._end = np.asarray(road.at(road.length)).tolist()
        self._last = math.ceil((road.length / SLOWEST + SPARE) / CONTROL)
        self._since, self._from = 0, (math.nan, math.nan)

    def ended(self, row: FloatArray, step: int, has_fallen: bool) -> Ended | None:
        """Returns how the drive ended at this step, or None if it continues; call it once for every step,
        from 0 on.

        Raises:
            SimulationError: the physics became unstable.
        """
        x, y, z, speed, s, outside = (float(row[place]) for place in _SEEN)
        if not math.isfinite(x + y + z + speed + outside):
            raise SimulationError(
                f"the physics became unstable at {step * CONTROL:.2f} s: check the road and the car for "
                "numbers that make no sense"
            )
        # Within one step the competition checks for the goal, then for motion, then for the lane.
        # If a road ends near its start, the goal counts only from half of the road on.
        if s > self._length / 2 and math.hypot(x - self._end[0], y - self._end[1]) < GOAL:
            return "goal"
        if self._is_stuck(x, y, step):
            return "stuck"
        if outside > self._tolerance or self._has_departed(row):
            return "out_of_lane"
        if has_fallen:
            return "fell"
        return "timeout" if step >= self._last else None

    def _has_departed(self, row: FloatArray) -> bool:
        return self._tyres is not None and bool(self._tyres.beyond(row[None, _POSE])[0] > 0)

    def _is_stuck(self, x: float, y: float, step: int) -> bool:
        if step == 0 or math.hypot(x - self._from[0], y - self._from[1]) >= STUCK_WAY:
            self._since, self._from = step, (x, y)
        return (step - self._since) * CONTROL >= STUCK_TIME
