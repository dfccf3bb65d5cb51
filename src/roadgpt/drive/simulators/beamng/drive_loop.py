"""Runs one drive in BeamNG: steps the physics, samples the car, asks the driver, and detects how the drive
ends.

If the car reaches the goal or leaves its lane between two samples, that moment is found by interpolation.
"""

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from roadgpt.drive.drive import COLUMNS, Columns, Drive, Ended, FloatArray
from roadgpt.drive.drive_monitor import STUCK_WAY, DriveMonitor
from roadgpt.drive.driver_guard import DriverGuard
from roadgpt.drive.marking_monitor import POSE
from roadgpt.drive.outlook import Outlook
from roadgpt.drive.simulators.beamng.loaded_road import LoadedRoad
from roadgpt.drive.simulators.beamng.tracking import LOCK, CarSample, RoadTracker, interpolate_samples
from roadgpt.drive.view import View
from roadgpt.errors import SimulationError
from roadgpt.stopping import look

if TYPE_CHECKING:
    from roadgpt.road import Road, World

FALLEN = 1.0  # m below the road's surface
HALVINGS = 20  # how often the time between two samples is halved to find the moment of an event

AI = "beamng_ai"
"""Name of the driver when BeamNG's own AI drives."""


class Sample(NamedTuple):
    """The car at one time, and its position relative to the road: ``s`` and ``t`` in metres, and ``outside``,
    the share of the car outside its lane. ``throttle`` and ``brake`` are 0 to 1.
    """

    car: CarSample
    s: float
    t: float
    outside: float
    steer: float
    throttle: float
    brake: float


