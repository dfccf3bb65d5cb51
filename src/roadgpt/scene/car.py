"""The 3D model of the car in images: a saloon of the simulated car's size, with a hull lofted through
cross-sections, a cabin with windows, wheels that roll and steer, and brake lights.

The model's coordinates are in metres. Their origin is on the ground below the middle of the car's length; x
points forward, y to the left and z up."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roadgpt.export.ego import CAR
from roadgpt.geometry.curve import Array
from roadgpt.scene.camera import CameraPose, Pose, axes_of
from roadgpt.scene.light import (
    BRAKE,
    GAP,
    GLASS,
    GLOSS,
    HEAD,
    HIGH,
    PAINT,
    PALETTE,
    PLATE,
    RIM,
    SHINING,
    SUN,
    TAIL,
    TRIM,
    TYRE,
    daylight,
)
from roadgpt.scene.mesh import Mesh, Patch, grid, joined, sphere_around

# Cross-sections from the tail to the nose: x; height of the underside, half width of the sill; half width and
# height where it is widest; of the shoulder; of the deck's edge; height of the deck's middle. All m.
SECTIONS = (
    (-2.350, 0.38, 0.60, 0.70, 0.52, 0.72, 0.66, 0.66, 0.74, 0.76),
    (-2.325, 0.30, 0.70, 0.80, 0.52, 0.79, 0.74, 0.72, 0.90, 0.92),
    (-2.270, 0.25, 0.77, 0.87, 0.54, 0.85, 0.82, 0.76, 0.985, 1.005),
    (-2.100, 0.22, 0.80, 0.905, 0.56, 0.88, 0.87, 0.78, 1.000, 1.025),
    (-1.750, 0.20, 0.82, 0.925, 0.58, 0.90, 0.91, 0.78, 1.000, 1.030),
    (-1.000, 0.19, 0.83, 0.930, 0.60, 0.905, 0.935, 0.80, 0.975, 0.990),
    (0.000, 0.18, 0.83, 0.925, 0.60, 0.900, 0.930, 0.80, 0.960, 0.970),
    (0.850, 0.18, 0.83, 0.925, 0.60, 0.895, 0.915, 0.80, 0.950, 0.985),
    (1.300, 0.19, 0.83, 0.925, 0.58, 0.885, 0.880, 0.78, 0.915, 0.960),
    (1.800, 0.20, 0.81, 0.910, 0.55, 0.860, 0.805, 0.74, 0.845, 0.890),
    (2.130, 0.22, 0.75, 0.860, 0.52, 0.800, 0.715, 0.66, 0.760, 0.800),
    (2.280, 0.26, 0.65, 0.745, 0.48, 0.690, 0.620, 0.54, 0.670, 0.695),
    (2.350, 0.34, 0.50, 0.570, 0.46, 0.520, 0.550, 0.38, 0.580, 0.590),
)
# m: half width and height of the cabin's foot; height of the roof's edge
SILL, BELT, ROOF = 0.80, 0.935, 1.385
NARROW = 0.575  # m, half width of the roof
FRONT, REAR = (1.02, 0.28), (-1.74, -1.02)  # m: windscreen and rear window, foot and top
CROWN = 0.055  # m that the roof's middle is higher than its edge
AROUND = 30  # corners of a wheel
OUTER, INNER = 0.155, -0.09  # m from the hub's middle outward: the tyre's faces
RIM_RADIUS, HUB_RADIUS = 0.232, 0.06  # m
SPOKE = 0.5  # of a fifth of the rim
MIRRORED = 0.05  # share of light that paint and glass reflect at normal incidence (refractive index 1.5)


def surface(net: Array, kind: int) -> Patch:
    """Returns a smooth surface through a grid of points ``(rows, columns, 3)``. Its normals point in the
    direction of the cross product a x b, where a is the direction of increasing row index and b the direction
    of increasing column index."""
    along, across = np.gradient(net, axis=0), np.gradient(net, axis=1)
    normals = np.cross(along, across)
    normals /= np.maximum(np.linalg.norm(normals, axis=-1, keepdims=True), 1e-12)
    return grid(net, normals, kind)


def body() -> Iterator[Patch]:
    """Yields the surfaces of the hull and the cabin."""
    rings = np.stack([_ring(*section) for section in SECTIONS])
    ends = [np.repeat(ring.mean(axis=0)[None], len(ring), axis=0) for ring in (rings[0], rings[-1])]
    yield surface(np.concatenate([ends[0][None], rings, ends[1][None]]), PAINT)
    yield from _cabin()


def _ring(x: float, *numbers: float) -> Array:
    half = np.column_stack([np.full(8, x), _half(*numbers)])
    return np.concatenate([half * [1, -1, 1], half[-2::-1]])


def _half(*numbers: float) -> Array:
    low, sill, wide, wide_z, shoulder, shoulder_z, deck, deck_z, middle = numbers
    side = [(0, low), (sill, low), (sill + 0.04, low + 0.12), (wide, wide_z), (shoulder, shoulder_z)]
    return np.array([*side, (deck, deck_z), (deck / 2, middle - 0.25 * (middle - deck_z)), (0, middle)])


def _cabin() -> Iterator[Patch]:
    (front_low, front_top), (rear_low, rear_top) = FRONT, REAR
    for side in (-1.0, 1.0):
        low = np.array([[rear_low, side * SILL, BELT], [front_low, side * SILL, BELT - 0.005]])
        top = np.array([[rear_top, side * NARROW, ROOF - 0.01], [front_top, side * NARROW, ROOF - 0.01]])
        along = [0.0, 0.10, 0.24, 0.27, 0.52, 0.56, 0.955, 1.0]
        glazed = {1, 3, 5}
        yield from _glazed(low, top, along, [0.0, 0.07, 0.90, 1.0], glazed, is_turned=side > 0)
    for foot, head, base, is_turned in ((front_low, front_top, 0.97, True), (rear_low, rear_top, 1.0, False)):
        low = np.array([[foot, SILL, BELT], [foot, -SILL, BELT]])
        low[:, 2] = base - 0.035
        top = np.array([[head, NARROW, ROOF], [head, -NARROW, ROOF]])
        yield from _glazed(low, top, [0.0, 0.055, 0.945, 1.0], [0.0, 0.04, 0.93, 1.0], {1}, is_turned)
    x = np.array([rear_top, -0.72, -0.35, 0.05, front_top])
    y = np.linspace(-NARROW, NARROW, 7)
    rise = CROWN * (1 - (np.abs(y) / NARROW) ** 2.5)[None] * np.array([0.1, 0.8, 1.0, 0.8, 0.1])[:, None]
    edge = ROOF + np.array([0.0, 0.012, 0.016, 0.010, 0.0])[:, None]
    yield surface(np.stack(np.broadcast_arrays(x[:, None], y[None], edge + rise), axis=-1), PAINT)


def _glazed(
    low: Array, top: Array, along: Sequence[float], up: Sequence[float], glazed: set[int], is_turned: bool
) -> Iterator[Patch]:
    """Yields the cells of a slightly curved wall between a lower and an upper edge.

    Args:
        low, top: the two ends of the lower and of the upper edge, shape (2, 3).
        along: shares (0 to 1) of the length of the edges at which the wall is divided.
        up: shares of the way from the lower to the upper edge at which the wall is divided.
        glazed: indices along the edges of the cells that are glass in the second row from below.
        is_turned: whether to reverse the direction in which the wall bulges and its front faces point."""
    a, b = np.array(along), np.array(up)
    foot = low[0] + a[:, None] * (low[1] - low[0])
    head = top[0] + a[:, None] * (top[1] - top[0])
    net = foot[:, None] + b[None, :, None] * (head - foot)[:, None]
    outward = np.cross(low[1] - low[0], top[0] - low[0]) * (-1 if is_turned else 1)
    bulge = 0.05 * np.sin(np.pi * a)[:, None, None] * np.sin(np.pi * b)[None, :, None]
    net = net + bulge * outward / np.linalg.norm(outward)
    whole = surface(net[::-1] if is_turned else net, PAINT)
    cells = len(a) - 1
    for i in range(cells):
        for j in range(len(b) - 1):
            row = cells - 1 - i if is_turned else i
            at = 2 * (row * (len(b) - 1) + j)
            kind = GLASS if i in glazed and j == 1 else PAINT
            triangles = whole.triangles[at : at + 2]
            used, where = np.unique(triangles, return_inverse=True)
            corners = where.reshape(2, 3)
            yield Patch(whole.points[used], whole.attributes[used], corners, np.full(2, kind, np.int64))


def trim() -> Iterator[Patch]:
    """Yields the bumpers, number plate, seams, grille, wheel arches and mirrors."""
    wide = np.array([-0.76, -0.7, -0.6, -0.3, 0.0, 0.3, 0.6, 0.7, 0.76])
    yield _on_hull(-0.97 * wide, (0.315, 0.36, 0.41), TRIM, -1)
    yield _on_hull(-wide, (0.672, 0.684), TRIM, -1)
    yield _on_hull(np.array([0.27, 0.0, -0.27]), (0.545, 0.65), PLATE, -1, 0.018)
    yield _on_hull(np.array([-0.4, -0.2, 0.0, 0.2, 0.4]), (0.45, 0.50, 0.55), TRIM, 1)
    yield _on_hull(0.75 * wide, (0.35, 0.38, 0.41), TRIM, 1)
    for ahead in (CAR.front_axle - CAR.middle, CAR.rear_axle - CAR.middle):
        for side in (-1.0, 1.0):
            yield _disc(ahead, side * 0.934, CAR.wheel / 2 + 0.01, 0.385, TRIM)
    for side in (-1.0, 1.0):
        yield from box(np.array([0.74, side * 0.985, 1.0]), np.array([0.09, 0.11, 0.065]), PAINT)


def lamps() -> Iterator[Patch]:
    """Yields tail lamps that reach around the rear corners, a third brake lamp in the rear window, and
    headlamps."""
    tail, head = np.array([0.40, 0.55, 0.70, 0.77, 0.82, 0.855]), np.array([0.46, 0.56, 0.66, 0.74, 0.80])
    for side in (-1.0, 1.0):
        yield _on_hull(np.sort(side * tail)[::-1], (0.71, 0.77, 0.83), TAIL, -1)
        yield _on_hull(np.sort(side * head), (0.575, 0.62, 0.665), HEAD, 1, 0.02)
    high = np.array([[-1.125, 0.2, 1.345], [-1.125, -0.2, 1.345]])
    yield surface(np.stack([high, high + [0.035, 0.0, 0.028]], axis=1), HIGH)


def _on_hull(across: Array, heights: tuple[float, ...], kind: int, end: int, lift: float = 0.012) -> Patch:
    """Returns a strip on the tail (end -1, from left to right) or on the nose (end 1, from right to left)."""
    x = np.linspace(SECTIONS[0][0], SECTIONS[-1][0], 4701)[::-end]
    table = np.array(SECTIONS)
    profiles = np.array([_half(*row[1:]) for row in table])
    n = np.clip(np.searchsorted(table[:, 0], x) - 1, 0, len(table) - 2)
    share = (x - table[n, 0]) / (table[n + 1, 0] - table[n, 0])
    y, z = np.moveaxis(profiles[n] + share[:, None, None] * (profiles[n + 1] - profiles[n]), -1, 0)[..., 1:]
    wide = np.empty((len(heights), len(x)))
    for row, height in enumerate(heights):
        rank = np.clip((z <= height).sum(axis=1), 1, z.shape[1] - 1)
        (y0, y1), (z0, z1) = (np.take_along_axis(v, rank[:, None] - [1, 0], axis=1).T for v in (y, z))
        between = y0 + (y1 - y0) / (z1 - z0) * np.maximum(height - z0, 0.0)
        wide[row] = np.where(height > z[:, -1], 0.0, between)
    at = (wide[:, None] >= np.abs(across)[None, :, None]).argmax(axis=-1)
    net = np.stack(np.broadcast_arrays(x[at].T + end * lift, across[:, None], np.array(heights)), axis=-1)
    return surface(net, kind)


def _disc(x: float, y: float, z: float, radius: float, kind: int) -> Patch:
    angle = np.linspace(0.0, 2 * np.pi, 25) * (-1 if y > 0 else 1)
    rim = np.column_stack([x + radius * np.cos(angle), np.full(25, y), z + radius * np.sin(angle)])
    rim[:, 2] = np.maximum(rim[:, 2], 0.18)
    middle = np.repeat([[x, y, z]], 25, axis=0)
    part = surface(np.stack([rim, middle], axis=1), kind)
    return part._replace(attributes=np.tile([0.0, np.sign(y), 0.0], (50, 1)))


def box(middle: Array, half: ArrayLike, kind: int) -> Iterator[Patch]:
    """Yields the faces of a box; the attributes of their points are normals."""
    for axis in range(3):
        for sign in (-1.0, 1.0):
            u, v, w = (np.eye(3)[(axis + k) % 3] * np.asarray(half) for k in range(3))
            corners = [middle + sign * u + a * v + b * w for a in (-1, 1) for b in (-1, 1)]
            net = np.array(corners).reshape(2, 2, 3)
            yield surface(net if sign > 0 else net[::-1], kind)


def wheel(side: float) -> Iterator[Patch]:
    """Yields the parts of a wheel around its hub; ``side`` is 1 for left wheels, -1 for right ones."""
    radius = CAR.wheel / 2
    yield _turned([(radius, INNER), (radius, OUTER - 0.03), (radius - 0.03, OUTER)], side, TYRE)
    yield _turned([(radius - 0.03, OUTER), (RIM_RADIUS, OUTER - 0.005)], side, TYRE)
    yield _turned([(RIM_RADIUS, OUTER - 0.005), (RIM_RADIUS - 0.022, OUTER + 0.004)], side, RIM)
    yield _turned([(RIM_RADIUS - 0.022, OUTER - 0.03), (0.0, OUTER - 0.03)], side, GAP)
    yield _turned([(HUB_RADIUS, OUTER + 0.004), (0.0, OUTER + 0.006)], side, RIM)
    for k in range(5):
        middle = 2 * np.pi * k / 5
        angles = middle + np.array([-1.0, 1.0]) * SPOKE * np.pi / 5
        inner = _circle(HUB_RADIUS, OUTER + 0.002, middle + np.array([-0.7, 0.7]), side)
        outer = _circle(RIM_RADIUS - 0.02, OUTER + 0.002, angles, side)
        yield surface(np.stack([outer, inner], axis=1), RIM)


def _turned(profile: list[tuple[float, float]], side: float, kind: int) -> Patch:
    """Returns the surface of revolution of a profile of (radius, distance outwards) about the axle."""
    angles = np.linspace(0.0, 2 * np.pi, AROUND + 1)
    return surface(np.stack([_circle(r, y, angles, side) for r, y in profile], axis=1), kind)


def _circle(radius: float, outward: float, angles: Array, side: float) -> Array:
    turned, aside = -angles * side, np.full(len(angles), side * outward)
    return np.column_stack([radius * np.cos(turned), aside, radius * np.sin(turned)])


@dataclass(frozen=True, eq=False)
class Saloon:
    """The surface of the car in its rest position, and the points that rotate with each wheel."""

    mesh: Mesh  # the triangles of the car; the attributes of each point are the components of its normal
    gloss: Array
    shade: Array
    """Fraction of the light, 0 to 1, that reaches each point; it is less than 1 near the ground and under the
    sills."""
    wheels: tuple[tuple[slice, Array, bool], ...]
    """For each wheel: the slice of its points, the position of its hub, and whether it steers."""

    def placed(self, pose: Pose, eye: CameraPose) -> Mesh:
        """Returns the mesh of a car at ``pose`` in world coordinates. The three attributes of a point
        are the light that the point reflects to the camera ``eye``, an unused number, and the brightness."""
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
