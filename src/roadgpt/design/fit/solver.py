"""Finds the smallest change to the lengths and turns of a plan that meets all limits. Main function:
``least_change``.

The objective is a weighted sum of squared relative changes. Its weights make a few larger changes cost no
more than many small ones. For each limit that is exceeded, the squared excess in metres is added as a
penalty, whose weight grows from round to round. Each step solves for all free lengths, all free turns and the
place on the map at once (Levenberg-Marquardt).
"""

from math import ceil, floor, radians
from typing import NamedTuple

import numpy as np

from roadgpt.design.fit.limits import Aim
from roadgpt.design.layout import neighbours
from roadgpt.geometry.curve import Array
from roadgpt.geometry.nearness import Complex, Indices, meeting
from roadgpt.road import Segment

LENGTH_WEIGHT, TURN_WEIGHT = 1.0, 1.4  # of a relative change
LEAST_TURN_COUNTED = radians(15)  # changes of slighter turns are taken as relative to this
SPARSE = 2  # steps between the points that are held apart
HEADINGS = np.radians([0, 5, -5, 10, -10, 15, -15, 20, -20, 30, -30, 40, -40, 45])  # of the start, in order
PENALTIES = (0.05, 1.0, 20.0)  # per square metre by which a limit is broken
STEPS = 25  # at every penalty, at most
SETTLED = 1e-5  # relative gain
FEW = 0.04  # relative change; values that change by more get a smaller weight in the second round
MOST_WORK = 2e7  # points squared, times steps: after this much no further start is tried (about 2 s)
BROKEN = 0.15  # m: a limit, margins included, may be broken by this much
CHEAP = 0.05  # cost of a change for each segment, below which no other start is tried
TENTH, CENTIMETRE = 10.0, 100.0  # per degree or metre, per metre: how changed numbers are written
SHORTEST_TRANSITION = 0.1  # m
STARTS = (1.0, 0.8, 0.6, 0.45, 0.3, 0.2)  # shares of all free turns where the search starts


class Solution(NamedTuple):
    """The lengths and turns that were found, the cost of the change, and how far limits are exceeded."""

    lengths: Array
    """Length of each segment in metres."""
    turns: Array
    """Turning angle of each segment in radians, left positive."""
    cost: float
    broken: float
    """Largest amount in metres by which a limit is exceeded."""
    steps: int
    """Number of solver steps that were taken."""


def least_change(aim: Aim) -> tuple[Segment, ...] | None:
    """Returns the segments with the cheapest change that was found; None if no change meets the limits.

    Limits that concern only frozen segments are ignored.
    """
    concerned = (aim.rows[:, np.tile(aim.free, 2)] != 0).any(axis=1)
    aim = aim._replace(rows=aim.rows[concerned], most=aim.most[concerned])
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
    best = min(found, key=lambda one: one.cost, default=None)
    return None if best is None else _written(aim, best.lengths, best.turns)


def _descended(aim: Aim, share: float) -> Solution:
    n = len(aim.lengths)
    hands = np.where(aim.turns < 0, -1.0, 1.0)
    start = np.concatenate([aim.lengths, np.where(aim.free, share, 1.0) * np.abs(aim.turns), [0.0, 0.0, 0.0]])
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
    broken, _ = _misses(aim, hands, v, with_slopes=False)
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
    """Returns the first heading tried at which the road fits on the map, and the start that centres it there.

    If it fits at none, the heading with the smallest bounding box is returned. If the search always began at
    heading 0, a straight road would be shortened, because a small rotation by itself gains nothing.
    """
    n = len(aim.lengths)
    z, _ = aim.figure.walk(v[:n], hands * v[n : 2 * n], 0.0)
    turned = np.exp(1j * HEADINGS)[:, None] * z
    box = np.maximum(np.ptp(turned.real, axis=1), np.ptp(turned.imag, axis=1))
    fits = np.flatnonzero(
        box <= aim.world.site.map_size - aim.world.section.road_width - 2 * aim.margins.edge
    )
    best = int(fits[0]) if fits.size else int(box.argmin())
    x, y = turned[best].real, turned[best].imag
    middle = np.array([np.ptp(x) / 2 + x.min(), np.ptp(y) / 2 + y.min()])
    return np.concatenate([HEADINGS[best : best + 1], aim.world.site.map_size / 2 - middle])


