"""Runs checks against a real BeamNG and reports the results. The checks are needed because RoadGPT was
developed without a licence for BeamNG.

The result of each check is a sentence with figures. The checks answer the questions that BeamNG's
documentation leaves open: whether the AI finds roads that are loaded from prefabs, whether decals lie
correctly on slopes, how much repeated runs differ, and whether RoadGPT's level folders load.
"""

import json
import platform
import time
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from importlib.metadata import version
from pathlib import Path

import numpy as np

from roadgpt import __version__
from roadgpt.drive.drive import Drive
from roadgpt.drive.drivers.beamng_like import BeamngLike
from roadgpt.drive.drivers.reference import Reference
from roadgpt.drive.view import CameraSpec
from roadgpt.road import Design, Road, Segment, World, build
from roadgpt_beamng.level import ABOVE_GROUND, rotation, write_level
from roadgpt_beamng.level.roads import GOAL, level_road
from roadgpt_beamng.loaded_road import LoadedRoad, as_quaternion
from roadgpt_beamng.session import LEVELS, Session, client, session_of
from roadgpt_beamng.settings import BeamngSettings
from roadgpt_beamng.simulator import BeamngSimulator

REPORT = "beamng-selftest"
WORLD = World()
LEVEL = "roadgpt_selftest"
STEEP = 15.0  # percent
DRIVEN = 20.0  # m that the AI must drive in RoadGPT's own level
PATIENCE = 15.0  # s for that


@dataclass(frozen=True)
class Check:
    """A check and its result."""

    about: str
    is_fine: bool
    said: str
    seconds: float = 0.0


def bent(z: float, incline: float) -> Road:
    """Returns a test road of 190 m that starts at height ``z`` in metres and climbs by ``incline`` percent:
    a straight, a left bend, a right bend, and another straight."""
    left = Segment(distance=40, direction="left", turn_degrees=60, incline=incline)
    right = Segment(distance=50, direction="right", turn_degrees=-60, incline=incline)
    straight = Segment(distance=50, direction="straight", incline=incline)
    return build(Design(starting_point=(40, 60, z), theta=0, segments=(straight, left, right, straight)))


