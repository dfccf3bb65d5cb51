"""Builds a Road from a Design, either from lines, arcs, clothoids and parabolas, or from a spline.

The spline is that of the RoadGPT thesis, section 5.3.2: each segment is treated as a straight line between
two nodes, and the spline through the nodes makes the road smooth. Unlike the program of the thesis, this
module does not shift roads by (5, 5) m.
"""

import math
from collections.abc import Sequence
from itertools import accumulate
from typing import Literal

import numpy as np

from roadgpt.geometry import GradeProfile, PieceCurve
from roadgpt.geometry.curve import Array
from roadgpt.geometry.pieces import joined
from roadgpt.road.alignment import pieces_of
from roadgpt.road.design import Design, Segment, vertical_curves_of
from roadgpt.road.road import Road, check_length

Geometry = Literal["arcs", "spline"]
STUB = 5.0  # m, level, before the first segment of a spline, so that the car starts on level ground


def build(design: Design, geometry: Geometry = "arcs") -> Road:
    """Returns the Road that a Design describes.

    Args:
        design: The segments of the road.
        geometry: "arcs" keeps the lengths, angles and radii of the design. "spline" is the method of the
            RoadGPT thesis: a cubic spline through nodes at the ends of the segments.

    Raises:
        UsageError: Two neighbouring nodes of the spline coincide, or the road would be longer than 50 km.
    """
    if geometry == "spline":
        return Road.through(nodes_of(design))
    check_length(sum(segment.distance for segment in design.segments))
    x, y, z = design.starting_point
    plan = PieceCurve(x, y, math.radians(design.theta), joined(pieces_of(design.segments)))
    return Road(plan, elevation_of(design.segments, z))


def elevation_of(segments: Sequence[Segment], z0: float) -> GradeProfile:
    """Returns the elevation profile of the segments of a Design, starting at height ``z0`` in metres.

    A vertical curve changes heights only within its own length. Elsewhere, heights are as if the grade
    changed abruptly between segments.
    """
    grades = [segment.incline / 100 for segment in segments]
    stations, values = [0.0], [grades[0]]
    for i, at, half, _ in vertical_curves_of(segments):
        stations += [at - half, at + half]
        values += [grades[i - 1], grades[i]]
    # not sum(), which rounds differently from Python 3.12 on
    stations += [*accumulate(segment.distance for segment in segments)][-1:]
    values.append(grades[-1])
    return GradeProfile(z0, tuple(stations), tuple(values))


def nodes_of(design: Design) -> Array:
    """Returns the nodes of the spline of a Design, ``(n, 3)`` in metres.

    The nodes are the start, the end of a level stretch of 5 m before the first segment, and the end of every
    segment.
    """
    nodes = [design.starting_point]
    heading = math.radians(design.theta)
    hops = [(STUB, 0.0, 0.0)] + [(s.distance, s.turn_degrees, s.incline) for s in design.segments]
    for distance, turn, incline in hops:
        heading += math.radians(turn)
        x, y, z = nodes[-1]
        across = (distance * math.cos(heading), distance * math.sin(heading))
        nodes.append((x + across[0], y + across[1], z + distance * incline / 100))
    return np.array(nodes)
