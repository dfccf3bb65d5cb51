"""Drives a failing road again with small disturbances, and measures the fraction of these drives that fail.

A failure that recurs in at least half of the drives counts as stable; other failures are attributed to
chance.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from inspect import signature

from scipy.stats import beta

from roadgpt import plugins
from roadgpt.campaign.faults.disturbed import Disturbance, LateDriver, disturbance_of
from roadgpt.drive import Simulator, simulate
from roadgpt.drive.isolation import driver_of
from roadgpt.drive.permission import require_permission
from roadgpt.errors import DriverError, SimulationError, SimulatorError
from roadgpt.run import Run
from roadgpt.run.lost_drives import LostDrives
from roadgpt.verdict import Verdict, judge

SURE = 0.95  # confidence level of the interval
STABLE = 0.5  # share of drives that fail, from which a failure counts as stable


@dataclass(frozen=True)
class Repeated:
    """The result of one disturbed drive of a road."""

    number: int
    disturbance: Disturbance
    failed: bool
    margin: float
    """Margin to out of bounds, metres; NaN if the drive ended with an error."""
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
    def interval(self) -> tuple[float, float]:
        """95 % confidence interval of ``share``, after Clopper and Pearson (Biometrika 26, 1934)."""
        n, k = len(self.drives), self.failed
        low = float(beta.ppf((1 - SURE) / 2, k, n - k + 1)) if k else 0.0
        high = float(beta.ppf((1 + SURE) / 2, k + 1, n - k)) if k < n else 1.0
        return low, high

    @property
    def sentence(self) -> str:
        """The result as text for users."""
        if self.failed == len(self.drives):
            return f"fails every time ({len(self.drives)} of {len(self.drives)} disturbed drives)"
        share = f"{self.failed} of {len(self.drives)}"
        return f"fails in {share} drives with friction, start and sensors slightly disturbed"


def repeated(run: Run, times: int, spread: Callable[..., Iterable[Repeated]] = map) -> Stability:
    """Drives the Run's road several times, each time with a different disturbance.

    The disturbances are derived from the Run's seed, so the results can be reproduced.

    Args:
        run: the Run of a valid road, with any outcome.
        times: number of drives, 1 or more.
        spread: the function that runs the drives: the built-in ``map``, or the ``map`` of a process pool.

    Raises:
        UsageError: the user did not permit the driver's file to be run, or the driver or the simulator cannot
            be loaded.
        GivenUpError: the simulator failed three times in a row.
    """
    require_permission(run.request.setup.driver)  # other processes do not know who named the driver
    return Stability(tuple(spread(once, [(run, number) for number in range(1, times + 1)])))


def once(task: tuple[Run, int]) -> Repeated:
    """Drives a Run's road once with a disturbance; ``task`` is the Run and the number of the disturbance.

    A drive that ends with a DriverError or a SimulationError counts as failed. After a SimulatorError, the
    drive is repeated.

    Raises:
        UsageError: the driver or the simulator cannot be loaded.
        GivenUpError: the simulator failed three times in a row.
    """
    run, number = task
    disturbance = disturbance_of(run.seed, number)
    losses: LostDrives[int] = LostDrives()
    while True:
        try:
            verdict = drive_disturbed(run, disturbance)
        except SimulatorError as error:
            if losses.count(number, is_lost=True):
                raise losses.given_up(
                    str(error), "fix it and run the same command again, which continues"
                ) from error
            continue
        except (DriverError, SimulationError):
            return Repeated(number, disturbance, True, float("nan"), None)
        break
    return Repeated(number, disturbance, not verdict.kept, verdict.margin, verdict.at_s)


def drive_disturbed(run: Run, disturbance: Disturbance) -> Verdict:
    """Drives a Run's road once with its driver and a disturbance, and returns the verdict.

    Raises:
        DriverError, SimulationError: as raised by ``roadgpt.drive.simulate``.
    """
    road, world, setup = run.road, run.world, run.request.setup
    assert road is not None
    driver = LateDriver(driver_of(setup.driver), disturbance.delay, world)
    heeds = "friction" not in getattr(plugins.find("simulators", setup.simulator), "ignores", ())
    grip = world.site.friction * (disturbance.friction if heeds else 1.0)
    slippery = world.changed(friction=grip)
    drive = simulate(road, slippery, driver, run.seed, _engine(setup.simulator, disturbance), False)
    return judge(road, drive, slippery)


def _engine(name: str, disturbance: Disturbance) -> Simulator | str:
    """Returns the simulator with the disturbed start position; just its name if it has no such setting."""
    part = plugins.find("simulators", name)
    if not isinstance(part, type) or "start_offset" not in signature(part).parameters:
        return name
    engine: Simulator = part(start_offset=disturbance.offset)
    return engine
