"""Samples a road for the physics as a table of equally spaced stations, from which the smooth road surface is
computed at any point.

Between stations the centre line is a cubic in x, y and z, continuous in its direction, so that there are no
kinks. The table continues straight beyond both ends.
"""

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from roadgpt.drive.compiled import inlined
from roadgpt.drive.drive import FloatArray

if TYPE_CHECKING:
    from roadgpt.road import Road

STEP = 0.25  # m, desired distance of stations; the cubic is then within 1 micrometre of a 14 m arc
BEYOND = 30.0  # m of straight road in the table before the start and after the end

# Columns of the table.
X, Y, Z, HEADING, GRADE, CURVATURE, COS, SIN = range(8)


class SampledRoad(NamedTuple):
    """Equally spaced stations of a road, as arrays and numbers that compiled code can use."""

    table: FloatArray
    """Shape (n, 8): x, y, z (m), heading (rad, unwrapped), grade, curvature (1/m), cosine and sine of the
    heading."""
    first: float
    """Station of row 0 in metres; negative."""
    step: float
    """Metres between rows."""
    length: float
    """Length of the road itself in metres."""


def sample_road(road: "Road") -> SampledRoad:
    """Returns the table of stations of a road."""
    length = float(road.length)
    count = max(2, math.ceil(length / STEP))
    step = length / count
    s = np.linspace(0.0, length, count + 1)
    x, y, z = np.asarray(road.at(s)).T
    heading = np.unwrap(np.asarray(road.heading(s), dtype=np.float64))
    cos, sin = np.cos(heading), np.sin(heading)
    inner = np.column_stack([x, y, z, heading, road.grade(s), road.curvature(s), cos, sin])
    extra = math.ceil(BEYOND / step)
    out = step * np.arange(1, extra + 1, dtype=np.float64)
    before, after = _straight_on(inner[0], -out[::-1]), _straight_on(inner[-1], out)
    table = np.ascontiguousarray(np.vstack([before, inner, after]), dtype=np.float64)
    return SampledRoad(table, -extra * step, step, length)


def _straight_on(row: FloatArray, along: FloatArray) -> FloatArray:
    rows = np.tile(row, (len(along), 1))
    rows[:, X] += along * math.cos(row[HEADING])
    rows[:, Y] += along * math.sin(row[HEADING])
    rows[:, Z] += along * row[GRADE]
    rows[:, CURVATURE] = 0.0
    return rows


@inlined
def _cubic(u: float, step: float, p0: float, p1: float, d0: float, d1: float) -> float:
    """Returns Hermite's cubic with these end values and slopes, at u in 0..1."""
    a = p1 - p0
    v = 1.0 - u
    return p0 + a * u * u * (3.0 - 2.0 * u) + step * u * v * (d0 * v - d1 * u)


@inlined
def locate_on(
    table: FloatArray, first: float, step: float, x: float, y: float, s: float
) -> tuple[float, float, float, float, float]:
    """Returns station, offset, height, slope and heading of the road at the point (x, y), searching near
    station s.

    The slope is measured along the road at this offset. The search uses Newton's method; if s is the station
    of the previous time step, two iterations are enough.
    """
    last = table.shape[0] - 2
    t = height = slope = heading = 0.0
    for _ in range(6):
        at = (s - first) / step
        i = min(max(int(at), 0), last)
        u = min(max(at - i, -1.0), 2.0)
        a = table[i]
        b = table[i + 1]
        heading = a[HEADING] + (b[HEADING] - a[HEADING]) * u
        c = math.cos(heading)
        n = math.sin(heading)
        dx = x - _cubic(u, step, a[X], b[X], a[COS], b[COS])
        dy = y - _cubic(u, step, a[Y], b[Y], a[SIN], b[SIN])
        along = dx * c + dy * n
        t = dy * c - dx * n
        s = first + (i + u) * step
        # Far inside a tight bend, stations lie close together; the lower bound keeps the step finite.
        crowd = max(1.0 - (b[HEADING] - a[HEADING]) / step * t, 0.2)
        height = _cubic(u, step, a[Z], b[Z], a[GRADE], b[GRADE])
        slope = (a[GRADE] + (b[GRADE] - a[GRADE]) * u) / crowd
        if abs(along) < 1e-7:
            break
        s += min(max(along / crowd, -5.0), 5.0)
    return s, t, height, slope, heading
