"""Computes the superelevation of a road from the radii of its bends and the speed limit.

Source: National Highways, CD 109 Highway link design (earlier TD 9/93), section 3: at a design speed of V
km/h, a bend of radius R metres has a superelevation of V^2 / (2.828 R) percent, and at most 7 % outside
towns. It is run in over the transition curve, here from the value at its beginning to that at its end and
without a kink.
"""

import math
from itertools import pairwise

import numpy as np

from roadgpt.geometry import CubicProfile, PieceCurve
from roadgpt.geometry.curve import Array, PlanCurve

SHARE = 2.828  # CD 109; the superelevation then balances 45 % of the lateral acceleration: 127 / 2.828 = 45
MOST = 0.07  # ratio, CD 109
STRAIGHT = 1 / 2000  # 1/m; flatter curves count as straight where one superelevation is set for all bends
JUMP = 1e-4  # 1/m; where the curvature changes at once by more, the superelevation is run in beside it
STEP = 4.0  # m between the stations of a superelevation that does not follow pieces of the plan
SHORTEST = 1e-6  # m; shorter pieces of the plan are skipped
RUN_IN = 24.0  # m over which a jump of the curvature is spread


def superelevation(plan: PlanCurve, speed: float, ratio: float | None = None) -> CubicProfile:
    """Returns the angle in radians by station, negative in left bends, so that bends fall to their inside.

    Args:
        plan: The centre line.
        speed: Design speed in m/s.
        ratio: The superelevation of every bend as a ratio; None takes that of CD 109 for its radius.
    """
    if isinstance(plan, PieceCurve) and not _jumps(plan):
        pieces = [piece for piece in plan.pieces if piece.length > SHORTEST]
        s = np.r_[0.0, np.cumsum([piece.length for piece in pieces])]
        starts = _angles(np.array([piece.k0 for piece in pieces]), speed, ratio)
        ends = _angles(np.array([piece.k1 for piece in pieces]), speed, ratio)
    else:
        s = np.linspace(0.0, plan.length, max(2, round(plan.length / STEP) + 1))
        angles = _smoothed(plan, s, speed, ratio)
        starts, ends = angles[:-1], angles[1:]
    rows = [
        (start, 0.0, 3 * (end - start) / n**2, -2 * (end - start) / n**3)
        for start, end, n in zip(starts.tolist(), ends.tolist(), np.diff(s).tolist(), strict=True)
    ]
    return CubicProfile(tuple(s.tolist()), (*rows, (float(ends[-1]), 0.0, 0.0, 0.0)))


def _angles(curvature: Array, speed: float, ratio: float | None) -> Array:
    bend = np.abs(curvature)
    if ratio is None:
        sizes = np.minimum((speed * 3.6) ** 2 * bend / (100 * SHARE), MOST)
    else:
        sizes = np.where(bend > STRAIGHT, ratio, 0.0)
    return -np.copysign(np.arctan(sizes), curvature) + 0.0


def _jumps(plan: PieceCurve) -> bool:
    """Returns whether the curvature changes at once somewhere between two pieces."""
    pieces = [piece for piece in plan.pieces if piece.length > SHORTEST]
    return any(abs(b.k0 - a.k1) > JUMP for a, b in pairwise(pieces))


def _smoothed(plan: PlanCurve, s: Array, speed: float, ratio: float | None) -> Array:
    """Returns the mean angle over the run-in length about each station."""
    fine = np.linspace(0.0, plan.length, max(2, math.ceil(plan.length)) + 1)
    total = np.r_[0.0, np.cumsum(np.diff(fine) * _between(_angles(plan.curvature(fine), speed, ratio)))]
    low, high = np.clip(s - RUN_IN / 2, 0.0, plan.length), np.clip(s + RUN_IN / 2, 0.0, plan.length)
    return np.asarray((np.interp(high, fine, total) - np.interp(low, fine, total)) / (high - low))


def _between(values: Array) -> Array:
    return np.asarray((values[1:] + values[:-1]) / 2)
