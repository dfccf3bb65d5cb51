"""The smallest change of lengths and turns that keeps all limits: least squares with penalties.

The objective is a weighted sum of squared relative changes, with weights that make a few larger changes cost
no more than many small ones, plus a penalty for each violated limit, in metres, whose weight grows from round
to round. Each step solves for all lengths, all turns and the place on the map at once (Levenberg-Marquardt).
"""

from math import radians
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roadgpt.design.repair.limits import Margins
from roadgpt.design.repair.polyline import Complex, PlanPolyline
from roadgpt.geometry.curve import Array
from roadgpt.road import World

Indices = NDArray[np.intp]

LENGTH_WEIGHT, TURN_WEIGHT = 1.0, 1.4  # of a relative change
LEAST_TURN_COUNTED = radians(15)  # changes of slighter turns are taken as relative to this
SPARSE = 2  # steps between the points that are held apart
HEADINGS = np.radians(
    [0, 5, -5, 10, -10, 15, -15, 20, -20, 30, -30, 40, -40, 45]
)  # of the start, in this order
NEIGHBOURS = 27.0  # m along the road: places nearer than this cannot meet
PENALTIES = (0.05, 1.0, 20.0)  # of a square metre that breaks a limit
STEPS = 25  # at every penalty, at most
SETTLED = 1e-5  # relative gain
FEW = 0.04  # a relative change below which it is no longer dearer to change one thing more
MOST_WORK = 2e7  # points squared, times steps: after so many no further start is tried (some 2 s)
BROKEN = 0.15  # m: by so much, margins included, a limit may be missed
CHEAP = 0.05  # of a change, for each segment: then no other start is tried
STARTS = (
    1.0,
    0.8,
    0.6,
    0.45,
    0.3,
    0.2,
)  # of all turns: where the search sets out; a straight road keeps clear


class Aim(NamedTuple):
    """The proposed lengths and turns, and the limits that they must keep."""

    lengths: Array
    turns: Array
    """Radians, left positive."""
    figure: PlanPolyline
    rows: Array
    most: Array
    world: World
    margins: Margins


class Solution(NamedTuple):
    """Lengths in metres, turns in radians, the cost of the change, and metres by which a limit is missed."""

    lengths: Array
    turns: Array
    cost: float
    broken: float
    steps: int
    """Number of solver steps that were taken."""


def solved(aim: Aim) -> Solution | None:
    """Returns the cheapest change that was found; None where none keeps the limits."""
    found: list[Solution] = []
    work = 0
    for share in STARTS:
        one = _descended(aim, share)
        work += one.steps * len(aim.figure.owner) ** 2
        if work > MOST_WORK:
            found += [one] if one.broken <= BROKEN else []
            break
        if one.broken <= BROKEN:
            found.append(one)
            if (share == 1.0 and one.cost < CHEAP * len(aim.lengths)) or len(found) == 2:
                break
    return min(found, key=lambda one: one.cost, default=None)


def _descended(aim: Aim, share: float) -> Solution:
    n = len(aim.lengths)
    hands = np.where(aim.turns < 0, -1.0, 1.0)
    start = np.concatenate([aim.lengths, share * np.abs(aim.turns), [0.0, 0.0, 0.0]])
    start[2 * n :] = _laid(aim, start, hands)
    units = _units(aim)
    weights = np.ones(2 * n)
    v, steps = start, 0
    for round_ in range(2):
        for penalty in PENALTIES[round_:]:
            v, taken = _settled(aim, hands, units, weights, v, penalty)
            steps += taken
        change = np.abs(units * (v[: 2 * n] - _proposed(aim)))
        weights = np.sqrt(FEW / (change + FEW))
    change = units * (v[: 2 * n] - _proposed(aim))
    broken = _misses(aim, hands, v, with_slopes=False)[0]
    return Solution(
        v[:n], hands * v[n : 2 * n], float(change @ change), float(broken.max(initial=0.0)), steps
    )


def _proposed(aim: Aim) -> Array:
    return np.concatenate([aim.lengths, np.abs(aim.turns)])


def _units(aim: Aim) -> Array:
    turns = np.abs(aim.turns)
    by_turn = np.where(turns > 0, TURN_WEIGHT / np.maximum(turns, LEAST_TURN_COUNTED), 100.0)
    return np.concatenate([LENGTH_WEIGHT / aim.lengths, by_turn])


def _laid(aim: Aim, v: Array, hands: Array) -> Array:
    """Heading and start at which the road's box is smallest, and lies in the middle of the map.

    Left at heading 0, a straight road would be made shorter, as a small turn alone gains nothing.
    """
    n = len(aim.lengths)
    z, _ = aim.figure.walk(v[:n], hands * v[n : 2 * n], 0.0)
    turned = np.exp(1j * HEADINGS)[:, None] * z
    box = np.maximum(np.ptp(turned.real, axis=1), np.ptp(turned.imag, axis=1))
    fits = np.flatnonzero(box <= aim.world.map_size - aim.world.road_width - 2 * aim.margins.edge)
    best = int(fits[0]) if fits.size else int(box.argmin())
    x, y = turned[best].real, turned[best].imag
    middle = np.array([np.ptp(x) / 2 + x.min(), np.ptp(y) / 2 + y.min()])
    return np.concatenate([HEADINGS[best : best + 1], aim.world.map_size / 2 - middle])


