"""Moves a road to another place on the map, and reverses its direction."""

import math
from dataclasses import replace

import numpy as np

from roadgpt.geometry import CubicProfile, ElevationProfile, GradeProfile, Piece, PieceCurve, shifted
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


def reversed_road(road: Road) -> Road:
    """Returns a road that leads from the end of the given road to its start.

    The given road must consist of lines, arcs and clothoids, or be a spline through nodes. The result has no
    ``profile`` of its own.
    """
    if road.nodes is not None:
        return Road.through(road.nodes[::-1])
    assert isinstance(road.plan, PieceCurve)
    x, y = road.plan.at(road.length).tolist()
    heading = float(road.plan.heading(road.length)) + math.pi
    pieces = tuple(Piece(piece.length, -piece.k1, -piece.k0) for piece in reversed(road.plan.pieces))
    return Road(PieceCurve(x, y, heading, pieces), _turned(road.elevation, road.length))


def _turned(profile: ElevationProfile, length: float) -> ElevationProfile:
    """Returns the heights as a function of the distance from the end of a road of this length."""
    if isinstance(profile, GradeProfile):
        stations = np.array([0.0, *(s for s in profile.stations if 0 < s < length), length])
        grades = -profile.grade(stations)[::-1]
        return GradeProfile(
            float(profile.height(length)), tuple((length - stations[::-1]).tolist()), tuple(grades.tolist())
        )
    assert isinstance(profile, CubicProfile)
    return reversed_cubics(profile, length)


def reversed_cubics(profile: CubicProfile, length: float) -> CubicProfile:
    """Converts cubic functions of the station on a road of ``length`` metres to functions of the distance
    from its end.
    """
    stations = np.array([0.0, *(s for s in profile.stations if 0 < s < length), length])
    at_ends = shifted(profile.cubics(stations[:-1]), np.diff(stations)) * np.array([1.0, -1.0, 1.0, -1.0])
    return CubicProfile.of_table((length - stations[:0:-1]).tolist(), at_ends[::-1])
