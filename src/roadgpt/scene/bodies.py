"""The others on the road in images: bodies of a few boxes."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from roadgpt.brief.scene import ActorKind
from roadgpt.scene.camera import axes_of
from roadgpt.scene.car import box
from roadgpt.scene.light import CONCRETE, GLASS, PAINT, RED, RIM, TAIL, TRIM, TYRE, WHITE, YELLOW, daylight
from roadgpt.scene.mesh import Mesh, Patch, attributes, joined


class Body(NamedTuple):
    """Somebody else on the road, in metres and radians; x, y and z are of the middle of its box on the
    ground."""

    kind: ActorKind
    size: tuple[float, float, float]
    x: float
    y: float
    z: float
    heading: float


LAMPS = (-0.503, -0.49, 0.25, 0.35, 0.96, TAIL)
WHEELS = (-0.4, 0.4, 0.0, 0.3, 0.94, TYRE)
TALL = ((-0.5, 0.5, 0.12, 1.0, 1.0, WHITE), (0.35, 0.503, 0.55, 0.85, 0.92, GLASS), WHEELS, LAMPS)
CYCLE = ((-0.5, 0.5, 0, 0.36, 0.2, TYRE), (-0.2, 0.2, 0.36, 0.86, 0.8, PAINT), (-0.1, 0.1, 0.86, 1, 0.3, RIM))
PERSON = ((-0.25, 0.25, 0, 0.48, 0.6, TRIM), (-0.3, 0.3, 0.48, 0.86, 1, RED), (-0.2, 0.2, 0.87, 1, 0.4, RIM))
DEER = ((-0.4, 0.25, 0, 0.5, 0.4, TRIM), (-0.5, 0.3, 0.45, 0.8, 1, TRIM), (0.2, 0.5, 0.75, 1, 0.4, TRIM))
PARTS: Mapping[ActorKind, tuple[tuple[float, ...], ...]] = {
    "car": ((-0.5, 0.5, 0.15, 0.62, 1.0, RIM), (-0.4, 0.22, 0.62, 1.0, 0.84, GLASS), WHEELS, LAMPS),
    "van": TALL,
    "truck": ((-0.5, 0.28, 0.3, 1.0, 1.0, WHITE), (0.32, 0.5, 0.15, 0.85, 0.98, RED), WHEELS, LAMPS),
    "bus": ((-0.5, 0.5, 0.1, 1.0, 1.0, YELLOW), (-0.48, 0.503, 0.5, 0.8, 1.01, GLASS), WHEELS, LAMPS),
    "motorcycle": CYCLE,
    "bicycle": CYCLE,
    "adult": PERSON,
    "child": PERSON,
    "animal": DEER,
    "cones": ((-0.3, 0.3, 0.0, 1.0, 0.6, RED), (-0.31, 0.31, 0.5, 0.75, 0.62, WHITE)),
    "barrier": ((-0.1, 0.1, 0.4, 1.0, 1.0, RED), (-0.11, 0.11, 0.6, 0.8, 1.01, WHITE)),
    "lost_load": ((-0.5, 0.5, 0.0, 1.0, 1.0, CONCRETE),),
}
"""Of each part: its rear and front, underside and top, as shares of the length and height, its share of the
width, and its colour."""
MOST_TRIANGLES = 12 * max(map(len, PARTS.values()))


def mesh_of(bodies: Sequence[Body]) -> Mesh:
    """Returns the mesh of the bodies, at least one."""
    patches = []
    for kind, size, *place, heading in bodies:
        faces: list[Patch] = []
        for rear, front, low, high, wide, colour in PARTS[kind]:
            middle, half = ((rear + front) / 2, 0.0, (low + high) / 2), (front - rear, wide, high - low)
            faces += box(np.array(middle) * size, np.array(half) * size / 2, int(colour))
        part, axes = joined(faces), axes_of(heading, 0.0, 0.0)
        light = daylight(part.attributes @ axes)
        seen = attributes(0.0, light, light)
        patches.append(part._replace(points=part.points @ axes + place, attributes=seen))
    return Mesh.of(patches)
