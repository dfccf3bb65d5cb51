"""Runs one control step: 20 ms of physics, after which the state of the car is written as one row of a
Drive."""

import math
from typing import Any

from roadgpt.drive.compiled import compiled, inlined
from roadgpt.drive.drive import COLUMNS, FloatArray
from roadgpt.drive.lane_polygon import share_outside
from roadgpt.drive.sampled_road import locate_on
from roadgpt.drive.simulators.mujoco.dynamics import (
    PAST_VX,
    PAST_VY,
    STATION,
    STEER,
    CarState,
    Ground,
    MujocoHandles,
    call,
    step_once,
)
from roadgpt.drive.simulators.mujoco.model import BODY, STEP
from roadgpt.drive.simulators.mujoco.vectors import normal_of

STEPS = 10  # physics steps in a control step
FALLEN = 2.0  # m below the road: from there RoadGPT's car cannot return to its floating road
FALLEN_OVER = 0.5  # cosine of 60 degrees between car and road: a saloon that leans more overturns

_ROW = {name: place for place, name in enumerate(COLUMNS)}
TIME, OUTSIDE = _ROW["time"], _ROW["outside"]
X, Y, Z = _ROW["x"], _ROW["y"], _ROW["z"]
HEADING, PITCH, ROLL = _ROW["heading"], _ROW["pitch"], _ROW["roll"]
VX, VY, VZ, YAW_RATE, SPEED = _ROW["vx"], _ROW["vy"], _ROW["vz"], _ROW["yaw_rate"], _ROW["speed"]
AX, AY = _ROW["ax"], _ROW["ay"]
STEERED, THROTTLE, BRAKE = _ROW["steer"], _ROW["throttle"], _ROW["brake"]
S, T = _ROW["s"], _ROW["t"]


@inlined
def _look(mj: MujocoHandles, car: Any, ground: Ground, car_state: CarState, row: FloatArray) -> bool:
    """Fills the row; returns whether the car has fallen off the road or overturned."""
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
    upright = m[2] * nx + m[5] * ny + m[8] * nz
    fell: bool = z - car.cg_height < height - FALLEN or upright < FALLEN_OVER
    return fell


@compiled
def control_step(
    mj: MujocoHandles,
    cars: Any,
    axles: Any,
    ground: Ground,
    car_state: CarState,
    steer: float,
    throttle: float,
    brake: float,
    steps: int,
    row: FloatArray,
) -> bool:
    """Runs ``steps`` steps of 2 ms and writes the car's state into ``row``. Returns whether the car fell
    off the road or overturned. ``steer`` is in rad, ``throttle`` and ``brake`` are 0 to 1."""
    car = cars[0]
    for _ in range(steps):
        step_once(mj, car, axles, ground, car_state, steer, throttle, brake)
    fell = _look(mj, car, ground, car_state, row)
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
    row[THROTTLE] = throttle
    row[BRAKE] = brake
    return fell
