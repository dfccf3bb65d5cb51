"""When a drive is over: asked at every control step, of a row of what can be seen."""

import math
from typing import TYPE_CHECKING

import numpy as np

from roadgpt.drive.drive import COLUMNS, Box, Ended, FloatArray
from roadgpt.drive.marking import POSE, Marking
from roadgpt.drive.simulators.mujoco.vehicle import CONTROL
from roadgpt.errors import SimulationError
from roadgpt.road.ends import GOAL, START

if TYPE_CHECKING:
    from roadgpt.road import Road, World

STUCK_TIME = 10.0  # s in which a car must move ... (SBFT)
STUCK_WAY = 1.0  # m ... this far
SLOWEST = 2.0  # m/s, mean, before time is out
SPARE = 30.0  # s, on top

_NAMES = tuple(COLUMNS)
_SEEN = tuple(map(_NAMES.index, ("x", "y", "z", "speed", "s", "outside")))
_POSE = list(map(_NAMES.index, POSE))


class Course:
    """One drive along a road, watched from its first step on."""

    def __init__(self, road: "Road", world: "World", box: Box, keep_driving: bool = False) -> None:
        """Along the road, by a car of this outline; ``keep_driving``: it may leave its lane."""
        self.start = min(START, road.length / 2)
        """Metres along the road where the car is put."""
        self._length = road.length
        self._tolerance = math.inf if keep_driving else world.oob_tolerance
        is_watched = world.lane_departure and not keep_driving
        self._tyres = Marking.for_tyres(road, world, box) if is_watched else None
        self._end = np.asarray(road.at(road.length)).tolist()
        self._last = math.ceil((road.length / SLOWEST + SPARE) / CONTROL)
        self._since, self._from = 0, (math.nan, math.nan)

    def ended(self, row: FloatArray, step: int, has_fallen: bool) -> Ended | None:
        """How the drive ended at this step; None: it goes on. Ask it of every step once, from 0 on.

        Raises:
            SimulationError: the physics broke down.
        """
        x, y, z, speed, s, outside = (float(row[place]) for place in _SEEN)
        if not math.isfinite(x + y + z + speed + outside):
            raise SimulationError(
                f"the physics broke down at {step * CONTROL:.2f} s: check the road and the car for numbers "
                "that make no sense"
            )
        # At one and the same step the competition asks for the goal, then for motion, then for the lane.
        # Where a road ends near its start, only a car that has come round has arrived.
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
