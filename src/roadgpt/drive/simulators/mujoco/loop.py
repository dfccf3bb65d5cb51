"""The inner loop: 2 ms steps of forces on the car, between MuJoCo's two half steps.

The forces are put into MuJoCo as generalised forces (``qfrc_applied``), worked out by hand for this one
tree of bodies: the same as forces at the wheel bodies, at a fraction of the cost.
"""

import math
from typing import Any, NamedTuple

from roadgpt.drive.compiled import inlined
from roadgpt.drive.drive import FloatArray
from roadgpt.drive.lane import Lane
from roadgpt.drive.ribbon import Ribbon, place_on
from roadgpt.drive.simulators.mujoco.bridge import call
from roadgpt.drive.simulators.mujoco.hull import hull_forces
from roadgpt.drive.simulators.mujoco.model import (
    BODY,
    CARRIER,
    SLIDE_DOF,
    SPIN_DOF,
    STEER_DOF,
    STEP,
    WHEEL,
)
from roadgpt.drive.simulators.mujoco.systems import SLOWEST_ABS, expected_yaw_rate, stability, valve
from roadgpt.drive.simulators.mujoco.tyres import tyre_forces

AIR = 1.2  # kg/m^3, at 20 degrees C
UNDER = 0.25  # m below the road's surface at which it holds nothing any more

# The car's own state beside MuJoCo's, as places in one array ...
STEER, THROTTLE, BRAKE, EXPECTED, STATION, SUPPORT, PAST_VX, PAST_VY = range(8)
STATE = 8
# ... and one row for each wheel.
SLIP_X, SLIP_Y, ABS, TCS, AT, LOAD, FX, FY = range(8)
WHEEL_STATE = 8


class Engine(NamedTuple):
    """MuJoCo, as compiled code takes it: functions, model and data, and views of the data's arrays."""

    first: Any
    second: Any
    place: Any
    model: Any
    data: Any
    qpos: FloatArray
    qvel: FloatArray
    qfrc: FloatArray
    xpos: FloatArray
    xmat: FloatArray
    cvel: FloatArray
    com: FloatArray


class Ground(NamedTuple):
    """What the wheels stand on."""

    ribbon: Ribbon
    edge: float
    """m from the centre line to where the ground ends."""
    friction: float
    lane: Lane


class Motion(NamedTuple):
    """What changes as the car moves, beside MuJoCo's own state, and room to work in."""

    state: FloatArray
    """Shape (STATE,)."""
    wheels: FloatArray
    """Shape (4, WHEEL_STATE)."""
    hull: FloatArray
    """Shape (n, 3): points of the hull; they never change."""
    box: FloatArray
    """Shape (4, 2)."""
    scratch: FloatArray
    """Shape (2, 16, 2)."""


