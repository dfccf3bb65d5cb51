"""The plan of a segment list as a row of points that knows how it moves when a length or an angle changes.

    step m of segment i:   z += d_i / steps_i * exp(1j * (heading + turns before i + share_m * turn_i))

``share_m`` says how much of a segment's turn is behind at that step; it is taken from the built curve, and
kept while lengths and angles change a little.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roadgpt.geometry import PieceCurve
from roadgpt.geometry.curve import Array
from roadgpt.geometry.pieces import joined
from roadgpt.road import Segment
from roadgpt.road.alignment import pieces_of

STEP = 2.0  # m between points, about
MOST_STEPS = 500  # of a road beyond all measure, about
Complex = NDArray[np.complex128]


class PlanPolyline(NamedTuple):
    """A plan as steps of a polyline."""

    owner: NDArray[np.intp]
    """Index of the segment that each step belongs to, ``(k,)``."""
    share: Array
    """Share of its segment's turn that is completed in the middle of each step, ``(k,)``."""
    peak: Array
    """Ratio of the largest to the mean curvature of each segment; 0 for straights."""

    def walk(self, lengths: Array, turns: Array, heading: float) -> tuple[Complex, Complex]:
        """Returns points ``(k + 1,)`` as x + iy from the origin, and every step.

        Args:
            lengths: of the segments, metres.
            turns: of the segments, radians, left positive.
            heading: of the start, radians.
        """
        count = np.bincount(self.owner, minlength=len(lengths))
        before = np.concatenate([[0.0], np.cumsum(turns)[:-1]])
        angle = heading + before[self.owner] + self.share * turns[self.owner]
        steps = (lengths / count)[self.owner] * np.exp(1j * angle)
        return np.concatenate([[0j], np.cumsum(steps)]), steps

    def slopes(self, lengths: Array, steps: Complex) -> tuple[Complex, Complex]:
        """Returns the derivatives of all points by each length and by each turn, ``(k + 1, n)`` each."""
        n, k = len(lengths), len(steps)
        own = self.owner[:, None] == np.arange(n)
        behind = np.where(own, self.share[:, None], self.owner[:, None] > np.arange(n))
        by_length, by_turn = np.zeros((k + 1, n), complex), np.zeros((k + 1, n), complex)
        np.cumsum(own * (steps[:, None] / lengths), axis=0, out=by_length[1:])
        np.cumsum(1j * behind * steps[:, None], axis=0, out=by_turn[1:])
        return by_length, by_turn


def polyline_of(segments: Sequence[Segment]) -> PlanPolyline:
    """Returns the polyline of the plan that is built from these segments."""
    pieces = pieces_of(segments)
    curve = PieceCurve(0.0, 0.0, 0.0, joined(pieces))
    step = max(STEP, curve.length / MOST_STEPS)
    owner, share, peak = list[int](), list[Array](), np.zeros(len(segments))
    at, first = 0.0, 0
    for index, segment in enumerate(segments):
        steps = max(2, round(segment.distance / step))
        owner += [index] * steps
        middles = at + segment.distance * (np.arange(steps) + 0.5) / steps
        turn = np.radians(segment.turn_degrees)
        if abs(turn) < 1e-9:
            share.append(np.zeros(steps))
            first += 1
        else:
            entry = curve.heading(np.array([at]))
            share.append((curve.heading(middles) - entry) / turn)
            bent = max(max(abs(p.k0), abs(p.k1)) for p in pieces[first : first + 5] if p.length > 1e-9)
            peak[index] = bent * segment.distance / abs(turn)
            first += 5
        at += segment.distance
    return PlanPolyline(np.array(owner), np.concatenate(share), peak)
