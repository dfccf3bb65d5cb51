r"""How fast a driver means to be at every station of its line: the friction circle, swept both ways.

    limit    ____________                    ______________
                         \                  /                 backward sweep: brake in time
    corner                \______arc_______/                  forward sweep: no faster than the engine allows

Source: the usual quasi-steady sweep, e.g. Kapania, Subosits, Gerdes (2016),
https://doi.org/10.1115/1.4033311.
"""

import math
from dataclasses import dataclass

from roadgpt.drive.driving_line import Line

GRAVITY = 9.81  # m/s^2
SLOWEST = 1.0  # m/s: no bend is planned slower, so that nobody stands still before one
LIGHTEST = 0.4  # share of gravity that must stay on the wheels on a crest


@dataclass(frozen=True)
class Limits:
    """What a driver asks of car and road, as shares of the load on the wheels."""

    lateral: float
    """Sideways acceleration in a steady bend, in g."""
    braking: float
    """In g, straight on."""
    traction: float
    """In g, straight on."""
    speed: float
    """m/s."""
    power: float = 100.0
    """W per kg: above some speed the engine allows less than the tyres."""


def plan_speed(line: Line, limits: Limits) -> list[float]:
    """Speeds in m/s at every station of the line.

    The load on the wheels is that of the slope and of the crest or dip: ``g cos + v^2 * vertical curvature``.
    """
    top = [_corner_speed(line, i, limits) for i in range(len(line.x))]
    _sweep(line, top, limits.lateral, limits.braking, math.inf, forward=False)
    _sweep(line, top, limits.lateral, limits.traction, limits.power, forward=True)
    return top


def _corner_speed(line: Line, i: int, limits: Limits) -> float:
    """The speed at which a steady bend takes all of the lateral limit, or a crest too much of the load."""
    steep = 1 / math.hypot(1.0, line.grade[i])
    crest = line.crest[i] * steep**3
    needed = abs(line.curvature[i]) - limits.lateral * crest
    square = limits.speed**2
    if needed > 1e-9:
        square = min(square, limits.lateral * GRAVITY * steep / needed)
    if crest < -1e-9:
        square = min(square, (1 - LIGHTEST) * GRAVITY * steep / -crest)
    return math.sqrt(max(square, SLOWEST**2))


def _sweep(
    line: Line, top: list[float], lateral: float, along: float, power: float, *, forward: bool
) -> None:
    """Lowers speeds that cannot be reached from the station before (forward) or left in time (backward)."""
    way = 1 if forward else -1
    order = range(len(top)) if forward else range(len(top) - 1, -1, -1)
    before = top[order[0]] if not forward else 0.0
    for i in order:
        v2 = before * before
        steep = 1 / math.hypot(1.0, line.grade[i])
        load = max(GRAVITY * steep + v2 * line.crest[i] * steep**3, LIGHTEST * GRAVITY)
        used = min(v2 * abs(line.curvature[i]) / (lateral * load), 1.0)
        pull = min(along * load * math.sqrt(1 - used * used), power / max(before, 1.0))
        pull -= way * GRAVITY * line.grade[i] * steep
        reached = math.sqrt(max(v2 + 2 * pull * line.step * line.stretch[i], SLOWEST**2))
        top[i] = before = min(top[i], reached)
