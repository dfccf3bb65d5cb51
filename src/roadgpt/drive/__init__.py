"""Drives cars: a driver controls a simulated car on a road, and the result is a Drive.

Main function: ``simulate``.

This package has two kinds of plug-ins. A simulator (``simulators/``) is a car and its physics; a driver
(``drivers/``) controls the car:

    class Simulator:
        def simulate(self, road, world, driver, seed, keep_driving=False, traffic=None) -> Drive

    class Driver:
        def start(self, road, world, seed) -> None     # optional: called before time 0
        def steer(self, view: View) -> Command         # called every 20 ms"""

import logging
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

import numpy as np

from roadgpt import plugins
from roadgpt.brief.scene import Scene
from roadgpt.drive.drive import COLUMNS, Box, Columns, Drive, Ended, Handover, check_motion
from roadgpt.drive.isolation import driver_of
from roadgpt.drive.view import CameraSpec, Command, JunctionAhead, LightAhead, Other, SignAhead, View
from roadgpt.errors import UsageError
from roadgpt.ground.given import GivenGround
from roadgpt.network import only_road, refuse_other_lane, refuse_without_route

if TYPE_CHECKING:
    from roadgpt.road import Road, World
    from roadgpt.traffic import TestedCar, Tracks, Traffic

NO_LAND = "this simulator builds no land: the road is driven without it"
# The former name of CameraSpec; users' drivers may import it.
Camera = CameraSpec

__all__ = [
    "COLUMNS",
    "Box",
    "Camera",
    "CameraSpec",
    "Columns",
    "Command",
    "Drive",
    "Driver",
    "Ended",
    "Handover",
    "JunctionAhead",
    "LightAhead",
    "Other",
    "SignAhead",
    "Simulator",
    "View",
    "simulate",
]


@runtime_checkable
class Driver(Protocol):
    """Controls the car.

    A driver may also have a method ``start(road, world, seed)``. This method is called before time 0, and
    again where a scene makes the car change lanes, for a road whose driven lane is the new one.
    A driver may have an attribute ``name``. The Drive records this name; without a name, the Drive records
    the name of the driver's class. A driver that lets somebody else drive for a while, such as the person at
    the wheel, names them in an attribute ``handed_to``, which is None while it drives itself. The Drive
    records it, and the Verdict says whose a failure is. A driver that does itself what a scene tells the car
    names these actions in ``follows``: it finds them in ``view.task``."""

    def steer(self, view: View) -> Command:
        """Returns the command for the next control step, which lasts ``view.dt`` seconds."""
        ...


@runtime_checkable
class Simulator(Protocol):
    """Simulates a car and its physics.

    A simulator that cannot apply some field of the World, such as "friction", lists the field's name in an
    attribute ``ignores``. If a user sets one of these fields, an error is raised. A simulator that cannot
    drive routes through junctions has an attribute ``single_roads_only`` that is True. A simulator that moves
    others on the road has an attribute ``moves_others`` that is True; only then it gets ``traffic``. One that
    does what a scene tells the tested car has an attribute ``heeds_scripts`` that is True."""

    def simulate(
        self,
        road: "Road",
        world: "World",
        driver: Driver,
        seed: int,
        keep_driving: bool = False,
        traffic: "Traffic | None" = None,
    ) -> Drive:
        """Drives from the start of the road until the drive ends.

        At every control step the simulator checks these conditions in this order: the car has reached the
        goal; the car is stuck; the car is out of its lane; the car has fallen; the time is up. The first
        condition that holds ends the drive. The car is out of its lane if the share of its box outside the
        lane exceeds ``world.limits.oob_tolerance``. If ``world.limits.lane_departure`` is set, one front tyre
        beyond a marking is enough. With ``keep_driving``, the drive goes on when the car leaves its lane.

        With ``traffic`` others are on the road. The car then starts at the speed of the scene, or else at the
        speed limit, and leaving its lane does not end the drive. From the first contact of its box with
        another on it brakes fully, and 3 s later the drive ends. It is stuck if it moves less than 1 m in
        120 s, not in 10 s, and the time is up after twice the time that it may take alone for the way.

        Raises:
            DriverError: the driver raised an exception, returned something that is not a command, or hung.
            SimulatorError: the simulator itself failed. Commands that drive many roads stop after three such
                failures in a row.
            SimulationError: the physics became unstable."""
        ...