def _settled(
    aim: Aim, hands: Array, units: Array, weights: Array, v: Array, penalty: float
) -> tuple[Array, int]:
    """The bottom of the valley that ``v`` lies in, at one penalty, and the steps that it took."""
    n, damping = len(aim.lengths), 1e-3
    scale = np.concatenate([1 / units, [0.3, 20.0, 20.0]])
    own = np.diag(np.concatenate([weights**2, np.full(3, 1e-8)]))

    def total(at: Array) -> float:
        change = weights * units * (at[: 2 * n] - _proposed(aim))
        missed = _misses(aim, hands, at, with_slopes=False)[0]
        return float(change @ change + penalty * (missed @ missed))

    now = total(v)
    for taken in range(STEPS):
        missed, slopes = _misses(aim, hands, v, with_slopes=True)
        slopes = slopes * scale
        change = np.concatenate([weights**2 * units * (v[: 2 * n] - _proposed(aim)), np.zeros(3)])
        matrix = own + penalty * (slopes.T @ slopes)
        down = change + penalty * (slopes.T @ missed)
        for _ in range(6):
            step = np.linalg.solve(matrix + damping * np.diag(np.diag(matrix) + 1e-6), -down)
            step *= min(1.0, 0.5 / max(np.abs(step[:n]).max(), np.abs(step[n : 2 * n]).max(), 1e-12))
            after = v + scale * step
            after[: 2 * n] = np.maximum(after[: 2 * n], 0.0)
            after[:n] = np.maximum(after[:n], 0.1 * aim.lengths)
            then = total(after)
            if then < now:
                break
            damping *= 6
        else:
            return v, taken
        v, gained, now, damping = after, now - then, then, max(damping / 8, 1e-9)
        if gained < SETTLED * (now + 1e-9):
            break
    return v, taken


def _misses(aim: Aim, hands: Array, v: Array, with_slopes: bool) -> tuple[Array, Array]:
    """Metres by which limits are missed, ``(m,)``, and how each changes with every unknown."""
    n = len(aim.lengths)
    by_rows = aim.rows @ v[: 2 * n] - aim.most
    over = by_rows > 0
    z, steps = aim.figure.walk(v[:n], hands * v[n : 2 * n], v[2 * n])
    border = aim.world.road_width / 2 + aim.margins.edge
    x, y = z.real + v[2 * n + 1], z.imag + v[2 * n + 2]
    outside = np.stack(
        [border - x, border - y, x + border - aim.world.map_size, y + border - aim.world.map_size]
    )
    out = outside > 0
    one, other = _meeting(z, v[:n], aim)
    apart = aim.world.road_width + aim.margins.clear
    away = z[other] - z[one]
    size = np.maximum(np.abs(away), 1e-6)
    missed = np.concatenate([by_rows[over], outside[out], apart - size])
    if not with_slopes:
        return missed, missed
    by_length, by_turn = aim.figure.slopes(v[:n], steps)
    moves = np.concatenate([by_length, by_turn * (hands * (aim.turns != 0)), 1j * z[:, None]], axis=1)
    rows = np.concatenate([aim.rows[over], np.zeros((int(over.sum()), 3))], axis=1)
    which, point = np.nonzero(out)
    sign = np.where(which < 2, -1.0, 1.0)[:, None]
    along_y = (which % 2)[:, None]
    own = np.where(along_y, moves[point].imag, moves[point].real)
    box = sign * np.concatenate([own, 1 - along_y, along_y], axis=1)
    part = (moves[other] - moves[one]) * (away.conj() / size)[:, None]
    clear = np.concatenate([-part.real, np.zeros((len(one), 2))], axis=1)
    return missed, np.concatenate([rows, box, clear])


def _meeting(z: Complex, lengths: Array, aim: Aim) -> tuple[Indices, Indices]:
    """Pairs of points, every other one, that lie nearer to each other than the road may come to itself."""
    count = np.bincount(aim.figure.owner, minlength=len(lengths))
    s = np.concatenate([[0.0], np.cumsum((lengths / count)[aim.figure.owner])])[::SPARSE]
    x, y = z.real[::SPARSE], z.imag[::SPARSE]
    dx, dy = x[:, None] - x, y[:, None] - y
    near = dx * dx + dy * dy < (aim.world.road_width + aim.margins.clear) ** 2
    near &= s - s[:, None] > NEIGHBOURS
    one, other = np.nonzero(near)
    return SPARSE * one, SPARSE * other
