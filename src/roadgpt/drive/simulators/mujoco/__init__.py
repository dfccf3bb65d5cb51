"""The simulator ``mujoco``: MuJoCo computes the rigid bodies, RoadGPT the tyres and the road surface.

The car can be changed: ``MujocoSimulator(replace(ETK_LIKE, max_drive_acceleration=4.0))`` uses a car with
weaker acceleration."""

import math
from dataclasses import replace
from operator import itemgetter
from typing import TYPE_CHECKING

import numpy as np

from roadgpt.brief.junctions import RAMPS
from roadgpt.drive import Driver
from roadgpt.drive.camera_sensor import CameraSensor, camera_of
from roadgpt.drive.drive import COLUMNS, SCRIPT, Box, Columns, Drive
from roadgpt.drive.drive_monitor import DriveMonitor
from roadgpt.drive.driver_guard import DriverGuard
from roadgpt.drive.lane_position import LanePolygon
from roadgpt.drive.outlook import Outlook
from roadgpt.drive.simulators.mujoco.car import ETK_LIKE, Axle, Car, Tyre
from roadgpt.drive.simulators.mujoco.vehicle import CONTROL, Vehicle, plane
from roadgpt.drive.view import LightAhead, Other, View
from roadgpt.road import Road, World
from roadgpt.stopping import look

if TYPE_CHECKING:
    from roadgpt.traffic import Traffic

__all__ = ["ETK_LIKE", "Axle", "Car", "MujocoSimulator", "Tyre", "Vehicle", "plane"]

_NAMES = tuple(COLUMNS)
_SEEN = itemgetter(
    *map(_NAMES.index, ["x", "y", "z", "heading", "speed", "yaw_rate", "s", "t", "steer", "vx", "vy"])
)


EASY = 3.0  # m/s^2, with which a car slows down for a bend, and that it takes sideways there
CALM = 2.0  # m/s^2, with which it stops before a junction


def _first_speed(road: Road, world: World, start: float, box: Box) -> float:
    """Returns the speed in m/s at which the car starts to roll. Where the scene does not say it, it is at
    most that from which the car slows down without effort for the bends behind ``start``, and stops before
    the first junction if it has no priority there."""
    speed = world.first_speed
    if world.scene.speed is not None:
        return speed
    front = start + box.ahead + box.length / 2
    stops = [way for way in road.passages if way.control != "priority" and way.entered.kind not in RAMPS]
    lines = [way.line - front for way in stops if way.line > front]
    speed = min([speed, *(math.sqrt(2 * CALM * away) for away in lines)])
    away = np.arange(0.0, min(speed**2 / 2 / EASY, road.length - start), 1.0)
    bends = np.abs(road.curvature(start + away))
    return float(np.sqrt((EASY / np.maximum(bends, 1e-6) + 2 * EASY * away).min(initial=speed**2)))


class MujocoSimulator:
    """Simulates a saloon car in steps of 2 ms; the driver returns a command every 20 ms."""

    moves_others = True
    builds_land = True
    heeds_scripts = True

    def __init__(self, car: Car = ETK_LIKE, start_offset: float = 0.0) -> None:
        """Uses this car, which starts ``start_offset`` metres to the left of the middle of its lane."""
        self.car, self.start_offset = car, start_offset

    def simulate(
        self,
        road: Road,
        world: World,
        driver: Driver,
        seed: int,
        keep_driving: bool = False,
        traffic: "Traffic | None" = None,
    ) -> Drive:
        """Implements `roadgpt.drive.Simulator.simulate`; the seed is only passed to the driver, because the
        physics uses no random numbers."""
        script = None
        if world.scene.has_script:
            from roadgpt.drive.script_hand import ScriptHand  # only drives with one load it

            script = ScriptHand(road, world, self.car.box, seed, traffic, driver)
            road = script.road
        guard, camera = DriverGuard(driver, script=script), camera_of(driver)
        vehicle = Vehicle.on(road, world, self.car)
        sensor = None if camera is None else CameraSensor(camera, road, world)
        outlook, station = Outlook(road, world), _NAMES.index("s")
        monitor = DriveMonitor(road, world, self.car.box, keep_driving, traffic is not None)
        company, seen, lights = None, tuple[Other, ...](), tuple[LightAhead, ...]()
        if traffic is not None:
            from roadgpt.drive.company import Company  # only drives among others load it

            company = Company(traffic, self.car.box, monitor, road, world)
        guard.start(road, world, seed)
        middle = float(world.profile_of(road).middle(monitor.start))
        rolls = traffic is not None or world.scene.speed is not None
        speed = _first_speed(road, world, monitor.start, self.car.box) if rolls else 0.0
        vehicle.put(monitor.start, middle + self.start_offset, speed)
        rows, step = [vehicle.row.tobytes()], 0
        while True:
            if company is not None:
                seen = company.seen(vehicle.row, step * CONTROL)
            ended = monitor.ended(vehicle.row, step * CONTROL, vehicle.mishap)
            if ended is not None:
                break
            now = vehicle.row.tolist()
            *place, steer, vx, vy = _SEEN(now)
            image = None
            if sensor is not None:
                bodies = () if company is None else company.bodies(step * CONTROL)
                image = sensor.see(vehicle.see(), bodies)
            ahead = outlook.at(now[station])
            if company is not None:
                lights = company.lights(now[station], step * CONTROL)
            here = (step * CONTROL, *place, road, world, steer, CONTROL, vx, vy, image)
            task = script and script.task
            if script is not None:
                script.has_crashed = monitor.touched is not None
            view = View._make((*here, *ahead, seen, lights, outlook.signs(now[station]), task))
            steer, throttle, brake = guard.ask(view)
            if script is not None:
                monitor.heed(
                    SCRIPT if script.is_changing else guard.handed_to, script.has_end, step * CONTROL, CONTROL
                )
                monitor.is_over = script.is_over
                if script.road is not road:
                    road = script.road
                    vehicle.keep_to(LanePolygon.along(road, world))
                    monitor.keep_to(road, world, self.car.box)
                    guard.start(road, world, seed)
            if monitor.touched is not None:
                throttle, brake = 0.0, 1.0  # whatever the driver says
            if world.scene.slippery:
                vehicle.stand_on(world.friction_at(now[station]))
            vehicle.move(steer, throttle, brake)
            look()
            rows.append(vehicle.row.tobytes())
            step += 1
        table = np.frombuffer(b"".join(rows)).reshape(len(rows), -1)
        columns = Columns({name: table[:, place] for place, name in enumerate(_NAMES)})
        others = None if traffic is None else traffic.tracks()
        has_lights = company is not None and company.has_lights
        handovers = tuple(guard.handovers)
        drive = Drive(guard.name, "mujoco", seed, columns, ended, self.car.box, handovers, others, has_lights)
        if script is None:
            return drive
        said = {name: getattr(script, name) for name in ("missed", "limited", "moves", "history", "tasks")}
        return replace(drive, **said, unheeded=guard.unheeded)
