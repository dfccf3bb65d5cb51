"""One control step: 20 ms of physics, then what can be seen of the car, as one row of a Drive."""

import hashlib
import math
from pathlib import Path
from typing import Any

from roadgpt.drive import compiled as compiling
from roadgpt.drive.compiled import compiled, inlined
from roadgpt.drive.drive import COLUMNS, FloatArray
from roadgpt.drive.lane import share_outside
from roadgpt.drive.ribbon import place_on
from roadgpt.drive.simulators.mujoco.bridge import call
from roadgpt.drive.simulators.mujoco.loop import (
    PAST_VX,
    PAST_VY,
    STATION,
    STEER,
    Engine,
    Ground,
    Motion,
    step_once,
)
from roadgpt.drive.simulators.mujoco.model import BODY, STEP

STEPS = 10  # of physics in a control step
FALLEN = 2.0  # m below the road: RoadGPT's car has then left its floating road for good
FALLEN_OVER = 0.5  # cosine of 60 degrees between car and road: beyond it a saloon does not come back

_ROW = {name: place for place, name in enumerate(COLUMNS)}
TIME, OUTSIDE = _ROW["time"], _ROW["outside"]
X, Y, Z = _ROW["x"], _ROW["y"], _ROW["z"]
HEADING, PITCH, ROLL = _ROW["heading"], _ROW["pitch"], _ROW["roll"]
VX, VY, VZ, YAW_RATE, SPEED = _ROW["vx"], _ROW["vy"], _ROW["vz"], _ROW["yaw_rate"], _ROW["speed"]
AX, AY = _ROW["ax"], _ROW["ay"]
STEERED, THROTTLE, BRAKE = _ROW["steer"], _ROW["throttle"], _ROW["brake"]
S, T = _ROW["s"], _ROW["t"]


@inlined
def _look(engine: Engine, car: Any, ground: Ground, motion: Motion, row: FloatArray) -> bool:
    """Fills the row; says whether the car has fallen off the road or over."""
    ribbon, state, box = ground.ribbon, motion.state, motion.box
    # The half step just done moved the coordinates; bring the body's axes up to date with them.
    call(engine.place, engine.model, engine.data)
    m = engine.xmat[BODY]
    x, y, z = engine.qpos[0], engine.qpos[1], engine.qpos[2]
    vx, vy, vz = engine.qvel[0], engine.qvel[1], engine.qvel[2]
    s, t, height, slope, heading = place_on(ribbon.table, ribbon.first, ribbon.step, x, y, state[STATION])
    state[STATION] = s
    row[X], row[Y], row[Z] = x, y, z
    row[HEADING] = math.atan2(m[3], m[0])
    row[PITCH] = math.asin(min(max(m[6], -1.0), 1.0))
    row[ROLL] = math.atan2(m[7], m[8])
    row[VX] = vx * m[0] + vy * m[3] + vz * m[6]
    row[VY] = vx * m[1] + vy * m[4] + vz * m[7]
    row[VZ] = vx * m[2] + vy * m[5] + vz * m[8]
    row[YAW_RATE] = engine.qvel[5]
    row[SPEED] = math.sqrt(vx * vx + vy * vy + vz * vz)
    row[STEERED] = state[STEER]
    row[S], row[T] = s, t
    # Corners of the car's floor, counter-clockwise in plan.
    front = car.box_ahead + 0.5 * car.length
    for k in range(4):
        bx = front if k in (1, 2) else front - car.length
        by = 0.5 * car.width if k >= 2 else -0.5 * car.width
        box[k, 0] = x + m[0] * bx + m[1] * by - m[2] * car.height
        box[k, 1] = y + m[3] * bx + m[4] * by - m[5] * car.height
    row[OUTSIDE] = share_outside(ground.lane.edges, ground.lane.step, box, s, motion.scratch)
    upright = m[8] - slope * (m[2] * math.cos(heading) + m[5] * math.sin(heading))
    upright /= math.sqrt(1.0 + slope * slope)
    fell: bool = z - car.height < height - FALLEN or upright < FALLEN_OVER
    return fell


def _made(mark: int) -> Any:
    """`control_step`, compiled. Numba finds what it kept on disk by a function's own file and by the values
    that it closes over; the mark lets it know of all the other files."""

    @compiled
    def control_step(
        engine: Engine,
        cars: Any,
        axles: Any,
        ground: Ground,
        motion: Motion,
        steer: float,
        throttle: float,
        brake: float,
        steps: int,
        row: FloatArray,
    ) -> bool:
        """`steps` steps of 2 ms with these commands (rad, 0..1, 0..1), then the row; True: the car fell."""
        car = cars[0]
        for _ in range(steps):
            step_once(engine, car, axles, ground, motion, steer, throttle, brake)
        fell = _look(engine, car, ground, motion, row)
        m = engine.xmat[BODY]
        vx, vy = engine.qvel[0], engine.qvel[1]
        dt = max(steps, 1) * STEP
        state = motion.state
        gx, gy = (vx - state[PAST_VX]) / dt, (vy - state[PAST_VY]) / dt
        state[PAST_VX], state[PAST_VY] = vx, vy
        # Level axes of the car; over a step of 20 ms the mean acceleration.
        norm = 1.0 / max(math.hypot(m[0], m[3]), 1e-6)
        c, n = m[0] * norm, m[3] * norm
        row[AX] = gx * c + gy * n
        row[AY] = gy * c - gx * n
        row[THROTTLE] = throttle
        row[BRAKE] = brake
        return fell or mark == 0  # it never is; but a value that is not used is not closed over

    return control_step


def _mark_of_sources() -> int:
    """Another number when any file of the physics has changed."""
    here = Path(__file__)
    files = sorted(here.parent.glob("*.py"))
    files += [
        here.parents[2] / name for name in ("compiled.py", "drive.py", "lane.py", "native.py", "ribbon.py")
    ]
    digest = hashlib.sha256(b"".join(file.read_bytes() for file in files)).hexdigest()
    return int(digest[:12], 16) | 1


control_step = _made(_mark_of_sources() if compiling.COMPILES else 1)
