"""Where a road is tightest, steepest and lowest: exact for pieces and parabolas, sampled for splines.

The curvature of a piece and the grade of a parabola run linearly, so both are extreme where one begins or
ends; a parabola is lowest there or where its grade is 0.
"""

import numpy as np

from roadgpt.geometry import ElevationProfile, GradeProfile, PieceCurve
from roadgpt.geometry.curve import Array
from roadgpt.road import Road

KINK = 2.0  # m: less than a car's wheelbase, so that no wheel feels a shorter one as less


def tightest(road: Road) -> tuple[float, float]:
    """Station and curvature (1/m, left positive) of the tightest place; the first one of several."""
    if isinstance(road.plan, PieceCurve):
        pieces = road.plan.pieces
        ends = np.cumsum([piece.length for piece in pieces])
        s = np.stack((ends - [piece.length for piece in pieces], ends), axis=1).ravel()
        bend = np.array([(piece.k0, piece.k1) for piece in pieces]).ravel()
    else:
        s, bend = road.sample().s, road.sample().curvature
    return _greatest(s, bend)


def steepest(road: Road) -> tuple[float, float]:
    """Station and grade (ratio, uphill positive) of the steepest place; the first one of several."""
    if isinstance(road.elevation, GradeProfile):
        s = _stations(road.elevation, road.length)
        return _greatest(s, road.elevation.grade(s))
    return _greatest(road.sample().s, road.sample().grade)


def vertical_bends(road: Road) -> tuple[Array, Array, Array]:
    """Where the grade changes: stations (m) of begin and end, and the change per metre, negative on a crest.

    Parabolas as they are; of other profiles every stretch of about ``KINK`` metres, in which a kink counts
    as spread over it.
    """
    if isinstance(road.elevation, GradeProfile):
        s = _stations(road.elevation, road.length)
    else:
        s = np.linspace(0.0, road.length, max(1, round(road.length / KINK)) + 1)
    grade = road.elevation.grade(s)
    return s[:-1], s[1:], np.diff(grade) / np.diff(s)


def lowest(profile: ElevationProfile, length: float) -> tuple[float, float]:
    """Station and height (m) of the lowest place over so many metres."""
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
    """Where parabolas begin or end on the road, and its own ends, metres, rising."""
    s = np.array(profile.stations)
    return np.concatenate(([0.0], s[(s > 0) & (s < length)], [length]))


def _greatest(s: Array, values: Array) -> tuple[float, float]:
    most = int(np.abs(values).argmax())
    return float(s[most]), float(values[most])
