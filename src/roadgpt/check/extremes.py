"""Finds where a road is tightest, steepest and lowest; exact for lines, arcs, clothoids and parabolas, while
splines are sampled.

The curvature of a line, arc or clothoid and the grade of a parabola change linearly, so their extremes are at
the ends. A parabola is lowest at one of its ends or where its grade is 0."""

import numpy as np

from roadgpt.geometry import ElevationProfile, GradeProfile, PieceCurve
from roadgpt.geometry.curve import Array
from roadgpt.road import Road

KINK = 2.0  # m: shorter than a car's wheelbase


def tightest(road: Road) -> tuple[float, float]:
    """Returns the station (m) and the curvature (1/m, positive to the left) of the first tightest place."""
    if isinstance(road.plan, PieceCurve):
        pieces = road.plan.pieces
        ends = np.cumsum([piece.length for piece in pieces])
        s = np.stack((ends - [piece.length for piece in pieces], ends), axis=1).ravel()
        bend = np.array([(piece.k0, piece.k1) for piece in pieces]).ravel()
    else:
        s, bend = road.sample().s, road.sample().curvature
    return _greatest(s, bend)


def steepest(road: Road) -> tuple[float, float]:
    """Returns the station (m) and the grade (ratio, uphill positive) of the first steepest place."""
    if isinstance(road.elevation, GradeProfile):
        s = _stations(road.elevation, road.length)
        return _greatest(s, road.elevation.grade(s))
    return _greatest(road.sample().s, road.sample().grade)


def vertical_bends(road: Road) -> tuple[Array, Array, Array]:
    """Returns the start and end stations (m) of each part where the grade changes, and the change per metre,
    negative on a crest. In a GradeProfile, each parabola is one part. Other profiles are divided into parts
    of about 2 m, over which the change of grade at a kink is distributed."""
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
    s = np.array(profile.stations)
    return np.concatenate(([0.0], s[(s > 0) & (s < length)], [length]))


def _greatest(s: Array, values: Array) -> tuple[float, float]:
    most = int(np.abs(values).argmax())
    return float(s[most]), float(values[most])
