"""Computes how far a car is outside its lane: the share of its box outside, and its reach beyond markings."""

import math
from typing import NamedTuple

import numpy as np

from roadgpt.compiled import compiled, inlined
from roadgpt.drive.drive import Box, Drive, FloatArray
from roadgpt.drive.sampled_road import CURVATURE, SampledRoad, locate_on, room_at, sample_road, stations_of
from roadgpt.geometry.curve import LEAST_STRETCH
from roadgpt.road import Road, World

STEP = 0.5  # m, longest quad; a chord of that length is 2 mm off a 14 m arc
REACH = 8.0  # m along the road, ahead of and behind the car's station, within which its box must lie
POSE = ("x", "y", "heading", "pitch", "roll", "s")
"""Columns of a Drive that give the pose of the car."""
ALONG = 9  # points along one side of the body; the error in bends is then at most 5 mm
SLACK = 0.1  # m, added to the extent across the lane that a bend and the car's roll cause


class LanePolygon(NamedTuple):
    """The driven lane in plan, as a strip of quadrilaterals.

    Only those near the car's own station count. Other sections of the same road that pass nearby, or cross
    above or below, are therefore ignored."""

    edges: FloatArray  # shape (n, 4): x and y of the left edge, x and y of the right edge, in metres
    step: float  # distance in metres along the centre line between rows of ``edges``

    @classmethod
    def along(cls, road: Road, world: World) -> "LanePolygon":
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
    (2, 16, 2)."""
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


class MarkingMonitor(NamedTuple):
    r"""How far a car reaches beyond the outer edges of the markings on both sides of its lane.

        left                    right          The result is positive beyond an edge and negative inside,
    |    ¦ ¦      lane           |¦            in metres across the lane.
    |    ¦ ¦  <- the car ->      |¦
         ¦ ¦                     |¦
           ^ outer edge            ^ outer edge

    It is measured either at the outer edges of the front tyres, where they touch the road (``for_tyres``), or
    along both lower edges of the body (``for_body``). Both take pitch and roll into account."""

    sampled: SampledRoad
    edges: FloatArray
    """Offsets of the outer edges of the left and the right marking, in metres to the left of the centre line.

    The shape is (n, 2), with one row for each row of the table in ``sampled``."""
    points: FloatArray
    """Points of the car, shape (n, 3): metres ahead, to the left and up, from its centre of gravity."""

    @classmethod
    def for_tyres(cls, road: Road, world: World, box: Box) -> "MarkingMonitor":
        """Returns a monitor for the outer edges of the front tyres."""
        side = box.tyres / 2
        points = [(box.axle, side, -box.height), (box.axle, -side, -box.height)]
        return cls._of(road, world, points)

    @classmethod
    def for_body(cls, road: Road, world: World, box: Box) -> "MarkingMonitor":
        """Returns a monitor for both sides of the car's body, corners included."""
        front, side = box.ahead + box.length / 2, box.width / 2
        way = np.linspace(front - box.length, front, ALONG)
        points = [(x, y, -box.under) for y in (-side, side) for x in way]
        return cls._of(road, world, points)

    @classmethod
    def _of(cls, road: Road, world: World, points: list[tuple[float, float, float]]) -> "MarkingMonitor":
        sampled = sample_road(road)
        edges = np.column_stack(world.profile_of(road).marking_limits(stations_of(sampled)))
        return cls(sampled, edges, np.array(points))

    def beyond(self, poses: FloatArray, floor: float = -math.inf) -> FloatArray:
        """Returns how far the car reaches beyond the outer edge of the nearer marking, in metres for each
        pose, shape (n,); negative inside.

        ``poses`` has the columns POSE, shape (n, 6). Values below ``floor`` need not be exact, to save time
        when only the largest value matters."""
        table, first, step, _ = self.sampled
        poses = np.ascontiguousarray(poses, dtype=np.float64)
        return farthest(table, first, step, poses, self.points, self.edges, float(floor))

    def along(self, drive: Drive, floor: float = -math.inf) -> FloatArray:
        """Returns ``beyond`` for every step of a drive."""
        return self.beyond(np.stack([drive[name] for name in POSE], axis=-1), floor)


@compiled
def farthest(
    table: FloatArray,
    first: float,
    step: float,
    poses: FloatArray,
    points: FloatArray,
    edges: FloatArray,
    floor: float,
) -> FloatArray:
    """Computes the result of ``MarkingMonitor.beyond`` in compiled code."""
    found = np.empty(poses.shape[0])
    long = np.abs(points[:, 0]).max()
    wide = np.abs(points[:, 1]).max()
    tall = np.abs(points[:, 2]).max()
    bend = np.abs(table[:, CURVATURE]).max()
    for i in range(poses.shape[0]):
        x, y, heading = poses[i, 0], poses[i, 1], poses[i, 2]
        s, t, _, _, _, way = locate_on(table, first, step, x, y, poses[i, 5])
        reach = abs(math.sin(heading - way)) * long + abs(math.cos(heading - way)) * wide
        reach += abs(math.sin(poses[i, 4])) * tall + SLACK
        reach += 0.5 * (long * long + wide * wide) * bend / max(1.0 - bend * abs(t), LEAST_STRETCH)
        found[i] = reach - room_at(edges, first, step, s, t)
        if found[i] < floor:
            continue
        ch, sh = math.cos(heading), math.sin(heading)
        cp, sp = math.cos(poses[i, 3]), math.sin(poses[i, 3])
        cr, sr = math.cos(poses[i, 4]), math.sin(poses[i, 4])
        # The car's axes in plan: forward, to its left, and towards its roof.
        lx, ly = -cr * sh - sr * ch * sp, cr * ch - sr * sh * sp
        ux, uy = sr * sh - cr * ch * sp, -sr * ch - cr * sh * sp
        best = -math.inf
        for k in range(points.shape[0]):
            a, b, c = points[k, 0], points[k, 1], points[k, 2]
            px = x + ch * cp * a + lx * b + ux * c
            py = y + sh * cp * a + ly * b + uy * c
            at, across, _, _, _, _ = locate_on(table, first, step, px, py, s + a)
            best = max(best, -room_at(edges, first, step, at, across))
        found[i] = best
    return found
