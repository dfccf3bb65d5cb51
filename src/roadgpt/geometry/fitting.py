"""Joins poses about a metre apart by clothoids; leaves out poses near places where two lines do not meet."""

from dataclasses import dataclass, replace

import numpy as np

from roadgpt.geometry.curve import Array, wrap_angle
from roadgpt.geometry.pieces import Piece, PieceCurve, joined

ROUNDS = 12  # Newton steps of a clothoid; three are enough for gentle bends
_NODES_24, _WEIGHTS_24 = np.polynomial.legendre.leggauss(24)
_TAU, _W = (_NODES_24 + 1) / 2, _WEIGHTS_24 / 2
BLOCK = 20_000  # clothoids at a time, to spare memory
GENTLE = 0.002  # 1/m, curvature that bridging a join may add
FARTHEST = 2.5  # m before and behind a join
NEAREST = 0.1  # m; joins that need less are left unchanged
SHORT = 1.0  # m; a shorter element between two joins is skipped
SHARE = 0.45  # of any other element, that a join may take at either end
CLOSEST = 0.05  # m between the poses of a bridged line
WIDEST = 12.0  # m between two poses; over a larger gap the line cannot be reconstructed

Fit = tuple[PieceCurve, Array, Array]
"""A curve, and the stations in metres of places along it: in the file, and on the curve."""


def clothoids(poses: Array) -> list[Piece] | None:
    """Returns the clothoids that join consecutive poses, rows (x, y, heading) in metres and radians, ``(n +
    1, 3)``; None if two poses cannot be joined. Every clothoid ends at the next pose, so errors do not add
    up.

    The only unknown, the change of curvature, is found with Newton's method. Source: Bertolazzi and Frego, G1
    fitting with clothoids, Mathematical Methods in the Applied Sciences 38 (2015)."""
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


@dataclass(frozen=True)
class SampledLine:
    """Poses along a line."""

    s: Array  # station at each pose, as measured in the file, ``(n,)``
    poses: Array  # one row (x, y, heading) per pose, ``(n, 3)``, in metres and radians
    gaps: Array
    """Distance in metres between the ends of the two elements that meet at each pose, ``(n,)``; 0 where no
    elements meet."""
    kinks: Array  # jump of the heading in radians at each pose, ``(n,)``; 0 where no elements meet
    ends: Array
    """Points ``(m, 2)`` in metres where the elements of the file begin and end. Where two elements meet, the
    pose is halfway between the end of one and the start of the next."""

    def only(self, kept: Array) -> "SampledLine":
        """Returns a line with only the poses that a boolean mask or an array of indices selects."""
        return SampledLine(self.s[kept], self.poses[kept], self.gaps[kept], self.kinks[kept], self.ends)


def bridged(line: SampledLine) -> SampledLine | None:
    """Returns the line without the poses close to places where elements do not meet exactly; None if the
    remaining poses are too far apart to be joined by clothoids.

    Files contain rounded numbers, and some elements are shorter than the rounding errors. A curve through
    every pose would oscillate there: an error of 1 cm within one metre causes a bend with a radius of 33 m.
    The larger the error, the more poses are left out."""
    kept = _thinned(line.s, _away_from_joins(line))
    if np.diff(line.s[kept]).max() > WIDEST:
        return None
    # the heading of a very short element at an end is noise
    poses = line.poses.copy()
    poses[0, 2] += line.kinks[line.s < line.s[0] + NEAREST].sum()
    poses[-1, 2] -= line.kinks[line.s > line.s[-1] - NEAREST].sum()
    return replace(line, poses=poses).only(kept)


def _away_from_joins(line: SampledLine) -> Array:
    # a clothoid of length l that closes a gap g has a curvature of 6 g / l^2, for a kink d of 4 d / l
    wanted = np.maximum(np.sqrt(1.5 * line.gaps / GENTLE), 2 * np.abs(line.kinks) / GENTLE)
    joins = np.flatnonzero(wanted > NEAREST)
    kept = np.ones(len(line.s), bool)
    if joins.size:
        at = line.s[joins]
        room = np.diff(at, prepend=line.s[0], append=line.s[-1])
        room = np.where(room > SHORT, SHARE * room, np.inf)
        reach = np.minimum(wanted[joins], FARTHEST)
        first = np.searchsorted(line.s, at - np.minimum(reach, room[:-1]), side="right")
        last = np.searchsorted(line.s, at + np.minimum(reach, room[1:]), side="left")
        for begin, end in zip(first.tolist(), last.tolist(), strict=True):
            kept[begin:end] = False
    kept[[0, -1]] = True
    return kept


def _thinned(s: Array, kept: Array) -> Array:
    out = [0]
    for i in np.flatnonzero(kept)[1:].tolist():
        if s[i] - s[out[-1]] >= CLOSEST:
            out.append(i)
    last = len(s) - 1
    if out[-1] != last:
        out = [*(out[:-1] if len(out) > 1 else out), last]
    return np.array(out)


def fitted(line: SampledLine) -> Fit | None:
    """Returns a curve of clothoids through the poses, and the stations in metres of these poses, in the file
    and on the curve. Poses near gaps between elements are left out. Returns None if clothoids cannot follow
    the line."""
    kept = bridged(line)
    return None if kept is None else through(kept.s, kept.poses)


def through(s: Array, poses: Array) -> Fit | None:
    """Returns a curve as ``fitted`` does, through all poses, which have the stations ``s`` in the file."""
    pieces = clothoids(poses)
    if pieces is None:
        return None
    stations = np.r_[0.0, np.cumsum([piece.length for piece in pieces])]
    x, y, heading = poses[0].tolist()
    return PieceCurve(x, y, heading, joined(pieces)), s, stations
