"""A car that can be moved step by step, on a road or on a plane."""

import math
from typing import Any

import mujoco
import numpy as np

from roadgpt.compiled import COMPILES, FUNCTIONS, addresses, bound, compiled, inlined
from roadgpt.drive.drive import COLUMNS, FloatArray, Mishap
from roadgpt.drive.lane_position import LanePolygon, share_outside
from roadgpt.drive.sampled_road import BANK, GRADE, SampledRoad, locate_on, sample_road, stations_of
from roadgpt.drive.simulators.mujoco.car import ETK_LIKE, Car, tables
from roadgpt.drive.simulators.mujoco.dynamics import (
    ABS,
    AT,
    BODY,
    BRAKE,
    BRIDGE,
    PAST_VX,
    PAST_VY,
    SPIN_DOF,
    STATE,
    STATION,
    STEER,
    STEP,
    TCS,
    TUNNEL,
    WHEEL_STATE,
    CarState,
    DrivenGround,
    LandGrid,
    MujocoHandles,
    beyond_rim,
    call,
    centre_height,
    crossing_at,
    hull_points,
    is_over_land,
    land_contact,
    model_of,
    normal_of,
    step_once,
)
from roadgpt.road import Road, World

SETTLED = 2e-4  # m/s and rad/s, below which all parts count as at rest
LONGEST_SETTLING = 150  # control steps
STEPS = 10  # physics steps in a control step
CONTROL = STEPS * STEP
"""Length of a control step in seconds: the time between two commands of the driver."""
FALLEN = 2.0  # m below the road: from there RoadGPT's car cannot return to its floating road
MISHAPS: tuple[Mishap | None, ...] = (None, "fell", "rolled", "crashed", "sank")
FELL, ROLLED, CRASHED, SANK = range(1, 5)
SHOCK = 80.0  # m/s^2, mean of a control step, beside the road: no tyre brakes so hard, but a slope does
IN_THE_AIR = 0.5  # m above the land, of a car that falls off a bridge
BESIDE_WALL = 0.9  # m from a wall to the middle of the car that touches it
CONTAINED = 10.4  # m/s across a parapet up to which it holds a car (EN 1317-2, N2: 110 km/h at 20 degrees)
NO_WATER = -1e6  # m
FALLEN_OVER = 0.5  # cosine of 60 degrees between car and road: a saloon that leans more overturns
_ROW = {name: place for place, name in enumerate(COLUMNS)}
TIME, OUTSIDE = _ROW["time"], _ROW["outside"]
X, Y, Z = _ROW["x"], _ROW["y"], _ROW["z"]
HEADING, PITCH, ROLL = _ROW["heading"], _ROW["pitch"], _ROW["roll"]
VX, VY, VZ, YAW_RATE, SPEED = _ROW["vx"], _ROW["vy"], _ROW["vz"], _ROW["yaw_rate"], _ROW["speed"]
AX, AY = _ROW["ax"], _ROW["ay"]
STEERED, ACCELERATED, BRAKED = _ROW["steer"], _ROW["throttle"], _ROW["brake"]
S, T = _ROW["s"], _ROW["t"]


