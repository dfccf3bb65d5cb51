"""Converts a Design to the nodes of a spline, as in the RoadGPT thesis.

Each segment is treated as a straight line between two nodes; the spline through the nodes makes the road
smooth. Source: the thesis, section 5.3.2. Unlike the program of the thesis, this module does not shift roads
by (5, 5) m.
"""

import math

import numpy as np

from roadgpt.geometry.curve import Array
from roadgpt.road.design import Design

STUB = 5.0  # m, level, before the first segment, so that the car starts on level ground


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
        nodes.append(
            (
                x + distance * math.cos(heading),
                y + distance * math.sin(heading),
                z + distance * incline / 100,
            )
        )
    return np.array(nodes)
