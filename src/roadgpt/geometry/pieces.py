"""Defines plane curves made of lines, arcs and clothoids, like the reference line in OpenDRIVE.

The curvature of a clothoid changes linearly with arc length, so its points are computed with Fresnel
integrals (scipy.special.fresnel)."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy
from numpy.typing import ArrayLike

from roadgpt.geometry.curve import Array, Number, before, placed

SAME = 1e-9  # 1/m; curvatures closer than this are treated as equal
ALMOST_ARC = 1e-3  # rad; below this change of curvature times squared length, Fresnel arguments lose digits
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)


@dataclass(frozen=True, slots=True)
class Piece:
    """A line, arc or clothoid of ``length`` metres, whose curvature changes linearly from ``k0`` to ``k1``.
    Curvatures are in 1/m, positive to the left."""

    length: float
    k0: float = 0.0
    k1: float = 0.0


@dataclass(frozen=True, eq=False)
class PieceCurve:
    """A plane curve of lines, arcs and clothoids joined end to end. It starts at ``(x, y)`` in metres with
    heading ``heading0`` in radians. Beyond its ends, the first piece is extended backwards and the last piece
    forwards."""

    x: float
    y: float
    heading0: float
    pieces: tuple[Piece, ...]

    def __post_init__(self) -> None:
        if not self.pieces or not all(piece.length > 0 for piece in self.pieces):
            raise ValueError("a curve needs at least one piece, and each piece must be longer than 0 m")

    @cached_property
    def _table(self) -> tuple[Array, Array, Array, Array, Array, Array]:
        """Returns station, x, y, heading, curvature and its change per metre at the start of each piece."""
        rows = np.array([(p.length, p.k0, p.k1) for p in self.pieces])
        length, k0, k1 = rows[:, 0], rows[:, 1], rows[:, 2]
        dk = (k1 - k0) / length
        heading = self.heading0 + before(length * (k0 + k1) / 2)
        dx, dy = advance(length, heading, k0, dk, length)
        return before(length), self.x + before(dx), self.y + before(dy), heading, k0, dk

    @cached_property
    def mirrored(self) -> "PieceCurve":
        """The curve with the sign of y changed: left becomes right."""
        pieces = tuple(Piece(piece.length, 0.0 - piece.k0, 0.0 - piece.k1) for piece in self.pieces)
        return PieceCurve(self.x, 0.0 - self.y, 0.0 - self.heading0, pieces)

    @cached_property
    def length(self) -> float:
        """The arc length of the whole curve in metres."""
        return float(np.add.reduce([piece.length for piece in self.pieces]))

    @cached_property
    def _lengths(self) -> Array:
        return np.array([piece.length for piece in self.pieces])

    @property
    def end(self) -> tuple[float, float, float]:
        """x and y in metres and the heading in radians at the end, as ``at`` and ``heading`` give them, but
        computed faster."""
        s = turned = across = along = 0.0
        for piece in self.pieces[:-1]:
            dx, dy = _step(piece, piece.length, self.heading0 + turned)
            across, along = across + dx, along + dy
            s, turned = s + piece.length, turned + piece.length * (piece.k0 + piece.k1) / 2
        last, u, heading = self.pieces[-1], self.length - s, self.heading0 + turned
        dx, dy = _step(last, u, heading)
        dk = (last.k1 - last.k0) / last.length
        return self.x + across + dx, self.y + along + dy, heading + u * (last.k0 + u * dk / 2)

    def at(self, s: ArrayLike) -> Array:
        """Returns points of shape ``(..., 2)`` in metres at stations ``s`` of shape ``(...)``."""
        u, i = placed(s, self._table[0])
        _, x, y, heading, k0, dk = self._table
        dx, dy = advance(u, heading[i], k0[i], dk[i], self._lengths[i])
        return np.stack([x[i] + dx, y[i] + dy], axis=-1)

    def heading(self, s: ArrayLike) -> Array:
        """Returns headings in radians at stations ``s``, continuous along the curve."""
        u, i = placed(s, self._table[0])
        _, _, _, heading, k0, dk = self._table
        return np.asarray(heading[i] + u * (k0[i] + u * dk[i] / 2))

    def curvature(self, s: ArrayLike) -> Array:
        """Returns curvatures in 1/m at stations ``s``, positive to the left. At a station where the curvature
        jumps, the result is the value after the jump."""
        u, i = placed(s, self._table[0])
        _, _, _, _, k0, dk = self._table
        return np.asarray(k0[i] + u * dk[i])


def along_all(curves: Sequence[PieceCurve], stations: Sequence[Array]) -> tuple[Array, Array]:
    """Returns points ``(n, 2)`` in metres and headings ``(n,)`` in radians on one or more curves, in order.
    ``stations`` are those on each curve in metres. ``at`` and ``heading`` give the same values, but
    more slowly."""
    counts = [len(curve.pieces) for curve in curves]
    is_piece = np.arange(max(counts)) < np.array(counts)[:, None]
    rows = np.zeros((3, *is_piece.shape))
    rows[0] = 1.0  # m, of what fills up the rows of curves with fewer pieces
    rows[:, is_piece] = np.array([(p.length, p.k0, p.k1) for curve in curves for p in curve.pieces]).T
    length, k0, k1 = rows
    x, y, heading = np.array([(curve.x, curve.y, curve.heading0) for curve in curves]).T[..., None]
    dk = (k1 - k0) / length
    heading = heading + before(length * (k0 + k1) / 2)
    dx, dy = advance(length, heading, k0, dk, length)
    x, y = x + before(dx), y + before(dy)
    start = np.where(is_piece, before(length), np.inf)
    s, curve = np.concatenate(stations), np.repeat(np.arange(len(curves)), [len(each) for each in stations])
    piece = np.maximum((start[curve] <= s[:, None]).sum(axis=1) - 1, 0)
    x, y, heading, k0, dk, length, start = (
        each[curve, piece] for each in (x, y, heading, k0, dk, length, start)
    )
    u = s - start
    dx, dy = advance(u, heading, k0, dk, length)
    return np.stack((x + dx, y + dy), axis=-1), heading + u * (k0 + u * dk / 2)


def advance(u: Array, heading: Array, k: Array, dk: Array, length: Array) -> tuple[Array, Array]:
    """Returns the displacements along x and y in metres after ``u`` metres on a line, an arc or a clothoid
    that starts with a heading in radians and a curvature ``k`` in 1/m, which changes by ``dk`` per metre. The
    ``length`` of the whole piece in metres serves only to choose an accurate formula."""
    dx, dy = map(np.asarray, _arc(u, heading, k))
    bend = np.abs(dk) * length**2
    if bend.any():
        u, heading, k, dk, bend = np.broadcast_arrays(u, heading, k, dk, bend)
        is_clothoid = bend >= ALMOST_ARC
        for some, integral in ((is_clothoid, _fresnel), ((bend > 0) & ~is_clothoid, _quadrature)):
            if some.any():
                dx[some], dy[some] = integral(u[some], heading[some], k[some], dk[some])
    return dx, dy


def _step(piece: Piece, u: float, heading: float) -> tuple[float, float]:
    """Returns the displacements after ``u`` metres on one piece, as ``advance`` does but faster."""
    dk = (piece.k1 - piece.k0) / piece.length
    bend = abs(dk) * piece.length**2
    if 0 < bend < ALMOST_ARC:
        dx, dy = _quadrature(*(np.array([value]) for value in (u, heading, piece.k0, dk)))
        return float(dx[0]), float(dy[0])
    x, y = _fresnel(u, heading, piece.k0, dk) if bend else _arc(u, heading, piece.k0)
    return float(x), float(y)


def _arc(u: Number, heading: Number, k: Number) -> tuple[Number, Number]:
    turn = k * u
    chord, middle = u * np.sinc(turn / (2 * np.pi)), heading + turn / 2
    return chord * np.cos(middle), chord * np.sin(middle)


def _fresnel(u: Number, heading: Number, k: Number, dk: Number) -> tuple[Number, Number]:
    """Integrates a clothoid as part of Euler's spiral, from the place where its curvature is ``k``."""
    sign = np.sign(dk)
    a = np.sqrt(np.abs(dk) / np.pi)
    origin = sign * k / np.abs(dk)
    s1, c1 = scipy.special.fresnel(a * (u + origin))
    s0, c0 = scipy.special.fresnel(a * origin)
    along, across = (c1 - c0) / a, sign * (s1 - s0) / a
    turned = heading - k * origin * sign * sign / 2
    cos, sin = np.cos(turned), np.sin(turned)
    return along * cos - across * sin, along * sin + across * cos


def _quadrature(u: Array, heading: Array, k: Array, dk: Array) -> tuple[Array, Array]:
    """Integrates by Gauss-Legendre quadrature, exact to rounding where the curvature hardly changes."""
    v = u[..., None] * (_NODES + 1) / 2
    phase = heading[..., None] + v * (k[..., None] + v * dk[..., None] / 2)
    half = u / 2
    return half * (np.cos(phase) @ _WEIGHTS), half * (np.sin(phase) @ _WEIGHTS)


def joined(pieces: Sequence[Piece]) -> tuple[Piece, ...]:
    """Returns pieces without those of zero length, and with neighbouring pieces of equal curvature merged.
    Only lines and arcs are merged, never clothoids."""
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
