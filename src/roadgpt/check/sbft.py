"""Reproduces the SBFT tool competition's road validator: the same rules, order and messages, but faster.

Source: the Cyber-Physical Systems tool competition's validator (2024). These quirks of the validator are
reproduced on purpose:

* the test for "inside the map" binds ``and`` before ``or``, so a road completely outside the map can pass;
* interpolation may add a node beyond the last point;
* quads of the road that touch count as crossing, unless they are neighbours;
* the length is measured on nodes that have been interpolated a second time;
* the radius is that of the circle through nodes i, i+2, i+4, and the last such triple of nodes is left out.

The competition's validator compares every pair of quads with the library shapely, one after another. Here
shapely compares at once those pairs whose bounding boxes meet."""

import math

import numpy as np
from numpy.typing import ArrayLike

from roadgpt.check.ribbon import Indices, is_convex, near_pairs, quads_of
from roadgpt.errors import UsageError
from roadgpt.geometry import interpolate, walked
from roadgpt.geometry.curve import Array

ROAD_WIDTH = 8.0  # m, of every competition road
FEET_PER_METRE = 3.280839895
MIN_RADIUS = 47.0  # ft
MIN_LENGTH = 20.0  # m
MAX_POINTS = 500
STRAIGHT = 1e-6  # m^2: three nodes that span less (twice the triangle's area) lie on a line
SPLINE_REACH = 1.5  # m by which the competition's spline may leave a road: a node 1 m too far, and rounding

TOO_FEW = "Not enough road points."
TOO_MANY = "The road definition contains too many points"
OUTSIDE = "Not entirely inside the map boundaries"
CROSSING = "The road is self-intersecting"
TOO_SHORT = "The road is not long enough."
TOO_SHARP = "The road is too sharp"


def sbft_verdict(points: ArrayLike, map_size: float) -> tuple[bool, str]:
    """Returns the competition validator's result ``(is_valid, validation_message)`` for control points ``(n,
    2)`` in metres and the side of the square map; further columns are ignored. Raises UsageError if two
    neighbouring points are the same or a number is not finite; the competition's code fails on such input
    too."""
    points = np.asarray(points, float)
    if len(points) < 2:
        return False, TOO_FEW
    if len(points) > MAX_POINTS:
        return False, TOO_MANY
    if not np.isfinite(points[:, :2]).all():
        raise UsageError("a number of the road points is not finite; give every point as two plain numbers")
    message = _complaint(interpolate(points[:, :2]), map_size)
    return not message, message


def _complaint(nodes: Array, map_size: float) -> str:
    left, right = edges(nodes)
    if not _passes_for_inside(nodes, map_size) or _meets_border(left, right, map_size):
        return OUTSIDE
    if not keeps_clear(quads_of(left, right)):
        return CROSSING
    apart = nodes[-1] - nodes[0]  # the road is no shorter than the distance between its ends
    if apart @ apart <= (MIN_LENGTH + 1) ** 2 and measured_length(nodes) <= MIN_LENGTH:
        return TOO_SHORT
    if smallest_radius(nodes)[0] * FEET_PER_METRE < MIN_RADIUS:
        return TOO_SHARP
    return ""


def splines(points: Array) -> tuple[Array, Array]:
    """Returns the nodes of the spline through control points ``(n, 2)``, for driving forwards and backwards.
    The two arrays ``(m, 2)`` contain different points, because nodes are spaced from the first control point
    in the direction of driving, and one extra node may lie beyond the last control point."""
    return interpolate(points), interpolate(points[::-1])


def edges(nodes: Array, road_width: float = ROAD_WIDTH) -> tuple[Array, Array]:
    """Returns the left and the right edge points ``(n, 2)`` of a road with nodes ``(n, 2)``, each at a right
    angle to the direction to the next node, and at the last node to that from the previous one."""
    ahead = np.diff(nodes, axis=0, append=nodes[-2:-1])
    with np.errstate(
        invalid="ignore"
    ):  # coinciding nodes have no direction: the NaN makes their quads invalid
        across = ahead / np.sqrt((ahead**2).sum(axis=1, keepdims=True)) * (road_width / 2)
    turned = np.stack((-across[:, 1], across[:, 0]), axis=1)
    turned[-1] *= -1
    return nodes + turned, nodes - turned


