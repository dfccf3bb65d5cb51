"""The simulator ``mujoco``: rigid bodies by MuJoCo, tyres and road surface of our own."""

from typing import TYPE_CHECKING, Any

import numpy as np

from roadgpt.drive.drive import COLUMNS, Columns, Drive, Ended, FloatArray
from roadgpt.drive.eyes import Eyes, camera_of
from roadgpt.drive.seat import Seat
from roadgpt.drive.simulators.mujoco.car import ETK_LIKE, Car
from roadgpt.drive.simulators.mujoco.course import Course
from roadgpt.drive.simulators.mujoco.vehicle import CONTROL, Vehicle
from roadgpt.drive.view import View
from roadgpt.stopping import look

if TYPE_CHECKING:
    from roadgpt.drive import Driver
    from roadgpt.road import Road, World

_NAMES = tuple(COLUMNS)
_SEEN = tuple(
    map(_NAMES.index, ("x", "y", "z", "heading", "speed", "yaw_rate", "s", "t", "steer", "vx", "vy"))
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
        seat, camera = Seat(driver), camera_of(driver)
        vehicle = Vehicle.on(road, world, self.car)
        eyes = None if camera is None else Eyes(camera, road, world)
        course = Course(road, world, self.car.box, keep_driving)
        with seat.watched():
            seat.start(road, world, seed)
            vehicle.put(course.start, -world.lane_width / 2 + self.start_offset)
            rows, ended = _drive(vehicle, seat, course, eyes, road, world)
        columns = Columns({name: rows[:, place] for place, name in enumerate(_NAMES)})
        return Drive(seat.name, "mujoco", seed, columns, ended, self.car.box)


def _drive(
    vehicle: Vehicle, seat: Seat, course: Course, eyes: Eyes | None, road: "Road", world: "World"
) -> tuple[FloatArray, Ended]:
    log = _Log()
    row = log.add(vehicle.row)
    step = 0
    while (ended := course.ended(vehicle.row, step, vehicle.has_fallen)) is None:
        x, y, z, heading, speed, yaw_rate, s, t, steer, vx, vy = (row[i] for i in _SEEN)
        image = None if eyes is None else eyes.see(vehicle.see())
        view = View(
            step * CONTROL,
            x,
            y,
            z,
            heading,
            speed,
            yaw_rate,
            s,
            t,
            road,
            world,
            steer,
            CONTROL,
            vx,
            vy,
            image,
        )
        vehicle.move(*seat.ask(view))
        look()
        row = log.add(vehicle.row)
        step += 1
    return log.rows(), ended


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
