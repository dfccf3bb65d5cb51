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

SPRING = 100e3  # N/m at each point
DAMPER = 6e3  # Ns/m
FRICTION = 0.5  # of sheet metal on a road of friction 1
SMOOTH = 0.2  # m/s of sliding at which that friction is reached
DEEP = 0.3  # m below the surface, beyond which a point has no contact any more


def hull_points(car: Car) -> FloatArray:
    """Returns points in the body's axes, shape (n, 3), metres: a grid on the underbody, and the corners of
    the roof."""
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
def normal_of(slope: float, lateral: float, heading: float) -> tuple[float, float, float]:
    """Returns the unit normal of a surface, given two slopes of the surface: one along a heading, and one
    at a right angle to the left of that heading."""
    nz = 1.0 / math.sqrt(1.0 + slope * slope + lateral * lateral)
    cos, sin = math.cos(heading), math.sin(heading)
    return (lateral * sin - slope * cos) * nz, -(slope * sin + lateral * cos) * nz, nz


@inlined
def hull_forces(mj: Any, car: Any, ground: Any, station: float, hull: FloatArray) -> None:
    """Adds the contact forces at the hull's points to the forces and moments on the body; moments are in
    world axes."""
    qfrc = mj.qfrc
    sampled = ground.sampled
    m = mj.xmat[BODY]
    v = mj.cvel[BODY]
    for j in range(hull.shape[0]):
        hx, hy, hz = hull[j, 0], hull[j, 1], hull[j, 2]
        bx = m[0] * hx + m[1] * hy + m[2] * hz
        by = m[3] * hx + m[4] * hy + m[5] * hz
        bz = m[6] * hx + m[7] * hy + m[8] * hz
        px, py, pz = mj.xpos[BODY, 0] + bx, mj.xpos[BODY, 1] + by, mj.xpos[BODY, 2] + bz
        s, t, height, slope, lateral, heading = locate_on(
            sampled.table, sampled.first, sampled.step, px, py, station + hx
        )
        nx, ny, nz = normal_of(slope, lateral, heading)
        depth = (height - pz) * nz
        if depth <= 0.0 or depth > DEEP or room_at(ground.rims, sampled.first, sampled.step, s, t) < 0.0:
            continue
        if s < -ground.beyond or s > sampled.length + ground.beyond:
            continue
        rx, ry, rz = px - mj.com[BODY, 0], py - mj.com[BODY, 1], pz - mj.com[BODY, 2]
        ux, uy, uz = v[3] + v[1] * rz - v[2] * ry, v[4] + v[2] * rx - v[0] * rz, v[5] + v[0] * ry - v[1] * rx
        up = ux * nx + uy * ny + uz * nz
        force = max(SPRING * depth - DAMPER * up, 0.0)
        ux, uy, uz = ux - up * nx, uy - up * ny, uz - up * nz
        slide = math.sqrt(ux * ux + uy * uy + uz * uz)
        drag = -FRICTION * ground.friction * force / max(slide, SMOOTH)
        fx, fy, fz = force * nx + drag * ux, force * ny + drag * uy, force * nz + drag * uz
        qfrc[0] += fx
        qfrc[1] += fy
        qfrc[2] += fz
        qfrc[3] += by * fz - bz * fy
        qfrc[4] += bz * fx - bx * fz
        qfrc[5] += bx * fy - by * fx
