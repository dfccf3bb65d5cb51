"""Computes how much of the car lies outside its lane, by clipping two polygons exactly.

The strip between the edges of the driven lane is divided into quadrilaterals, and only those near the car's
own station count. Other sections of the same road that pass nearby, or cross above or below, are therefore
ignored.
"""

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from roadgpt.drive.compiled import compiled, inlined
from roadgpt.drive.drive import FloatArray

if TYPE_CHECKING:
    from roadgpt.road import Road, World

STEP = 0.5  # m, longest quad; a chord of that length is 2 mm off a 14 m arc
REACH = 8.0  # m along the road, ahead of and behind the car's station, within which its box must lie


class LanePolygon(NamedTuple):
    """The driven lane in plan, as a strip of quadrilaterals."""

    edges: FloatArray
    """Shape (n, 4): x and y of the left edge, x and y of the right edge, in metres."""
    step: float
    """Distance in metres along the centre line between rows of ``edges``."""

    @classmethod
    def along(cls, road: "Road", world: "World") -> "LanePolygon":
        """Returns the driven lane of a road, from its start to its end."""
        count = max(2, math.ceil(road.length / STEP))
        s = np.linspace(0.0, road.length, count + 1)
        sides = [np.asarray(road.at(s, t))[:, :2] for t in world.profile_of(road).lane(s)]
        edges = np.ascontiguousarray(np.hstack(sides), dtype=np.float64)
        return cls(edges, road.length / count)

    def outside(self, corners: FloatArray, s: float) -> float:
        """Returns the share of a box's area that is outside the lane, 0..1. The box is given by its four
        corners, shape (4, 2), counter-clockwise. Only the section of the lane near station s is considered.
        """
        box = np.ascontiguousarray(corners, dtype=np.float64)
        return share_outside(self.edges, self.step, box, float(s), np.empty((2, 16, 2)))


@inlined
def _clipped(scratch: FloatArray, source: int, count: int, px: float, py: float, qx: float, qy: float) -> int:
    """Clips the polygon in ``scratch[source]`` by the half-plane to the left of the line from p to q
    (Sutherland and Hodgman); writes its corners to ``scratch[1 - source]`` and returns their number."""
    kept = 0
    for k in range(count):
        x0, y0 = scratch[source, k, 0], scratch[source, k, 1]
        after = k + 1 if k + 1 < count else 0
        x1, y1 = scratch[source, after, 0], scratch[source, after, 1]
        d0 = (qx - px) * (y0 - py) - (qy - py) * (x0 - px)
        d1 = (qx - px) * (y1 - py) - (qy - py) * (x1 - px)
        if d0 >= 0.0:
            scratch[1 - source, kept, 0] = x0
            scratch[1 - source, kept, 1] = y0
            kept += 1
        if (d0 >= 0.0) != (d1 >= 0.0):
            share = d0 / (d0 - d1)
            scratch[1 - source, kept, 0] = x0 + share * (x1 - x0)
            scratch[1 - source, kept, 1] = y0 + share * (y1 - y0)
            kept += 1
    return kept


@inlined
def _with_overlap(area: float, box: FloatArray, a: FloatArray, b: FloatArray, scratch: FloatArray) -> float:
    """Returns ``area`` plus the area that the box shares with the quadrilateral between the rows a and b."""
    for k in range(4):
        scratch[0, k, 0], scratch[0, k, 1] = box[k, 0], box[k, 1]
    source, count = 0, 4
    # Counter-clockwise round the quad: right edge forward, across, left edge back, across.
    px, py = a[2], a[3]
    for qx, qy in ((b[2], b[3]), (b[0], b[1]), (a[0], a[1]), (a[2], a[3])):
        count = _clipped(scratch, source, count, px, py, qx, qy)
        source, px, py = 1 - source, qx, qy
        if count < 3:
            return area
    x0, y0 = scratch[source, 0, 0], scratch[source, 0, 1]
    for k in range(1, count - 1):  # a fan of triangles
        ax, ay = scratch[source, k, 0] - x0, scratch[source, k, 1] - y0
        bx, by = scratch[source, k + 1, 0] - x0, scratch[source, k + 1, 1] - y0
        area += 0.5 * (ax * by - ay * bx)
    return area


@compiled
def share_outside(edges: FloatArray, step: float, box: FloatArray, s: float, scratch: FloatArray) -> float:
    """Returns the share of the box's area that is outside the lane; ``scratch`` is working memory of shape
    (2, 16, 2).
    """
    whole = 0.0
    mid_x = 0.25 * (box[0, 0] + box[1, 0] + box[2, 0] + box[3, 0])
    mid_y = 0.25 * (box[0, 1] + box[1, 1] + box[2, 1] + box[3, 1])
    around = 0.0
    for k in range(4):
        after = (k + 1) % 4
        whole += 0.5 * (box[k, 0] * box[after, 1] - box[after, 0] * box[k, 1])
        around = max(around, math.hypot(box[k, 0] - mid_x, box[k, 1] - mid_y))
    if whole < 1e-3:
        return 1.0
    first = max(int((s - REACH) / step), 0)
    last = min(int((s + REACH) / step) + 1, edges.shape[0] - 1)
    inside = 0.0
    for i in range(first, last):
        a = edges[i]
        b = edges[i + 1]
        far = around + 0.5 * (math.hypot(a[0] - b[2], a[1] - b[3]) + step)
        if math.hypot(0.5 * (a[0] + b[2]) - mid_x, 0.5 * (a[1] + b[3]) - mid_y) <= far:
            inside = _with_overlap(inside, box, a, b, scratch)
    share = 1.0 - inside / whole
    # If the box is wholly inside, only a rounding error is left.
    return min(share, 1.0) if share > 1e-9 else 0.0
