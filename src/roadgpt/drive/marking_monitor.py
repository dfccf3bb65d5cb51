r"""Computes how far a car reaches beyond the outer edges of the markings on both sides of its lane.

    left                    right          The result is positive beyond an edge and negative inside,
|    ¦ ¦      lane           |¦            in metres across the lane.
|    ¦ ¦  <- the car ->      |¦
     ¦ ¦                     |¦
       ^ outer edge            ^ outer edge

A monitor measures either at the outer edges of the front tyres, where they touch the road (``for_tyres``), or
along both lower edges of the body (``for_body``). Both take pitch and roll into account.
"""

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from roadgpt.drive.compiled import compiled
from roadgpt.drive.drive import Box, FloatArray
from roadgpt.drive.sampled_road import (
    CURVATURE,
    SampledRoad,
    locate_on,
    room_at,
    sample_road,
    stations_of,
)

if TYPE_CHECKING:
    from roadgpt.drive.drive import Drive
    from roadgpt.road import Road, World

POSE = ("x", "y", "heading", "pitch", "roll", "s")
"""Columns of a Drive that give the pose of the car."""
ALONG = 9  # points along one side of the body; the error in bends is then at most 5 mm
SLACK = 0.1  # m, added to the extent across the lane that a bend and the car's roll cause
LEAST_STRETCH = 0.2  # lower bound of the metres on the inside of a bend per metre of road


class MarkingMonitor(NamedTuple):
    """The markings of the driven lane of one road, and the points of a car whose distance to these
    markings is computed."""

    sampled: SampledRoad
    edges: FloatArray
    """Offsets of the outer edges of the left and the right marking, in metres to the left of the centre line.

    The shape is (n, 2), with one row for each row of the table in ``sampled``.
    """
    points: FloatArray
    """Points of the car, shape (n, 3): metres ahead, to the left and up, from its centre of gravity."""

    @classmethod
    def for_tyres(cls, road: "Road", world: "World", box: Box) -> "MarkingMonitor":
        """Returns a monitor for the outer edges of the front tyres."""
        side = box.tyres / 2
        points = [(box.axle, side, -box.height), (box.axle, -side, -box.height)]
        return cls._of(road, world, points)

    @classmethod
    def for_body(cls, road: "Road", world: "World", box: Box) -> "MarkingMonitor":
        """Returns a monitor for both sides of the car's body, corners included."""
        front, side = box.ahead + box.length / 2, box.width / 2
        way = np.linspace(front - box.length, front, ALONG)
        points = [(x, y, -box.under) for y in (-side, side) for x in way]
        return cls._of(road, world, points)

    @classmethod
    def _of(cls, road: "Road", world: "World", points: list[tuple[float, float, float]]) -> "MarkingMonitor":
        sampled = sample_road(road)
        edges = np.column_stack(world.profile_of(road).marking_limits(stations_of(sampled)))
        return cls(sampled, edges, np.array(points))

    def beyond(self, poses: FloatArray, floor: float = -math.inf) -> FloatArray:
        """Returns how far the car reaches beyond the outer edge of the nearer marking, in metres for each
        pose, shape (n,); negative inside.

        Args:
            poses: shape (n, 6), with the columns POSE.
            floor: values below ``floor`` need not be exact; set it to save time when only the largest value
                matters.
        """
        table, first, step, _ = self.sampled
        poses = np.ascontiguousarray(poses, dtype=np.float64)
        return farthest(table, first, step, poses, self.points, self.edges, float(floor))

    def along(self, drive: "Drive", floor: float = -math.inf) -> FloatArray:
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
