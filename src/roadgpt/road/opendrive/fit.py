"""Joins consecutive poses by clothoids that match the position and heading of both poses.

The only unknown, the change of curvature, is found with Newton's method. Source: Bertolazzi and Frego, G1
fitting with clothoids, Mathematical Methods in the Applied Sciences 38 (2015).
"""

import numpy as np

from roadgpt.geometry import Piece, wrap_angle
from roadgpt.geometry.curve import Array

ROUNDS = 12  # Newton steps; three are enough for gentle bends
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(24)
_TAU, _W = (_NODES + 1) / 2, _WEIGHTS / 2


BLOCK = 20_000  # pieces at a time, to spare memory


def clothoids(poses: Array) -> list[Piece] | None:
    """Returns the clothoids that join consecutive poses, rows (x, y, heading) in metres and radians, ``(n +
    1, 3)``; None if two poses cannot be joined. Every clothoid ends at the next pose, except for rounding, so
    errors do not add up.
    """
    found: list[Piece] = []
    for first in range(0, len(poses) - 1, BLOCK):
        some = _block(poses[first : first + BLOCK + 1])
        if some is None:
            return None
        found += some
    return found


def _block(poses: Array) -> list[Piece] | None:
    chord = np.diff(poses[:, :2], axis=0)
    reach = np.hypot(chord[:, 0], chord[:, 1])
    along = np.arctan2(chord[:, 1], chord[:, 0])
    first, last = wrap_angle(poses[:-1, 2] - along), wrap_angle(poses[1:, 2] - along)
    turn = last - first
    a = 3 * (first + last)
    for _ in range(ROUNDS):
        angle = _angle(a, turn, first)
        across = np.sin(angle) @ _W
        slope = (np.cos(angle) * (_TAU * (_TAU - 1))) @ _W
        a = a - across / np.where(np.abs(slope) < 1e-3, -1 / 6, slope)
    angle = _angle(a, turn, first)
    shrunk = np.cos(angle) @ _W
    missed = np.abs(np.sin(angle) @ _W)
    if not (np.isfinite(a).all() and (shrunk > 0.1).all() and (missed < 1e-9).all()):
        return None
    length = reach / shrunk
    k0 = (turn - a) / length
    k1 = (turn + a) / length
    return [Piece(*row) for row in np.column_stack([length, k0, k1]).tolist()]


def _angle(a: Array, turn: Array, first: Array) -> Array:
    """Returns the heading relative to the chord, ``(n, 24)``, at the nodes of integration."""
    return np.asarray(first[:, None] + _TAU * ((turn - a)[:, None] + _TAU * a[:, None]))
