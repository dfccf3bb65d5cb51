"""Computes the superelevation of a road from the radii of its bends and the speed limit.

Source: National Highways, CD 109 Highway link design (earlier TD 9/93), section 3: at a design speed of V
km/h, a bend of radius R metres has a superelevation of V^2 / (2.828 R) percent, and at most 7 % outside
towns. The superelevation is built up over a run-in, which is usually the transition curve. If this curve is
so short that the edge of the carriageway would climb or fall by more than 1 % relative to the centre line,
the run-in begins earlier and ends later. It never extends beyond the middle of the adjoining straight or arc.
"""

import math
from itertools import pairwise

import numpy as np

from roadgpt.geometry import CubicProfile, PieceCurve
from roadgpt.geometry.curve import Array, PlanCurve

SHARE = 2.828  # CD 109; the superelevation then balances 45 % of the lateral acceleration: 127 / 2.828 = 45
MOST = 0.07  # ratio, CD 109
EDGE = 0.01  # ratio, CD 109: grade of an edge of the carriageway against the centre line
STRAIGHT = 1 / 2000  # 1/m; flatter curves count as straight where one superelevation is set for all bends
EQUAL = 1e-9  # rad
SHORTEST = 1e-6  # m; shorter pieces of the plan are skipped
STEP = 4.0  # m between the stations at which the superelevation of a spline is computed
RUN_IN = 24.0  # m over which the superelevation of a spline is averaged

Knots = list[tuple[float, float]]
"""Stations in metres, each with an angle in radians; between two stations the angle changes smoothly."""


def superelevation(plan: PlanCurve, reach: float, speed: float, ratio: float | None = None) -> CubicProfile:
    """Returns the superelevation in radians as a function of the station: negative in left bends, because the
    surface falls to the inside.

    ``reach`` is the distance in metres from the centre line to the farther edge of the carriageway. ``speed``
    is the design speed in m/s. ``ratio`` is the superelevation of every bend as a ratio; with None, each bend
    has the value that CD 109 gives for its radius."""
    if isinstance(plan, PieceCurve):
        knots = _of_pieces(plan, reach, speed, ratio)
    else:
        s = np.linspace(0.0, plan.length, max(2, round(plan.length / STEP) + 1))
        knots = list(zip(s.tolist(), _smoothed(plan, s, speed, ratio).tolist(), strict=True))
    return CubicProfile.smooth(knots)


def _of_pieces(plan: PieceCurve, reach: float, speed: float, ratio: float | None) -> Knots:
    """Returns knots at both ends of each run-in, and at the ends of the road."""
    pieces = [piece for piece in plan.pieces if piece.length > SHORTEST]
    s = np.r_[0.0, np.cumsum([piece.length for piece in pieces])].tolist()
    starts = superelevation_for(np.array([piece.k0 for piece in pieces]), speed, ratio).tolist()
    ends = superelevation_for(np.array([piece.k1 for piece in pieces]), speed, ratio).tolist()
    level = [abs(b - a) < EQUAL for a, b in zip(starts, ends, strict=True)]
    spare = [(s[i + 1] - s[i]) / 2 if level[i] else 0.0 for i in range(len(pieces))]
    knots: Knots = [(0.0, starts[0])]
    for i in range(len(pieces)):
        if i and abs(starts[i] - ends[i - 1]) >= EQUAL:  # no transition curve between two pieces
            knots += _run_in((s[i], ends[i - 1]), (s[i], starts[i]), reach, (spare[i - 1], spare[i]))
        if not level[i]:
            beside = (spare[i - 1] if i else 0.0, spare[i + 1] if i + 1 < len(pieces) else 0.0)
            knots += _run_in((s[i], starts[i]), (s[i + 1], ends[i]), reach, beside)
    knots.append((s[-1], ends[-1]))
    return [knots[0], *(b for a, b in pairwise(knots) if b[0] - a[0] > SHORTEST)]


def _run_in(
    first: tuple[float, float], last: tuple[float, float], reach: float, spare: tuple[float, float]
) -> Knots:
    """Returns the knots of one run-in, made longer by at most the spare metres before and behind it."""
    (s0, start), (s1, end) = first, last
    lacking = max(abs(end - start) * reach / EDGE - (s1 - s0), 0.0) / 2
    return [(s0 - min(lacking, spare[0]), start), (s1 + min(lacking, spare[1]), end)]


def superelevation_for(curvature: Array, speed: float, ratio: float | None = None) -> Array:
    """Returns the superelevation in radians for curvatures in 1/m (positive to the left), without a run-in;
    for ``speed`` and ``ratio`` see ``superelevation``."""
    bend = np.abs(curvature)
    if ratio is None:
        sizes = np.minimum((speed * 3.6) ** 2 * bend / (100 * SHARE), MOST)
    else:
        sizes = np.where(bend > STRAIGHT, ratio, 0.0)
    return -np.copysign(np.arctan(sizes), curvature) + 0.0


def _smoothed(plan: PlanCurve, s: Array, speed: float, ratio: float | None) -> Array:
    """Returns the superelevation in radians at each station, averaged over ``RUN_IN`` metres around it."""
    fine = np.linspace(0.0, plan.length, max(2, math.ceil(plan.length)) + 1)
    angle = superelevation_for(plan.curvature(fine), speed, ratio)
    total = np.r_[0.0, np.cumsum(np.diff(fine) * ((angle[1:] + angle[:-1]) / 2))]
    low, high = np.clip(s - RUN_IN / 2, 0.0, plan.length), np.clip(s + RUN_IN / 2, 0.0, plan.length)
    return np.asarray((np.interp(high, fine, total) - np.interp(low, fine, total)) / (high - low))
