"""Vectors in space as tuples of three numbers, and the mechanics of a rigid body, for compiled code."""

import math
from typing import Any

from roadgpt.drive.compiled import inlined
from roadgpt.drive.drive import FloatArray
from roadgpt.drive.simulators.mujoco.model import BODY

Vector = tuple[float, float, float]


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
