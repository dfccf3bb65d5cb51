"""Reverses the direction of a road."""

import math

import numpy as np

from roadgpt.geometry import CubicProfile, ElevationProfile, GradeProfile, Piece, PieceCurve, shifted
from roadgpt.road.road import Road


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
    """Converts cubic functions of the station to functions of the distance from the end of the road.

    Args:
        profile: the cubic functions.
        length: the length of the road in metres.
    """
    stations = np.array([0.0, *(s for s in profile.stations if 0 < s < length), length])
    at_ends = shifted(profile.cubics(stations[:-1]), np.diff(stations)) * np.array([1.0, -1.0, 1.0, -1.0])
    rows = [(a, b, c, d) for a, b, c, d in at_ends[::-1].tolist()]
    return CubicProfile(tuple((length - stations[:0:-1]).tolist()), tuple(rows))