class Vehicle:
    """One car on a road or a plane; its state changes as it moves."""

    def __init__(self, car: Car, ground: DrivenGround) -> None:
        """Prepares a car on this ground; call `put` to place it."""
        self.car = car
        self._model = model_of(car)
        self._data = mujoco.MjData(self._model)
        self._ground = ground
        self._state = np.zeros(STATE)
        self.wheels: FloatArray = np.zeros((4, WHEEL_STATE))
        """The state of each wheel: slips, valves, station, load and forces. The column indices are in
        `dynamics`."""
        scratch = (np.zeros((4, 2)), np.zeros((2, 16, 2)))
        car_state = CarState(self._state, self.wheels, hull_points(car), *scratch)
        self._parts = (_handles(self._model, self._data), *tables(car), ground, car_state)
        self.row: FloatArray = np.zeros(len(COLUMNS))
        """The present state of the car, in the order of COLUMNS."""
        self.mishap: Mishap | None = None
        """What ends every drive: see ``Ended``; None if nothing has happened to the car."""
        self._step = bound(control_step, (*self._parts, 0.0, 0.0, 0.0, 0, self.row))

    def __getstate__(self) -> dict[str, Any]:
        arrays = {"_state": self._state, "wheels": self.wheels, "row": self.row}
        return {"car": self.car, "ground": self._ground, "data": self._data, "arrays": arrays,
                "mishap": self.mishap}  # fmt: skip

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__init__(state["car"], state["ground"])  # type: ignore[misc]  # with a model of its own
        mujoco.mj_copyData(self._data, self._model, state["data"])
        for name, values in state["arrays"].items():
            getattr(self, name)[:] = values
        self.mishap = state["mishap"]

    @classmethod
    def on(cls, road: Road, world: World, car: Car = ETK_LIKE) -> "Vehicle":
        """Returns a car on a road, with the road's lanes and shoulders and the world's friction."""
        sampled, profile = sample_road(road), world.profile_of(road)
        rims = np.column_stack(profile.rims(stations_of(sampled)))
        lane = LanePolygon.along(road, world)
        beyond = profile.reach
        if road.passages:  # shoulders reach around the corners of junctions
            beyond = float(profile.shoulder(road.length))
        ground = DrivenGround(sampled, rims, beyond, world.site.friction, lane)
        return cls(car, ground._replace(land=_land(road, world)) if world.has_ground else ground)

    def put(self, s: float, t: float, speed: float = 0.0) -> None:
        """Places the car at station ``s`` and offset ``t`` in metres, facing along the road, at time 0.

        If ``speed`` (m/s) is 0, the car settles on its springs with the brakes applied. Otherwise the car
        rolls freely at this speed."""
        car, data = self.car, self._data
        mujoco.mj_resetData(self._model, data)
        self._state[:] = 0.0
        self.wheels[:] = 0.0
        self.wheels[:, (ABS, TCS)] = 1.0
        self.wheels[:, AT] = s
        self._state[STATION] = s
        frame = self._frame(s)
        data.qpos[:3] = self._row_at(s)[:3] + t * frame[:, 1] + frame[:, 2] * car.cg_height
        mujoco.mju_mat2Quat(data.qpos[3:7], np.ascontiguousarray(frame).ravel())
        if speed:
            data.qvel[:3] = frame[:, 0] * speed
            for dof, axle in zip(SPIN_DOF, (car.front, car.front, car.rear, car.rear), strict=True):
                data.qvel[dof] = speed / centre_height(car, axle)
        else:
            self._state[BRAKE] = 1.0
            for _ in range(LONGEST_SETTLING):
                self._move(0.0, 0.0, 1.0, STEPS)
                if self.mishap or np.abs(data.qvel).max() < SETTLED:
                    break
        data.time = 0.0
        self._move(0.0, 0.0, 0.0 if speed else 1.0, 0)
        self.row[AX] = self.row[AY] = 0.0

    def move(self, steer: float, throttle: float, brake: float) -> None:
        """Runs one control step of 20 ms with these commands: ``steer`` in rad, ``throttle`` and ``brake``
        from 0 to 1."""
        self._move(steer, throttle, brake, STEPS)
        self.row[TIME] = round(self._data.time, 9)

    def stand_on(self, friction: float) -> None:
        """Sets the friction of the ground under all wheels."""
        self._change(friction=friction)

    def keep_to(self, lane: LanePolygon) -> None:
        """Sets the lane that the column ``outside`` is about."""
        self._change(lane=lane)

    def _change(self, **of_ground: Any) -> None:
        *before, ground, car = self._parts
        self._ground = ground._replace(**of_ground)
        self._parts = (*before, self._ground, car)

    def see(self) -> dict[str, float]:
        """Returns the present state of the car as a dictionary with the names in COLUMNS as keys."""
        return dict(zip(COLUMNS, self.row.tolist(), strict=True))

    def _move(self, steer: float, throttle: float, brake: float, steps: int) -> None:
        # always floats, for which the step is compiled
        command = float(steer), float(throttle), float(brake)
        self.mishap = MISHAPS[self._step(*self._parts, *command, steps, self.row)]

    def _row_at(self, s: float) -> FloatArray:
        sampled = self._ground.sampled
        stations = sampled.first + sampled.step * np.arange(len(sampled.table))
        return np.array([np.interp(s, stations, column) for column in sampled.table.T])

    def _frame(self, s: float) -> FloatArray:
        """Returns the road's unit vectors forward, left and up at station s, as the columns of a (3, 3)
        array."""
        _, _, _, heading, grade, *more = self._row_at(s).tolist()
        along = np.array([math.cos(heading), math.sin(heading), grade])
        along /= np.linalg.norm(along)
        left = np.array([-math.sin(heading), math.cos(heading), 0.0])
        up = np.cross(along, left)
        is_banked = self._ground.sampled.table.shape[1] > BANK  # only banked roads have this column
        if is_banked:
            angle = math.atan(more[BANK - GRADE - 1])
            left, up = (
                math.cos(angle) * left + math.sin(angle) * up,
                math.cos(angle) * up - math.sin(angle) * left,
            )
        return np.column_stack([along, left, up])


