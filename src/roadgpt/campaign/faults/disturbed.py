"""Small random disturbances of a drive: the friction, the start position, and the delay of the driver's
perception.

A failure that disappears under these disturbances is due to chance; a failure that persists is due to the
road.
"""

from collections import deque
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from roadgpt.drive import Command, View

if TYPE_CHECKING:
    from roadgpt.road import Road, World

GRIP = 0.05  # standard deviation of friction, as a share: patches of one dry road differ by this much
START = 0.10  # m, standard deviation of the lateral start position: a positioning system with corrections
DELAY = 0.06  # s, longest delay of what the driver sees: a camera and its network take up to 100 ms
MOST = 3.0  # standard deviations; a number beyond this is drawn again


@dataclass(frozen=True)
class Disturbance:
    """One random disturbance of a drive."""

    friction: float
    """Factor by which the friction coefficient of the road is multiplied."""
    offset: float
    """Lateral offset of the start position from the middle of the lane, metres, positive to the left."""
    delay: float
    """Delay of the driver's perception, seconds."""


def disturbance_of(seed: int, number: int) -> Disturbance:
    """Returns the disturbance for repetition ``number`` (from 1) of a drive, derived from the seed of that
    drive.
    """
    rng = np.random.default_rng([seed, number, 0xD157])
    return Disturbance(1 + GRIP * _normal(rng), START * _normal(rng), float(rng.uniform(0.0, DELAY)))


def _normal(rng: np.random.Generator) -> float:
    while abs(value := float(rng.normal())) > MOST:
        pass
    return value


class LateDriver:
    """A driver whose perception is delayed.

    Args:
        driver: the driver that receives delayed views.
        delay: delay in seconds, rounded to whole control steps.
        world: the world without disturbance; the driver receives it even if the simulated friction is
            disturbed.
    """

    def __init__(self, driver: Any, delay: float, world: "World") -> None:
        self.name = str(getattr(driver, "name", type(driver).__name__))
        self._driver, self._delay, self._world = driver, delay, world
        if hasattr(driver, "camera"):
            self.camera = driver.camera
        self._seen: deque[View] = deque()

    def start(self, road: "Road", world: "World", seed: int) -> None:
        """Starts the driver, and passes it the world without disturbance instead of ``world``."""
        del world
        self._seen.clear()
        if hasattr(self._driver, "start"):
            self._driver.start(road, self._world, seed)

    def steer(self, view: View) -> Command:
        """Returns the driver's command for the view of ``delay`` seconds ago.

        Until that time has passed, the driver receives the first view.
        """
        self._seen.append(view._replace(world=self._world))
        if len(self._seen) > round(self._delay / view.dt) + 1:
            self._seen.popleft()
        command: Command = self._driver.steer(self._seen[0])
        return command
