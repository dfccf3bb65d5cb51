"""The inner loop: computes the forces on the car in steps of 2 ms, between MuJoCo's two half steps.

The forces are those of tyres, suspension, engine, brakes, air, and of the hull on the road; ABS, traction
control and a simple ESC stand between the driver's pedals and the wheels. The forces are passed to MuJoCo as
generalised forces (``qfrc_applied``), computed with formulas written for this one tree of bodies. The result
is the same as with forces on the wheel bodies, but takes a fraction of the computing time.

The tyre is the Magic Formula with the similarity method. The longitudinal and the lateral force each have a
pure-slip curve. Under combined slip, the direction of the normalised slip determines how the two forces share
the friction ellipse. Slips build up over a relaxation length. Source: H. B. Pacejka, Tyre and Vehicle
Dynamics, 3rd ed., sections 4.3.1, 7.2 and 8.6 (low speeds).

MuJoCo knows the rigid bodies of the car, with 16 degrees of freedom, no contacts, no constraints and no force
but gravity. The wheels are numbered left front, right front, left rear, right rear:

    body (6) --- slide along the suspension (4) --- steering hinge (2, front) --- wheel spin (4)"""

import math
from typing import Any, NamedTuple

import mujoco
import numpy as np

from roadgpt.compiled import COMPILES, call_at, inlined
from roadgpt.drive.drive import FloatArray
from roadgpt.drive.lane_position import LanePolygon
from roadgpt.drive.sampled_road import SampledRoad, locate_on, room_at
from roadgpt.drive.simulators.mujoco.car import Axle, Car
from roadgpt.road.speed_profile import GRAVITY

LOW_SPEED = 2.5  # m/s, below which a damper is added (Pacejka 8.6)
LOW_SPEED_DAMPING = 0.75  # Ns/m per N of load
MOST_SLIP = 3.0  # normalised, limit of the slip that a standing tyre's carcass may store


@inlined
def _curve(shape: float, bend: float, slip: float) -> float:
    """Returns the Magic Formula at a normalised slip; its height is 1, and its slope at the origin is 1."""
    b = slip / shape
    return math.sin(shape * math.atan(b - bend * (b - math.atan(b))))


@inlined
def _relaxed(slip: float, sliding: float, speed: float, length: float, dt: float) -> float:
    """Returns the slip after a time step, integrated implicitly, which is stable at every speed."""
    way = dt / length
    return (slip + way * sliding) / (1.0 + way * speed)


@inlined
def _peak_friction(axle: Any, friction: float, over: float, camber: float) -> tuple[float, float]:
    """Returns longitudinal and lateral peak friction; ``over`` is the load above the nominal one, as a share
    of it."""
    fade = max(1.0 - axle.tyre_friction_load_sensitivity * over, 0.3)
    loss = 1.0 - axle.tyre_camber_friction_loss * camber * camber
    return friction * axle.tyre_peak_friction_x * fade, friction * axle.tyre_peak_friction_y * fade * loss


@inlined
def _normalised_slips(
    axle: Any, over: float, slip_x: float, slip_y: float, peak_x: float, peak_y: float
) -> tuple[float, float, float]:
    """Returns the slips in units of (peak friction / slip stiffness): longitudinal, lateral, combined."""
    soft = max(1.0 - axle.tyre_stiffness_load_sensitivity * over, 0.3)
    nx = slip_x * soft * axle.tyre_slip_stiffness / peak_x
    ny = slip_y * soft * axle.tyre_cornering_stiffness / peak_y
    return nx, ny, math.sqrt(nx * nx + ny * ny)


@inlined
def _combined(
    axle: Any, most_x: float, most_y: float, nx: float, ny: float, total: float
) -> tuple[float, float]:
    """Returns the forces in N in the friction ellipse with the semi-axes ``most_x`` and ``most_y``."""
    if total < 1e-9:
        return 0.0, 0.0
    curve_x = _curve(axle.tyre_shape_factor_x, axle.tyre_curvature_factor_x, total)
    curve_y = _curve(axle.tyre_shape_factor_y, axle.tyre_curvature_factor_y, total)
    return most_x * curve_x * nx / total, most_y * curve_y * ny / total


