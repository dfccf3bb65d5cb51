"""Computes the forces of the road on one tyre.

The model is the Magic Formula with the similarity method. The longitudinal and the lateral force each have
a pure-slip curve. Under combined slip, the direction of the normalised slip determines how the two forces
share the friction ellipse. Slips build up over a relaxation length. Source: H. B. Pacejka, Tyre and Vehicle
Dynamics, 3rd ed., sections 4.3.1, 7.2 and 8.6 (low speeds)."""

import math
from typing import Any

from roadgpt.compiled import inlined

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
