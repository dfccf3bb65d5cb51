"""The simulator ``beamng``: BeamNG.tech, controlled through beamngpy."""

import math
from collections.abc import Callable

import numpy as np

from roadgpt.drive import Driver
from roadgpt.drive.camera_sensor import camera_of
from roadgpt.drive.drive import COLUMNS, Columns, Drive, Ended, FloatArray
from roadgpt.drive.drive_monitor import STUCK_WAY, DriveMonitor
from roadgpt.drive.driver_guard import DriverGuard
from roadgpt.drive.lane_position import POSE
from roadgpt.drive.outlook import Outlook
from roadgpt.drive.view import View
from roadgpt.errors import RoadGPTError, SimulationError, SimulatorError
from roadgpt.road import Road, World
from roadgpt.stopping import look
from roadgpt_beamng.loaded_road import LoadedRoad
from roadgpt_beamng.session import Session, session_of
from roadgpt_beamng.settings import BeamngSettings
from roadgpt_beamng.tracking import LOCK, CarSample, RoadTracker, interpolate_samples

FALLEN = 1.0  # m below the road's surface
HALVINGS = 20  # how often the time between two samples is halved to find the moment of an event
AI = "beamng_ai"
"""Name of the driver when BeamNG's own AI drives."""
TRIES = 2  # per road
IMITATES = "beamng_like"


class BeamngSimulator:
    """Simulates an ETK 800 in BeamNG.tech on a mesh road.

    In place of the driver ``beamng_like``, which imitates BeamNG's AI, the AI itself drives as ``beamng_ai``,
    unless the setting ``imitation`` is True. If BeamNG hangs, ends or loses its connection, the drive is
    repeated once with a new one.
    """

    # The surfaces are those of the level's materials, and mesh roads that a client builds are level across.
    ignores = ("friction", "bank")
    single_roads_only = True

    def __init__(self, settings: BeamngSettings | None = None) -> None:
        """Uses these settings, or those of the environment variables if ``settings`` is None."""
        self.settings = BeamngSettings.of() if settings is None else settings

    def simulate(
        self, road: Road, world: World, driver: Driver, seed: int, keep_driving: bool = False
    ) -> Drive:
        """Implements `roadgpt.drive.Simulator.simulate`; the seed is passed to the driver, and also
        determines the random shifts (up to 1 cm) of the road's mesh."""
        session = session_of(self.settings)
        for tried in range(TRIES):
            try:
                session.ready()
                drive = self._once(session, road, world, driver, seed, keep_driving)
            except RoadGPTError:
                if session.watchdog.has_fired:
                    session.drop()
                raise
            except Exception as error:  # whatever a client raises whose game is gone
                session.drop()
                if tried + 1 == TRIES:
                    raise SimulatorError(
                        f"BeamNG failed {TRIES} times on this road: {str(error) or type(error).__name__}"
                    ) from error
            except BaseException:
                session.drop()
                raise
            else:
                session.roads += 1
                return drive
        raise AssertionError

    def _once(
        self, session: Session, road: Road, world: World, driver: Driver, seed: int, keep_driving: bool
    ) -> Drive:
        camera = camera_of(driver)
        ai_drives = getattr(driver, "name", "") == IMITATES and not self.settings.imitation
        guard = None if ai_drives else DriverGuard(driver)
        with LoadedRoad(session, road, world, seed) as loaded:
            if guard is None:
                return record(loaded, road, world, None, seed, keep_driving)
            loaded.take_the_wheel()
            if camera is not None:
                loaded.open_camera(camera)
            guard.start(road, world, seed)
            return record(loaded, road, world, guard, seed, keep_driving)


def record(
    loaded: LoadedRoad, road: Road, world: World, guard: DriverGuard | None, seed: int, keep_driving: bool
) -> Drive:
    """Runs one driver on the loaded road, and returns the Drive."""
    recorder = DriveLoop(loaded, road, world, guard)
    with loaded.session.watchdog.within(loaded.settings.poll_timeout, "it was driving"):
        ended = recorder.drive(keep_driving)
    columns, lock = recorder.columns()
    name, handovers = (AI, ()) if guard is None else (guard.name, tuple(guard.handovers))
    return Drive(name, "beamng", seed, columns, ended, loaded.body.box(lock), handovers)