@inlined
def tyre_forces(
    axle: Any,
    friction: float,
    load: float,
    camber: float,
    forward: float,
    across: float,
    rolling: float,
    slip_x: float,
    slip_y: float,
    dt: float,
) -> tuple[float, float, float, float]:
    """Returns the forces on the tyre in its longitudinal and lateral direction, and its slips after a time
    step.

    Args:
        axle: record with the tyre's parameters and its nominal load.
        friction: friction of the road.
        load: vertical load in N.
        camber: camber angle in rad, positive if the top leans to the right.
        forward: speed of the contact point along the wheel in m/s.
        across: speed of the contact point to the left in m/s.
        rolling: angular speed of the wheel times its radius, in m/s.
        slip_x: longitudinal slip one step before (positive: the tyre's force points forward).
        slip_y: lateral slip one step before (positive: the tyre's force points to the left).
        dt: length of the time step in s.

    Returns:
        The force forward in N, the force to the left in N, and the new ``slip_x`` and ``slip_y``."""
    if load <= 0.0:
        return 0.0, 0.0, 0.0, 0.0
    speed = abs(forward)
    slip_x = _relaxed(slip_x, rolling - forward, speed, axle.tyre_relaxation_length_x, dt)
    slip_y = _relaxed(slip_y, -across, speed, axle.tyre_relaxation_length_y, dt)
    over = load / axle.nominal_load - 1.0
    side = 1.0 if camber > 0.0 else (-1.0 if camber < 0.0 else 0.0)
    shift = side * axle.tyre_horizontal_shift + axle.tyre_camber_horizontal_shift * camber
    peak_x, peak_y = _peak_friction(axle, friction, over, camber)
    nx, ny, total = _normalised_slips(axle, over, slip_x, slip_y - shift, peak_x, peak_y)
    fx, fy = _combined(axle, peak_x * load, peak_y * load, nx, ny, total)
    if total > MOST_SLIP and speed < LOW_SPEED:
        slip_x *= MOST_SLIP / total
        slip_y *= MOST_SLIP / total
    fy += load * (side * axle.tyre_vertical_shift + axle.tyre_camber_vertical_shift * camber)
    if speed < LOW_SPEED:
        damper = LOW_SPEED_DAMPING * load * 0.5 * (1.0 + math.cos(math.pi * speed / LOW_SPEED))
        hold = math.hypot(peak_x, peak_y) * load
        fx = min(max(fx + damper * (rolling - forward), -hold), hold)
        fy = min(max(fy - damper * across, -hold), hold)
    return fx, fy, slip_x, slip_y


STEP = 0.002  # s
WHEELS = ("lf", "rf", "lr", "rr")
WHEEL_SHARE = 0.7  # of the unsprung mass rotates with the wheel; the rest only steers
# kg m^2 of armature that hold the steering hinges at the angles that the steering prescribes.
STIFF_HINGE = 1e5

# Indices into qvel (qpos has one number more, for the quaternion), in the order of the tree below.
SLIDE_DOF = (6, 9, 12, 14)
STEER_DOF = (7, 10)
SPIN_DOF = (8, 11, 13, 15)
# Numbers of the bodies.
BODY = 1
CARRIER = (2, 4, 6, 8)
WHEEL = (3, 5, 7, 9)

_DISABLED = """constraint equality frictionloss limit contact spring damper clampctrl warmstart actuation
    sensor eulerdamp autoreset"""


def model_of(car: Car) -> Any:
    """Returns the compiled MuJoCo model of the car, with the masses and positions of its body and wheels."""
    flags = " ".join(f'{name}="disable"' for name in _DISABLED.split())
    wheels = "".join(
        _wheel_body(car, axle, name, side)
        for axle, pair in ((car.front, WHEELS[:2]), (car.rear, WHEELS[2:]))
        for name, side in zip(pair, (1, -1), strict=True)
    )
    inertia = f"{car.roll_inertia} {car.pitch_inertia} {car.yaw_inertia}"
    return mujoco.MjModel.from_xml_string(f"""
    <mujoco>
      <compiler angle="radian" autolimits="false" balanceinertia="false"/>
      <option timestep="{STEP}" gravity="0 0 {-GRAVITY}" integrator="Euler" jacobian="dense">
        <flag {flags}/>
      </option>
      <worldbody>
        <body name="body">
          <freejoint/>
          <inertial pos="0 0 0" mass="{car.sprung_mass}" diaginertia="{inertia}"/>
          {wheels}
        </body>
      </worldbody>
    </mujoco>""")


def centre_height(car: Car, axle: Axle) -> float:
    """Returns the height in m of a wheel's centre above level ground, at rest."""
    return car.unloaded_radius - car.static_wheel_load(axle) / axle.tyre.vertical_stiffness


