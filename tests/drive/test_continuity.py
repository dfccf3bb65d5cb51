"""A jump of the car, or a speed that its places do not follow, is an error of the simulation."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from drive.slippery_bicycle import SlipperyBicycle
from roadgpt.drive import Columns, Drive, simulate
from roadgpt.drive.drive import check_motion
from roadgpt.drive.drivers.beamng_like import BeamngLike
from roadgpt.drive.drivers.reference import Reference
from roadgpt.drive.simulators.mujoco import MujocoSimulator
from roadgpt.errors import SimulationError
from roadgpt.road import CrossSection, Limits, Road, Site, World
from roadgpt.run import Setup, prove

STRAIGHT = Road.through([[40, 100], [90, 100], [140, 100]])


def changed(drive: Drive, **columns: np.ndarray) -> Drive:
    return replace(drive, columns=Columns({**drive.columns, **columns}))


@pytest.fixture(scope="module")
def driven() -> Drive:
    return simulate(STRAIGHT, World(), Reference())


class Jumps:
    """MuJoCo, whose car is so many metres to the side from the middle of its drive on."""

    name = "jumps"

    def __init__(self, aside: float) -> None:
        self.aside = aside

    def simulate(self, road: Road, world: World, driver: Any, seed: int, keep_driving: bool = False) -> Drive:
        drive = MujocoSimulator().simulate(road, world, driver, seed, keep_driving)
        late = np.arange(len(drive)) >= len(drive) // 2
        outside = np.where(late, 1.0, drive["outside"])
        moved = changed(drive, y=drive["y"] + late * self.aside, t=drive["t"] + late * self.aside)
        return replace(changed(moved, outside=outside), ended="out_of_lane")


@pytest.mark.parametrize("aside", [2.0, -500.0])
def test_a_jump_is_an_error_and_not_out_of_lane(aside: float) -> None:
    with pytest.raises(
        SimulationError, match=rf"moved the car by {abs(aside):.1f} m within 0.02 s, \d+ m along"
    ):
        simulate(STRAIGHT, World(), Reference(), simulator=Jumps(aside))


def test_a_run_with_a_jump_ends_in_error(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = MujocoSimulator.simulate

    def jumping(self: MujocoSimulator, *given: Any) -> Drive:
        drive = whole(self, *given)
        late = np.arange(len(drive)) >= len(drive) // 2
        return changed(drive, x=drive["x"] + 500.0 * late)

    monkeypatch.setattr(MujocoSimulator, "simulate", jumping)
    run = prove(STRAIGHT, 1, setup=Setup(driver="reference"))
    assert (run.outcome, run.verdict) == ("ERROR", None)
    assert "moved the car by 500." in run.description
    assert "says nothing about the driver" in run.description


def test_places_that_do_not_follow_the_speed_are_an_error(driven: Drive) -> None:
    check_motion(driven)
    frozen = {name: np.full(len(driven), driven[name][0]) for name in ("x", "y", "z")}
    with pytest.raises(
        SimulationError, match=r"speeds that amount to \d+ m, but positions that amount to 0 m"
    ):
        check_motion(changed(driven, **frozen))
    # a speed that nobody believes excuses no jump
    late = np.arange(len(driven)) >= len(driven) // 2
    fast = changed(driven, x=driven["x"] + 500.0 * late, speed=np.full(len(driven), 25_000.0))
    with pytest.raises(SimulationError, match="no car can do that"):
        check_motion(fast)
    nowhere = changed(driven, z=np.where(late, np.nan, driven["z"]))
    with pytest.raises(SimulationError, match="not a finite number"):
        check_motion(nowhere)
    backwards = changed(driven, time=driven["time"][::-1].copy(), x=driven["x"] + 5.0 * late)
    with pytest.raises(SimulationError, match="no car can do that"):
        check_motion(backwards)


def test_what_cars_do_is_no_jump() -> None:
    # falls, slides at 300 km/h, crawls and another simulator's steps: the hardest that is driven here
    class Throttle(Reference):
        def steer(self, view: Any) -> Any:
            return super().steer(view)._replace(steer=0.3, throttle=1.0, brake=0.0)

    for world in (
        World(section=CrossSection(shoulder=0)),
        World(limits=Limits(speed_limit=300 / 3.6), site=Site(friction=2.0)),
        World(site=Site(friction=0.05)),
    ):
        for driver in (Throttle, BeamngLike):
            check_motion(simulate(STRAIGHT, world, driver(), keep_driving=True))
    check_motion(SlipperyBicycle().simulate(STRAIGHT, World(), BeamngLike(), 0))
