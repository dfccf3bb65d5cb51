"""The others on the road in images: bodies of a few boxes."""

from collections.abc import Mapping, Sequence

import numpy as np

from roadgpt.language.names import ActorKind
from roadgpt.language.table import ROAD_USERS
from roadgpt.scene.camera import axes_of
from roadgpt.scene.car import box
from roadgpt.scene.light import GLASS, PAINT, RED, RIM, TAIL, TRIM, TYRE, WHITE, daylight
from roadgpt.scene.mesh import Mesh, Patch, attributes, joined

Body = tuple[ActorKind, tuple[float, float, float], Sequence[float]]
"""The kind of somebody else on the road; length, width and height of its box in metres; x, y and z of the
middle of its box on the ground, and its heading."""
Parts = tuple[tuple[float, ...], ...]
ROLLS = ((-0.4, 0.4, 0, 0.3, 0.94, TYRE), (-0.503, -0.49, 0.25, 0.35, 0.96, TAIL))
CAR: Parts = ((-0.5, 0.5, 0.15, 0.62, 1, RIM), (-0.4, 0.22, 0.62, 1, 0.84, GLASS), *ROLLS)
TALL: Parts = ((-0.5, 0.5, 0.12, 1, 1, WHITE), (0.35, 0.503, 0.55, 0.85, 0.92, GLASS), *ROLLS)
CYCLE = ((-0.5, 0.5, 0, 0.36, 0.2, TYRE), (-0.2, 0.2, 0.36, 0.86, 0.8, PAINT), (-0.1, 0.1, 0.86, 1, 0.3, RIM))
PERSON = ((-0.25, 0.25, 0, 0.48, 0.6, TRIM), (-0.3, 0.3, 0.48, 0.86, 1, RED), (-0.2, 0.2, 0.87, 1, 0.4, RIM))
DEER = ((-0.4, 0.25, 0, 0.5, 0.4, TRIM), (-0.5, 0.3, 0.45, 0.8, 1, TRIM), (0.2, 0.5, 0.75, 1, 0.4, TRIM))
THING = ((-0.49, 0.49, 0, 1, 0.98, RED), (-0.5, 0.5, 0.5, 0.75, 1, WHITE))
SMALL = ((-0.4, 0.3, 0, 0.7, 0.5, TRIM), (-0.5, 0.5, 0.5, 0.9, 1, TRIM))
LOW = ((-0.5, 0.5, 0, 0.2, 0.4, TYRE), (-0.2, 0.2, 0.1, 0.86, 1, PAINT), (-0.1, 0.1, 0.87, 1, 0.4, RIM))
SEATED = ((-0.4, 0.4, 0, 0.4, 1, TYRE), (-0.3, 0.1, 0.35, 0.8, 0.7, RED), (-0.2, 0.1, 0.8, 1, 0.3, RIM))
PUSHING = (
    (-0.45, -0.15, 0, 0.48, 0.6, TRIM), (-0.45, -0.1, 0.48, 0.86, 1, RED), (-0.4, -0.2, 0.87, 1, 0.4, RIM),
    (0, 0.5, 0.1, 0.55, 0.9, PAINT),
)  # fmt: skip
FARM: Parts = ((-0.5, 0.5, 0.2, 0.6, 0.6, PAINT), (-0.45, 0, 0.6, 1, 0.6, GLASS), *ROLLS)
PARTS: Mapping[str, Parts] = {
    "car": CAR, "pickup": CAR, "van": TALL, "truck": TALL, "bus": TALL, "tractor": FARM, "motorcycle": CYCLE,
    "bicycle": CYCLE, "e_scooter": LOW, "person": PERSON, "wheelchair": SEATED, "pushchair": PUSHING,
    "animal": DEER, "dog": SMALL, "cones": THING, "barrier": THING, "lost_load": THING,
}  # fmt: skip
"""By look. Of each part: its rear and front, underside and top, as shares of the length and height, its share
of the width, and its colour."""


def mesh_of(bodies: Sequence[Body]) -> Mesh:
    """Returns the mesh of the bodies, at least one."""
    patches = []
    for kind, size, (*place, heading) in bodies:
        faces: list[Patch] = []
        for rear, front, low, high, wide, colour in PARTS[ROAD_USERS[kind].look]:
            middle, half = ((rear + front) / 2, 0.0, (low + high) / 2), (front - rear, wide, high - low)
            faces += box(np.array(middle) * size, np.array(half) * size / 2, int(colour))
        part, axes = joined(faces), axes_of(heading, 0.0, 0.0)
        light = daylight(part.attributes @ axes)
        seen = attributes(0.0, light, light)
        patches.append(part._replace(points=part.points @ axes + place, attributes=seen))
    return Mesh.of(patches)
