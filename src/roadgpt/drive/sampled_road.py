"""Samples a road for the physics as a table of equally spaced stations. From this table, the smooth road
surface is computed at any point.

Between stations, x, y and z of the centre line are cubic polynomials, and its direction has no jumps. The
table continues straight beyond both ends. On a road with superelevation, the surface is rotated about the
pitched centre line, as in ``Road.at``."""

import math
from typing import NamedTuple

import numpy as np

from roadgpt.compiled import announce, inlined
from roadgpt.drive.drive import FloatArray
from roadgpt.road import Road

STEP = 0.25  # m, desired distance between stations: keeps the cubic within 1 micrometre of a 14 m arc
BEYOND = 30.0  # m of straight road in the table before the start and after the end

# Columns of the table. The last two exist only on roads with superelevation.
X, Y, Z, HEADING, GRADE, CURVATURE, COS, SIN, BANK, TWIST = range(10)

announce()  # every simulator needs this file, and drawing images does not


class SampledRoad(NamedTuple):
    """Equally spaced stations of a road, as arrays and numbers that compiled code can use."""

    table: FloatArray
    """Shape (n, 8): x, y, z (m), heading (rad, unwrapped), grade, curvature (1/m), cosine and sine of the
    heading. On a road with superelevation the shape is (n, 10); the two further columns are the tangent of
    the superelevation, and the change of this tangent per metre."""
    first: float  # station of row 0 in metres; negative
    step: float  # distance in metres between rows of the table
    length: float  # length of the road itself in metres


def sample_road(road: Road) -> SampledRoad:
    """Returns the table of stations of a road."""
    length = float(road.length)
    count = max(2, math.ceil(length / STEP))
    step = length / count
    s = np.linspace(0.0, length, count + 1)
    x, y, z = np.asarray(road.at(s)).T
    heading = np.unwrap(np.asarray(road.heading(s), dtype=np.float64))
    cos, sin = np.cos(heading), np.sin(heading)
    columns = [x, y, z, heading, road.grade(s), road.curvature(s), cos, sin]
    if road.profile is not None and road.profile.superelevation_angle is not None:
        angle = road.profile.superelevation_angle
        bank = np.tan(angle.height(s))
        columns += [bank, angle.grade(s) * (1 + bank * bank)]
    inner = np.column_stack(columns)
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
    rows[:, TWIST:] = 0.0
    return rows


def stations_of(sampled: SampledRoad) -> FloatArray:
    """Returns the station of each row of the table; beyond an end of the road, that of the end."""
    s = sampled.first + sampled.step * np.arange(len(sampled.table))
    return np.clip(s, 0.0, sampled.length)


@inlined
def room_at(edges: FloatArray, first: float, step: float, s: float, t: float) -> float:
    """Returns the distance in metres from offset ``t`` to the nearer of two edges at station ``s``; negative
    outside the edges.

    ``edges`` has the offsets of the left and the right edge for each row of the table, shape (n, 2)."""
    at = min(max((s - first) / step, 0.0), edges.shape[0] - 1.0)
    i = min(int(at), edges.shape[0] - 2)
    u = at - i
    left = edges[i, 0] + (edges[i + 1, 0] - edges[i, 0]) * u
    right = edges[i, 1] + (edges[i + 1, 1] - edges[i, 1]) * u
    room: float = min(left - t, t - right)
    return room


@inlined
def _cubic(u: float, step: float, p0: float, p1: float, d0: float, d1: float) -> float:
    """Returns Hermite's cubic with these end values and slopes, at u in 0..1."""
    a = p1 - p0
    v = 1.0 - u
    return p0 + a * u * u * (3.0 - 2.0 * u) + step * u * v * (d0 * v - d1 * u)


@inlined
def locate_on(
    table: FloatArray, first: float, step: float, x: float, y: float, s: float
) -> tuple[float, float, float, float, float, float]:
    """Returns station, offset, height, slopes and heading of the road at the point (x, y). The search starts
    at station s.

    The offset is measured along the surface. The slopes are those of the surface at this point, in the
    direction of the heading and to its left. The search uses Newton's method; if s is the station of the
    previous time step, two iterations are enough."""
    last = table.shape[0] - 2
    t = height = slope = lateral = heading = 0.0
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
        bend = (b[HEADING] - a[HEADING]) / step
        height = _cubic(u, step, a[Z], b[Z], a[GRADE], b[GRADE])
        slope = a[GRADE] + (b[GRADE] - a[GRADE]) * u
        if table.shape[1] <= BANK:
            crowd = max(1.0 - bend * t, 0.2)
            slope /= crowd
        else:
            t, back, rise, crowd, slope, lateral = _banked(a, b, u, step, t, bend, slope)
            along += back
            height += rise
        if abs(along) < 1e-7:
            break
        s += min(max(along / crowd, -5.0), 5.0)
    return s, t, height, slope, lateral, heading


@inlined
def _banked(
    a: FloatArray, b: FloatArray, u: float, step: float, t: float, bend: float, grade: float
) -> tuple[float, float, float, float, float, float]:
    """Computes the surface of a road with superelevation, ``t`` metres in plan to the left of its centre.

    A point of the surface that is ``t`` metres to the left in plan is ``rise * t`` above the centre line and
    ``rise * grade * t`` behind its station, because the section is rotated about the pitched centre line.

    Returns:
        The offset along the surface; how far the point is back from its station and above the centre line;
        the metres of its path per metre of road; the slopes along the heading and to its left."""
    tangent = _cubic(u, step, a[BANK], b[BANK], a[TWIST], b[TWIST])
    twist = a[TWIST] + (b[TWIST] - a[TWIST]) * u
    kink = (b[GRADE] - a[GRADE]) / step
    long = math.sqrt(1.0 + grade * grade)
    rise = tangent / long
    more = (twist - rise * grade * kink / long) / long
    lag, lag_more = rise * grade, more * grade + rise * kink
    crowd = max(1.0 - t * (bend + lag_more + lag * lag * bend), 0.2)
    slope = (grade + t * (more + rise * lag * bend)) / crowd
    return t * math.sqrt(1.0 + tangent * tangent), t * lag, t * rise, crowd, slope, rise + lag * slope
