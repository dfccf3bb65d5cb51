"""The 3D model of the car in images: a saloon of the simulated car's size, with wheels that roll and steer,
and with brake lights.

The model's coordinates are in metres. Their origin is on the ground below the middle of the car's length; x
points forward, y to the left and z up.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from roadgpt.export.ego import CAR
from roadgpt.geometry.curve import Array
from roadgpt.scene.body import body, lamps, trim, wheel
from roadgpt.scene.camera import CameraPose, Pose, axes_of
from roadgpt.scene.light import SUN, daylight
from roadgpt.scene.mesh import Mesh, joined, sphere_around
from roadgpt.scene.palette import BRAKE, GLOSS, PALETTE, SHINING

MIRRORED = 0.05  # share of light that paint and glass reflect at normal incidence (refractive index 1.5)


@dataclass(frozen=True, eq=False)
class Saloon:
    """The surface of the car in its rest position, and the points that rotate with each wheel."""

    mesh: Mesh
    """The triangles of the car; the attributes of each point are the components of its normal."""
    gloss: Array
    shade: Array
    """Fraction of the light, 0 to 1, that reaches each point; it is less than 1 near the ground and under the
    sills."""
    wheels: tuple[tuple[slice, Array, bool], ...]
    """For each wheel: the slice of its points, the position of its hub, and whether it steers."""

    def placed(self, pose: Pose, eye: CameraPose) -> Mesh:
        """Returns the mesh of a car at ``pose`` in world coordinates. The three attributes of a point
        are the light that the point reflects to the camera ``eye``, an unused number, and the brightness.
        """
        points, normals = self.mesh.points.copy(), self.mesh.attributes.copy()
        for part, hub, steers in self.wheels:
            turn = _turn(pose.wheel, pose.steer if steers else 0.0)
            points[part] = (points[part] - hub) @ turn.T + hub
            normals[part] = normals[part] @ turn.T
        axes = axes_of(pose.heading, pose.pitch, pose.roll)
        points[:, 0] += CAR.middle
        points[:, 2] -= CAR.gravity_height
        points = points @ axes + np.array([pose.x, pose.y, pose.z])
        normals = normals @ axes
        light = daylight(normals) * self.shade
        seen = np.stack([self._shine(points, normals, eye), light, light], axis=1)
        return self.mesh._replace(points=points, attributes=seen, spheres=sphere_around(points)[None])

    def _shine(self, points: Array, normals: Array, eye: CameraPose) -> Array:
        """Returns the light of sky, ground and sun that glossy points reflect."""
        away = eye.position - points
        away /= np.linalg.norm(away, axis=1, keepdims=True)
        facing = np.clip((away * normals).sum(axis=1), 0.0, 1.0)
        back = 2 * facing[:, None] * normals - away
        sky = np.clip(back[:, 2] * 4.0 + 0.5, 0.0, 1.0)
        seen = 0.10 + sky * (0.72 - 0.40 * np.clip(back[:, 2], 0.0, 1.0))
        sun = np.clip(back @ SUN, 0.0, 1.0) ** 40
        mirrored = MIRRORED + (1 - MIRRORED) * (1 - facing) ** 5
        return np.asarray(self.gloss * (mirrored * seen + 0.35 * sun))


def _turn(rolled: float, steer: float) -> Array:
    """Returns the rotation of a wheel that has rolled forward by one angle and is steered to the left by
    another."""
    c, s = np.cos(rolled), np.sin(rolled)
    roll: Array = np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
    c, s = np.cos(steer), np.sin(steer)
    return np.asarray(np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]) @ roll)


@cache
def saloon() -> Saloon:
    """Returns the car model; it is built at the first call and then reused."""
    parts = [*body(), *trim(), *lamps()]
    count = sum(len(part.points) for part in parts)
    wheels = []
    for ahead, steers in ((CAR.front_axle - CAR.middle, True), (CAR.rear_axle - CAR.middle, False)):
        for side in (-1.0, 1.0):
            hub = np.array([ahead, side * CAR.track / 2, CAR.wheel / 2])
            made = [part._replace(points=part.points + hub) for part in wheel(side)]
            size = sum(len(part.points) for part in made)
            wheels.append((slice(count, count + size), hub, steers))
            parts += made
            count += size
    mesh = Mesh.of([joined(parts)])
    gloss = np.concatenate([np.full(len(p.points), GLOSS.get(int(p.kinds[0]), 0.0)) for p in parts])
    shade = 0.45 + 0.55 * np.clip((mesh.points[:, 2] - 0.05) / 0.5, 0.0, 1.0)
    return Saloon(mesh, gloss, shade, tuple(wheels))


def palette_of(pose: Pose | None) -> NDArray[np.float64]:
    """Returns the colours of all surfaces without a pattern, ``(n, 6)`` as in PALETTE. The brake lights are
    on if the brake pedal is pressed in ``pose``; they are off if ``pose`` is None."""
    colours = PALETTE.copy()
    if pose is not None and pose.brake > BRAKE:
        for row, light in SHINING.items():
            colours[row, 3:] = light
    return np.asarray(colours)