def _land(road: Road, world: World) -> LandGrid:
    from roadgpt.network.landscape import crossings, ground_around  # only drives over land load it

    ground = ground_around(road, world)
    x, y = np.meshgrid(ground.x, ground.y)
    water = np.nan_to_num(ground.water_level(x, y), nan=NO_WATER)
    of = ground.layers
    walls = [
        (each.start, each.end, TUNNEL if each.kind == "tunnel" else BRIDGE) for each in crossings(road, world)
    ]
    places = np.array(walls, float).reshape(-1, 3)
    return LandGrid(ground.heights, water, of.x, of.y, of.cell, of.slope, places)


def plane(friction: float = 1.0, grade: float = 0.0, size: float = 5000.0, car: Car = ETK_LIKE) -> Vehicle:
    """Returns a car in the middle of a plane that climbs along x, for manoeuvres that need more space than a
    road has. It is one large lane of ``size`` metres along x, so the car is never outside its lane."""
    s = np.array([0.0, size / 2, size])
    table = np.zeros((3, 8))
    table[:, 0], table[:, 2], table[:, 4], table[:, 6] = s - size / 2, (s - size / 2) * grade, grade, 1.0
    edges = np.column_stack([s - size / 2, np.full(3, size), s - size / 2, np.full(3, -size)])
    rims = np.array([[size, -size]] * 3)
    sampled, lane = SampledRoad(table, 0.0, size / 2, size), LanePolygon(edges, size / 2)
    vehicle = Vehicle(car, DrivenGround(sampled, rims, size, friction, lane))
    vehicle.put(size / 2, 0.0)
    return vehicle


def _handles(model: Any, data: Any) -> MujocoHandles:
    # MuJoCo would log warnings to a file in the current folder; our simulator reports what failed.
    mujoco.set_mju_user_warning(lambda _: None)
    functions = addresses() if COMPILES else tuple(getattr(mujoco, name) for name in FUNCTIONS)
    both = (model._address, data._address) if COMPILES else (model, data)
    views = (data.qpos, data.qvel, data.qfrc_applied, data.xpos, data.xmat, data.cvel, data.subtree_com)
    return MujocoHandles._make((*functions, *both, *views))


