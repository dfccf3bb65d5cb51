"""Computes the box around a network, for the header of its file."""

from collections.abc import Sequence

import numpy as np

from roadgpt.export.exporters.opendrive.plan import Start
from roadgpt.geometry.pieces import advance

APART_ON_BENDS = 1.0  # m, at most, between two points of a bend


def bounds_of(starts: Sequence[Start], reach: float) -> tuple[float, float, float, float]:
    """Returns the smallest x and y and the largest x and y in metres that lanes can have.

    No lane lies outside. The box may be larger than needed, by 2 cm in bends of a radius of 6 m, and where a
    road is narrower than the widest one.

    Args:
        starts: The lines, arcs and spirals of all reference lines.
        reach: The distance in metres from a reference line to the outermost edge of a lane, at most.
    """
    length = np.array([start.piece.length for start in starts])
    k0 = np.array([start.piece.k0 for start in starts])
    k1 = np.array([start.piece.k1 for start in starts])
    place = np.array([(start.x, start.y, start.heading) for start in starts])
    bend = np.maximum(np.abs(k0), np.abs(k1))
    count = np.where(bend > 0, np.ceil(length / APART_ON_BENDS), 1).astype(int)
    piece = np.repeat(np.arange(len(starts)), count)
    number = np.arange(1, len(piece) + 1) - np.repeat(np.cumsum(count) - count, count)
    u = length[piece] * number / count[piece]
    dk = ((k1 - k0) / length)[piece]
    along, across = advance(u, place[piece, 2], k0[piece], dk, length[piece])
    # a curve is at most this far from the chord between two of its points
    sag = float(np.max(bend * (length / count) ** 2)) / 8
    x = np.r_[place[:, 0], place[piece, 0] + along]
    y = np.r_[place[:, 1], place[piece, 1] + across]
    far = reach + sag
    return float(x.min()) - far, float(y.min()) - far, float(x.max()) + far, float(y.max()) + far
