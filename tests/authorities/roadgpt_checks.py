"""What RoadGPT itself accepts: its own checks, as its repositories are described, faults included.

Nothing of roadgpt is used here. The faults are kept on purpose, as they say what "accepted" meant in its
published figures:

* sharpness is looked at on control points, five at a time, so a road of up to five nodes is never checked;
* only the mean slope of blocks of ten nodes counts, and only uphill, so that falling by 60 % is accepted;
* the start is shifted by (5, 5), and a level stub of 5 m comes first;
* of "inside the map" the operators bind so that a road far outside passes that one test.

The map is 250 m wide, as the thesis says (the code has 1000 and its prompt 200).
"""

import math

import numpy as np
import shapely
from scipy.interpolate import splev, splprep

from authorities import sbft_official_slow as slow

MAP = 250.0  # m
SHIFT, STUB = 5.0, 5.0  # m
STEEPEST = 0.15  # ratio
BLOCK = 10  # nodes
LINE = 1  # shapely's number of the type LineString


def nodes_of(design) -> list[tuple[float, float, float]]:
    """Control points of a dictionary in RoadGPT's format."""
    x, y, z = (float(v) for v in design["starting_point"])
    x, y, heading = x + SHIFT, y + SHIFT, math.radians(design["theta"])
    nodes = [(x, y, z)]
    segments = [design[f"road_segment{i}"] for i in range(1, len(design) - 1)]
    stub = {"distance": STUB, "turn_degrees": 0, "incline": 0}
    for segment in [stub, *segments]:
        heading += math.radians(segment["turn_degrees"])
        x += segment["distance"] * math.cos(heading)
        y += segment["distance"] * math.sin(heading)
        z += segment["distance"] * segment["incline"] / 100
        nodes.append((x, y, z))
    return nodes


def verdict(design, map_size: float = MAP) -> str:
    """Why RoadGPT refuses a design; empty where it accepts it."""
    control = nodes_of(design)
    plan = [(x, y) for x, y, _ in control]
    nodes = slow.interpolated(plan)
    left, right = slow.sides(nodes)
    ribbon = shapely.Polygon(left + right[::-1])
    border = shapely.box(0, 0, map_size, map_size).boundary
    if not slow.passes_for_inside(nodes, map_size) or ribbon.intersects(border):
        return "outside"
    if not _is_free_of_overlap(left, right):
        return "overlap"
    if shapely.LineString(nodes).length <= slow.SHORTEST:
        return "short"
    if 0.0 < slow.tightest_radius_in_feet(plan) < slow.TIGHTEST:
        return "sharp"
    return "steep" if _is_too_steep(control) else ""


def _is_free_of_overlap(left, right) -> bool:
    corners = np.array([[left[i], left[i + 1], right[i + 1], right[i]] for i in range(len(left) - 1)])
    quads = shapely.polygons(corners)
    if not shapely.is_valid(quads).all():
        return False
    if (shapely.get_type_id(shapely.intersection(quads[:-1], quads[1:])) != LINE).any():
        return False
    one, other = shapely.STRtree(quads).query(quads, predicate="intersects")
    return not (np.abs(one - other) > 1).any()


def _is_too_steep(control) -> bool:
    """Mean slope of blocks of ten nodes; a fall is never too steep."""
    degree = {2: 1, 3: 2}.get(len(control), 3)
    points = np.array(control)
    spline, _ = splprep(points.T, s=0, k=degree)
    count = max(20, int(np.hypot(*np.diff(points[:, :2], axis=0).T).sum()))
    x, y, z = splev(np.linspace(0, 1, count + 1), spline)
    slopes = np.diff(z) / np.maximum(np.hypot(np.diff(x), np.diff(y)), 1e-9)
    return any(slopes[i : i + BLOCK].mean() > STEEPEST for i in range(0, len(slopes), BLOCK))
