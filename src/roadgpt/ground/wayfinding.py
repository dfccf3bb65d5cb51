"""Finds a way for a road over given land, from one point to another: not steeper than a grade, no bend
tighter than a radius, and with little earthworks.

The search lays arcs and straights one behind another and keeps, for each cell and direction, the cheapest way
there (Galin et al., *Procedural Generation of Roads*, CGF 29(2), 2010, with the states of Hybrid A*: Dolgov
et al., *Practical Search Techniques in Path Planning*, 2008). Its height follows the land as closely as the
grade allows; what lies between is paid for. Then clothoids join the arcs, and a linear programme finds the
profile with the least area between road and land."""

import heapq
import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog
from scipy.sparse import csr_array, eye_array, hstack, vstack

from roadgpt.compiled import compiled, inlined
from roadgpt.errors import UsageError
from roadgpt.geometry import GradeProfile, Piece, PieceCurve
from roadgpt.geometry.curve import Array
from roadgpt.ground.relief import Relief, cubic_at

MOVE = 12.0  # m of one arc or straight
CELL = 8.0  # m, side of the cells in which ways are compared
DIRECTIONS = 32
SHARES = (0.0, 0.5, -0.5, 1.0, -1.0)  # of the greatest curvature
MOST_STATES = 600_000
NEAR = 45.0  # m from the end, where a single arc may lead there
DEEPEST = 15.0  # m, of cuttings and fills
DEEP_COST = (0.3, 0.12)  # m of way for each m of way and m of depth, and m^2 of depth
BAND = 4.0  # m above or below the land, beyond which another way to the same place is kept
CLEAR = 20.0  # m between a way and its own earlier course
OLDER = 5  # moves after which it is earlier
GENTLER = 0.97  # share of the grade that the search uses: vertical curves take the rest
BEND_COST = 0.15  # share of a move, for the tightest bend
TRIES = (
    (1.0, False, 1.03), (1.0, True, 1.03), (0.15, False, 1.03), (0.15, True, 1.03), (1.0, False, 1.2),
    (0.15, True, 1.2), (0.02, False, 1.1), (0.02, True, 1.1),
)  # fmt: skip
"""The share of the usual cost of depth, whether the way is sought from its end, and by how much radii are
larger in the search, as leading the way to its end takes some of them."""
CLOTHOID = 10.0  # m
ROUNDS = 6  # of leading a curve to its end
SCALED = 0.02  # how readily a curve is scaled rather than its straights made longer
SHORTEST = 0.5  # m, of a straight
KNOT = 8.0  # m between the knots of a profile
SMOOTH = 0.05  # m of distance from the land that a change of grade of 1 is worth
LEAST_VERTICAL = 300.0  # m, radius of crests and dips
MARGIN = 14.0  # m from the border of the land


@dataclass(frozen=True, eq=False)
class FoundWay:
    """A way over land."""

    plan: PieceCurve
    elevation: GradeProfile
    deepest: float  # greatest depth of a cutting or height of a fill in metres


