"""Finds where a road is tightest, steepest and lowest: exactly for pieces and parabolas, sampled for splines.

The curvature of a piece and the grade of a parabola change linearly, so both have their extremes where one
begins or ends. A parabola is lowest there or where its grade is 0.
"""

import numpy as np

from roadgpt.geometry import ElevationProfile, GradeProfile, PieceCurve
from roadgpt.geometry.curve import Array
from roadgpt.road import Road

KINK = 2.0  # m: shorter than a car's wheelbase


def tightest(road: Road) -> tuple[float, float]:
    """Returns station and curvature (1/m, positive to the left) of the first of the tightest places."""
    if isinstance(road.plan, PieceCurve):
        pieces = road.plan.pieces
        ends = np.cumsum([piece.length for piece in pieces])
        s = np.stack((ends - [piece.length for piece in pieces], ends), axis=1).ravel()
        bend = np.array([(piece.k0, piece.k1) for piece in pieces]).ravel()
    else:
        s, bend = road.sample().s, road.sample().curvature
    return _greatest(s, bend)


def steepest(road: Road) -> tuple[float, float]:
    """Returns station and grade (ratio, uphill positive) of the first of the steepest places."""
    if isinstance(road.elevation, GradeProfile):
        s = _stations(road.elevation, road.length)
        return _greatest(s, road.elevation.grade(s))
    return _greatest(road.sample().s, road.sample().grade)


def vertical_bends(road: Road) -> tuple[Array, Array, Array]:
    """Returns where the grade changes: start and end stations (m), and the change per metre.

    The change is negative on a crest.

    Parabolas are returned as they are. Other profiles are divided into parts of about ``KINK`` metres; a kink
    counts as spread over its part.
    """
    if isinstance(road.elevation, GradeProfile):
        s = _stations(road.elevation, road.length)
    else:
        s = np.linspace(0.0, road.length, max(1, round(road.length / KINK)) + 1)
    grade = road.elevation.grade(s)
    return s[:-1], s[1:], np.diff(grade) / np.diff(s)


def lowest(profile: ElevationProfile, length: float) -> tuple[float, float]:
    """Returns station and height (m) of the lowest place of a profile over its first ``length`` metres."""
    if isinstance(profile, GradeProfile):
        s = _stations(profile, length)
        grade = profile.grade(s)
        dips = np.flatnonzero((grade[:-1] < 0) & (grade[1:] > 0))
        fall = -grade[dips] / (grade[dips + 1] - grade[dips])
        s = np.concatenate((s, s[dips] + fall * (s[dips + 1] - s[dips])))
    else:
        s = np.linspace(0.0, length, max(2, round(length) + 1))
    z = profile.height(s)
    least = int(z.argmin())
    return float(s[least]), float(z[least])


def _stations(profile: GradeProfile, length: float) -> Array:
    """Returns the stations in metres where parabolas begin or end on the road, and its two ends."""
    s = np.array(profile.stations)
    return np.concatenate(([0.0], s[(s > 0) & (s < length)], [length]))


def _greatest(s: Array, values: Array) -> tuple[float, float]:
    most = int(np.abs(values).argmax())
    return float(s[most]), float(values[most])