def _wheel_body(car: Car, axle: Axle, name: str, side: int) -> str:
    down = centre_height(car, axle) - car.cg_height
    lean = axle.inclination
    slide = f"0 {side * math.sin(lean)} {math.cos(lean)}"
    steer = f'<joint name="steer_{name}" axis="0 0 1" armature="{STIFF_HINGE}"/>' if axle is car.front else ""
    turning, carried = WHEEL_SHARE * axle.unsprung_mass, (1 - WHEEL_SHARE) * axle.unsprung_mass
    across = car.wheel_inertia / 2 + turning * car.tyre_width**2 / 12
    small = 0.01 * carried
    return f"""
      <body name="carrier_{name}" pos="{axle.position} {side * axle.track_width / 2} {down}">
        <joint name="slide_{name}" type="slide" axis="{slide}"/>{steer}
        <inertial pos="0 0 0" mass="{carried}" diaginertia="{small} {small} {small}"/>
        <body name="wheel_{name}">
          <joint name="spin_{name}" axis="0 1 0"/>
          <inertial pos="0 0 0" mass="{turning}" diaginertia="{across} {car.wheel_inertia} {across}"/>
        </body>
      </body>"""


AIR = 1.2  # kg/m^3, at 20 degrees C
UNDER = 0.25  # m below the surface of a road that floats, beyond which a wheel has no contact any more
SOLID = 5.0  # m, the same where land is below
BLURRED = 1.5  # cells of the land's grid beside a rim, in which its heights are mixed with those of the road
# The car's own state beside MuJoCo's, as indices into one array ...
STEER, THROTTLE, BRAKE, EXPECTED, STATION, SUPPORT, PAST_VX, PAST_VY = range(8)
STATE = 8
# ... and one row for each wheel.
SLIP_X, SLIP_Y, ABS, TCS, AT, LOAD, FX, FY = range(8)
WHEEL_STATE = 8
LETS_GO = 12.0  # 1/s, maximum rate at which a valve closes
COMES_BACK = 5.0  # 1/s, maximum rate at which it opens
SLOWEST_ABS = 1.5  # m/s, below which wheels may lock
SLOWEST_ESC = 5.0  # m/s, below which the ESC does nothing
TOLERANCE = 0.06  # rad/s of yaw rate error that the ESC ignores
TOLERANCE_SHARE = 0.10  # of the expected yaw rate, ignored on top of that
ESC_LAG = 0.12  # s, lag of the expected yaw rate behind the steering
ESC_MOST = 2500.0  # Nm at one wheel
CUT = 4.0  # s/rad, share of throttle removed per yaw rate error
FRICTION_USED = 0.95  # share of the friction that the expected yaw rate may need
SPRING = 100e3  # N/m at each point
DAMPER = 6e3  # Ns/m
FRICTION = 0.5  # of sheet metal on a road of friction 1
SMOOTH = 0.2  # m/s of sliding at which that friction is reached
DEEP = 0.3  # m below the surface, beyond which a point has no contact any more
Vector = tuple[float, float, float]


call: Any = call_at if COMPILES else lambda function, model, data: function(model, data)
"""Calls one of MuJoCo's functions: compiled code by its address, plain Python through the bindings."""


class MujocoHandles(NamedTuple):
    """What compiled code needs to use MuJoCo: its functions, the model and the data (all as ``call`` expects
    them), and array views into the data."""

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


class LandGrid(NamedTuple):
    """Heights of the land beside the road on a grid in metres; without any rows, there is nothing."""

    heights: FloatArray  # (rows, columns), roads included
    water: FloatArray  # heights of the surface of water, (rows, columns); far below where there is none
    x: float  # of the first column
    y: float  # of the first row
    cell: float
    slope: float  # largest of cuttings and fills, metres up for each metre aside
    crossings: FloatArray
    """Stations in m of the start and the end of each bridge and tunnel, and BRIDGE or TUNNEL, (n, 3)."""


BRIDGE, TUNNEL = 1.0, 2.0
ROOF, UNDERSIDE = 5.0, 1.5  # m above the road of a tunnel, and below that of a bridge, where land may be
NO_LAND = LandGrid(np.empty((0, 0)), np.empty((0, 0)), 0.0, 0.0, 1.0, 0.0, np.empty((0, 3)))


class DrivenGround(NamedTuple):
    """The surface under the wheels: a road or a plane, and the land around it."""

    sampled: SampledRoad
    rims: FloatArray
    """Offsets of the left and the right edge of the ground in m to the left of the centre line, shape (n, 2):
    one row for each row of the table in ``sampled``."""
    beyond: float  # length in m by which the ground continues before the start and after the end of the road
    friction: float
    lane: LanePolygon
    land: LandGrid = NO_LAND


