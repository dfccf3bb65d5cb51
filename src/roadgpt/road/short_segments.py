"""Replaces the segments of a design by short straight ones, so that a spline preserves the bends of the
design.
"""

import math

import numpy as np

from roadgpt.geometry import wrap_angle
from roadgpt.road.builder import STUB, build
from roadgpt.road.design import Design, Direction, Segment

GROWS = 2  # segments with a reduced grade after the stub
MOST_HOPS = 500
HOP = 2.0  # m; a spline through points this dense keeps a radius of 14.8 m above SBFT's least, 14.33 m


def in_short_segments(design: Design) -> Design:
    """Returns a design of short straight segments that approximates the given design.

    If the new design is built with the geometry "spline", the road follows the lines, arcs and clothoids of
    the given design. The geometry "spline" puts a level stretch of 5 m at the start of the road. The grade is
    therefore built up over two segments after this stretch, so that the spline does not overshoot there. The
    reduced grade shifts the heights of the rest of the road by a constant.
    """
    road = build(design)
    first = min(STUB, road.length / 2)
    count = min(MOST_HOPS, max(2, math.ceil((road.length - first) / HOP)))
    ways = np.diff(road.at(np.linspace(first, road.length, count + 1)), axis=0)
    distances = np.hypot(ways[:, 0], ways[:, 1])
    headings = np.arctan2(ways[:, 1], ways[:, 0])
    turns = np.degrees(wrap_angle(np.diff(headings, prepend=math.radians(design.theta))))
    grown = np.minimum(1.0, np.arange(1, count + 1) / (GROWS + 1))
    inclines = 100 * grown * ways[:, 2] / distances
    hops = zip(distances.tolist(), turns.tolist(), inclines.tolist(), strict=True)
    segments = (_hop(distance, turn, incline) for distance, turn, incline in hops)
    return design.model_copy(update={"segments": tuple(segments)})


def _hop(distance: float, turn: float, incline: float) -> Segment:
    turn = round(turn, 5)
    direction: Direction = "left" if turn > 0 else "right" if turn < 0 else "straight"
    return Segment(
        distance=round(distance, 5), direction=direction, incline=round(incline, 4), turn_degrees=turn
    )