@inlined
def step_once(
    engine: Engine,
    car: Any,
    axles: Any,
    ground: Ground,
    motion: Motion,
    steer: float,
    throttle: float,
    brake: float,
) -> None:
    """2 ms with these commands (rad, 0..1, 0..1)."""
    state = motion.state
    _steer_and_pedals(engine, car, axles, state, steer, throttle, brake)
    call(engine.first, engine.model, engine.data)
    qvel = engine.qvel
    qfrc = engine.qfrc
    m = engine.xmat[BODY]
    vx, vy, vz = qvel[0], qvel[1], qvel[2]
    speed = vx * m[0] + vy * m[3] + vz * m[6]

    # The engine is limited by power; the ESC may take throttle away and brake single wheels.
    state[EXPECTED] = expected_yaw_rate(car, ground.friction, speed, state[STEER], state[EXPECTED], STEP)
    e0, e1, e2, e3, kept = stability(car, speed, qvel[5], state[EXPECTED])
    push = kept * state[THROTTLE] * min(car.launch * car.mass, car.power / max(speed, 1.0))
    stop = state[BRAKE] * car.brakes * car.mass

    drag = -0.5 * AIR * car.drag_area * math.sqrt(vx * vx + vy * vy + vz * vz)
    qfrc[0], qfrc[1], qfrc[2] = drag * vx, drag * vy, drag * vz
    qfrc[3] = qfrc[4] = qfrc[5] = 0.0
    state[SUPPORT] = 1.0
    for i in range(4):
        axle = axles[i // 2]
        extra = e0 if i == 0 else (e1 if i == 1 else (e2 if i == 2 else e3))
        turn = 0.5 * push * axle.drive_share * car.wheel_radius
        hold = 0.5 * stop * axle.brake_share * car.wheel_radius
        _wheel(i, engine, car, axle, ground, state, motion.wheels[i], turn, hold, extra)
    if state[SUPPORT] < 1.0 or m[8] < 0.95 or _lies_low(engine, car, ground, state):
        hull_forces(engine, car, ground, state[STATION], motion.hull)

    # MuJoCo wants the free body's moment in the body's own axes.
    mx, my, mz = qfrc[3], qfrc[4], qfrc[5]
    qfrc[3] = m[0] * mx + m[3] * my + m[6] * mz
    qfrc[4] = m[1] * mx + m[4] * my + m[7] * mz
    qfrc[5] = m[2] * mx + m[5] * my + m[8] * mz
    call(engine.second, engine.model, engine.data)


@inlined
def _steer_and_pedals(
    engine: Engine, car: Any, axles: Any, state: FloatArray, steer: float, throttle: float, brake: float
) -> None:
    steer = min(max(steer, -car.steer_limit), car.steer_limit)
    moved = min(max(steer - state[STEER], -car.steer_rate * STEP), car.steer_rate * STEP)
    for side in range(2):
        # The hinges are led: MuJoCo carries them on from `now` at this rate, and their armature holds them.
        now = _hinge_angle(car, axles[0], state[STEER], 1 - 2 * side)
        then = _hinge_angle(car, axles[0], state[STEER] + moved, 1 - 2 * side)
        engine.qpos[STEER_DOF[side] + 1] = now
        engine.qvel[STEER_DOF[side]] = (then - now) / STEP
    state[STEER] += moved
    state[THROTTLE] += (throttle - state[THROTTLE]) * STEP / (car.throttle_lag + STEP)
    state[BRAKE] += (brake - state[BRAKE]) * STEP / (car.brake_lag + STEP)


@inlined
def _hinge_angle(car: Any, axle: Any, steer: float, side: int) -> float:
    """rad of one wheel: all four axes of rotation meet in one point, as far as `ackermann` says."""
    tangent = math.tan(steer)
    return math.atan(tangent / (1.0 - side * car.ackermann * tangent * 0.5 * axle.track / car.wheelbase))


@inlined
def _wheel(
    i: int,
    engine: Engine,
    car: Any,
    axle: Any,
    ground: Ground,
    state: FloatArray,
    wheel: FloatArray,
    turn: float,
    hold: float,
    extra: float,
) -> None:
    """One wheel: tyre, spring, engine, brakes; adds to the generalised forces."""
    qfrc = engine.qfrc
    ribbon = ground.ribbon
    side = 1.0 - 2.0 * (i % 2)
    slide, spin = SLIDE_DOF[i], SPIN_DOF[i]
    centre = engine.xpos[WHEEL[i]]
    cx, cy, cz = centre[0], centre[1], centre[2]
    k = engine.xmat[CARRIER[i]]
    ax, ay, az = k[1], k[4], k[7]
    s, t, height, slope, heading = place_on(ribbon.table, ribbon.first, ribbon.step, cx, cy, wheel[AT])
    wheel[AT] = s
    nz = 1.0 / math.sqrt(1.0 + slope * slope)
    nx, ny = -slope * math.cos(heading) * nz, -slope * math.sin(heading) * nz
    gap = (cz - height) * nz
    over = min(ground.edge - abs(t), s + ground.edge, ribbon.length + ground.edge - s)
    share = min(max(over / car.tread + 0.5, 0.0), 1.0)
    state[SUPPORT] = min(state[SUPPORT], share)

    # Velocity of the contact point, as if the wheel did not spin.
    v = engine.cvel[CARRIER[i]]
    px, py, pz = cx - nx * gap, cy - ny * gap, cz - nz * gap
    rx, ry, rz = px - engine.com[BODY, 0], py - engine.com[BODY, 1], pz - engine.com[BODY, 2]
    ux, uy, uz = v[3] + v[1] * rz - v[2] * ry, v[4] + v[2] * rx - v[0] * rz, v[5] + v[0] * ry - v[1] * rx

    # Along the wheel: axle x normal; to its left: normal x along.
    lean = ax * nx + ay * ny + az * nz
    lx, ly, lz = ay * nz - az * ny, az * nx - ax * nz, ax * ny - ay * nx
    norm = 1.0 / max(math.sqrt(lx * lx + ly * ly + lz * lz), 0.05)
    lx, ly, lz = lx * norm, ly * norm, lz * norm
    wx, wy, wz = ny * lz - nz * ly, nz * lx - nx * lz, nx * ly - ny * lx

    depth = car.wheel_radius - gap * norm
    load = 0.0
    if depth > 0.0 and gap > -UNDER:
        load = share * (axle.tyre_spring * depth - axle.tyre_damper * (ux * nx + uy * ny + uz * nz))
    load = max(load, 0.0)
    out = engine.qpos[slide + 1]
    camber = math.asin(min(max(lean, -1.0), 1.0)) - side * axle.camber_gain * out
    forward = ux * lx + uy * ly + uz * lz
    fx, fy, wheel[SLIP_X], wheel[SLIP_Y] = tyre_forces(
        axle,
        ground.friction,
        load,
        camber,
        forward,
        ux * wx + uy * wy + uz * wz,
        engine.qvel[spin] * gap,
        wheel[SLIP_X],
        wheel[SLIP_Y],
        STEP,
    )
    wheel[LOAD], wheel[FX], wheel[FY] = load, fx, fy
    gx, gy, gz = fx * lx + fy * wx + load * nx, fx * ly + fy * wy + load * ny, fx * lz + fy * wz + load * nz

    # On the whole car: force, and moment about the body's centre.
    bx, by, bz = px - engine.xpos[BODY, 0], py - engine.xpos[BODY, 1], pz - engine.xpos[BODY, 2]
    qfrc[0] += gx
    qfrc[1] += gy
    qfrc[2] += gz
    qfrc[3] += by * gz - bz * gy
    qfrc[4] += bz * gx - bx * gz
    qfrc[5] += bx * gy - by * gx
    # Along the suspension: the tyre's force less spring, damper, bar and stops.
    m = engine.xmat[BODY]
    sy, sz = side * math.sin(axle.lean), math.cos(axle.lean)
    pushed = gx * (m[1] * sy + m[2] * sz) + gy * (m[4] * sy + m[5] * sz) + gz * (m[7] * sy + m[8] * sz)
    other = engine.qpos[SLIDE_DOF[i + 1 - 2 * (i % 2)] + 1]
    spring = axle.carried + axle.spring * out + axle.damper * engine.qvel[slide]
    spring += axle.anti_roll / (axle.track * axle.track) * (out - other)
    spring += car.bump_stop * (max(out - car.bump, 0.0) + min(out + car.bump, 0.0))
    qfrc[slide] = pushed - spring

    # About the wheel's axle: engine and tyre turn it, brakes and rolling resistance at most stop it.
    # The slip of the peak falls with the friction; the valves are taken to have found that out.
    grip = min(ground.friction, 1.0)
    wheel[ABS] = (
        valve(wheel[ABS], -wheel[SLIP_X], car.abs_slip * grip, STEP) if forward > SLOWEST_ABS else 1.0
    )
    wheel[TCS] = valve(wheel[TCS], wheel[SLIP_X], car.tcs_slip * grip, STEP)
    free = turn * wheel[TCS] - gap * (
        ax * (ny * gz - nz * gy) + ay * (nz * gx - nx * gz) + az * (nx * gy - ny * gx)
    )
    most = (hold + extra) * wheel[ABS] + axle.tyre_rolling_resistance * load * car.wheel_radius
    stops = -(car.wheel_inertia * engine.qvel[spin] / STEP + free)
    qfrc[spin] = free + min(max(stops, -most), most)


@inlined
def _lies_low(engine: Engine, car: Any, ground: Ground, state: FloatArray) -> bool:
    """Could the underbody touch the road?"""
    ribbon = ground.ribbon
    x, y, z = engine.xpos[BODY, 0], engine.xpos[BODY, 1], engine.xpos[BODY, 2]
    s, _, height, _, _ = place_on(ribbon.table, ribbon.first, ribbon.step, x, y, state[STATION])
    state[STATION] = s
    low: bool = z - height < car.height - 0.6 * car.clearance
    return low
