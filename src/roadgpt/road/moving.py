"""The same road elsewhere on the map."""

from dataclasses import replace

import numpy as np

from roadgpt.geometry import PieceCurve
from roadgpt.road.road import Road


def moved(road: Road, x: float, y: float) -> Road:
    """A road of pieces, or through nodes, so many metres farther along each axis."""
    shift = np.array([x, y])
    if road.nodes is not None:
        nodes = road.nodes + np.r_[shift, np.zeros(road.nodes.shape[1] - 2)]
        return Road.through(nodes, None if road.road_points is None else road.road_points + shift)
    assert isinstance(road.plan, PieceCurve)
    return Road(replace(road.plan, x=road.plan.x + x, y=road.plan.y + y), road.profile)