def way_between(
    relief: Relief, start: tuple[float, float], end: tuple[float, float], steepest: float, radius: float
) -> FoundWay:
    """Returns a way from one point (x, y) in metres to another, on the land at both.

    Raises UsageError with the place and the limit if there is none: ``steepest`` as a ratio, ``radius`` in
    metres, and cuttings and fills of DEEPEST."""
    start, end = (float(start[0]), float(start[1])), (float(end[0]), float(end[1]))
    size = np.array(relief.size)
    for name, point in (("start", start), ("end", end)):
        if not (np.array(point) > MARGIN).all() or not (np.array(point) < size - MARGIN).all():
            raise UsageError(
                f"the {name} ({point[0]:g}, {point[1]:g}) is not on the land, which reaches from "
                f"({MARGIN:g}, {MARGIN:g}) to ({size[0] - MARGIN:g}, {size[1] - MARGIN:g})"
            )
    if math.dist(start, end) < 4 * MOVE:
        raise UsageError(
            f"start and end are {math.dist(start, end):.0f} m apart; give points {4 * MOVE:g} m apart"
        )
    nearest = (*start, math.dist(start, end))
    for cheap, is_back, spare in TRIES:
        a, b = (end, start) if is_back else (start, end)
        bends, lengths, heading, near = searched(
            relief.heights, relief.cell, *a, *b, GENTLER * steepest, 1.0 / (radius * spare), cheap
        )
        if not len(bends):
            nearest = min(nearest, near, key=lambda each: each[2]) if not is_back else nearest
            continue
        plan = _joined(bends, lengths, heading, a, b)
        if max(max(abs(piece.k0), abs(piece.k1)) for piece in plan.pieces) > 1.0 / radius:
            continue
        plan = _reversed(plan) if is_back else plan
        if (found := profile_over(relief, plan, steepest)) is not None:
            return FoundWay(plan, *found)
    x, y, left = nearest
    here, east, north = relief.at(np.array([x, x + 1.0, x]), np.array([y, y, y + 1.0])).tolist()
    raise UsageError(
        f"no road of {100 * steepest:g} % or less with bends of {radius:g} m and cuttings and fills up to "
        f"{DEEPEST:g} m was found from ({start[0]:g}, {start[1]:g}) to ({end[0]:g}, {end[1]:g}); the nearest "
        f"way ends at ({x:.0f}, {y:.0f}), {left:.0f} m before it, where the land rises by "
        f"{100 * math.hypot(east - here, north - here):.0f} %"
    )


def _reversed(curve: PieceCurve) -> PieceCurve:
    """Returns a curve in the other direction."""
    x, y = curve.at(np.array([curve.length]))[0].tolist()
    pieces = tuple(Piece(piece.length, -piece.k1, -piece.k0) for piece in reversed(curve.pieces))
    return PieceCurve(x, y, float(curve.heading(np.array([curve.length]))[0]) + math.pi, pieces)


@inlined
def _meets(state: Array, parent: NDArray[np.int32], n: int, x: float, y: float) -> bool:
    """Returns whether a point is too near to the way that leads to state ``n``."""
    steps = 0
    while n >= 0:
        steps += 1
        if steps > OLDER and (state[n, 0] - x) ** 2 + (state[n, 1] - y) ** 2 < CLEAR * CLEAR:
            return True
        n = parent[n]
    return False


