"""Computes the box around a network, for the header of its file."""

from collections.abc import Sequence

import numpy as np

from roadgpt.export.exporters.opendrive.plan import Start
from roadgpt.geometry import CubicProfile
from roadgpt.geometry.curve import Array
from roadgpt.geometry.pieces import advance
from roadgpt.road import Profile
from roadgpt.road.profile import Width

APART_ON_BENDS = 1.0  # m, greatest distance between two points of a bend


def bounds_of(
    roads: Sequence[Sequence[Start]], sides: Sequence[tuple[float, float]]
) -> tuple[float, float, float, float]:
    """Returns the box around all lanes: smallest x, smallest y, largest x and largest y, in metres.

    No lane lies outside the box. If no bend has a radius below 6 m, and all widths and lane offsets are
    constant, the box is too large by at most 2.1 cm, plus 0.35 cm for each metre of the greatest distance in
    ``sides``.

    Args:
        roads: The lines, arcs and spirals of each reference line.
        sides: For each road, the result of ``reaches``.
    """
    starts = [start for own in roads for start in own]
    left, right = np.repeat(np.array(sides), [len(own) for own in roads], axis=0).T
    length, k0, k1 = np.array([(start.piece.length, start.piece.k0, start.piece.k1) for start in starts]).T
    x, y, heading = np.array([start[1:4] for start in starts]).T
    bend = np.maximum(np.abs(k0), np.abs(k1))
    count = np.where(bend > 0, np.ceil(length / APART_ON_BENDS), 1).astype(int)
    outer = np.flatnonzero(_may_be_outermost(x, y, length + np.maximum(left, right)))
    points_of = count[outer] + 1
    piece = np.repeat(outer, points_of)
    first = np.zeros(len(starts), int)
    first[outer] = np.cumsum(points_of) - points_of
    u = length[piece] * (np.arange(len(piece)) - first[piece]) / count[piece]
    k, dk = k0[piece], ((k1 - k0) / length)[piece]
    dx, dy = advance(u, heading[piece], k, dk, length[piece])
    angle = heading[piece] + u * (k + u * dk / 2)
    points = np.array([x[piece] + dx, y[piece] + dy])
    normal = np.array([-np.sin(angle), np.cos(angle)])
    corners = np.concatenate((points + left[piece] * normal, points - right[piece] * normal), axis=1)
    # an edge is at most this far from the chord between two of its points
    sag = float(np.max(bend * (length / count) ** 2 / 8 * (1 + bend * np.maximum(left, right))))
    west, south = (corners.min(axis=1) - sag).tolist()
    east, north = (corners.max(axis=1) + sag).tolist()
    return west, south, east, north


def _may_be_outermost(x: Array, y: Array, reach: Array) -> Array:
    """Returns for each piece whether it may be outside the box around the starts of all pieces.

    Args:
        x: The starts of the pieces in metres.
        y: The same.
        reach: The distances in metres from the starts that the lanes beside the pieces do not exceed.
    """
    outside = [(v - reach < v.min()) | (v + reach > v.max()) for v in (x, y)]
    return np.asarray(outside[0] | outside[1])


def reaches(profile: Profile) -> tuple[float, float]:
    """Returns the distances in metres from the reference line to the outermost edges, on the left and right.

    Where widths vary, the distances are upper bounds.
    """
    left, right = (sum(_widest(lane.width) for lane in side) for side in (profile.left, profile.right))
    (low, high), begin = profile.offset_range, profile.begins
    return left + begin[0] + high, right + begin[1] - low


def _widest(width: Width) -> float:
    """Returns an upper bound of a width: the largest Bernstein coefficient of its cubics."""
    if not isinstance(width, CubicProfile):
        return width
    found = [width.coefficients[-1][0]]
    for start, end, (a, b, c, d) in zip(width.stations, width.stations[1:], width.coefficients, strict=False):
        n = end - start
        found += [a, a + n * b / 3, a + n * (2 * b + n * c) / 3, a + n * (b + n * (c + n * d))]
    return max(found)