class DriveLoop:
    """Drives one road, step by step, and records the samples."""

    def __init__(self, loaded: LoadedRoad, road: Road, world: World, guard: DriverGuard | None) -> None:
        """Prepares a drive; ``guard`` asks the driver, and is None if BeamNG's AI drives."""
        self.loaded, self.road, self.world, self.guard = loaded, road, world, guard
        self.track = RoadTracker(road, world, loaded.body)
        self.monitor = DriveMonitor(road, world, loaded.body.box(LOCK))
        self.outlook = Outlook(road, world)
        self.samples: list[CarSample] = []
        self.has_left = False

    def drive(self, keep_driving: bool) -> Ended:
        """Returns how the drive ended; with ``keep_driving``, it goes on when the car leaves its lane."""
        loaded, world = self.loaded, self.world
        watchdog = loaded.session.watchdog
        watchdog.pause()
        self.samples.append(self._on_road(loaded.now, 0.0, 0.0))
        if self.guard is None:
            watchdog.due_in(loaded.settings.poll_timeout)
            loaded.let_ai_drive(world.driven_speed)
            watchdog.pause()
        while True:
            now = self.samples[-1]
            if self._is_at_goal(now):
                self._cut(self._is_at_goal)
                return "goal"
            if self.monitor.is_stuck(now.x, now.y, now.time):
                self._check_ai()
                return "stuck"
            if self._is_out(now):
                if not self.has_left:
                    self.has_left = True
                    self._cut(self._is_out, keep=keep_driving)
                if not keep_driving:
                    return "out_of_lane"
            if now.z < self.track.place(now.x, now.y)[2] - FALLEN:
                return "fell"
            if now.time >= self.monitor.limit:
                return "timeout"
            self._go_on(now)

    def _go_on(self, here: CarSample) -> None:
        """Makes one step. The watchdog counts only BeamNG's time; the guard has its own clock."""
        look()
        throttle = brake = 0.0
        loaded = self.loaded
        watchdog = loaded.session.watchdog
        if self.guard is not None:
            watchdog.due_in(loaded.settings.poll_timeout)
            image = loaded.image()
            watchdog.pause()
            steer, throttle, brake = self.guard.ask(self._view(here, image))
            watchdog.due_in(loaded.settings.poll_timeout)
            loaded.steer(steer, throttle, brake)
        now = loaded.step()
        watchdog.pause()
        self.samples.append(self._on_road(now, throttle, brake))

    def _view(self, now: CarSample, image: FloatArray | None) -> View:
        dt, told = 1.0 / self.loaded.settings.rate, self.loaded.session.reported_gain
        state = (now.time, now.x, now.y, now.z, now.heading, now.speed, now.yaw_rate, now.s, now.t)
        steer = now.steer if told is None else now.steer * told
        ahead = self.outlook.at(now.s)
        return View(*state, self.road, self.world, steer, dt, now.vx, now.vy, image, *ahead)

    def _on_road(self, now: CarSample, throttle: float, brake: float) -> CarSample:
        """Returns a sample with its position relative to the road, and with the pedals of the driver's
        command if BeamNG's AI does not drive."""
        if self.guard is not None:
            now = now._replace(throttle=throttle, brake=brake)
        s, t, _ = self.track.place(now.x, now.y)
        return now._replace(s=s, t=t, outside=self.track.outside(now, s))

    def _is_at_goal(self, sample: CarSample) -> bool:
        return self.monitor.is_at_goal(sample.x, sample.y, sample.s)

    def _is_out(self, sample: CarSample) -> bool:
        return self.monitor.is_out(sample.outside, [getattr(sample, name) for name in POSE])

    def _cut(self, has_happened: Callable[[CarSample], bool], keep: bool = False) -> None:
        """Finds by interpolation the moment between the last two samples at which ``has_happened`` became
        true; a sample of it replaces the last sample, or with ``keep`` goes before it."""
        if len(self.samples) < 2 or has_happened(self.samples[-2]):
            return
        before, after = self.samples[-2:]
        low, high = 0.0, 1.0
        found = after
        for _ in range(HALVINGS):
            share = (low + high) / 2
            tried = self._on_road(interpolate_samples(before, after, share), after.throttle, after.brake)
            if has_happened(tried):
                high, found = share, tried
            else:
                low = share
        if before.time < found.time < after.time:
            self.samples[-1:] = [found, after] if keep else [found]

    def _check_ai(self) -> None:
        if self.guard is None and self.samples[-1].s - self.samples[0].s < STUCK_WAY:
            raise SimulationError(
                "BeamNG's AI did not start to move, as if it found no road there; run 'roadgpt doctor "
                "beamng' and see what it reports about the AI"
            )

    def columns(self) -> tuple[Columns, float]:
        """Returns the columns of a Drive, and the lock angle of the front wheels in radians."""
        table = dict(zip(CarSample._fields, np.array(self.samples).T, strict=True))
        told = self.loaded.session.reported_gain
        lock = LOCK if told is None else abs(told)
        if told is None:  # not measured: the sign follows from the direction in which the car turned
            turned = float(np.sum(table["steer"] * table["yaw_rate"]))
            told = math.copysign(LOCK, turned)
        table["steer"] = table["steer"] * told
        table["ax"] = _slope(table["vx"], table["time"]) - table["yaw_rate"] * table["vy"]
        table["ay"] = _slope(table["vy"], table["time"]) + table["yaw_rate"] * table["vx"]
        return Columns({name: table[name] for name in COLUMNS}), lock


def _slope(values: FloatArray, time: FloatArray) -> FloatArray:
    return np.gradient(values, time) if len(values) > 1 else np.zeros_like(values)