def _passes_for_inside(nodes: Array, map_size: float) -> bool:
    (min_x, min_y), (_, max_y), max_x = nodes.min(axis=0), nodes.max(axis=0), nodes[:, 0].max()
    # their condition, simplified: 0 < min_x or ... and 0 < max_x or ... and 0 < min_y or ...
    return bool(min_x > 0 or (max_x > map_size and min_y > 0) or max_y > map_size)


def _meets_border(left: Array, right: Array, map_size: float) -> bool:
    outline = np.concatenate((left, right[::-1]))
    if outline.min() > 0 and outline.max() < map_size:
        return False
    import shapely

    border = shapely.box(0, 0, map_size, map_size).boundary
    try:
        with np.errstate(invalid="ignore"):
            return bool(shapely.intersects(shapely.polygons(outline), border))
    except shapely.errors.GEOSException:  # a NaN: their code stops here, ours lets the check of quads fail
        return False


def keeps_clear(quads: Array) -> bool:
    """Returns whether all quads are valid, neighbouring quads share exactly one edge, and all other pairs
    of quads are disjoint."""
    import shapely

    plain = is_convex(quads)
    if not np.isfinite(quads[~plain]).all():
        return False
    shapes = shapely.polygons(quads)
    if not shapely.is_valid(shapes[~plain]).all():
        return False
    for i, j in near_pairs(quads, reach=0.0):
        differ = (quads[i] != quads[j]).any(axis=(1, 2))
        if shapely.intersects(shapes[i[differ]], shapes[j[differ]]).any():
            return False
    # Two convex clockwise neighbours lie on either side of their common side, and so meet in it alone.
    joints = np.flatnonzero(~(plain[:-1] & plain[1:]))
    return not joints.size or _share_a_side(quads, joints)


def _share_a_side(quads: Array, joints: Indices) -> bool:
    """Returns whether quads i and i + 1 share exactly one line for every joint i; ignores equal quads."""
    import shapely

    one, other = shapely.polygons(quads[joints]), shapely.polygons(quads[joints + 1])
    equal = (quads[joints] == quads[joints + 1]).all(axis=(1, 2))
    inside = shapely.contains(one, other) | shapely.contains(other, one)
    is_line = shapely.get_type_id(shapely.intersection(one, other)) == shapely.GeometryType.LINESTRING
    return bool((equal | (is_line & ~inside)).all())


def measured_length(nodes: Array) -> float:
    """Returns the length in metres of nodes ``(n, 2)``, interpolated a second time as in the competition."""
    return walked(interpolate(nodes))


def smallest_radius(nodes: Array) -> tuple[float, int]:
    """Returns the smallest radius in metres of the circles in ``radii(nodes)``, infinite if there is none,
    and the index of the middle one of the three nodes on the smallest circle."""
    found = radii(nodes)
    if not found.size:
        return math.inf, 0
    least = int(found.argmin())
    return float(found[least]), least + 2


def radii(nodes: Array) -> Array:
    """Returns radii ``(n - 5,)`` in metres of the circles through nodes i, i+2, i+4 of ``(n, 2)``; infinite
    where the three nodes are collinear."""
    a, b, c = nodes[:-5], nodes[2:-3], nodes[4:-1]
    (ax, ay), (bx, by), (cx, cy) = a.T, b.T, c.T
    square = bx * bx + by * by
    p, q = (ax * ax + ay * ay - square) / 2, (square - cx * cx - cy * cy) / 2
    area = (ax - bx) * (by - cy) - (bx - cx) * (ay - by)
    bends = np.abs(area) >= STRAIGHT
    area = np.where(bends, area, 1.0)
    x = (p * (by - cy) - q * (ay - by)) / area
    y = ((ax - bx) * q - (bx - cx) * p) / area
    return np.where(bends, np.sqrt((x - ax) ** 2 + (y - ay) ** 2), np.inf)