def _settled(
    aim: Aim, hands: Array, units: Array, weights: Array, v: Array, penalty: float
) -> tuple[Array, int]:
    """Returns the local minimum reached from ``v`` at one penalty, and the number of steps taken."""
    n, damping = len(aim.lengths), 1e-3
    free = np.concatenate([np.tile(aim.free, 2), [True] * 3])
    scale = np.concatenate([1 / units, [0.3, 20.0, 20.0]])[free]
    own = np.diag(np.concatenate([weights**2, np.full(3, 1e-8)])[free])

    def total(at: Array) -> float:
        change = weights * units * (at[: 2 * n] - _proposed(aim))
        missed, _ = _misses(aim, hands, at, with_slopes=False)
        return float(change @ change + penalty * (missed @ missed))

    now = total(v)
    for taken in range(STEPS):
        missed, slopes = _misses(aim, hands, v)
        slopes = slopes[:, free] * scale
        change = np.concatenate([weights**2 * units * (v[: 2 * n] - _proposed(aim)), np.zeros(3)])[free]
        matrix = own + penalty * (slopes.T @ slopes)
        down = change + penalty * (slopes.T @ missed)
        for _ in range(6):
            step = np.linalg.solve(matrix + damping * np.diag(np.diag(matrix) + 1e-6), -down)
            step *= min(1.0, 0.5 / max(np.abs(step[:-3]).max(), 1e-12))
            after = v.copy()
            after[free] += scale * step
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


def _misses(aim: Aim, hands: Array, v: Array, with_slopes: bool = True) -> tuple[Array, Array]:
    """Returns the metres by which limits are exceeded, ``(m,)``, and their derivatives by every unknown."""
    n = len(aim.lengths)
    by_rows = aim.rows @ v[: 2 * n] - aim.most
    over = by_rows > 0
    z, steps = aim.figure.walk(v[:n], hands * v[n : 2 * n], v[2 * n])
    border = aim.world.section.road_width / 2 + aim.margins.edge
    x, y = z.real + v[2 * n + 1], z.imag + v[2 * n + 2]
    outside = np.stack(
        [border - x, border - y, x + border - aim.world.site.map_size, y + border - aim.world.site.map_size]
    )
    out = outside > 0
    one, other = _meeting(z, v[:n], aim)
    apart = aim.world.section.road_width + aim.margins.clear
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
    """Returns pairs of points that lie nearer to each other than the road may come to itself.

    Only every second point is compared. Points with no free segment between them are left out, because their
    distance cannot change.
    """
    owner = aim.figure.owner
    count = np.bincount(owner, minlength=len(lengths))
    s = np.concatenate([[0.0], np.cumsum((lengths / count)[owner])])[::SPARSE]
    moved = np.concatenate([[0], np.cumsum(aim.free[owner])])[::SPARSE]
    points, apart = z[::SPARSE], aim.world.section.road_width + aim.margins.clear
    other, one = meeting(points, s, points, s, apart, neighbours(apart))
    free = moved[other] > moved[one]
    return SPARSE * one[free], SPARSE * other[free]


def _written(aim: Aim, lengths: Array, turns: Array) -> tuple[Segment, ...]:
    """Returns the segments with new lengths and turns, rounded.

    Radii are scaled accordingly. A radius that becomes too small is removed together with its transition, and
    a transition that becomes too long is shortened.
    """
    tightest = aim.world.limits.min_radius * aim.margins.radius
    out = []
    for segment, length, turn, may_change in zip(aim.proposed, lengths, turns, aim.free, strict=True):
        if not may_change:
            out.append(segment)
            continue
        distance = _rounded(float(length), segment.distance)
        degrees = _rounded(float(np.degrees(turn)), segment.turn_degrees)
        radius, transition = segment.radius, segment.transition
        if radius and degrees:
            grown = radius * (distance / segment.distance) * (segment.turn_degrees / degrees)
            if grown < tightest:
                radius = transition = None
            elif grown != radius:
                radius = ceil(grown * CENTIMETRE) / CENTIMETRE
        if degrees and not radius:
            most = max(distance - tightest * abs(np.radians(degrees)), SHORTEST_TRANSITION)
            if (transition or min(distance / 4, 12.0)) > most:
                transition = floor(most * TENTH) / TENTH
        update = {"distance": distance, "turn_degrees": degrees, "radius": radius, "transition": transition}
        out.append(segment.model_copy(update=update))
    return tuple(out)


def _rounded(value: float, before: float) -> float:
    """Returns a value rounded to a tenth; the value before, if the difference is at most 0.5 %."""
    return before if abs(value - before) <= 0.005 * abs(before) else round(value * TENTH) / TENTH
