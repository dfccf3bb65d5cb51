"""Computes the box around a network, for the header of its file."""

from collections.abc import Sequence

import numpy as np

from roadgpt.export.exporters.opendrive.plan import Start
from roadgpt.geometry.pieces import advance

APART_ON_BENDS = 1.0  # m, at most, between two points of a bend


def bounds_of(
    starts: Sequence[Start], reaches: Sequence[tuple[float, float]]
) -> tuple[float, float, float, float]:
    """Returns the smallest x and y and the largest x and y in metres that lanes have.

    No lane lies outside. The box is too large by at most 3 cm for each metre by which the lanes reach beyond
    a bend of a radius of 6 m.

    Args:
        starts: The lines, arcs and spirals of all reference lines.
        reaches: For each of them, the distances in metres from the reference line to the outermost edge of
            the lanes on its left, and on its right.
    """
    length, k0, k1 = np.array([(start.piece.length, start.piece.k0, start.piece.k1) for start in starts]).T
    x, y, heading = np.array([start[1:4] for start in starts]).T
    bend = np.maximum(np.abs(k0), np.abs(k1))
    count = np.where(bend > 0, np.ceil(length / APART_ON_BENDS), 1).astype(int)
    piece = np.repeat(np.arange(len(starts)), count + 1)
    first = np.cumsum(count + 1) - count - 1
    u = length[piece] * (np.arange(len(piece)) - first[piece]) / count[piece]
    k, dk = k0[piece], ((k1 - k0) / length)[piece]
    dx, dy = advance(u, heading[piece], k, dk, length[piece])
    angle = heading[piece] + u * (k + u * dk / 2)
    left, right = np.array(reaches).T[:, piece]
    points = np.array([x[piece] + dx, y[piece] + dy])
    normal = np.array([-np.sin(angle), np.cos(angle)])
    corners = np.concatenate((points + left * normal, points - right * normal), axis=1)
    # an edge is at most this far from the chord between two of its points
    sag = float(np.max(bend * (length / count) ** 2 / 8 * (1 + bend * np.array(reaches).max(axis=1))))
    west, south = (corners.min(axis=1) - sag).tolist()
    east, north = (corners.max(axis=1) + sag).tolist()
    return west, south, east, north
