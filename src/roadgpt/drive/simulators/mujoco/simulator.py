"""The simulator ``mujoco``: rigid bodies by MuJoCo, tyres and road surface of our own."""

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from roadgpt.drive.drive import COLUMNS, Columns, Drive, Ended, FloatArray
from roadgpt.drive.seat import Seat
from roadgpt.drive.simulators.mujoco.car import ETK_LIKE, Car
from roadgpt.drive.simulators.mujoco.vehicle import CONTROL, Vehicle
from roadgpt.drive.view import View
from roadgpt.errors import SimulationError

if TYPE_CHECKING:
    from roadgpt.drive import Driver
    from roadgpt.road import Road, World

START = 2.5  # m along the road (RoadGPT, SBFT)
GOAL = 8.0  # m from the end of the centre line (SBFT)
STUCK_TIME = 10.0  # s in which a car must move ... (SBFT)
STUCK_WAY = 1.0  # m ... this far
SLOWEST = 2.0  # m/s, mean, before time is out
SPARE = 30.0  # s, on top

_NAMES = tuple(COLUMNS)
_SEEN = tuple(
    map(
        _NAMES.index,
        ("x", "y", "z", "heading", "speed", "yaw_rate", "s", "t", "steer", "vx", "vy", "outside"),
    )
)


class MujocoSimulator:
    """A saloon car on the road, every 2 ms; the driver is asked every 20 ms."""

    def __init__(self, car: Car = ETK_LIKE, start_offset: float = 0.0) -> None:
        """A simulator with this car, which starts so many metres to the left of its lane's middle."""
        self.car, self.start_offset = car, start_offset

    def simulate(
        self, road: "Road", world: "World", driver: "Driver", seed: int, keep_driving: bool = False
    ) -> Drive:
        """See `roadgpt.drive.Simulator`. The seed is the driver's; the physics draws no random number."""
        seat = Seat(driver)
        vehicle = Vehicle.on(road, world, self.car)
        with seat.watched():
            seat.start(road, world, seed)
            place = -world.lane_width / 2 + self.start_offset
            rows, ended = _drive(vehicle, seat, road, world, keep_driving, place)
        columns = Columns({name: rows[:, place] for place, name in enumerate(_NAMES)})
        return Drive(seat.name, "mujoco", seed, columns, ended, self.car.box)


def _drive(
    vehicle: Vehicle, seat: Seat, road: "Road", world: "World", keep_driving: bool, t: float
) -> tuple[FloatArray, Ended]:
    vehicle.put(min(START, road.length / 2), t)
    end = np.asarray(road.at(road.length)).tolist()
    limit = math.ceil((road.length / SLOWEST + SPARE) / CONTROL)
    tolerance = 2.0 if keep_driving else world.oob_tolerance
    log = _Log()
    row = log.add(vehicle.row)
    since, (from_x, from_y) = 0, row[1:3]
    for step in range(limit + 1):
        x, y, z, heading, speed, yaw_rate, s, t, steer, vx, vy, outside = (row[i] for i in _SEEN)
        if not math.isfinite(x + y + z + speed + outside):
            raise SimulationError(
                f"the physics broke down at {step * CONTROL:.2f} s: check the road and the car for numbers "
                "that make no sense"
            )
        # At one and the same step the competition asks for the goal, then for motion, then for the lane.
        # Where a road ends near its start, only a car that has come round has arrived.
        if s > road.length / 2 and math.hypot(x - end[0], y - end[1]) < GOAL:
            return log.rows(), "goal"
        if math.hypot(x - from_x, y - from_y) >= STUCK_WAY:
            since, from_x, from_y = step, x, y
        elif (step - since) * CONTROL >= STUCK_TIME:
            return log.rows(), "stuck"
        if outside > tolerance:
            return log.rows(), "out_of_lane"
        if vehicle.has_fallen:
            return log.rows(), "fell"
        if step == limit:
            break
        view = View(
            step * CONTROL, x, y, z, heading, speed, yaw_rate, s, t, road, world, steer, CONTROL, vx, vy
        )
        vehicle.move(*seat.ask(view))
        row = log.add(vehicle.row)
    return log.rows(), "timeout"


class _Log:
    """Rows, in an array that grows."""

    def __init__(self) -> None:
        self._rows = np.empty((512, len(COLUMNS)))
        self._count = 0

    def add(self, row: FloatArray) -> Any:
        """Keeps the row; returns it as a list of numbers."""
        if self._count == len(self._rows):
            self._rows = np.concatenate([self._rows, np.empty_like(self._rows)])
        self._rows[self._count] = row
        self._count += 1
        return row.tolist()

    def rows(self) -> FloatArray:
        """Everything kept, shape (n, columns)."""
        return self._rows[: self._count]
