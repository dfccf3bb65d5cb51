r"""Plans a driver's speed along its path, limited by the friction circle, in two sweeps over all stations.

    limit    ____________                    ______________
                         \                  /                 backward sweep: brake in time
    corner                \______arc_______/                  forward sweep: no faster than the engine allows

Source: the usual quasi-steady method, for example Kapania, Subosits, Gerdes (2016),
https://doi.org/10.1115/1.4033311.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike

from roadgpt.geometry.curve import Array
from roadgpt.road.world import World

GRAVITY = 9.81  # m/s^2
SLOWEST = 1.0  # m/s: no bend is planned slower, so that a car never stops before one
LIGHTEST = 0.4  # share of gravity that must remain as wheel load on a crest
LATERAL, BRAKING, TRACTION = 0.64, 0.9, 0.7  # g, of the car for which roads are checked
LEAST_STRETCH = 0.2  # m of lane per m of road, on the inside of a bend


class PathGeometry(Protocol):
    """The geometry of a driven path. Every sequence has one value per station."""

    @property
    def step(self) -> float:
        """Distance between consecutive stations in metres, measured along the road."""

    @property
    def stretch(self) -> Sequence[float]:
        """Length of path per length of road at each station; below 1 on the inside of a bend."""

    @property
    def curvature(self) -> Sequence[float]:
        """Curvature of the path in 1/m, which differs from that of the road."""

    @property
    def grade(self) -> Sequence[float]:
        """Grade as a ratio."""

    @property
    def crest(self) -> Sequence[float]:
        """Vertical curvature in 1/m, negative on a crest."""


@dataclass(frozen=True)
class DrivingLimits:
    """The limits that a driver respects: accelerations in multiples of g, speed, and engine power."""

    lateral: float
    """Largest lateral acceleration in a steady bend, in g."""
    braking: float
    """Largest deceleration when braking on a straight, in g."""
    traction: float
    """Largest acceleration when speeding up on a straight, in g."""
    speed: float
    """Speed limit in m/s."""
    power: float = 100.0
    """Engine power per mass of the car in W/kg, which limits the acceleration at higher speeds."""


class _LanePath(NamedTuple):
    """The middle of a lane as a PathGeometry."""

    step: float
    stretch: Sequence[float]
    curvature: Sequence[float]
    grade: Sequence[float]
    crest: Sequence[float]


def expected_speed(curvature: ArrayLike, grade: ArrayLike, step: float, world: World) -> Array:
    """Returns the speeds in m/s at which a car is expected to drive along a road from a standing start.

    The car drives on dry asphalt in the middle of the right lane, within the speed limit and the default
    driver's limits of acceleration. Arguments are as for ``lane_speed``.
    """
    limits = DrivingLimits(LATERAL, BRAKING, TRACTION, world.speed_limit)
    s = step * np.arange(np.size(curvature))
    offset = world.usual_profile(float(s[-1]) or step).middle(s)
    return lane_speed(curvature, grade, step, offset, limits)


def lane_speed(
    curvature: ArrayLike, grade: ArrayLike, step: float, offset: ArrayLike, limits: DrivingLimits
) -> Array:
    """Returns the speeds in m/s, from a standing start, of a car in the middle of the right lane.

    The car slows down for bends but not for crests. Otherwise a more abrupt crest would have a lower planned
    speed, and would appear gentler than it is.

    Args:
        curvature: Curvature of the centre line in 1/m, ``(n,)``.
        grade: Grade as a ratio, ``(n,)`` or one value for all stations.
        step: Distance between stations in metres.
        offset: Offset of the middle of the lane in metres to the left of the centre line, ``(n,)``.
        limits: The limits of acceleration, speed and power that the driver respects.
    """
    bend = np.asarray(curvature, float)
    along = np.maximum(1 - bend * offset, LEAST_STRETCH)
    grades = np.broadcast_to(np.asarray(grade, float), bend.shape)
    level = [0.0] * len(bend)
    lane = _LanePath(step, along.tolist(), (bend / along).tolist(), grades.tolist(), level)
    return np.array(plan_speed(lane, limits))


def plan_speed(line: PathGeometry, limits: DrivingLimits) -> list[float]:
    """Returns the speed in m/s at every station of the path.

    The wheel load per mass includes the slope and the crest or dip:
    ``g cos(slope angle) + v^2 * vertical curvature``.
    """
    top = [_corner_speed(line, i, limits) for i in range(len(line.grade))]
    _sweep(line, top, limits.lateral, limits.braking, math.inf, forward=False)
    _sweep(line, top, limits.lateral, limits.traction, limits.power, forward=True)
    return top


def _corner_speed(line: PathGeometry, i: int, limits: DrivingLimits) -> float:
    """Returns the speed at which a bend uses all of the lateral limit, or a crest too much of the load."""
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
    line: PathGeometry, top: list[float], lateral: float, along: float, power: float, *, forward: bool
) -> None:
    """Lowers speeds that cannot be reached from the previous station (forward) or left in time (backward)."""
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
