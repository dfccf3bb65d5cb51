"""Loads a road and a car into a running BeamNG, steps the physics, and controls the car."""

import os
from contextlib import suppress
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from roadgpt.drive.drive import FloatArray
from roadgpt.drive.view import CameraSpec
from roadgpt.errors import RoadGPTError, SimulationError
from roadgpt.road import Road, World
from roadgpt_beamng.level import ABOVE_GROUND, rotation
from roadgpt_beamng.level.roads import GOAL, Materials, Strip, level_road
from roadgpt_beamng.session import Session, client
from roadgpt_beamng.tracking import CarGeometry, CarSample, car_sample

# Materials of the competition's level, and of the art that BeamNG's own levels share.
TIG = Materials("tig_road_rubber_sticky", "tig_grass", "tig_road_rubber_sticky", "line_white", "line_yellow")
STOCK = Materials(
    "track_editor_C_center", "track_editor_C_border", "road_rubber_sticky", "line_white", "line_yellow"
)
CALM = 0.05  # m/s, below which the car counts as standing
SETTLING = 3.0  # s, the longest wait for that
DROP = 0.02  # m above the ground at which a car of known height is placed
DECIMALS = 4
GEARBOX = "arcade"
"""In this mode the throttle alone makes the car drive forwards, with any gearbox. According to BeamNGpy, the
driver has to select D in the mode "realistic_automatic", and every gear in "realistic_manual"."""
TRIAL, TRIAL_TIME = 0.4, 4.0  # steering input, and longest duration in s, of the trial of the steering
TRIAL_SPEED = 1.0, 4.0  # m/s; the trial is evaluated between these speeds
STRAIGHT = 0.003  # 1/m; if the curvature is smaller, the car did not turn in the trial
WHEELBASE = 0.6  # of the length, typical of saloons
LOCKS = 0.3, 1.0  # rad, plausible lock angles of front wheels
REFRESH = "if map and map.reset then map.reset() end"
"""Lua: makes the AI read its map again, because the road was added after the level was loaded."""