@inlined
def _look(mj: MujocoHandles, car: Any, ground: DrivenGround, car_state: CarState, row: FloatArray) -> int:
    """Fills the row; returns the number in MISHAPS of what has happened to the car."""
    sampled, state, box = ground.sampled, car_state.state, car_state.box
    # The last half step changed the coordinates; update the body's axes.
    call(mj.place, mj.model, mj.data)
    m = mj.xmat[BODY]
    x, y, z = mj.qpos[0], mj.qpos[1], mj.qpos[2]
    vx, vy, vz = mj.qvel[0], mj.qvel[1], mj.qvel[2]
    s, t, height, slope, lateral, heading = locate_on(
        sampled.table, sampled.first, sampled.step, x, y, state[STATION]
    )
    state[STATION] = s
    row[X], row[Y], row[Z] = x, y, z
    row[HEADING] = math.atan2(m[3], m[0])
    row[PITCH] = math.asin(min(max(m[6], -1.0), 1.0))
    row[ROLL] = math.atan2(m[7], m[8])
    row[VX] = vx * m[0] + vy * m[3] + vz * m[6]
    row[VY] = vx * m[1] + vy * m[4] + vz * m[7]
    row[VZ] = vx * m[2] + vy * m[5] + vz * m[8]
    row[YAW_RATE] = mj.qvel[5]
    row[SPEED] = math.sqrt(vx * vx + vy * vy + vz * vz)
    row[STEERED] = state[STEER]
    # The offset of the point of the surface below the car, at a right angle to the inclined section.
    row[S], row[T] = s, t + (z - height) * lateral / math.sqrt(1.0 + lateral * lateral)
    # Corners of the car's floor, counter-clockwise in plan.
    front = car.box_offset + 0.5 * car.length
    for k in range(4):
        bx = front if k in (1, 2) else front - car.length
        by = 0.5 * car.width if k >= 2 else -0.5 * car.width
        box[k, 0] = x + m[0] * bx + m[1] * by - m[2] * car.cg_height
        box[k, 1] = y + m[3] * bx + m[4] * by - m[5] * car.cg_height
    row[OUTSIDE] = share_outside(ground.lane.edges, ground.lane.step, box, s, car_state.scratch)
    nx, ny, nz = normal_of(slope, lateral, heading)
    beyond, land = beyond_rim(ground, s, t), ground.land
    if land.heights.shape[0] > 0:
        crossing, low = crossing_at(land, s), z - car.cg_height
        if crossing > 0.0 and -BESIDE_WALL < beyond < 0.0 and abs(low - height) < FALLEN:
            aside = abs(vy * math.cos(heading) - vx * math.sin(heading))
            if crossing == TUNNEL or aside < CONTAINED:
                return CRASHED
        if is_over_land(land, s, low, height, beyond):
            deck = height
            height, (nx, ny, nz) = land_contact(land, x, y, s, height, slope, lateral, heading, beyond)
            if crossing == BRIDGE and height + IN_THE_AIR < low < deck - FALLEN:
                return FELL
            i = min(max(int((x - land.x) / land.cell + 0.5), 0), land.heights.shape[1] - 1)
            j = min(max(int((y - land.y) / land.cell + 0.5), 0), land.heights.shape[0] - 1)
            if z < land.water[j, i]:
                return SANK
        return ROLLED if m[8] < FALLEN_OVER else 0
    if z - car.cg_height < height - FALLEN or m[2] * nx + m[5] * ny + m[8] * nz < FALLEN_OVER:
        return FELL
    return 0


@compiled
def control_step(
    mj: MujocoHandles,
    cars: Any,
    axles: Any,
    ground: DrivenGround,
    car_state: CarState,
    steer: float,
    throttle: float,
    brake: float,
    steps: int,
    row: FloatArray,
) -> int:
    """Runs ``steps`` steps of 2 ms and writes the car's state into ``row``. Returns the number in MISHAPS of
    what has happened to the car. ``steer`` is in rad, ``throttle`` and ``brake`` are 0 to 1."""
    car = cars[0]
    for _ in range(steps):
        step_once(mj, car, axles, ground, car_state, steer, throttle, brake)
    mishap = _look(mj, car, ground, car_state, row)
    m = mj.xmat[BODY]
    vx, vy = mj.qvel[0], mj.qvel[1]
    dt = max(steps, 1) * STEP
    state = car_state.state
    gx, gy = (vx - state[PAST_VX]) / dt, (vy - state[PAST_VY]) / dt
    state[PAST_VX], state[PAST_VY] = vx, vy
    # The mean acceleration of this control step, along the car's axes projected to the horizontal plane.
    norm = 1.0 / max(math.hypot(m[0], m[3]), 1e-6)
    c, n = m[0] * norm, m[3] * norm
    row[AX] = gx * c + gy * n
    row[AY] = gy * c - gx * n
    row[ACCELERATED] = throttle
    row[BRAKED] = brake
    if mishap == 0 and ground.land.heights.shape[0] > 0 and gx * gx + gy * gy > SHOCK * SHOCK and steps > 0:
        return CRASHED
    return mishap