class CarState(NamedTuple):
    """The state variables of the car that MuJoCo does not store, and working memory."""

    state: FloatArray  # state of the whole car, shape (STATE,)
    wheels: FloatArray  # state of each wheel, shape (4, WHEEL_STATE)
    hull: FloatArray  # points of the hull in the body's axes, shape (n, 3), metres
    box: FloatArray  # corners of the car's box in plan, shape (4, 2), metres
    scratch: FloatArray  # working memory for clipping polygons, shape (2, 16, 2)


@inlined
def step_once(
    mj: MujocoHandles,
    car: Any,
    axles: Any,
    ground: DrivenGround,
    car_state: CarState,
    steer: float,
    throttle: float,
    brake: float,
) -> None:
    """Simulates 2 ms with these commands: ``steer`` in rad, ``throttle`` and ``brake`` from 0 to 1."""
    state = car_state.state
    _steer_and_pedals(mj, car, axles, state, steer, throttle, brake)
    call(mj.first, mj.model, mj.data)
    qvel = mj.qvel
    qfrc = mj.qfrc
    m = mj.xmat[BODY]
    vx, vy, vz = qvel[0], qvel[1], qvel[2]
    speed = vx * m[0] + vy * m[3] + vz * m[6]

    # The engine is limited by power; the ESC may take throttle away and brake single wheels.
    state[EXPECTED] = expected_yaw_rate(car, ground.friction, speed, state[STEER], state[EXPECTED], STEP)
    e0, e1, e2, e3, kept = esc_torques(car, speed, qvel[5], state[EXPECTED])
    push = (
        kept * state[THROTTLE] * min(car.max_drive_acceleration * car.mass, car.max_power / max(speed, 1.0))
    )
    stop = state[BRAKE] * car.max_brake_deceleration * car.mass

    drag = -0.5 * AIR * car.drag_area * math.sqrt(vx * vx + vy * vy + vz * vz)
    qfrc[0], qfrc[1], qfrc[2] = drag * vx, drag * vy, drag * vz
    qfrc[3] = qfrc[4] = qfrc[5] = 0.0
    state[SUPPORT] = 1.0
    for i in range(4):
        axle = axles[i // 2]
        extra = e0 if i == 0 else (e1 if i == 1 else (e2 if i == 2 else e3))
        turn = 0.5 * push * axle.drive_torque_share * car.unloaded_radius
        hold = 0.5 * stop * axle.brake_torque_share * car.unloaded_radius
        _wheel(i, mj, car, axle, ground, state, car_state.wheels[i], turn, hold, extra)
    if state[SUPPORT] < 1.0 or m[8] < 0.95 or _lies_low(mj, car, ground, state):
        hull_forces(mj, car, ground, state[STATION], car_state.hull)

    # MuJoCo takes the free body's moment in the body's own axes.
    mx, my, mz = qfrc[3], qfrc[4], qfrc[5]
    qfrc[3] = m[0] * mx + m[3] * my + m[6] * mz
    qfrc[4] = m[1] * mx + m[4] * my + m[7] * mz
    qfrc[5] = m[2] * mx + m[5] * my + m[8] * mz
    call(mj.second, mj.model, mj.data)


@inlined
def _steer_and_pedals(
    mj: MujocoHandles, car: Any, axles: Any, state: FloatArray, steer: float, throttle: float, brake: float
) -> None:
    steer = min(max(steer, -car.max_steer_angle), car.max_steer_angle)
    moved = min(max(steer - state[STEER], -car.max_steer_rate * STEP), car.max_steer_rate * STEP)
    for side in range(2):
        # The hinges are prescribed: MuJoCo moves them from `now` at this rate, held by their armature.
        now = _hinge_angle(car, axles[0], state[STEER], 1 - 2 * side)
        then = _hinge_angle(car, axles[0], state[STEER] + moved, 1 - 2 * side)
        mj.qpos[STEER_DOF[side] + 1] = now
        mj.qvel[STEER_DOF[side]] = (then - now) / STEP
    state[STEER] += moved
    state[THROTTLE] += (throttle - state[THROTTLE]) * STEP / (car.throttle_time_constant + STEP)
    state[BRAKE] += (brake - state[BRAKE]) * STEP / (car.brake_time_constant + STEP)


@inlined
def _hinge_angle(car: Any, axle: Any, steer: float, side: int) -> float:
    """Returns the angle of one front wheel in rad, for the Ackermann fraction ``car.ackermann``."""
    tangent = math.tan(steer)
    return math.atan(
        tangent / (1.0 - side * car.ackermann * tangent * 0.5 * axle.track_width / car.wheelbase)
    )


@inlined
def beyond_rim(ground: DrivenGround, s: float, t: float) -> float:
    """Returns how far a point of the road's surface lies beyond its rim or its ends, in m; negative on it."""
    sampled = ground.sampled
    over = room_at(ground.rims, sampled.first, sampled.step, s, t)
    return -min(over, s + ground.beyond, sampled.length + ground.beyond - s)


@inlined
def crossing_at(land: LandGrid, s: float) -> float:
    """Returns BRIDGE or TUNNEL at a station, 0 elsewhere."""
    for n in range(land.crossings.shape[0]):
        if land.crossings[n, 0] <= s <= land.crossings[n, 1]:
            return BRIDGE if land.crossings[n, 2] == BRIDGE else TUNNEL
    return 0.0


@inlined
def is_over_land(land: LandGrid, s: float, z: float, road: float, beyond: float) -> bool:
    """Returns whether land, and not the road, is under a point at a height: beside the road, on the hill over
    a tunnel, and under a bridge. ``road`` is the height of the road's surface, continued to the point."""
    if land.heights.shape[0] == 0:
        return False
    crossing = crossing_at(land, s)
    if crossing == TUNNEL:
        return z > road + ROOF or beyond > ROOF
    return beyond > 0.0 or (crossing == BRIDGE and z < road - UNDERSIDE)


@inlined
def land_contact(
    land: LandGrid, x: float, y: float, s: float, road: float, slope: float, lateral: float, heading: float,
    beyond: float,
) -> tuple[float, Vector]:  # fmt: skip
    """Returns the height of the land at a point and its normal.

    Near the rim, ``beyond`` metres from it, cells of the grid reach over the road; there the slope begins at
    the height of the rim. ``road``, ``slope`` and ``lateral`` are the height and slopes of the road's
    surface, continued to the point."""
    u = min(max((x - land.x) / land.cell, 0.0), land.heights.shape[1] - 1.0)
    v = min(max((y - land.y) / land.cell, 0.0), land.heights.shape[0] - 1.0)
    i, j = min(int(u), land.heights.shape[1] - 2), min(int(v), land.heights.shape[0] - 2)
    u, v = u - i, v - j
    a, b = land.heights[j, i], land.heights[j, i + 1]
    c, d = land.heights[j + 1, i], land.heights[j + 1, i + 1]
    height = (a * (1.0 - u) + b * u) * (1.0 - v) + (c * (1.0 - u) + d * u) * v
    rise_x = ((b - a) * (1.0 - v) + (d - c) * v) / land.cell
    rise_y = ((c - a) * (1.0 - u) + (d - b) * u) / land.cell
    if beyond < BLURRED * land.cell and crossing_at(land, s) == 0.0:
        most = land.slope * beyond
        if abs(height - road) > most:
            height = road + most if height > road else road - most
            return height, normal_of(slope, lateral, heading)
    norm = 1.0 / math.sqrt(1.0 + rise_x * rise_x + rise_y * rise_y)
    return height, (-rise_x * norm, -rise_y * norm, norm)


@inlined
def _ground_contact(
    car: Any, ground: DrivenGround, wheel: FloatArray, centre: FloatArray
) -> tuple[Vector, float, float, float]:
    """Returns the normal of the ground under a wheel's centre, the distance of the centre from it in m, the
    share of the tyre's width, 0 to 1, that has ground under it, and how deep below its surface the ground
    still is."""
    sampled = ground.sampled
    s, t, height, slope, lateral, heading = locate_on(
        sampled.table, sampled.first, sampled.step, centre[0], centre[1], wheel[AT]
    )
    wheel[AT] = s
    normal = normal_of(slope, lateral, heading)
    beyond = beyond_rim(ground, s, t)
    if is_over_land(ground.land, s, centre[2], height, beyond):
        height, normal = land_contact(
            ground.land, centre[0], centre[1], s, height, slope, lateral, heading, beyond
        )
        return normal, (centre[2] - height) * normal[2], 1.0, SOLID
    share = min(max(-beyond / car.tyre_width + 0.5, 0.0), 1.0)
    if ground.land.heights.shape[0] > 0:
        return normal, (centre[2] - height) * normal[2], 1.0, SOLID
    return normal, (centre[2] - height) * normal[2], share, UNDER


@inlined
def _contact_axes(axis: Vector, normal: Vector) -> tuple[Vector, Vector, float]:
    """Returns unit vectors along the wheel and to its left, and the reciprocal of the camber's cosine, at
    most 20."""
    lx, ly, lz = cross(axis, normal)
    norm = 1.0 / max(math.sqrt(lx * lx + ly * ly + lz * lz), 0.05)
    along = lx * norm, ly * norm, lz * norm
    return along, cross(normal, along), norm


@inlined
def _wheel_load(axle: Any, share: float, depth: float, rate: float) -> float:
    """Returns the load in N on a wheel: a tyre cannot pull. ``depth`` is its compression in m, and ``rate``
    the speed in m/s at which the contact point moves away from the ground."""
    load: float = share * (axle.tyre_vertical_stiffness * depth - axle.tyre_vertical_damping * rate)
    return max(load, 0.0)


@inlined
def _suspension_force(i: int, mj: MujocoHandles, car: Any, axle: Any, force: Vector) -> float:
    """Returns in N the tyre's force along the suspension without spring, damper, anti-roll bar and bump
    stops."""
    slide, opposite = SLIDE_DOF[i], SLIDE_DOF[i + 1 - 2 * (i % 2)]
    out, other = mj.qpos[slide + 1], mj.qpos[opposite + 1]
    m = mj.xmat[BODY]
    sy, sz = (1.0 - 2.0 * (i % 2)) * math.sin(axle.inclination), math.cos(axle.inclination)
    strut = m[1] * sy + m[2] * sz, m[4] * sy + m[5] * sz, m[7] * sy + m[8] * sz
    spring: float = axle.sprung_load + axle.wheel_rate * out + axle.damping * mj.qvel[slide]
    spring += axle.anti_roll_stiffness / (axle.track_width * axle.track_width) * (out - other)
    spring += car.bump_stop_rate * (max(out - car.bump_travel, 0.0) + min(out + car.bump_travel, 0.0))
    return dot(force, strut) - spring


@inlined
def _set_valves(car: Any, friction: float, forward: float, wheel: FloatArray) -> None:
    """Updates the valves of ABS and traction control, which are assumed to know the road's friction: the slip
    at which a tyre reaches its peak friction decreases with it, and so do the thresholds."""
    grip = min(friction, 1.0)
    wheel[ABS] = (
        slip_valve(wheel[ABS], -wheel[SLIP_X], car.abs_slip_threshold * grip, STEP)
        if forward > SLOWEST_ABS
        else 1.0
    )
    wheel[TCS] = slip_valve(wheel[TCS], wheel[SLIP_X], car.tcs_slip_threshold * grip, STEP)


@inlined
def _spin_torque(car: Any, axle: Any, load: float, free: float, brake: float, rate: float) -> float:
    """Returns the torque about the wheel's axle in Nm: ``free`` (engine and tyre) turns the wheel; brakes and
    rolling resistance can only stop it. ``rate`` is the wheel's angular speed in rad/s."""
    most: float = brake + axle.tyre_rolling_resistance * load * car.unloaded_radius
    stops: float = -(car.wheel_inertia * rate / STEP + free)
    return free + min(max(stops, -most), most)


@inlined
def _wheel(
    i: int,
    mj: MujocoHandles,
    car: Any,
    axle: Any,
    ground: DrivenGround,
    state: FloatArray,
    wheel: FloatArray,
    turn: float,
    hold: float,
    extra: float,
) -> None:
    """Adds the forces of one wheel (tyre, suspension, engine and brakes) to the generalised forces."""
    spin = SPIN_DOF[i]
    centre, k = mj.xpos[WHEEL[i]], mj.xmat[CARRIER[i]]
    axis = k[1], k[4], k[7]
    normal, gap, share, under = _ground_contact(car, ground, wheel, centre)
    state[SUPPORT] = min(state[SUPPORT], share)
    px, py, pz = centre[0] - normal[0] * gap, centre[1] - normal[1] * gap, centre[2] - normal[2] * gap
    # The velocity that the contact point would have if the wheel did not spin.
    velocity = velocity_at(mj, CARRIER[i], (px, py, pz))
    along, left, norm = _contact_axes(axis, normal)
    depth = car.unloaded_radius - gap * norm
    touches = depth > 0.0 and gap > -under
    load = _wheel_load(axle, share, depth, dot(velocity, normal)) if touches else 0.0
    gain = (1.0 - 2.0 * (i % 2)) * axle.camber_gain
    camber = math.asin(min(max(dot(axis, normal), -1.0), 1.0)) - gain * mj.qpos[SLIDE_DOF[i] + 1]
    forward, rolling = dot(velocity, along), mj.qvel[spin] * gap
    fx, fy, wheel[SLIP_X], wheel[SLIP_Y] = tyre_forces(
        axle, ground.friction, load, camber, forward, dot(velocity, left), rolling,
        wheel[SLIP_X], wheel[SLIP_Y], STEP,
    )  # fmt: skip
    wheel[LOAD], wheel[FX], wheel[FY] = load, fx, fy
    force = (
        fx * along[0] + fy * left[0] + load * normal[0],
        fx * along[1] + fy * left[1] + load * normal[1],
        fx * along[2] + fy * left[2] + load * normal[2],
    )
    add_force(mj.qfrc, force, (px - mj.xpos[BODY, 0], py - mj.xpos[BODY, 1], pz - mj.xpos[BODY, 2]))
    mj.qfrc[SLIDE_DOF[i]] = _suspension_force(i, mj, car, axle, force)
    _set_valves(car, ground.friction, forward, wheel)
    free = turn * wheel[TCS] - gap * dot(axis, cross(normal, force))
    mj.qfrc[spin] = _spin_torque(car, axle, load, free, (hold + extra) * wheel[ABS], mj.qvel[spin])


@inlined
def _lies_low(mj: MujocoHandles, car: Any, ground: DrivenGround, state: FloatArray) -> bool:
    sampled = ground.sampled
    x, y, z = mj.xpos[BODY, 0], mj.xpos[BODY, 1], mj.xpos[BODY, 2]
    s, t, height, _, lateral, _ = locate_on(sampled.table, sampled.first, sampled.step, x, y, state[STATION])
    state[STATION] = s
    if ground.land.heights.shape[0] > 0 and beyond_rim(ground, s, t) > -2.0:
        return True  # some of the hull may be over land
    low: bool = (z - height) / math.sqrt(1.0 + lateral * lateral) < car.cg_height - 0.6 * car.ground_clearance
    return low


@inlined
def slip_valve(opening: float, slip: float, limit: float, dt: float) -> float:
    """Returns the share of the torque, 0 to 1, that ABS or traction control lets pass after a time step of
    ``dt`` seconds. ``opening`` is the share before the step; the share decreases while ``slip`` exceeds
    ``limit``."""
    if limit <= 0.0:
        return 1.0
    rate = 20.0 * (limit - slip) / limit
    rate = min(max(rate, -LETS_GO), COMES_BACK)
    return min(max(opening * (1.0 + rate * dt), 0.02), 1.0)


@inlined
def expected_yaw_rate(
    car: Any, friction: float, speed: float, steer: float, before: float, dt: float
) -> float:
    """Returns the yaw rate in rad/s that the ESC expects for the steering angle. The friction limits this yaw
    rate, and a lag delays it; ``before`` is the value one time step earlier."""
    wanted = speed * math.tan(steer) / (car.wheelbase + car.esc_understeer_gradient * speed * speed)
    most = FRICTION_USED * friction * GRAVITY / max(speed, 1.0)
    wanted = min(max(wanted, -most), most)
    now: float = before + (wanted - before) * dt / (ESC_LAG + dt)
    return now


@inlined
def esc_torques(
    car: Any, speed: float, yaw_rate: float, expected: float
) -> tuple[float, float, float, float, float]:
    """Returns the ESC's braking torques in Nm (left front, right front, left rear, right rear) and the share
    of the throttle, 0 to 1, that the ESC allows."""
    excess = yaw_rate - expected
    beyond = abs(excess) - TOLERANCE - TOLERANCE_SHARE * abs(expected)
    if car.esc_gain <= 0.0 or speed < SLOWEST_ESC or beyond <= 0.0:
        return 0.0, 0.0, 0.0, 0.0, 1.0
    torque = min(car.esc_gain * beyond, ESC_MOST)
    kept = max(1.0 - CUT * beyond, 0.0)
    turns_left = expected > 0.0 if abs(expected) > 0.02 else yaw_rate > 0.0
    too_far = excess > 0.0 if turns_left else excess < 0.0
    if too_far:  # oversteer: braking the outer front wheel turns the car back
        if turns_left:
            return 0.0, torque, 0.0, 0.0, kept
        return torque, 0.0, 0.0, 0.0, kept
    if turns_left:  # understeer: braking the inner rear wheel turns the car in
        return 0.0, 0.0, 0.5 * torque, 0.0, kept
    return 0.0, 0.0, 0.0, 0.5 * torque, kept


def hull_points(car: Car) -> FloatArray:
    """Returns the hull's points in the body's axes, shape (n, 3), metres: a grid on the underbody, and the
    roof's corners."""
    front = car.box_offset + car.length / 2
    floor = car.ground_clearance - car.cg_height
    under = [
        (x, y, floor)
        for x in np.linspace(front - car.length, front, 5)
        for y in np.linspace(-0.48, 0.48, 7) * car.width
    ]
    roof = [
        (x, y * car.width, car.overall_height - car.cg_height) for x in (-1.3, 0.5) for y in (-0.35, 0.35)
    ]
    return np.array(under + roof)


@inlined
def hull_forces(mj: Any, car: Any, ground: Any, station: float, hull: FloatArray) -> None:
    """Adds the contact forces at the hull's points to the forces and moments on the body; moments are in
    world axes.

    They matter when wheels have left the road: the sill then rests on the road's edge, and the car slides or
    overturns. Impacts are modelled as soft springs; their forces are not validated."""
    sampled = ground.sampled
    m = mj.xmat[BODY]
    for j in range(hull.shape[0]):
        hx, hy, hz = hull[j, 0], hull[j, 1], hull[j, 2]
        bx = m[0] * hx + m[1] * hy + m[2] * hz
        by = m[3] * hx + m[4] * hy + m[5] * hz
        bz = m[6] * hx + m[7] * hy + m[8] * hz
        px, py, pz = mj.xpos[BODY, 0] + bx, mj.xpos[BODY, 1] + by, mj.xpos[BODY, 2] + bz
        s, t, height, slope, lateral, heading = locate_on(
            sampled.table, sampled.first, sampled.step, px, py, station + hx
        )
        normal, beyond, deepest = normal_of(slope, lateral, heading), beyond_rim(ground, s, t), DEEP
        if ground.land.heights.shape[0] > 0:
            deepest = SOLID
            if is_over_land(ground.land, s, pz, height, beyond):
                height, normal = land_contact(ground.land, px, py, s, height, slope, lateral, heading, beyond)
        elif beyond > 0.0:
            continue
        nx, ny, nz = normal
        depth = (height - pz) * nz
        if depth <= 0.0 or depth > deepest:
            continue
        ux, uy, uz = velocity_at(mj, BODY, (px, py, pz))
        up = dot((ux, uy, uz), normal)
        force = max(SPRING * depth - DAMPER * up, 0.0)
        ux, uy, uz = ux - up * nx, uy - up * ny, uz - up * nz
        slide = math.sqrt(ux * ux + uy * uy + uz * uz)
        drag = -FRICTION * ground.friction * force / max(slide, SMOOTH)
        push = force * nx + drag * ux, force * ny + drag * uy, force * nz + drag * uz
        add_force(mj.qfrc, push, (bx, by, bz))


@inlined
def dot(a: Vector, b: Vector) -> float:
    """Returns the scalar product of two vectors."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inlined
def cross(a: Vector, b: Vector) -> Vector:
    """Returns the vector product of two vectors."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@inlined
def normal_of(slope: float, lateral: float, heading: float) -> Vector:
    """Returns the unit normal of a surface from its slope along a heading and its slope to the left of that
    heading."""
    nz = 1.0 / math.sqrt(1.0 + slope * slope + lateral * lateral)
    cos, sin = math.cos(heading), math.sin(heading)
    return (lateral * sin - slope * cos) * nz, -(slope * sin + lateral * cos) * nz, nz


@inlined
def velocity_at(mj: Any, body: int, point: Vector) -> Vector:
    """Returns the velocity in m/s of a point of a rigid body; ``point`` is in world coordinates."""
    # MuJoCo stores angular and linear velocity, the latter at the centre of gravity of the whole car.
    v = mj.cvel[body]
    rx, ry, rz = point[0] - mj.com[BODY, 0], point[1] - mj.com[BODY, 1], point[2] - mj.com[BODY, 2]
    return v[3] + v[1] * rz - v[2] * ry, v[4] + v[2] * rx - v[0] * rz, v[5] + v[0] * ry - v[1] * rx


@inlined
def add_force(qfrc: FloatArray, force: Vector, arm: Vector) -> None:
    """Adds a force in N, and its moment about the body's centre, to the generalised forces; ``arm`` is the
    vector in m from that centre to the point of application. The moment is in world axes."""
    moment = cross(arm, force)
    for k in range(3):
        qfrc[k] += force[k]
        qfrc[3 + k] += moment[k]