@compiled
def searched(
    land: Array, cell: float, x0: float, y0: float, x1: float, y1: float, steepest: float, tightest: float,
    cheap: float,
) -> tuple[Array, Array, float, tuple[float, float, float]]:  # fmt: skip
    """Returns the curvatures (1/m) and lengths of the moves of a way and its heading at the start, no moves
    if there is none; and where the way came nearest to the end: x, y and the distance in metres."""
    wide, high = (land.shape[1] - 1) * cell, (land.shape[0] - 1) * cell
    columns, rows = int(wide / CELL) + 1, int(high / CELL) + 1
    best = np.full((rows, columns, DIRECTIONS, 3), np.inf)
    state = np.empty((MOST_STATES, 6))  # x, y, heading, z, cost, curvature of the move there
    parent = np.full(MOST_STATES, -1, np.int32)
    length, band = np.full(MOST_STATES, MOVE), np.ones(MOST_STATES, np.int8)
    z0, z1 = cubic_at(land, 0.0, 0.0, cell, x0, y0), cubic_at(land, 0.0, 0.0, cell, x1, y1)
    count = 0
    queue = [(0.0, 0)]
    queue.pop()
    for k in range(DIRECTIONS):
        state[count] = x0, y0, 2.0 * math.pi * k / DIRECTIONS, z0, 0.0, 0.0
        heapq.heappush(queue, (0.0, count))
        count += 1
    near, last = (x0, y0, math.hypot(x1 - x0, y1 - y0)), -1
    while len(queue) > 0 and count < MOST_STATES - len(SHARES) - 1:
        _, n = heapq.heappop(queue)
        x, y, heading, z, cost, _bend = state[n]
        i, j = int(x / CELL), int(y / CELL)
        d = int(heading / (2.0 * math.pi) * DIRECTIONS + 0.5) % DIRECTIONS
        if cost > best[j, i, d, band[n]] + 1e-9 and parent[n] >= 0:
            continue
        away = math.hypot(x1 - x, y1 - y)
        if away < near[2]:
            near = (x, y, away)
        if away < NEAR and parent[n] >= 0:
            aim = math.atan2(y1 - y, x1 - x) - heading
            aim = math.atan2(math.sin(aim), math.cos(aim))
            bend = 2.0 * math.sin(aim) / max(away, 1e-9)
            arc = away if abs(aim) < 1e-6 else away * aim / math.sin(aim)
            bulge = math.tan(aim / 2.0)
            u, v = (x + x1 + bulge * (y1 - y)) / 2.0, (y + y1 - bulge * (x1 - x)) / 2.0  # half-way
            is_clear = not _meets(state, parent, n, u, v) and not _meets(state, parent, n, x1, y1)
            if is_clear and abs(bend) <= tightest and abs(aim) < 1.2 and abs(z1 - z) <= steepest * arc:
                state[count] = x1, y1, heading + bend * arc, z1, cost, bend
                parent[count], length[count] = n, arc
                last = count
                break
        for share in SHARES:
            bend = share * tightest
            total, height, is_out, u, v, h, depth, ground = 0.0, z, False, x, y, heading, 0.0, 0.0
            for _ in range(2):  # half moves, along the chord of the arc
                turn = bend * MOVE / 2.0
                u, v, h = (
                    u + MOVE / 2.0 * math.cos(h + turn / 2.0),
                    v + MOVE / 2.0 * math.sin(h + turn / 2.0),
                    h + turn,
                )
                if u < MARGIN or v < MARGIN or u > wide - MARGIN or v > high - MARGIN:
                    is_out = True
                    break
                ground = cubic_at(land, 0.0, 0.0, cell, u, v)
                most = steepest * MOVE / 2.0
                height = min(max(ground, height - most), height + most)
                depth = abs(height - ground)
                if depth > DEEPEST:
                    is_out = True
                    break
                total += MOVE / 2.0 * (1.0 + cheap * depth * (DEEP_COST[0] + DEEP_COST[1] * depth))
            if is_out or _meets(state, parent, n, u, v):
                continue
            h = h % (2.0 * math.pi)
            whole = cost + total + BEND_COST * MOVE * abs(share)
            i, j = int(u / CELL), int(v / CELL)
            d = int(h / (2.0 * math.pi) * DIRECTIONS + 0.5) % DIRECTIONS
            level = 1 if depth < BAND else 2 if height > ground else 0
            if whole < best[j, i, d, level] - 1e-9:
                best[j, i, d, level] = whole
                band[count] = level
                state[count] = u, v, h, height, whole, bend
                parent[count], length[count] = n, MOVE
                left = max(math.hypot(x1 - u, y1 - v), abs(z1 - height) / steepest)
                heapq.heappush(queue, (whole + left, count))
                count += 1
    moves, n = 0, last
    while n >= 0 and parent[n] >= 0:
        moves += 1
        n = parent[n]
    bends, lengths, n = np.empty(moves), np.empty(moves), last
    for k in range(moves - 1, -1, -1):
        bends[k], lengths[k] = state[n, 5], length[n]
        n = parent[n]
    return bends, lengths, state[max(n, 0), 2], near


def _joined(
    bends: Array, lengths: Array, heading: float, start: tuple[float, float], end: tuple[float, float]
) -> PieceCurve:
    """Returns the curve whose curvature is the mean of that of the moves over CLOTHOID metres around each
    place, turned and scaled a little so that it ends where it has to."""
    stops = np.r_[0.0, np.cumsum(lengths)]
    jumps = np.r_[bends[0], np.diff(bends), -bends[-1]]
    half = CLOTHOID / 2
    knots = np.unique(np.round(np.r_[0.0, (stops[1:-1, None] + [-half, half]).ravel(), stops[-1]], 6))
    knots = knots[(knots >= 0) & (knots <= stops[-1])]

    def curvature(s: Array) -> Array:
        inner = np.clip((s[:, None] - stops[1:-1] + half) / CLOTHOID, 0.0, 1.0)
        return np.asarray(jumps[0] + inner @ jumps[1:-1])

    values = curvature(knots)
    pieces = tuple(
        Piece(float(b - a), float(k0), float(k1))
        for a, b, k0, k1 in zip(knots[:-1], knots[1:], values[:-1], values[1:], strict=True)
        if b - a > 1e-6
    )
    return _led_to(PieceCurve(*start, heading, pieces), end)


