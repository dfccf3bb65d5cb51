"""Computes the forces of the road on one tyre.

The model is the Magic Formula with the similarity method: each axis has its own pure-slip curve, and combined
slips share the friction ellipse in the direction of the (normalised) slip. Slips build up over a relaxation
length. Source: H. B. Pacejka, Tyre and Vehicle Dynamics, 3rd ed., sections 4.3.1, 7.2 and 8.6 (low speeds).
"""

import math
from typing import Any

from roadgpt.drive.compiled import inlined

LOW_SPEED = 2.5  # m/s, below which a damper is added (Pacejka 8.6)
LOW_SPEED_DAMPING = 0.75  # Ns/m per N of load
MOST_SLIP = 3.0  # normalised, limit of the slip that a standing tyre's carcass may store


@inlined
def _curve(shape: float, bend: float, slip: float) -> float:
    """Returns the Magic Formula of height 1 and slope 1, over normalised slip."""
    b = slip / shape
    return math.sin(shape * math.atan(b - bend * (b - math.atan(b))))


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
        The force forward in N, the force to the left in N, and the new ``slip_x`` and ``slip_y``.
    """
    if load <= 0.0:
        return 0.0, 0.0, 0.0, 0.0
    speed = abs(forward)
    # Implicit integration of the slips makes the relaxation stable at every speed.
    way_x = dt / axle.tyre_relaxation_length_x
    way_y = dt / axle.tyre_relaxation_length_y
    slip_x = (slip_x + way_x * (rolling - forward)) / (1.0 + way_x * speed)
    slip_y = (slip_y - way_y * across) / (1.0 + way_y * speed)

    over = load / axle.nominal_load - 1.0
    fade = max(1.0 - axle.tyre_friction_load_sensitivity * over, 0.3)
    grip_x = friction * axle.tyre_peak_friction_x * fade
    grip_y = (
        friction * axle.tyre_peak_friction_y * fade * (1.0 - axle.tyre_camber_friction_loss * camber * camber)
    )
    soft = max(1.0 - axle.tyre_stiffness_load_sensitivity * over, 0.3)
    side = 1.0 if camber > 0.0 else (-1.0 if camber < 0.0 else 0.0)
    shift = side * axle.tyre_horizontal_shift + axle.tyre_camber_horizontal_shift * camber
    nx = slip_x * soft * axle.tyre_slip_stiffness / grip_x
    ny = (slip_y - shift) * soft * axle.tyre_cornering_stiffness / grip_y
    total = math.sqrt(nx * nx + ny * ny)
    if total < 1e-9:
        fx = 0.0
        fy = 0.0
    else:
        fx = (
            grip_x * load * _curve(axle.tyre_shape_factor_x, axle.tyre_curvature_factor_x, total) * nx / total
        )
        fy = (
            grip_y * load * _curve(axle.tyre_shape_factor_y, axle.tyre_curvature_factor_y, total) * ny / total
        )
        if total > MOST_SLIP and speed < LOW_SPEED:
            slip_x *= MOST_SLIP / total
            slip_y *= MOST_SLIP / total
    fy += load * (side * axle.tyre_vertical_shift + axle.tyre_camber_vertical_shift * camber)
    if speed < LOW_SPEED:
        damper = LOW_SPEED_DAMPING * load * 0.5 * (1.0 + math.cos(math.pi * speed / LOW_SPEED))
        hold = math.hypot(grip_x, grip_y) * load
        fx = min(max(fx + damper * (rolling - forward), -hold), hold)
        fy = min(max(fy - damper * across, -hold), hold)
    return fx, fy, slip_x, slip_y
