"""Builds a Road from a Design, either from lines, arcs, clothoids and parabolas, or from a spline."""

import math
from typing import Literal

from roadgpt.geometry import PieceCurve
from roadgpt.geometry.pieces import joined
from roadgpt.road.alignment import pieces_of
from roadgpt.road.design import Design
from roadgpt.road.elevation import elevation_of
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