def simulate(
    road: "Road",
    world: "World",
    driver: Driver | type[Driver] | str,
    seed: int = 0,
    simulator: str | Simulator = "mujoco",
    keep_driving: bool = False,
    replay: "Tracks | Path | str | None" = None,
) -> Drive:
    """Drives a road with one driver, and returns the Drive.

    In the simulator ``mujoco``, the same arguments give the same Drive, bit for bit, on one machine.

    Args:
        road: the road to drive on.
        world: the World, with friction, speed limit and tolerances, and with the lanes of a road that does
            not define its own.
        driver: a driver, a driver class, the name of a driver plug-in, or PATH.py:CLASS for a user's own
            file.
        seed: passed to the driver and recorded. The physics of ``mujoco`` uses no random numbers; ``beamng``
            uses the seed for small shifts of the road's mesh.
        simulator: a simulator, or the name of a simulator plug-in.
        keep_driving: whether to continue after the car has left the lane.
        replay: recorded tracks of others who are on the road as well, or the file that holds them: a table
            or OpenSCENARIO, see ``roadgpt.traffic.recording``.

    Raises:
        DriverError: the driver raised an exception, returned something that is not a command, or hung.
        SimulatorError: the simulator itself failed.
        SimulationError: the physics became unstable, or the recorded motion is impossible for a car."""
    made: Any = driver_of(driver) if isinstance(driver, str) else driver
    if isinstance(made, type):
        made = made()
    engine: Any = plugins.find("simulators", simulator) if isinstance(simulator, str) else simulator
    if isinstance(engine, type):
        engine = engine()
    refuse_without_route(road, "driven")
    world = world.in_weather_of(seed)
    road = world.lay(road)
    refuse_other_lane(road, world)
    refuse_ignored(engine, world, road, replay is not None)
    if world.has_ground and not getattr(engine, "builds_land", False):
        logging.getLogger("roadgpt").warning("roadgpt: %s", NO_LAND)
    traffic = None
    if replay is not None or world.scene.has_others:
        from roadgpt.traffic import begin  # a drive without others does not need it

        aims = {n: None for n, each in enumerate(world.scene.actors) if each.hits}
        path = _path(road, world, seed, begin(road, world, seed, replay, aims)) if aims else ()
        traffic = begin(road, world, seed, replay, path=path)
    more = () if traffic is None else (traffic,)  # a simulator without others takes no such argument
    drive: Drive = engine.simulate(road, world, made, seed, keep_driving, *more)
    check_motion(drive)
    if traffic is None:
        return drive
    missed, limited = (*drive.missed, *traffic.missed), (*drive.limited, *traffic.limited)
    history = (*drive.history, *traffic.history)
    return replace(drive, missed=missed, limited=limited, stopped=traffic.stopped, history=history)


def _path(road: "Road", world: "World", seed: int, traffic: "Traffic | None") -> "list[TestedCar]":
    """Returns where the tested car is every STEP seconds that the test robot drives, and the script of the
    scene, among those others who are to hit nobody: it reacts to nobody."""
    from roadgpt.traffic import STEP, TestedCar

    robot = driver_of("robot")
    drive = plugins.find("simulators", "mujoco")().simulate(road, world, robot, seed, True, traffic)
    at = np.arange(0.0, drive.duration + 1e-6, STEP)
    columns = [*drive.middles.T, *(drive[name] for name in ("speed", "s", "t"))]
    rows = np.column_stack([np.interp(at, drive["time"], each) for each in columns]).tolist()
    return [TestedCar(*row, *drive.car[:2]) for row in rows]


def refuse_ignored(simulator: Any, world: "World", road: "Road | None" = None, replays: bool = False) -> None:
    """Raises UsageError if the simulator cannot apply a setting of the world, the superelevation of the road,
    cannot drive through the junctions of a route, or cannot move others on the road, who come from the scene
    or are replayed. ``road`` is None if it is not known yet."""
    from roadgpt.road import World

    if world.scene.has_script and not getattr(simulator, "heeds_scripts", False):
        does = (*world.scene.actions, f"starts {world.scene.offset} m aside")[0]
        does = "a robot's run-in" if world.scene.is_test else does
        raise UsageError(
            f"this simulator cannot make the tested car do what its scene tells ({does}); drive in the "
            "simulator mujoco"
        )
    asked = world.scene.on_the_road
    if (replays or asked != Scene()) and not getattr(simulator, "moves_others", False):
        lacks = "move others on the road yet; leave scene and tracks out"
        if not (replays or world.scene.has_others):
            lacks = "apply the weather, light, surface and speed of a scene yet; leave the scene out"
        raise UsageError(f"this simulator cannot {lacks}, or drive in the simulator mujoco")

    if isinstance(world.site.ground, GivenGround) and not getattr(simulator, "builds_land", False):
        raise UsageError(
            "this simulator cannot build land yet; leave --ground out, or drive in the simulator mujoco"
        )
    # such a simulator builds what a plain road has: no traffic on the left, no lanes that a Route has merged
    is_simple = getattr(simulator, "single_roads_only", False)
    if is_simple and road is not None and only_road(road, world) is None:
        raise UsageError("this simulator cannot build junctions yet; drive in the simulator mujoco")
    values, usual = world.values(), World().values()
    ignored = getattr(simulator, "ignores", ())
    profile = None if road is None else road.profile
    is_banked = profile is not None and profile.superelevation_angle is not None
    if "bank" in ignored and (is_banked or values["bank"] != usual["bank"]):
        raise UsageError(
            "this simulator cannot incline roads towards the inside of their bends (superelevation): they "
            "are level across there; leave out --bank, or drive in the simulator mujoco"
        )
    for name in ignored:
        if (value := values[name]) != usual[name]:
            said = name.replace("_", " ")
            raise UsageError(
                f"{said} {value:g} has no effect in this simulator, whose roads have a {said} of their own; "
                f"give --{name.replace('_', '-')} {usual[name]:g}, or drive in the simulator mujoco"
            )
