"""Moves a road to another place on the map."""

from dataclasses import replace

import numpy as np

from roadgpt.geometry import CubicProfile, ElevationProfile, GradeProfile, PieceCurve
from roadgpt.road.road import Road


def moved(road: Road, x: float, y: float, z: float = 0.0) -> Road:
    """Returns a road shifted by the given distances in metres along each axis.

    The road must consist of lines, arcs and clothoids, or be a spline through nodes. If the nodes have no
    heights, ``z`` is ignored.
    """
    shift = np.array([x, y])
    if road.nodes is not None:
        nodes = road.nodes + np.array([x, y, z])[: road.nodes.shape[1]]
        control = None if road.road_points is None else road.road_points + shift
        return Road.through(nodes, control).with_profile(road.profile)
    assert isinstance(road.plan, PieceCurve)
    plan = replace(road.plan, x=road.plan.x + x, y=road.plan.y + y)
    return Road(plan, _lifted(road.elevation, z) if z else road.elevation, profile=road.profile)


def _lifted(profile: ElevationProfile, z: float) -> ElevationProfile:
    if isinstance(profile, GradeProfile):
        return replace(profile, z0=profile.z0 + z)
    assert isinstance(profile, CubicProfile)
    rows = tuple((a + z, b, c, d) for a, b, c, d in profile.coefficients)
    return replace(profile, coefficients=rows)
