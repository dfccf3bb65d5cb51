"""Builds a Road from a Design, either from lines, arcs, clothoids and parabolas, or from a spline."""

import math
from collections.abc import Sequence
from typing import Literal

from roadgpt.geometry import GradeProfile, PieceCurve
from roadgpt.geometry.pieces import joined
from roadgpt.road.alignment import pieces_of
from roadgpt.road.design import Design, Segment, vertical_curves_of
from roadgpt.road.nodes import nodes_of
from roadgpt.road.road import Road, check_length

Geometry = Literal["arcs", "spline"]


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
    at = 0.0
    for segment in segments[:-1]:
        at += segment.distance
    stations.append(at + segments[-1].distance)
    values.append(grades[-1])
    return GradeProfile(z0, tuple(stations), tuple(values))