def _led_to(curve: PieceCurve, end: tuple[float, float]) -> PieceCurve:
    """Returns a curve that ends at a point: turned about its start, and its straights made longer or shorter.
    What straights cannot give, a change of scale gives."""
    for _ in range(ROUNDS):
        lengths = np.array([piece.length for piece in curve.pieces])
        is_straight = np.array([piece.k0 == piece.k1 == 0 for piece in curve.pieces])
        reached = curve.at(np.array([curve.length]))[0]
        ahead = curve.heading(np.cumsum(lengths)[is_straight])
        arm = reached - [curve.x, curve.y]
        moves = np.column_stack([np.cos(ahead), np.sin(ahead)])
        whole = np.vstack([moves, [-arm[1], arm[0]], arm * SCALED])
        change = np.linalg.lstsq(whole.T, np.subtract(end, reached), rcond=None)[0]
        lengths[is_straight] = np.maximum(lengths[is_straight] + change[:-2], SHORTEST)
        scale = 1.0 + float(change[-1]) * SCALED
        pieces = tuple(
            Piece(float(length) * scale, piece.k0 / scale, piece.k1 / scale)
            for length, piece in zip(lengths, curve.pieces, strict=True)
        )
        curve = PieceCurve(curve.x, curve.y, curve.heading0 + float(change[-2]), pieces)
    return curve


def profile_over(
    relief: Relief, plan: PieceCurve, steepest: float, deepest: float = DEEPEST
) -> tuple[GradeProfile, float] | None:
    """Returns the profile along a plan with the least area between road and land, which begins and ends on
    the land; and its greatest distance from the land in metres. None if the limits allow none."""
    n = max(4, round(plan.length / KNOT) + 1)
    s = np.linspace(0.0, plan.length, n)
    land = relief.at(*plan.at(s).T)
    step = plan.length / (n - 1)
    # unknown: grades at the knots, heights there, distances from the land, and changes of grade
    no, one, few = csr_array((n - 1, n)), eye_array(n, format="csr"), eye_array(n - 1, format="csr")
    before, behind = eye_array(n - 1, n, format="csr"), eye_array(n - 1, n, k=1, format="csr")
    turn, nothing, none = behind - before, csr_array((n, n)), csr_array((n, n - 1))
    equal: Any = hstack([-step / 2 * (before + behind), turn, no, csr_array((n - 1, n - 1))])
    limits: Any = vstack([
        hstack([turn, no, no, -few]), hstack([-turn, no, no, -few]),
        hstack([nothing, one, -one, none]), hstack([nothing, -one, -one, none]),
    ])  # fmt: skip
    ends = [(land[0], land[0]), *[(None, None)] * (n - 2), (land[-1], land[-1])]
    solved = linprog(
        np.r_[np.zeros(2 * n), np.ones(n), np.full(n - 1, SMOOTH)],
        limits, np.r_[np.zeros(2 * n - 2), land, -land], equal, np.zeros(n - 1),
        bounds=[*[(-steepest, steepest)] * n, *ends, *[(0.0, deepest)] * n,
                *[(0.0, step / LEAST_VERTICAL)] * (n - 1)], method="highs",
    )  # fmt: skip
    if solved.x is None:
        return None
    grades = solved.x[:n]
    profile = GradeProfile(float(land[0]), tuple(s.tolist()), tuple(grades.tolist()))
    return profile, float(solved.x[2 * n : 3 * n].max())
