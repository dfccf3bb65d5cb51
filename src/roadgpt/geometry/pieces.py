"""Lines, arcs and clothoids joined end to end: the elements of OpenDRIVE's reference line.

A clothoid's curvature grows linearly along it, so its points are Fresnel integrals (scipy.special.fresnel).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import fresnel

from roadgpt.geometry.curve import Array

SAME = 1e-9  # 1/m, curvatures that no measurement tells apart
ALMOST_ARC = 1e-3  # rad, change of curvature times length squared; below it Fresnel arguments lose digits
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)


@dataclass(frozen=True, slots=True)
class Piece:
    """A stretch whose curvature runs linearly from ``k0`` to ``k1`` (1/m) over ``length`` (m)."""

    length: float
    k0: float = 0.0
    k1: float = 0.0


@dataclass(frozen=True, eq=False)
class PieceCurve:
    """A plan curve that starts at ``(x, y)`` with ``heading0`` radians and runs through its pieces.

    Raises:
        ValueError: there is no piece, or one is not longer than nothing.
    """

    x: float
    y: float
    heading0: float
    pieces: tuple[Piece, ...]

    def __post_init__(self) -> None:
        if not self.pieces or not all(piece.length > 0 for piece in self.pieces):
            raise ValueError("a curve needs pieces, each longer than 0 m")

    @cached_property
    def _table(self) -> tuple[Array, Array, Array, Array, Array, Array]:
        """Per piece: station, x, y, heading and curvature at its start, and change of curvature per metre."""
        rows = np.array([(p.length, p.k0, p.k1) for p in self.pieces])
        length, k0, k1 = rows[:, 0], rows[:, 1], rows[:, 2]
        dk = (k1 - k0) / length
        heading = self.heading0 + np.r_[0.0, np.cumsum(length * (k0 + k1) / 2)][:-1]
        dx, dy = advance(length, heading, k0, dk, length)
        start = np.r_[0.0, np.cumsum(length)][:-1]
        x = self.x + np.r_[0.0, np.cumsum(dx)][:-1]
        y = self.y + np.r_[0.0, np.cumsum(dy)][:-1]
        return start, x, y, heading, k0, dk

    @cached_property
    def length(self) -> float:
        """Arc length, metres."""
        return float(np.sum([piece.length for piece in self.pieces]))

    @cached_property
    def _lengths(self) -> Array:
        return np.array([piece.length for piece in self.pieces])

    def _place(self, s: ArrayLike) -> tuple[Array, np.ndarray]:
        """Distance into its piece, and the piece's index, for each station; the ends are extended."""
        s = np.asarray(s, float)
        start = self._table[0]
        index = np.clip(np.searchsorted(start, s, side="right") - 1, 0, len(start) - 1)
        return s - start[index], index

    def at(self, s: ArrayLike) -> Array:
        """Points ``(..., 2)`` in metres."""
        u, i = self._place(s)
        _, x, y, heading, k0, dk = self._table
        dx, dy = advance(u, heading[i], k0[i], dk[i], self._lengths[i])
        return np.stack([x[i] + dx, y[i] + dy], axis=-1)

    def heading(self, s: ArrayLike) -> Array:
        """Directions in radians."""
        u, i = self._place(s)
        _, _, _, heading, k0, dk = self._table
        return np.asarray(heading[i] + u * (k0[i] + u * dk[i] / 2))

    def curvature(self, s: ArrayLike) -> Array:
        """Curvatures in 1/m; at a jump, the one that follows."""
        u, i = self._place(s)
        _, _, _, _, k0, dk = self._table
        return np.asarray(k0[i] + u * dk[i])


def advance(u: Array, heading: Array, k: Array, dk: Array, length: Array) -> tuple[Array, Array]:
    """Displacement after ``u`` metres from a start with this heading, curvature and change of curvature.

    Args:
        u: distance, metres; shape (...).
        heading: radians, at the start.
        k: curvature, 1/m, at the start.
        dk: change of curvature, 1/m^2.
        length: of the whole piece, metres; decides how it is integrated.
    """
    u, heading, k, dk, length = np.broadcast_arrays(u, heading, k, dk, length)
    turn = k * u
    chord = u * np.sinc(turn / (2 * np.pi))
    dx = np.asarray(chord * np.cos(heading + turn / 2))
    dy = np.asarray(chord * np.sin(heading + turn / 2))
    bend = np.abs(dk) * length**2
    for some, integral in ((bend >= ALMOST_ARC, _fresnel), ((bend > 0) & (bend < ALMOST_ARC), _quadrature)):
        if np.any(some):
            dx[some], dy[some] = integral(u[some], heading[some], k[some], dk[some])
    return dx, dy


def _fresnel(u: Array, heading: Array, k: Array, dk: Array) -> tuple[Array, Array]:
    """A clothoid is a stretch of Euler's spiral: move its start to where its curvature has grown to ``k``."""
    sign = np.sign(dk)
    a = np.sqrt(np.abs(dk) / np.pi)
    origin = sign * k / np.abs(dk)
    s1, c1 = fresnel(a * (u + origin))
    s0, c0 = fresnel(a * origin)
    along, across = (c1 - c0) / a, sign * (s1 - s0) / a
    turned = heading - k * origin * sign * sign / 2
    cos, sin = np.cos(turned), np.sin(turned)
    return along * cos - across * sin, along * sin + across * cos


def _quadrature(u: Array, heading: Array, k: Array, dk: Array) -> tuple[Array, Array]:
    """Gauss-Legendre, exact to rounding for so slight a change of curvature."""
    v = u[..., None] * (_NODES + 1) / 2
    phase = heading[..., None] + v * (k[..., None] + v * dk[..., None] / 2)
    half = u / 2
    return half * (np.cos(phase) @ _WEIGHTS), half * (np.sin(phase) @ _WEIGHTS)


def joined(pieces: Sequence[Piece]) -> tuple[Piece, ...]:
    """The same curve with neighbours of equal, constant curvature made one, and empty pieces left out."""
    out: list[Piece] = []
    for piece in pieces:
        if piece.length <= 1e-9:
            continue
        last = out[-1] if out else None
        if (
            last
            and max(last.k0, last.k1, piece.k0, piece.k1) - min(last.k0, last.k1, piece.k0, piece.k1) < SAME
        ):
            out[-1] = Piece(last.length + piece.length, last.k0, last.k1)
        else:
            out.append(piece)
    return tuple(out)
