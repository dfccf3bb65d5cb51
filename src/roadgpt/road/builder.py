"""Builds a Road from a Design: lines, arcs and clothoids over parabolic grades, or RoadGPT's spline."""

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
        design: The blueprint.
        geometry: "arcs" keeps every distance, angle and radius. "spline" is RoadGPT's method: nodes at the
            ends of the segments, and a cubic spline through them.

    Raises:
        UsageError: Nodes of the spline coincide, or the road would be longer than 50 km.
    """
    if geometry == "spline":
        return Road.through(nodes_of(design))
    check_length(sum(segment.distance for segment in design.segments))
    x, y, z = design.starting_point
    plan = PieceCurve(x, y, math.radians(design.theta), joined(pieces_of(design.segments)))
    return Road(plan, elevation_of(design.segments, z))
