"""A second opinion on the competition's verdict: its published rules, written out the slow way.

Nothing of roadgpt is used here. Every pair of quads goes to shapely, one after another, as the competition's
own validator does it, so the cost grows with the square of the road's length. Source: the rules of the SBFT
Cyber-Physical Systems tool competition, 2024 edition (order, messages and quirks as its validator has them).
"""

import math
from itertools import pairwise

import numpy as np
from scipy.interpolate import splev, splprep
from shapely.geometry import LineString, Polygon, box

ROAD_WIDTH = 8.0  # m
FEET_PER_METRE = 3.280839895
TIGHTEST = 47.0  # ft
SHORTEST = 20.0  # m
MOST_POINTS = 500

Points = list[tuple[float, float]]


def verdict(road_points, map_size: float) -> tuple[bool, str]:
    """(is_valid, validation_message) of control points [[x, y], ...] on a square map.

    Raises:
        ValueError: from scipy, where two neighbouring points are the same (their code stops there).
        shapely.errors.GEOSException: where neighbouring interpolated nodes are the same (it stops there too).
    """
    if len(road_points) < 2:
        return False, "Not enough road points."
    if len(road_points) > MOST_POINTS:
        return False, "The road definition contains too many points"
    with np.errstate(invalid="ignore"):  # nodes that coincide make sides of NaN, which shapely remarks on
        return judged([(float(p[0]), float(p[1])) for p in road_points], map_size)


def judged(road_points: Points, map_size: float) -> tuple[bool, str]:
    """The rules after those on the number of points."""
    nodes = interpolated(road_points)
    left, right = sides(nodes)
    outside = False, "Not entirely inside the map boundaries"
    if not passes_for_inside(nodes, map_size):
        return outside
    if Polygon(left + right[::-1]).intersects(box(0, 0, map_size, map_size).boundary):
        return outside
    if not is_free_of_overlap(left, right):
        return False, "The road is self-intersecting"
    if LineString(interpolated(nodes)).length <= SHORTEST:
        return False, "The road is not long enough."
    if 0.0 < tightest_radius_in_feet(nodes) < TIGHTEST:
        return False, "The road is too sharp"
    return True, ""


def interpolated(points: Points) -> Points:
    """About one node per metre, at least 20, on the spline through the points; rounded to millimetres."""
    degree = {2: 1, 3: 2}.get(len(points), 3)
    spline, _ = splprep([[p[0] for p in points], [p[1] for p in points]], s=0, k=degree)
    step = 1 / max(20, int(LineString(points).length))
    x, y = splev(np.arange(0, 1 + step, step), spline)
    return [
        (float(round(a, 3)), float(round(b, 3))) for a, b in zip(x, y, strict=True)
    ]  # numpy rounds, not Python


def sides(nodes: Points) -> tuple[Points, Points]:
    """Left and right edge points; at the last node the look back swaps them."""
    pairs = [across(a, b) for a, b in pairwise(nodes)]
    last_right, last_left = across(nodes[-1], nodes[-2])
    return [p[0] for p in pairs] + [last_left], [p[1] for p in pairs] + [last_right]


def across(here: tuple[float, float], there: tuple[float, float]):
    """The edge points to the left and right of ``here``, looking towards ``there``."""
    dx, dy = there[0] - here[0], there[1] - here[1]
    size = math.sqrt(dx * dx + dy * dy)
    if size == 0:
        return (math.nan, math.nan), (math.nan, math.nan)
    vx, vy = dx / size * (ROAD_WIDTH / 2), dy / size * (ROAD_WIDTH / 2)
    return (here[0] - vy, here[1] + vx), (here[0] + vy, here[1] - vx)


def passes_for_inside(nodes: Points, map_size: float) -> bool:
    """The competition's test as its operators bind: 'and' before 'or', so a road far outside can pass."""
    lowest_x, highest_x = min(p[0] for p in nodes), max(p[0] for p in nodes)
    lowest_y, highest_y = min(p[1] for p in nodes), max(p[1] for p in nodes)
    return (
        lowest_x > 0
        or (lowest_x > map_size and highest_x > 0)
        or (highest_x > map_size and lowest_y > 0)
        or (lowest_y > map_size and highest_y > 0)
        or highest_y > map_size
    )


def is_free_of_overlap(left: Points, right: Points) -> bool:
    """Every quad valid; none in another; strangers apart; neighbours sharing exactly an edge."""
    quads = [Polygon([left[i], left[i + 1], right[i + 1], right[i]]) for i in range(len(left) - 1)]
    if not all(quad.is_valid for quad in quads):
        return False
    return all(may_stand(i, a, j, b) for i, a in enumerate(quads) for j, b in enumerate(quads) if i < j)


def may_stand(i: int, one: Polygon, j: int, other: Polygon) -> bool:
    """Do quads i < j of the road keep the rule for two quads? (It is the same both ways round.)"""
    if one == other:
        return True
    if one.contains(other) or other.contains(one):
        return False
    if j - i > 1:
        return not one.intersects(other)
    return isinstance(one.intersection(other), LineString)


def tightest_radius_in_feet(nodes: Points) -> float:
    """Least radius over nodes i, i+2, i+4, without the last window; 0 where no three nodes make a circle."""
    radii = [radius(nodes[i], nodes[i + 2], nodes[i + 4]) for i in range(len(nodes) - 5)]
    least = min(radii, default=math.inf)
    return 0.0 if math.isinf(least) else least * FEET_PER_METRE


def radius(a, b, c) -> float:
    """Of the circle through three points; infinite where they lie on a line (spanning less than 1e-6 m^2)."""
    (ax, ay), (bx, by), (cx, cy) = a, b, c
    square = bx * bx + by * by
    p, q = (ax * ax + ay * ay - square) / 2, (square - cx * cx - cy * cy) / 2
    area = (ax - bx) * (by - cy) - (bx - cx) * (ay - by)
    if abs(area) < 1e-6:
        return math.inf
    x = (p * (by - cy) - q * (ay - by)) / area
    y = ((ax - bx) * q - (bx - cx) * p) / area
    return math.sqrt((x - ax) ** 2 + (y - ay) ** 2)
