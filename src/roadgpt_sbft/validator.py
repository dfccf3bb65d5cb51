"""Reproduces the SBFT tool competition's road validator: the same rules, order and messages, but faster. It
is the rule ``sbft``; the rule ``sbft_spline`` is about the road that the competition would build.

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
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roadgpt.brief.model import Brief
from roadgpt.check import Finding, ribbon
from roadgpt.check.extremes import tightest
from roadgpt.check.finding import single_road
from roadgpt.errors import UsageError
from roadgpt.geometry import interpolate, radii, walked
from roadgpt.network import Network
from roadgpt.road import Road, World

Array = NDArray[np.float64]

ROAD_WIDTH = 8.0  # m, of every competition road
FEET_PER_METRE = 3.280839895
MIN_RADIUS = 47.0  # ft
MIN_LENGTH = 20.0  # m
MAX_POINTS = 500
DOUBT = 1.0  # m: if the road is longer than its limit by more, the competition's measure agrees
ROUNDING = 1e-9  # of the least radius
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
    if not keeps_clear(left, right):
        return CROSSING
    apart = nodes[-1] - nodes[0]  # the road is no shorter than the distance between its ends
    if apart @ apart <= (MIN_LENGTH + 1) ** 2 and measured_length(nodes) <= MIN_LENGTH:
        return TOO_SHORT
    if smallest_radius(nodes)[0] * FEET_PER_METRE < MIN_RADIUS:
        return TOO_SHARP
    return ""


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


def keeps_clear(left: Array, right: Array) -> bool:
    """Returns whether all quads between edge points ``(n, 2)`` are valid, neighbouring quads share exactly
    one edge, and all other pairs of quads are disjoint."""
    import shapely

    quads = ribbon.quads_of(left, right)
    plain = ribbon.is_convex(quads)
    if not np.isfinite(quads[~plain]).all():
        return False
    shapes = shapely.polygons(quads)
    if not shapely.is_valid(shapes[~plain]).all():
        return False
    for i, j in ribbon.near_pairs(quads, reach=0.0):
        differ = (quads[i] != quads[j]).any(axis=(1, 2))
        if shapely.intersects(shapes[i[differ]], shapes[j[differ]]).any():
            return False
    # Two convex clockwise neighbours lie on either side of their common side, and so meet in it alone.
    joints = np.flatnonzero(~(plain[:-1] & plain[1:]))
    return not joints.size or _share_a_side(quads, joints)


def _share_a_side(quads: Array, joints: NDArray[np.intp]) -> bool:
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


def official(network: Network, route: Road | None, brief: Brief | None, world: World) -> tuple[Finding, ...]:
    """Requires the road to pass the competition's validator. Reports its message if it rejects the control
    points. A route through junctions never passes: the competition tests single roads."""
    road = single_road(route)
    if road is None:
        return (Finding("sbft", "the road leads through junctions, and SBFT tests are single roads"),)
    try:
        is_valid, message = sbft_verdict(road.control_points(), world.site.map_size)
    except UsageError as error:  # two points coincide in plan: the competition's code stops
        is_valid, message = False, str(error)
    return () if is_valid else (Finding("sbft", message),)


def spline(network: Network, route: Road | None, brief: Brief | None, world: World) -> tuple[Finding, ...]:
    """Requires a single road to keep the limits of length, map, radius and overlap also as the competition
    builds it: as a spline through the control points, which cuts corners between them, and may run up to a
    metre beyond the last one, driven forwards and backwards. Reports only what the road itself keeps: the
    rules ``too_short``, ``inside_map``, ``too_tight`` and ``no_overlap`` say the rest."""
    road = single_road(route)
    if road is None:
        return ()
    points = road.control_points()
    ways = interpolate(points), interpolate(points[::-1])  # nodes are spaced from the first point on
    rows = [edges(nodes, world.section.road_width) for nodes in ways]
    found = (
        _too_short(road, ways[0], world.limits.min_length),
        _outside(network, road, ways, rows, world.site.map_size),
        _too_tight(road, ways[0], world.limits.min_radius),
        _touching(network, road, rows, world),
    )
    return tuple(each for each in found if each is not None)


def _too_short(road: Road, nodes: Array, limit: float) -> Finding | None:
    if not limit < road.length <= limit + DOUBT or (length := measured_length(nodes)) > limit:
        return None
    said = f"the road is {length:.1f} m long, as SBFT measures it, and a road is longer than {limit:g} m"
    return Finding("sbft_spline", said)


def _outside(
    network: Network, road: Road, ways: Sequence[Array], rows: Sequence[tuple[Array, Array]], size: float
) -> Finding | None:
    sides = np.concatenate([np.stack(row, axis=1) for row in rows])
    if sides.min() > 0 and sides.max() < size:
        return None
    samples = road.sample()
    low, high = ribbon.extent(samples, network.roads[0].profile.edges(samples.s))
    if not 0 < min(low.min(), size - high.max()) <= SPLINE_REACH:
        return None
    node = int(np.any((sides <= 0) | (sides >= size), axis=(1, 2)).argmax())
    x, y = (float(v) for v in np.concatenate(ways)[node])
    said = f"near ({x:.0f}, {y:.0f}): with SBFT's spline the road leaves the map; keep away from its border"
    return Finding("sbft_spline", said, float(road.locate(x, y)[0]), x, y)


def _too_tight(road: Road, nodes: Array, limit: float) -> Finding | None:
    radius, middle = smallest_radius(nodes)
    if radius >= limit or abs(tightest(road)[1]) * limit > 1 + ROUNDING:
        return None
    x, y = (float(v) for v in nodes[middle])
    s = float(road.locate(x, y)[0])
    said = f"at s = {s:.0f} m: radius {radius:.1f} m, as SBFT measures it on its spline, is tighter than "
    return Finding("sbft_spline", f"{said}{limit:.4g} m", s, x, y)


def _touching(
    network: Network, road: Road, rows: Sequence[tuple[Array, Array]], world: World
) -> Finding | None:
    from roadgpt.check.rules.no_overlap import overlap_with_itself

    found, nearest, gap = overlap_with_itself(network.roads[0], world)
    if found is not None or gap >= SPLINE_REACH:  # far apart, or, in land, one above the other
        return None
    if all(keeps_clear(*row) for row in rows):
        return None
    samples = road.sample()
    s, x, y = (float(v[nearest]) for v in (samples.s, samples.x, samples.y))
    said = f"at s = {s:.0f} m, near ({x:.0f}, {y:.0f}): with SBFT's spline the road touches itself; move the "
    return Finding("sbft_spline", f"{said}two parts apart", s, x, y)