class LoadedRoad:
    """One road in BeamNG. Use it as ``with LoadedRoad(...) as loaded``; the road and the car are removed at
    the end."""

    def __init__(self, session: Session, road: Road, world: World, seed: int) -> None:
        """Loads the road and places the car at its start."""
        self.session, self.bng = session, session.bng
        self.settings = session.settings
        # A road on the floor of the world lies on the level's ground.
        self.lift = session.ground - world.site.z_floor
        session.laid += 1
        self.prefix = f"roadgpt_{os.getpid()}_{session.laid}_"
        materials = TIG if session.level == "tig" else STOCK
        self.scene = level_road(road, world, seed, materials, self.lift, self.prefix)
        self.goal = self.prefix + GOAL
        self.camera: Any = None
        self.now: CarSample
        self._begun = 0.0
        self._load()
        self._settle()

    def _load(self) -> None:
        package, scene = client(), self.scene
        scenario = package.Scenario(self.session.level, f"{self.prefix}road_scene")
        for strip in scene.strips:
            add = scenario.add_mesh_road if strip.is_mesh else scenario.add_road
            add(_road_of(package, strip))
        scenario.add_checkpoints([_triple(scene.goal)], [(4.0, 4.0, 4.0)], [self.goal])
        self.vehicle = package.Vehicle("ego", self.settings.model)
        self.vehicle.sensors.attach("electrics", package.sensors.Electrics())
        self.session.vehicle = self.vehicle
        place, turn = self._start()
        # BeamNG must not place it itself: it would put it on the level's ground.
        scenario.add_vehicle(self.vehicle, place, turn, False)
        with self.session.loading():
            scenario.make(self.bng)
            self.scenario = scenario
            self.bng.control.pause()  # loading keeps physics as it is
            self.bng.scenario.load(scenario)
            self.bng.scenario.start()
            self.bng.control.pause()
            self.session.step_evenly()
            self.bng.control.queue_lua_command(REFRESH)
            self.session.has_loaded = True

    def _start(self) -> tuple[tuple[float, float, float], tuple[float, float, float, float]]:
        """Returns the position of the reference node, and the rotation of the car."""
        scene, body = self.scene, self.session.body
        turn = rotation(scene.heading, scene.grade)
        if body is None:
            place = scene.start + [0.0, 0.0, ABOVE_GROUND]
        else:
            ahead, left, up = body.node
            left_row, back_row, up_row = turn
            place = scene.start - ahead * back_row + left * left_row + (up + body.height + DROP) * up_row
        return _triple(place), as_quaternion(turn)

    def _settle(self) -> None:
        """Waits until the car is at rest. The first one of a session is measured and moved to its start."""
        with self.session.watchdog.within(self.settings.poll_timeout, "the car was put down"):
            self._rest()
            if self.session.body is None:
                corners, gravity = self.vehicle.get_bbox(), self.vehicle.get_center_of_gravity()
                start = self.scene.start
                self.session.body = CarGeometry.measured(self.vehicle.state, gravity, corners, start)
                self.vehicle.teleport(*self._start(), True)
                self._rest()
            self._begun = self._clock()
            self.now = self._sample(None)

    def _rest(self) -> None:
        self.vehicle.control(steering=0.0, throttle=0.0, brake=0.0, parkingbrake=1.0)
        every = max(1, self.settings.rate // 5)
        for _ in range(int(SETTLING * self.settings.rate / every)):
            self.session.watchdog.due_in(self.settings.poll_timeout)
            self.bng.control.step(every)
            self.vehicle.sensors.poll("state")
            if np.linalg.norm(self.vehicle.state["vel"]) < CALM:
                break

    @property
    def body(self) -> CarGeometry:
        """The geometry of the car, measured in BeamNG."""
        assert self.session.body is not None
        return self.session.body

    def _clock(self) -> float:
        return float(self.vehicle.state.get("time", 0.0))

    def _sample(self, since: CarSample | None) -> CarSample:
        self.vehicle.sensors.poll("state", "electrics")
        state, electrics = self.vehicle.state, self.vehicle.sensors["electrics"]
        time = 0.0 if since is None else self._time_after(since)
        return car_sample(state, electrics, self.body, self.lift, since, time)

    def _time_after(self, since: CarSample) -> float:
        """Returns the seconds since the start, at least half a step more than at the previous sample; if the
        car reports no time, its steps are counted."""
        step = 1.0 / self.settings.rate
        if "time" not in self.vehicle.state:
            return since.time + step
        return max(self._clock() - self._begun, since.time + step / 2)

    def step(self) -> CarSample:
        """Runs one step of physics, and returns the sample of the car after this step."""
        self.session.watchdog.due_in(self.settings.poll_timeout)
        self.bng.control.step(1)
        self.now = self._sample(self.now)
        return self.now

    def steer(self, angle: float, throttle: float, brake: float) -> None:
        """Sends a driver's command; ``angle`` is in radians at the front wheels, left positive."""
        gain = self.session.gain or -1.0
        stands = self.now.vx < 0.5 and brake > 0 and throttle == 0
        self.vehicle.control(
            steering=min(max(angle / gain, -1.0), 1.0),
            throttle=throttle,
            brake=0.0 if stands else brake,  # a standing car's brake is the reverse gear in arcade mode
            parkingbrake=1.0 if stands else 0.0,
        )

    def let_ai_drive(self, limit: float) -> None:
        """Makes BeamNG's own AI drive to the goal, at up to ``limit`` m/s."""
        self.vehicle.control(parkingbrake=0.0)
        ai = self.vehicle.ai
        # In the competition's order, which is known to work: the goal, which sets it off, comes last.
        ai.set_aggression(self.settings.aggression)
        ai.set_speed(limit, "limit")
        ai.drive_in_lane(True)
        ai.set_waypoint(self.goal)

    def take_the_wheel(self) -> None:
        """Prepares the car for a RoadGPT driver: selects an automatic gearbox mode (in others the car does
        not move until a gear is selected), and measures the steering if this session has not done so yet."""
        with self.session.watchdog.within(self.settings.poll_timeout, "the gearbox was set"):
            self.vehicle.set_shift_mode(GEARBOX)
            if self.session.gain is not None:
                return
        self._measure_steering()
        with self.session.watchdog.within(self.settings.poll_timeout, "the gearbox was set"):
            self.vehicle.set_shift_mode(GEARBOX)  # it may have been reset with the car

    def _measure_steering(self) -> None:
        """Measures to which side, and how far, a steering input turns the wheels, which BeamNG does not
        document and which differs from car to car; then moves the car back to its start."""
        found: list[float] = []
        echoed = 0.0
        with self.session.watchdog.within(self.settings.poll_timeout, "the steering was measured"):
            self.vehicle.control(steering=TRIAL, throttle=0.4, brake=0.0, parkingbrake=0.0)
            for _ in range(int(TRIAL_TIME * self.settings.rate)):
                now = self.step()
                if now.vx > TRIAL_SPEED[0]:
                    found.append(now.yaw_rate / now.vx)
                    echoed += now.steer
                if now.vx > TRIAL_SPEED[1]:
                    break
            self.vehicle.teleport(*self._start(), True)
            self._rest()
            self._begun = self._clock()
            self.now = self._sample(None)
        bend = float(np.median(found[len(found) // 2 :])) if found else 0.0
        if abs(bend) < STRAIGHT:
            raise SimulationError("BeamNG's car does not respond to steering; check ROADGPT_BEAMNG_MODEL")
        wheelbase = WHEELBASE * (self.body.front - self.body.rear)
        lock = np.arctan(wheelbase * abs(bend)) / TRIAL
        self.session.gain = float(np.copysign(np.clip(lock, *LOCKS), bend))
        self.session.reported_gain = float(np.copysign(self.session.gain, bend * echoed))

    def open_camera(self, camera: CameraSpec) -> None:
        """Mounts the driver's camera on the car."""
        body = self.body
        # The camera is placed from the reference node; BeamNG's cars look along -y, their left is +x.
        place = (-body.node[1], -(camera.ahead - body.node[0]), camera.up - body.height - body.node[2])
        with self.session.watchdog.within(self.settings.poll_timeout, "the camera was opened"):
            self.camera = client().sensors.Camera(
                f"{self.prefix}eye",
                self.bng,
                self.vehicle,
                requested_update_time=1.0 / self.settings.rate,
                pos=place,
                dir=(0, -1, float(-np.tan(camera.down))),
                resolution=(camera.width, camera.height),
                field_of_view_y=float(np.degrees(camera.field_of_view)),
                is_using_shared_memory=False,
                is_render_annotations=False,
                is_render_depth=False,
            )

    def image(self) -> FloatArray | None:
        """Returns the camera's image, shape (height, width, 3), uint8; None if there is no camera."""
        if self.camera is None:
            return None
        seen = self.camera.poll().get("colour")
        if seen is None:
            raise SimulationError("BeamNG's camera draws no image; leave out --nogpu")
        return np.asarray(seen)[..., :3]

    def __enter__(self) -> "LoadedRoad":
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        """Removes the road and the car as far as possible."""
        session = self.session
        if kind is not None and not issubclass(kind, RoadGPTError):
            return  # the session is dropped as a whole
        with (
            session.watchdog.within(self.settings.load_timeout, "a road was cleared away"),
            suppress(Exception),
        ):
            if self.camera is not None:
                self.camera.remove()
            self.bng.scenario.stop()
            self.scenario.delete(self.bng)
        session.vehicle = None
        if session.watchdog.has_fired:
            session.drop()


def _road_of(package: Any, strip: Strip) -> Any:
    if strip.is_mesh:
        road = package.MeshRoad(strip.material, rid=strip.name)
    else:
        # BeamNGpy renumbers the decal roads of a scenario from 0, in the order in which they are added.
        # level_road uses the same numbers, so the drawing order does not depend on which of them BeamNG uses.
        look = {"drivability": strip.drivability, "render_priority": strip.priority}
        road = package.Road(strip.material, rid=strip.name, **look)
    road.add_nodes(*(tuple(node) for node in strip.nodes.round(DECIMALS).tolist()))
    return road


def _triple(point: FloatArray) -> tuple[float, float, float]:
    x, y, z = (round(float(value), DECIMALS) for value in point)
    return x, y, z


def as_quaternion(matrix: FloatArray) -> tuple[float, float, float, float]:
    """Returns the quaternion (x, y, z, w) of a rotation matrix, in the order of components that beamngpy
    expects for a car's attitude."""
    x, y, z, w = Rotation.from_matrix(matrix).as_quat().tolist()
    return x, y, z, w