class Selftest:
    """Runs the checks in order, and saves their images."""

    def __init__(self, settings: BeamngSettings, folder: Path, repeats: int) -> None:
        """Prepares the checks; images are saved in the folder."""
        self.settings, self.folder, self.repeats = settings, folder, repeats
        self.simulator = BeamngSimulator(settings)
        self.pictures: list[str] = []

    def checks(self) -> Iterator[Check]:
        """Yields the result of each check in turn; if BeamNG does not start, only the first result."""
        first = self._tried("connection", self._connection)
        yield first
        if not first.is_fine:
            return
        yield self._tried("level", self._level)
        yield self._tried("AI on a flat road of a prefab", lambda: self._ai(bent(WORLD.site.z_floor, 0.0)))
        yield self._tried("AI on a floating road", lambda: self._ai(bent(-10.0, 0.0)))
        yield self._tried(f"AI up {STEEP:g} %", lambda: self._ai(bent(-20.0, STEEP)))
        yield self._tried(f"AI down {STEEP:g} %", lambda: self._ai(bent(40.0, -STEEP)))
        yield self._tried("repeated runs", self._spread)
        yield self._tried("a RoadGPT driver", self._driver)
        yield self._tried(f"picture of a road of {STEEP:g} %", self._picture)
        yield self._tried("RoadGPT level folder", self._own_level)

    def _tried(self, about: str, check: Callable[[], tuple[bool, str]]) -> Check:
        begun = time.monotonic()
        try:
            is_fine, said = check()
        except Exception as error:  # any error is the result of the check
            is_fine, said = False, f"{type(error).__name__}: {error}"
        return Check(about, is_fine, said, round(time.monotonic() - begun, 1))

    @property
    def _session(self) -> Session:
        session = session_of(self.settings)
        session.ready()
        return session

    def _connection(self) -> tuple[bool, str]:
        bng = self._session.bng
        return (
            True,
            f"beamngpy {version('beamngpy')}, BeamNG in {bng.home}, user folder {bng.user_with_version}",
        )

    def _level(self) -> tuple[bool, str]:
        session = self._session
        there = sorted(session.bng.scenario.get_levels())
        with LoadedRoad(session, bent(WORLD.site.z_floor, 0.0), WORLD, 0) as loaded:
            height = loaded.now.z - WORLD.site.z_floor
        about = f"drives on {session.level}, ground assumed at {session.ground:g} m; known levels installed: "
        known = ", ".join(name for name in LEVELS if name in there)
        is_fine = 0.2 < height < 1.2
        return (
            is_fine,
            f"{about}{known}; centre of gravity of the standing car {height:.2f} m above its road",
        )

    def _ai(self, road: Road) -> tuple[bool, str]:
        return self._told(road, self.simulator.simulate(road, WORLD, BeamngLike(), 0))

    def _told(self, road: Road, drive: Drive) -> tuple[bool, str]:
        off = drive["t"] - WORLD.profile_of(road).middle(drive["s"])
        way, fast = drive["s"][-1], drive["speed"].max() * 3.6
        said = (
            f"{drive.driver} ended with '{drive.ended}' after {drive.duration:.1f} s and {way:.0f} m, "
            f"at most {fast:.0f} km/h, from the middle of its lane at most {np.abs(off).max():.2f} m and "
            f"{off.mean():+.2f} m on average; share outside at most {drive.max_outside:.2f}"
        )
        return drive.ended == "goal", said

    def _spread(self) -> tuple[bool, str]:
        road = bent(-10.0, 5.0)
        begun = time.monotonic()
        drives = [self.simulator.simulate(road, WORLD, BeamngLike(), 0) for _ in range(self.repeats)]
        took = time.monotonic() - begun
        s = np.linspace(5.0, min(float(drive["s"].max()) for drive in drives), 100)
        t = np.array([np.interp(s, drive["s"], drive["t"]) for drive in drives])
        durations = [drive.duration for drive in drives]
        ends = sorted({str(drive.ended) for drive in drives})
        said = (
            f"{self.repeats} runs: paths at most {np.ptp(t, axis=0).max() * 100:.1f} cm apart, durations "
            f"{min(durations):.2f} to {max(durations):.2f} s, ended with {' and '.join(ends)}; "
            f"{sum(durations) / took:.1f} s simulated per second, loading included"
        )
        return len(ends) == 1, said

    def _driver(self) -> tuple[bool, str]:
        road = bent(-10.0, 0.0)
        drive = self.simulator.simulate(road, WORLD, Reference(), 0)
        gain = self._session.gain or 0.0
        side = "left" if gain > 0 else "right"
        is_fine, said = self._told(road, drive)
        turned = f"steering input +1 turns the wheels {np.degrees(abs(gain)):.0f} degrees to the {side}"
        return is_fine, f"{said}; {turned}"

    def _picture(self) -> tuple[bool, str]:
        from PIL import Image

        if self.settings.nogpu:
            return True, "skipped: --nogpu draws nothing"
        session = self._session
        with LoadedRoad(session, bent(-20.0, STEEP), WORLD, 0) as loaded:
            loaded.open_camera(CameraSpec(1280, 720, 1.0, 2.0, 3.0, 0.15))
            with session.watchdog.within(self.settings.poll_timeout, "a picture was taken"):
                for _ in range(10):  # the first frames may be black
                    loaded.step()
                image = loaded.image()
        path = self.folder / f"{REPORT}-slope.png"
        Image.fromarray(np.asarray(image, np.uint8)).save(path)
        self.pictures.append(path.name)
        return (
            True,
            f"see {path.name}: is the road complete, and are its lines white and yellow, without flicker?",
        )

    def _own_level(self) -> tuple[bool, str]:
        session, road = self._session, bent(-10.0, 0.0)
        levels = Path(session.bng.user_with_version, "levels")
        written = write_level(road, levels, LEVEL, WORLD)
        if LEVEL not in session.bng.scenario.get_levels():
            return False, f"BeamNG does not list the level of {written}"
        package, scene = client(), level_road(road, WORLD, 0)
        scenario = package.Scenario(LEVEL, f"{LEVEL}_{time.time_ns()}")
        car = package.Vehicle("ego", self.settings.model)
        session.vehicle = car
        place = tuple((scene.start + [0.0, 0.0, ABOVE_GROUND]).tolist())
        scenario.add_vehicle(car, place, as_quaternion(rotation(scene.heading, scene.grade)), False)
        with session.watchdog.within(self.settings.load_timeout, "RoadGPT's level was loading"):
            scenario.make(session.bng)
            session.bng.scenario.load(scenario)
            session.bng.scenario.start()
            session.bng.control.pause()
            session.step_evenly()
            car.ai.set_waypoint(GOAL)
            car.ai.set_aggression(self.settings.aggression)
            car.ai.set_speed(WORLD.limits.speed_limit, "limit")
            way, position = 0.0, scene.start
            for _ in range(int(PATIENCE)):
                session.watchdog.due_in(self.settings.poll_timeout)
                session.bng.control.step(self.settings.rate)
                car.sensors.poll("state")
                position = np.asarray(car.state["pos"], float)
                way = float(np.linalg.norm((position - scene.start)[:2]))
                if way > DRIVEN:
                    break
            session.bng.scenario.stop()
        drop = float(scene.start[2] - position[2])
        said = f"loads; BeamNG's AI drove {way:.0f} m on a level road, and ended {drop:.1f} m below its start"
        return way > DRIVEN and drop < 1.0, said


def run(settings: BeamngSettings, folder: Path, repeats: int, tell: Callable[[Check], None]) -> list[Check]:
    """Runs all checks, passes each result to ``tell`` as it becomes available, and writes a report into the
    folder as .json and .md files."""
    test = Selftest(settings, folder, repeats)
    done = []
    for check in test.checks():
        tell(check)
        done.append(check)
    about = {
        "roadgpt": __version__,
        "python": platform.python_version(),
        "system": platform.platform(),
        "settings": settings.summary(),
    }
    report = {**about, "checks": [asdict(check) for check in done], "pictures": test.pictures}
    (folder / f"{REPORT}.json").write_text(json.dumps(report, indent=1) + "\n", encoding="utf-8")
    (folder / f"{REPORT}.md").write_text(_page(about, done), encoding="utf-8")
    return done


def _page(about: dict[str, str], checks: list[Check]) -> str:
    lines = ["# BeamNG selftest", "", *(f"- {name}: {value}" for name, value in about.items()), ""]
    lines += ["| check | passed | result | s |", "|---|---|---|---|"]
    for check in checks:
        fine = "yes" if check.is_fine else "**no**"
        said = check.said.replace("|", "/").replace("\n", " ")
        lines.append(f"| {check.about} | {fine} | {said} | {check.seconds:g} |")
    return "\n".join(lines) + "\n"
