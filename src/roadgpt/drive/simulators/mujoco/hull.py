"""Computes contact forces between the car's body and the road, at points of the hull.

These forces matter when wheels have left the road: the sill then rests on the road's edge, and the car slides
or overturns. Impacts are modelled as soft springs; their forces are not validated.
"""

import math
from typing import Any

import numpy as np

from roadgpt.drive.compiled import inlined
from roadgpt.drive.drive import FloatArray
from roadgpt.drive.sampled_road import locate_on, room_at
from roadgpt.drive.simulators.mujoco.car import Car
from roadgpt.drive.simulators.mujoco.model import BODY
from roadgpt.drive.simulators.mujoco.vectors import add_force, dot, normal_of, velocity_at

SPRING = 100e3  # N/m at each point
DAMPER = 6e3  # Ns/m
FRICTION = 0.5  # of sheet metal on a road of friction 1
SMOOTH = 0.2  # m/s of sliding at which that friction is reached
DEEP = 0.3  # m below the surface, beyond which a point has no contact any more


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
    world axes."""
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
        normal = normal_of(slope, lateral, heading)
        nx, ny, nz = normal
        depth = (height - pz) * nz
        if depth <= 0.0 or depth > DEEP or room_at(ground.rims, sampled.first, sampled.step, s, t) < 0.0:
            continue
        if s < -ground.beyond or s > sampled.length + ground.beyond:
            continue
        ux, uy, uz = velocity_at(mj, BODY, (px, py, pz))
        up = dot((ux, uy, uz), normal)
        force = max(SPRING * depth - DAMPER * up, 0.0)
        ux, uy, uz = ux - up * nx, uy - up * ny, uz - up * nz
        slide = math.sqrt(ux * ux + uy * uy + uz * uz)
        drag = -FRICTION * ground.friction * force / max(slide, SMOOTH)
        push = force * nx + drag * ux, force * ny + drag * uy, force * nz + drag * uz
        add_force(mj.qfrc, push, (bx, by, bz))
