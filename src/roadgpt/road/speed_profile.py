r"""Plans a car's speed along its path, limited by the friction circle, in two sweeps over all stations.

    limit    ____________                    ______________
                         \                  /                 backward sweep: brake in time
    corner                \______arc_______/                  forward sweep: no faster than the engine allows

Source: the usual quasi-steady method, for example Kapania, Subosits, Gerdes (2016),
https://doi.org/10.1115/1.4033311. On a road that is inclined by the angle e towards the inside of a bend of
curvature k, the tyres carry, per unit of mass, a lateral force of ``v^2 k cos e - g sin e`` and a wheel load
of ``g cos e + v^2 k sin e``."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import repeat
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from roadgpt.geometry.curve import LEAST_STRETCH, Array
from roadgpt.road.profile import Profile, superelevation_for
from roadgpt.road.world import World

GRAVITY = 9.81  # m/s^2
SLOWEST = 1.0  # m/s: no planned speed is lower, so that a car never stops before a bend
LIGHTEST = 0.4  # share of gravity that must remain as wheel load on a crest
LATERAL, BRAKING, TRACTION = 0.64, 0.9, 0.7  # g, of the car for which roads are checked


@dataclass(frozen=True, eq=False)
class PathGeometry:
    """The geometry of a driven path, as lists over equally spaced stations of the road."""

    step: float  # distance in metres between stations along the road
    stretch: list[float]
    """Length of the path per metre of the road's centre line; below 1 on the inside of a bend."""
    curvature: list[float]  # curvature of the path itself in 1/m, positive to the left
    grade: list[float]  # grade of the road as a ratio
    crest: list[float]  # vertical curvature of the road in 1/m, negative on a crest
    superelevation: list[float]
    """Superelevation of the road in radians, positive where the surface falls to the right."""


@dataclass(frozen=True)
class DrivingLimits:
    """The limits that a driver respects. Accelerations are in multiples of g."""

    lateral: float  # largest lateral acceleration in a steady bend, in g
    braking: float  # largest deceleration when braking on a straight, in g
    traction: float  # largest acceleration when speeding up on a straight, in g
    speed: float  # speed limit in m/s
    power: float = 100.0
    """Engine power per mass of the car in W/kg, which limits the acceleration at higher speeds."""
    first: float = 0.0  # speed in m/s with which the car comes to the start of its path


def expected_speed(
    curvature: ArrayLike, grade: ArrayLike, step: float, world: World, profile: Profile | None = None
) -> Array:
    """Returns the speeds in m/s at which a car is expected to drive along a road from a standing start.

    The car drives on dry asphalt in the middle of its lane, within the speed limit and the default driver's
    limits of acceleration. ``curvature``, ``grade`` and ``step`` are as in ``lane_speed``. ``profile`` is the
    cross-section of the road; with None, the road has the lanes and the superelevation of the World."""
    limits = DrivingLimits(LATERAL, BRAKING, TRACTION, world.limits.speed_limit)
    s = step * np.arange(np.size(curvature))
    if profile is not None:
        angle: ArrayLike = profile.superelevation(s)
    elif world.section.bank != "none":
        angle = superelevation_for(
            np.asarray(curvature, float), world.limits.speed_limit, world.section.bank_ratio
        )
    else:
        angle = 0.0
    lanes = profile or world.section.profile(float(s[-1]) or step)
    return lane_speed(curvature, grade, step, lanes.middle(s), limits, angle)


