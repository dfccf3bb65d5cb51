"""The room that drives: a car, a road and a driver give a Drive.

Two shelves. ``simulators/`` hold the car and its physics; ``drivers/`` hold those who sit in it:

    class Simulator:
        def simulate(self, road, world, driver, seed, keep_driving=False) -> Drive

    class Driver:
        def start(self, road, world, seed) -> None     # optional: called once, before time 0
        def steer(self, view: View) -> Command         # called every 20 ms
"""

from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

from roadgpt import plugins
from roadgpt.drive.apart import driver_of
from roadgpt.drive.continuity import check_motion
from roadgpt.drive.drive import COLUMNS, Box, Columns, Drive, Ended
from roadgpt.drive.view import Camera, Command, View
from roadgpt.errors import UsageError

if TYPE_CHECKING:
    from roadgpt.road import Road, World

__all__ = [
    "COLUMNS",
    "Box",
    "Camera",
    "Columns",
    "Command",
    "Drive",
    "Driver",
    "Ended",
    "Simulator",
    "View",
    "simulate",
]


@runtime_checkable
class Driver(Protocol):
    """Who sits in the car. A driver may also have ``start(road, world, seed)``, called once before time 0,
    and an attribute ``name`` (else its class's name is recorded)."""

    def steer(self, view: View) -> Command:
        """What to do for the next 20 ms."""
        ...


@runtime_checkable
class Simulator(Protocol):
    """A car and its physics. One that cannot heed some field of the World, such as "friction", names it in an
    attribute ``ignores``: then who sets it is told so."""

    def simulate(
        self, road: "Road", world: "World", driver: Driver, seed: int, keep_driving: bool = False
    ) -> Drive:
        """Drive from the start of the road until the drive ends.

        At every control step it is asked, in this order: is the car at the goal, is it stuck, is more than
        ``world.oob_tolerance`` of its box outside the right lane or, with ``world.lane_departure``, a front
        tyre beyond a marking (unless ``keep_driving``), has it fallen, is time out? The first yes ends the
        drive.

        Raises:
            DriverError: the driver raised, answered with what is no command, or hung.
            SimulatorError: the simulator itself failed; after three in a row nobody asks it any more.
            SimulationError: the physics broke down.
        """
        ...


def simulate(
    road: "Road",
    world: "World",
    driver: Driver | type[Driver] | str,
    seed: int = 0,
    simulator: str | Simulator = "mujoco",
    keep_driving: bool = False,
) -> Drive:
    """One driver on one road; the same arguments give the same Drive, bit for bit, on one machine.

    Args:
        driver: a driver, its class, the name of one on the shelf ``drivers``, or a user's PATH.py:CLASS.
        seed: handed to the driver and recorded; the car's physics draws no random number.
        simulator: a simulator, or the name of one on the shelf ``simulators``.
        keep_driving: go on after the car has left the lane.

    Raises:
        PartError: no simulator or driver of that name.
        UsageError: the user's file makes no driver, or the simulator cannot heed what the world says.
        DriverError: the driver raised, answered with what is no command, or hung.
        SimulationError: the physics broke down, or moved the car as none can move.
    """
    made: Any = driver_of(driver) if isinstance(driver, str) else driver
    if isinstance(made, type):
        made = made()
    engine: Any = plugins.find("simulators", simulator) if isinstance(simulator, str) else simulator
    if isinstance(engine, type):
        engine = engine()
    refuse_ignored(engine, world)
    drive: Drive = engine.simulate(road, world, made, seed, keep_driving)
    check_motion(drive)
    return drive


def refuse_ignored(simulator: Any, world: "World") -> None:
    """What a simulator cannot heed is refused where somebody sets it.

    Args:
        simulator: the part, or its class.
        world: a field that is as usual counts as not set.

    Raises:
        UsageError: names the setting.
    """
    from roadgpt.road import World

    usual = World()
    for name in getattr(simulator, "ignores", ()):
        if (value := getattr(world, name)) != getattr(usual, name):
            said = name.replace("_", " ")
            raise UsageError(
                f"{said} {value:g} has no effect in this simulator, whose roads have a {said} of their own; "
                f"leave out --{name.replace('_', '-')}, or drive in the simulator mujoco"
            )
