"""Lines beside the centre line as polylines: as few stations as keep their chords near the curve."""

from collections.abc import Sequence

import numpy as np

from roadgpt.export.finite import finite
from roadgpt.geometry.curve import Array
from roadgpt.road import Road

CHORD = 0.002  # m, most distance between a polyline and the curve it stands for
LONGEST = 10.0  # m between stations on a straight
SHORTEST = 0.05  # m; tighter bends than a kerb's are not followed any closer
STEP = 0.5  # m between the places where the curvature is looked at
PINCH = 0.95  # share of the radius; an offset line nearer to the centre of its bend would fold over itself


def stations(road: Road, reach: float, chord: float = CHORD) -> Array:
    """Rising stations, both ends included, dense in bends and on crests and sparse on straights.

    Args:
        road: where.
        reach: of the farthest line beside the centre line, metres; outer lines need more points.
        chord: most distance between the polyline and the curve, metres.

    Raises:
        ExportError: the road has a number that is not finite.
    """
    s = np.linspace(0.0, road.length, max(3, int(np.ceil(road.length / STEP)) + 1))
    finite(road.at(s))
    plan, upright = np.abs(finite(road.curvature(s))), np.abs(finite(road.vertical_curvature(s)))
    bend = _widened(np.maximum(plan * (1 + plan * reach), upright))
    spacing = np.clip(np.sqrt(8 * chord / np.maximum(bend, 1e-12)), SHORTEST, LONGEST)
    along = np.r_[0.0, np.cumsum(np.diff(s) * (1 / spacing[1:] + 1 / spacing[:-1]) / 2)]
    count = max(2, int(np.ceil(along[-1])) + 1)
    return np.interp(np.linspace(0.0, along[-1], count), along, s)


def line(road: Road, s: Array, t: float) -> Array:
    """Points ``(n, 3)`` at offset ``t``; pinched in a bend too tight for it, so that it never folds."""
    k = road.curvature(s)
    inside = k * t > PINCH
    offsets = np.where(inside, PINCH / np.where(inside, k, 1.0), t)
    return road.at(s, offsets)


def lines(road: Road, s: Array, offsets: Sequence[float]) -> list[Array]:
    """The lines at several offsets."""
    return [line(road, s, t) for t in offsets]


def _widened(bend: Array) -> Array:
    """Each place as bent as its neighbours: a curvature may jump between two places that were looked at."""
    padded = np.r_[bend[0], bend, bend[-1]]
    return np.asarray(np.maximum(np.maximum(padded[:-2], padded[2:]), bend))