class DriveLoop:
    """Drives one road, step by step, and records the samples."""

    def __init__(self, loaded: LoadedRoad, road: "Road", world: "World", guard: DriverGuard | None) -> None:
        """Prepares a drive; ``guard`` asks the driver, and is None if BeamNG's AI drives."""
        self.loaded, self.road, self.world, self.guard = loaded, road, world, guard
        self.track = RoadTracker(road, world, loaded.body)
        self.monitor = DriveMonitor(road, world, loaded.body.box(LOCK))
        self.outlook = Outlook(road, world)
        self.samples: list[Sample] = []
        self.has_left = False

    def drive(self, keep_driving: bool) -> Ended:
        """Drives until the drive ends, and returns how it ended.

        With ``keep_driving``, the drive goes on when the car leaves its lane.

        Raises:
            DriverError: the driver failed.
            SimulationError: BeamNG's AI does not start to move, or the physics became unstable.
        """
        loaded, world = self.loaded, self.world
        watchdog = loaded.session.watchdog
        watchdog.pause()
        self._keep(loaded.now, (0.0, 0.0, 0.0))
        if self.guard is None:
            watchdog.due_in(loaded.settings.poll_timeout)
            loaded.let_ai_drive(world.limits.speed_limit)
            watchdog.pause()
        while True:
            here = self.samples[-1]
            now = here.car
            if self._is_at_goal(here):
                self._cut(self._is_at_goal)
                return "goal"
            if self.monitor.is_stuck(now.x, now.y, now.time):
                self._check_ai()
                return "stuck"
            if self._is_out(here):
                if not self.has_left:
                    self.has_left = True
                    self._cut(self._is_out, keep=keep_driving)
                if not keep_driving:
                    return "out_of_lane"
            if now.z < self.track.place(now.x, now.y)[2] - FALLEN:
                return "fell"
            if now.time >= self.monitor.limit:
                return "timeout"
            self._go_on(here)

    def _go_on(self, here: Sample) -> None:
        """Makes one step. The watchdog counts only BeamNG's time: RoadGPT may be compiling its functions, and
        the guard has its own clock."""
        look()
        command = (0.0, 0.0, 0.0)
        loaded = self.loaded
        watchdog = loaded.session.watchdog
        if self.guard is not None:
            watchdog.due_in(loaded.settings.poll_timeout)
            image = loaded.image()
            watchdog.pause()
            command = self.guard.ask(self._view(here, image))
            watchdog.due_in(loaded.settings.poll_timeout)
            loaded.steer(*command)
        now = loaded.step()
        watchdog.pause()
        self._keep(now, command)

    def _view(self, here: Sample, image: FloatArray | None) -> View:
        now, dt = here.car, 1.0 / self.loaded.settings.rate
        state = (now.time, now.x, now.y, now.z, now.heading, now.speed, now.yaw_rate, here.s, here.t)
        ahead = self.outlook.at(here.s)
        return View(*state, self.road, self.world, here.steer, dt, now.vx, now.vy, image, *ahead)

    def _keep(self, now: CarSample, command: tuple[float, float, float]) -> None:
        self.samples.append(self._sample(now, command))

    def _sample(self, now: CarSample, command: tuple[float, float, float]) -> Sample:
        s, t, _ = self.track.place(now.x, now.y)
        outside = self.track.outside(now, s)
        told = self.loaded.session.reported_gain
        steer = now.steer if told is None else now.steer * told
        pedals = (now.throttle, now.brake) if self.guard is None else command[1:]
        return Sample(now, s, t, outside, steer, pedals[0], pedals[1])

    def _is_at_goal(self, sample: Sample) -> bool:
        return self.monitor.is_at_goal(sample.car.x, sample.car.y, sample.s)

    def _is_out(self, sample: Sample) -> bool:
        pose = [getattr(sample if name == "s" else sample.car, name) for name in POSE]
        return self.monitor.is_out(sample.outside, pose)

    def _cut(self, has_happened: Callable[[Sample], bool], keep: bool = False) -> None:
        """Finds by interpolation the moment between the last two samples at which ``has_happened`` became
        true. With ``keep``, a sample of this moment is inserted before the last sample; otherwise it replaces
        the last sample."""
        if len(self.samples) < 2 or has_happened(self.samples[-2]):
            return
        before, after = self.samples[-2:]
        low, high = 0.0, 1.0
        found = after
        for _ in range(HALVINGS):
            share = (low + high) / 2
            tried = self._sample(
                interpolate_samples(before.car, after.car, share), (0.0, after.throttle, after.brake)
            )
            if has_happened(tried):
                high, found = share, tried
            else:
                low = share
        if before.car.time < found.car.time < after.car.time:
            self.samples[-1:] = [found, after] if keep else [found]

    def _check_ai(self) -> None:
        if self.guard is None and self.samples[-1].s - self.samples[0].s < STUCK_WAY:
            raise SimulationError(
                "BeamNG's AI did not start to move, as if it found no road there; run 'roadgpt doctor "
                "beamng' and see what it reports about the AI"
            )

    def columns(self) -> tuple[Columns, float]:
        """Returns the columns of a Drive, and the lock angle of the front wheels in radians."""
        cars = {
            name: np.array([getattr(each.car, name) for each in self.samples]) for name in CarSample._fields
        }
        told = self.loaded.session.reported_gain
        lock = LOCK if told is None else abs(told)
        steer = np.array([each.steer for each in self.samples])
        if told is None:  # not measured: the sign follows from the direction in which the car turned
            turned = float(np.sum(steer * cars["yaw_rate"]))
            steer = steer * math.copysign(LOCK, turned)
        own = ("s", "t", "outside", "throttle", "brake")
        ours = {name: np.array([getattr(each, name) for each in self.samples]) for name in own}
        ours |= {
            "steer": steer,
            "ax": _slope(cars["vx"], cars["time"]) - cars["yaw_rate"] * cars["vy"],
            "ay": _slope(cars["vy"], cars["time"]) + cars["yaw_rate"] * cars["vx"],
        }
        return Columns({name: ours.get(name, cars.get(name)) for name in COLUMNS}), lock  # type: ignore[misc]


def record(
    loaded: LoadedRoad, road: "Road", world: "World", guard: DriverGuard | None, seed: int, keep_driving: bool
) -> Drive:
    """Runs one driver on the loaded road, and returns the Drive.

    Raises:
        DriverError, SimulationError: as for ``DriveLoop.drive``.
    """
    recorder = DriveLoop(loaded, road, world, guard)
    with loaded.session.within(loaded.settings.poll_timeout, "it was driving"):
        ended = recorder.drive(keep_driving)
    columns, lock = recorder.columns()
    name = AI if guard is None else guard.name
    return Drive(name, "beamng", seed, columns, ended, loaded.body.box(lock))


def _slope(values: FloatArray, time: FloatArray) -> FloatArray:
    return np.gradient(values, time) if len(values) > 1 else np.zeros_like(values)
