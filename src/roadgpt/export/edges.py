"""Converts lines parallel to the centre line to polylines with few points and a bounded chord error."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from roadgpt.export.finite import finite
from roadgpt.geometry.curve import Array
from roadgpt.road import Road

CHORD = 0.002  # m, most distance between a polyline and the curve it stands for
LONGEST = 10.0  # m between stations on a straight
SHORTEST = 0.05  # m between stations; tighter bends are not followed more closely
STEP = 0.5  # m between the places where the curvature is sampled
PINCH = 0.95  # share of the radius; an offset line closer to the centre of its bend would fold


def stations(road: Road, reach: float, chord: float = CHORD) -> Array:
    """Returns increasing stations for the points of a polyline along the road, both ends included.

    The stations are dense in bends and on crests, and sparse on straights.

    Args:
        road: The road.
        reach: Largest offset in metres of a line from the centre line. Larger offsets need more points.
        chord: Greatest allowed distance in metres between the polyline and the curve.

    Raises:
        ExportError: The road has a number that is not finite.
    """
    s = np.linspace(0.0, road.length, max(3, int(np.ceil(road.length / STEP)) + 1))
    finite(road.at(s))
    plan, upright = np.abs(finite(road.curvature(s))), np.abs(finite(road.vertical_curvature(s)))
    bend = _widened(np.maximum(plan * (1 + plan * reach), upright))
    spacing = np.clip(np.sqrt(8 * chord / np.maximum(bend, 1e-12)), SHORTEST, LONGEST)
    along = np.r_[0.0, np.cumsum(np.diff(s) * (1 / spacing[1:] + 1 / spacing[:-1]) / 2)]
    count = max(2, int(np.ceil(along[-1])) + 1)
    return np.interp(np.linspace(0.0, along[-1], count), along, s)


def line(road: Road, s: Array, t: ArrayLike) -> Array:
    """Returns points ``(n, 3)`` at stations ``s`` and offset ``t`` to the left, in metres.

    In a bend with a radius smaller than ``t``, the offset is reduced so that the line does not fold.
    """
    k = road.curvature(s)
    inside = k * np.asarray(t) > PINCH
    offsets = np.where(inside, PINCH / np.where(inside, k, 1.0), t)
    return road.at(s, offsets)


def lines(road: Road, s: Array, offsets: Sequence[ArrayLike]) -> list[Array]:
    """Returns for each of several offsets the points ``(n, 3)`` of ``line`` at stations ``s``."""
    return [line(road, s, t) for t in offsets]


def _widened(bend: Array) -> Array:
    """Returns the greatest bend of each place and its neighbours: a curvature may jump between two places."""
    padded = np.r_[bend[0], bend, bend[-1]]
    return np.asarray(np.maximum(np.maximum(padded[:-2], padded[2:]), bend))
