"""Drives a failing road again with small disturbances, and measures the fraction of these drives that fail.

A disturbance changes the friction, the start position, and the delay of the driver's perception. A failure
that recurs in at least half of the drives counts as stable, and is due to the road; other failures are
attributed to chance."""

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from inspect import signature
from typing import Any, TypeVar

import numpy as np

from roadgpt import plugins
from roadgpt.drive import Command, View, simulate
from roadgpt.drive.isolation import driver_of
from roadgpt.errors import DriverError, SimulationError, SimulatorError
from roadgpt.road import Road, World
from roadgpt.run import Run
from roadgpt.run.model import MOST as LOST_IN_A_ROW
from roadgpt.run.model import given_up
from roadgpt.verdict import Verdict, judge

STABLE = 0.5  # share of drives that fail, from which a failure counts as stable
GRIP = 0.05  # standard deviation of friction, as a share: patches of one dry road differ by this much
START = 0.10  # m, standard deviation of the lateral start position: a positioning system with corrections
DELAY = 0.06  # s, longest delay of what the driver sees: a camera and its network take up to 100 ms
MOST = 3.0  # standard deviations; a number beyond this is drawn again


@dataclass(frozen=True)
class Disturbance:
    """One random disturbance of a drive."""

    friction: float  # factor by which the friction coefficient of the road is multiplied
    offset: float
    """Lateral offset of the start position from the middle of the lane, metres, positive to the left."""
    delay: float  # delay of the driver's perception, seconds


def disturbance_of(seed: int, number: int) -> Disturbance:
    """Returns the disturbance for repetition ``number``, from 1, of the drive with a seed."""
    rng = np.random.default_rng([seed, number, 0xD157])
    return Disturbance(1 + GRIP * _normal(rng), START * _normal(rng), float(rng.uniform(0.0, DELAY)))


def _normal(rng: np.random.Generator) -> float:
    while abs(value := float(rng.normal())) > MOST:
        pass
    return value


class LateDriver:
    """A driver whose perception is delayed by some seconds, rounded to whole control steps. It always sees
    the world without disturbance, even if the simulated friction is disturbed."""

    def __init__(self, driver: Any, delay: float, world: World) -> None:
        self.name = str(getattr(driver, "name", type(driver).__name__))
        self._driver, self._delay, self._world = driver, delay, world
        if hasattr(driver, "camera"):
            self.camera = driver.camera
        self._seen: deque[View] = deque()

    def start(self, road: Road, world: World, seed: int) -> None:
        """Starts the driver in the world without disturbance, instead of ``world``."""
        del world
        self._seen.clear()
        if hasattr(self._driver, "start"):
            self._driver.start(road, self._world, seed)

    def steer(self, view: View) -> Command:
        """Returns the driver's command for the view of ``delay`` seconds ago; at first, the first view."""
        self._seen.append(view._replace(world=self._world))
        if len(self._seen) > round(self._delay / view.dt) + 1:
            self._seen.popleft()
        command: Command = self._driver.steer(self._seen[0])
        self.handed_to = getattr(self._driver, "handed_to", None)
        return command


@dataclass(frozen=True)
class Repeated:
    """The result of one disturbed drive of a road."""

    number: int
    disturbance: Disturbance
    failed: bool
    margin: float | None  # margin to out of bounds, metres; None if the drive ended with an error
    at_s: float | None


@dataclass(frozen=True)
class Stability:
    """The results of all disturbed drives of one road."""

    drives: tuple[Repeated, ...]

    @property
    def failed(self) -> int:
        """Number of disturbed drives that failed."""
        return sum(drive.failed for drive in self.drives)

    @property
    def share(self) -> float:
        """Fraction of the disturbed drives that failed, 0 to 1."""
        return self.failed / len(self.drives)

    @property
    def is_stable(self) -> bool:
        """True if at least half of the disturbed drives failed."""
        return self.share >= STABLE

    @property
    def sentence(self) -> str:
        """The result as text for users."""
        if self.failed == len(self.drives):
            return f"fails every time ({len(self.drives)} of {len(self.drives)} disturbed drives)"
        share = f"{self.failed} of {len(self.drives)}"
        return f"fails in {share} drives with friction, start and sensors slightly disturbed"


T = TypeVar("T")


def outlasted(drive: Callable[[], T]) -> T:
    """Returns what ``drive`` returns; after a SimulatorError it is called again, three times in all. Raises
    GivenUpError."""
    for _ in range(LOST_IN_A_ROW):
        try:
            return drive()
        except SimulatorError as error:
            lost = error
    raise given_up(str(lost), "fix it and run the same command again, which continues")


def repeated(run: Run, times: int) -> Stability:
    """Drives the road of a valid Run ``times`` times, each time with a disturbance derived from the Run's
    seed and its number. A DriverError or a SimulationError counts as a failure; after a SimulatorError, the
    drive is repeated."""
    return Stability(tuple(_once(run, number) for number in range(1, times + 1)))


def _once(run: Run, number: int) -> Repeated:
    disturbance = disturbance_of(run.seed, number)
    try:
        verdict = outlasted(lambda: drive_disturbed(run, disturbance))
        return Repeated(number, disturbance, verdict.failed, verdict.margin, verdict.at_s)
    except (DriverError, SimulationError):
        return Repeated(number, disturbance, True, None, None)


def drive_disturbed(run: Run, disturbance: Disturbance) -> Verdict:
    """Drives a Run's road once with its driver and a disturbance; raises the errors of ``drive.simulate``."""
    road, world, setup = run.road, run.world, run.request.setup
    assert road is not None
    driver = LateDriver(driver_of(setup.driver), disturbance.delay, world)
    part: Any = plugins.find("simulators", setup.simulator)
    heeds = "friction" not in getattr(part, "ignores", ())
    grip = world.site.friction * (disturbance.friction if heeds else 1.0)
    slippery = world.changed(friction=grip)
    is_shifted = isinstance(part, type) and "start_offset" in signature(part).parameters
    engine = part(start_offset=disturbance.offset) if is_shifted else part
    drive = simulate(road, slippery, driver, run.seed, engine, False)
    return judge(road, drive, slippery)