def lane_speed(
    curvature: ArrayLike,
    grade: ArrayLike,
    step: float,
    offset: ArrayLike,
    limits: DrivingLimits,
    superelevation: ArrayLike = 0.0,
) -> Array:
    """Returns the speeds in m/s of a car that drives in the middle of its lane.

    The car slows down for bends but not for crests, so that the check for abrupt crests is made at full
    speed. The arguments have values at stations ``step`` metres apart. ``curvature`` ``(n,)`` in 1/m and
    ``grade``, a ratio, are those of the centre line. ``superelevation`` is in radians, positive where the
    surface falls to the right. ``offset`` is that of the middle of the lane, in metres to the left. All but
    the curvature may be one value for all stations."""
    bend = np.asarray(curvature, float)
    angle, grades = (np.broadcast_to(np.asarray(each, float), bend.shape) for each in (superelevation, grade))
    along = np.maximum(1 - bend * offset * np.cos(angle), LEAST_STRETCH)
    level = [0.0] * len(bend)
    lane = PathGeometry(step, along.tolist(), (bend / along).tolist(), grades.tolist(), level, angle.tolist())
    return np.array(plan_speed(lane, limits))


def plan_speed(
    line: PathGeometry, limits: DrivingLimits, highest: Sequence[float] | None = None
) -> list[float]:
    """Returns the speed in m/s at every station of the path; ``highest`` limits it further at each station.
    The wheel load takes slopes, crests, dips and superelevation into account. Per unit of mass and without
    superelevation, it is ``g cos a + v^2 k cos(a)^3``, where a is the slope angle and k is ``line.crest``."""
    slopes = list(map(_inclination, line.grade, line.superelevation, line.curvature))
    top = list(map(_corner_speed, slopes, line.curvature, line.crest, repeat(limits)))
    if highest is not None:
        top = [min(speed, most) for speed, most in zip(top, highest, strict=True)]
    _sweep(line, slopes, top, top[-1], limits.lateral, limits.braking, math.inf, forward=False)
    _sweep(line, slopes, top, limits.first, limits.lateral, limits.traction, limits.power, forward=True)
    return top


class _Inclination(NamedTuple):
    """How the road is inclined at one station."""

    level: float  # cosine of the slope along the road
    cube: float  # the third power of ``level``
    cos: float  # cosine of the superelevation
    sin: float  # sine of the superelevation, positive where the surface falls to the inside of the bend


def _inclination(grade: float, superelevation: float, curvature: float) -> _Inclination:
    level = 1 / math.hypot(1.0, grade)
    inwards = -math.copysign(1.0, curvature) * math.sin(superelevation)
    return _Inclination(level, level**3, math.cos(superelevation), inwards)


def _corner_speed(slope: _Inclination, curvature: float, crest: float, limits: DrivingLimits) -> float:
    """Returns the highest speed in m/s within the speed limit, the lateral limit and the least wheel load on
    a crest."""
    level, cube, cos, sin = slope
    crest *= cube
    needed = abs(curvature) * (cos - limits.lateral * sin) - limits.lateral * crest
    square = limits.speed**2
    if needed > 1e-9:
        square = min(square, (limits.lateral * cos + sin) * GRAVITY * level / needed)
    if crest < -1e-9:
        square = min(square, (1 - LIGHTEST) * GRAVITY * level / -crest)
    return math.sqrt(max(square, SLOWEST**2))


def _sweep(
    line: PathGeometry,
    slopes: Sequence[_Inclination],
    top: list[float],
    before: float,
    lateral: float,
    along: float,
    power: float,
    *,
    forward: bool,
) -> None:
    """Lowers speeds that the car cannot reach by accelerating (forward), or from which it cannot brake to the
    speed at the following station (backward). ``before`` is the speed in m/s where the sweep begins."""
    way = 1 if forward else -1
    order = range(len(top)) if forward else range(len(top) - 1, -1, -1)
    for i in order:
        v2 = before * before
        (level, cube, cos, sin), bend = slopes[i], v2 * abs(line.curvature[i])
        load = GRAVITY * level * cos + bend * sin + v2 * line.crest[i] * cube
        load = max(load, LIGHTEST * GRAVITY)
        used = min(abs(bend * cos - GRAVITY * level * sin) / (lateral * load), 1.0)
        pull = min(along * load * math.sqrt(1 - used * used), power / max(before, 1.0))
        pull -= way * GRAVITY * line.grade[i] * level
        reached = math.sqrt(max(v2 + 2 * pull * line.step * line.stretch[i], SLOWEST**2))
        top[i] = before = min(top[i], reached)
