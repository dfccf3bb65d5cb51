"""Lays roads into land: cuttings and fills with a largest slope, and exact heights at every point.

Along the rims of the roads begin two cones with the largest slope, one upwards and one downwards. The land
stays between them: where it is higher than the upper cone it is cut, where it is lower than the lower one it
is filled. The cones of a rim segment are exact: the way down to the segment is the steepest one, also where
the segment itself climbs. Where the cones of two rims exclude each other there is no room for slopes; the
lower road decides, and a wall stands at the rim of the higher one.

A cell of the grid keeps the segment whose cone is the lowest there (or the highest), which spreads from cell
to cell as far as the cones cut into the land."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roadgpt.compiled import compiled, inlined
from roadgpt.geometry.curve import Array
from roadgpt.ground.relief import cubic_at

Integers = NDArray[np.int32]
BUCKET = 4  # cells of the grid along a side of a bucket of triangles
DIP = 1.5  # m of land below a cutting, or above a fill, behind which it may go on
REACH = 1.5  # cells around a segment in which it is known at once
TINY = 1e-9
NONE = -1  # no segment
SLIVER = 1e-6  # m^2, twice the area of the smallest triangle that counts


class Layers(NamedTuple):
    """What determines heights, for compiled code. Lengths are in metres."""

    x: float  # of the first column of the grid
    y: float  # of the first row
    cell: float
    heights: Array  # of the ground at the points of the grid, roads included, (rows, columns)
    cuts: Integers  # the segment whose upper cone is the lowest at each point, NONE where none is near
    fills: Integers  # the segment whose lower cone is the highest
    relief: Array  # of the land without roads, see Relief
    relief_x: float
    relief_y: float
    relief_cell: float
    segments: Array
    """x, y, z of both ends, (n, 6), of the edges of what is clear under bridges, from which land is cut but
    not filled; then of each segment of a rim; then of the edges of covers, where it is filled but not cut."""
    floors: int  # the first segment from which land is filled
    rims: int  # the first segment from which it is not cut
    triangles: Array  # x, y, z of the corners of the surface of the roads, (m, 9)
    starts: Integers  # of each bucket, in ``members``: one more than there are buckets
    members: Integers  # triangles
    slope: float
    covers: Array  # x, y, z of the corners of what land covers tunnels, (k, 9)
    lintels: Array  # x, y, z of both ends of the least height of land above each mouth of a tunnel, (k, 6)
    clear: Array  # x, y, z of the corners of what land stays below under bridges, (k, 9)


@inlined
def _cone(segments: Array, number: int, x: float, y: float, slope: float, sign: float) -> float:
    """Returns the height of a segment's cone at a point: with ``sign`` 1 of the one that opens upwards, with
    -1 of the one that opens downwards."""
    ax, ay, az = segments[number, 0], segments[number, 1], sign * segments[number, 2]
    dx, dy, dz = segments[number, 3] - ax, segments[number, 4] - ay, sign * segments[number, 5] - az
    length = max(math.sqrt(dx * dx + dy * dy), TINY)
    along = ((x - ax) * dx + (y - ay) * dy) / length
    aside = abs((x - ax) * dy - (y - ay) * dx) / length
    grade = dz / length
    if abs(grade) < slope:
        best = along - aside * grade / math.sqrt(slope * slope - grade * grade)
        best = min(max(best, 0.0), length)
    else:
        best = 0.0 if grade > 0.0 else length
    away = math.sqrt(aside * aside + (along - best) * (along - best))
    found: float = sign * (az + grade * best + slope * away)
    return found


@compiled
def on_roads(triangles: Array, x: float, y: float, cell: float, rows: int, columns: int) -> Array:
    """Returns the heights of the roads at the points of a grid, (rows, columns), NaN beside them. Of two
    triangles over the same point, the first one counts."""
    found = np.full((rows, columns), np.nan)
    for n in range(len(triangles)):
        t = triangles[n]
        first = max(0, math.ceil((min(t[0], t[3], t[6]) - x) / cell))
        last = min(columns - 1, math.floor((max(t[0], t[3], t[6]) - x) / cell))
        low = max(0, math.ceil((min(t[1], t[4], t[7]) - y) / cell))
        high = min(rows - 1, math.floor((max(t[1], t[4], t[7]) - y) / cell))
        for j in range(low, high + 1):
            for i in range(first, last + 1):
                if np.isnan(found[j, i]):
                    found[j, i] = _height_on(t, x + i * cell, y + j * cell)
    return found


@inlined
def _height_on(t: Array, x: float, y: float) -> float:
    """Returns the height of a triangle at a point, NaN beside it."""
    a = (t[3] - x) * (t[7] - y) - (t[4] - y) * (t[6] - x)
    b = (t[6] - x) * (t[1] - y) - (t[7] - y) * (t[0] - x)
    c = (t[0] - x) * (t[4] - y) - (t[1] - y) * (t[3] - x)
    whole = a + b + c
    if whole < 0.0:
        a, b, c = -a, -b, -c
    if abs(whole) < SLIVER or min(a, b, c) < -TINY:
        return math.nan
    found: float = (a * t[2] + b * t[5] + c * t[8]) / (a + b + c)
    return found


@compiled
def buckets(
    triangles: Array, x: float, y: float, cell: float, rows: int, columns: int
) -> tuple[Integers, Integers]:
    """Returns ``starts`` and ``members`` of Layers, for buckets of BUCKET x BUCKET cells of the grid."""
    side = cell * BUCKET
    wide, high = columns // BUCKET + 1, rows // BUCKET + 1
    counts = np.zeros(wide * high + 1, np.int32)
    members = np.empty(0, np.int32)
    for turn in range(2):
        for n in range(len(triangles)):
            t = triangles[n]
            first = min(max(int((min(t[0], t[3], t[6]) - x) / side), 0), wide - 1)
            last = min(max(int((max(t[0], t[3], t[6]) - x) / side), 0), wide - 1)
            low = min(max(int((min(t[1], t[4], t[7]) - y) / side), 0), high - 1)
            top = min(max(int((max(t[1], t[4], t[7]) - y) / side), 0), high - 1)
            for j in range(low, top + 1):
                for i in range(first, last + 1):
                    at = j * wide + i
                    if turn == 0:
                        counts[at + 1] += 1
                    else:
                        members[counts[at]] = n
                        counts[at] += 1
        if turn == 0:
            counts = np.cumsum(counts).astype(np.int32)
            members = np.empty(counts[-1], np.int32)
    starts = np.zeros_like(counts)
    for n in range(1, len(counts)):
        starts[n] = counts[n - 1]
    return starts, members


@compiled
def spread(
    segments: Array, land: Array, roads: Array, x: float, y: float, cell: float, slope: float, sign: float
) -> tuple[Integers, Array]:
    """Returns which segment's cone is the lowest at each point of a grid (``sign`` 1; with -1 the highest),
    and the height of that cone; infinite where none is near enough to matter.

    ``land`` are the heights without roads, and ``roads`` those of the roads, NaN beside them: no cone
    leads across a road."""
    rows, columns = land.shape
    owner = np.full((rows, columns), NONE, np.int32)
    best = np.full((rows, columns), np.inf)  # of sign * height
    queue = np.empty(rows * columns, np.int32)
    waits = np.zeros(rows * columns, np.uint8)
    first, count = 0, 0
    reach = REACH * cell
    for n in range(len(segments)):
        s = segments[n]
        left = max(0, math.ceil((min(s[0], s[3]) - reach - x) / cell))
        right = min(columns - 1, math.floor((max(s[0], s[3]) + reach - x) / cell))
        low = max(0, math.ceil((min(s[1], s[4]) - reach - y) / cell))
        high = min(rows - 1, math.floor((max(s[1], s[4]) + reach - y) / cell))
        for j in range(low, high + 1):
            for i in range(left, right + 1):
                height = sign * _cone(segments, n, x + i * cell, y + j * cell, slope, sign)
                if height < best[j, i]:
                    best[j, i], owner[j, i], at = height, n, j * columns + i
                    if np.isnan(roads[j, i]) and waits[at] == 0:
                        queue[(first + count) % len(queue)], waits[at], count = at, 1, count + 1
    while count > 0:
        at = queue[first]
        first, count = (first + 1) % len(queue), count - 1
        waits[at] = 0
        row, column = at // columns, at % columns
        n = owner[row, column]
        cuts = best[row, column] < sign * land[row, column] + DIP
        for j in range(max(row - 1, 0), min(row + 2, rows)):
            for i in range(max(column - 1, 0), min(column + 2, columns)):
                if owner[j, i] == n or not np.isnan(roads[j, i]):
                    continue
                height = sign * _cone(segments, n, x + i * cell, y + j * cell, slope, sign)
                if height < best[j, i] and (cuts or height < sign * land[j, i] + DIP):
                    best[j, i], owner[j, i], to = height, n, j * columns + i
                    if waits[to] == 0:
                        queue[(first + count) % len(queue)], waits[to], count = to, 1, count + 1
    return owner, sign * best


@inlined
def road_at(of: Layers, x: float, y: float) -> float:
    """Returns the height of the road at a point, NaN beside all roads."""
    side = of.cell * BUCKET
    wide, high = of.heights.shape[1] // BUCKET + 1, of.heights.shape[0] // BUCKET + 1
    i, j = math.floor((x - of.x) / side), math.floor((y - of.y) / side)
    if 0 <= i < wide and 0 <= j < high:
        at = j * wide + i
        for k in range(of.starts[at], of.starts[at + 1]):
            found = _height_on(of.triangles[of.members[k]], x, y)
            if not math.isnan(found):
                return found
    return math.nan


@inlined
def land_at(of: Layers, x: float, y: float) -> float:
    """Returns the height of the ground at one point beside the roads."""
    rows, columns = of.cuts.shape
    if rows > 0:
        x = min(max(x, of.x), of.x + (columns - 1) * of.cell)
        y = min(max(y, of.y), of.y + (rows - 1) * of.cell)
    found = cubic_at(of.relief, of.relief_x, of.relief_y, of.relief_cell, x, y)
    for k in range(len(of.covers)):
        roof = _height_on(of.covers[k], x, y)
        if not math.isnan(roof):
            for n in range(len(of.lintels)):
                found = min(found, _cone(of.lintels, n, x, y, of.slope, 1.0))
            return max(found, roof)
    i, j = math.floor((x - of.x) / of.cell), math.floor((y - of.y) / of.cell)
    if rows == 0:
        return found
    i, j = min(i, columns - 2), min(j, rows - 2)
    top, floor, cut, fill = math.inf, -math.inf, NONE, NONE
    for k in range(4):
        b, a = j + k // 2, i + k % 2
        if of.cuts[b, a] != cut:  # most neighbours have the same
            cut = of.cuts[b, a]
            top = min(top, _nearest_cone(of, cut, x, y, 1.0))
        if of.fills[b, a] != fill:
            fill = of.fills[b, a]
            floor = max(floor, -_nearest_cone(of, fill, x, y, -1.0))
    for k in range(len(of.clear)):
        under = _height_on(of.clear[k], x, y)
        if not math.isnan(under):
            top = min(top, under)
    return min(max(found, floor), top)


@inlined
def _nearest_cone(of: Layers, number: int, x: float, y: float, sign: float) -> float:
    """Returns ``sign`` times the height at a point of the lowest cone among those of a segment and of its
    neighbours along the rim, as far as they are lower and lower; infinite for NONE."""
    if number < 0:
        return math.inf
    best = sign * _cone(of.segments, number, x, y, of.slope, sign)
    for step in (-1, 1):
        at = number + step
        first, last = (0, of.rims) if sign > 0.0 else (of.floors, len(of.segments))
        while first <= at < last:
            one, two = max(at, at - step), min(at, at - step)
            if of.segments[two, 3] != of.segments[one, 0] or of.segments[two, 4] != of.segments[one, 1]:
                break  # another rim, or a mouth between them
            height = sign * _cone(of.segments, at, x, y, of.slope, sign)
            if height >= best:
                break
            best = height
            at += step
    return best


@compiled
def heights_at(of: Layers, x: Array, y: Array, has_roads: bool) -> Array:
    """Returns the heights ``(n,)`` at n points: of the ground with its roads, or of what is beside them."""
    found = np.empty(len(x))
    for n in range(len(x)):
        road = road_at(of, x[n], y[n]) if has_roads else math.nan
        found[n] = land_at(of, x[n], y[n]) if math.isnan(road) else road
    return found


@compiled
def roads_at(of: Layers, x: Array, y: Array) -> Array:
    """Returns the heights ``(n,)`` of the roads at n points, NaN beside them."""
    found = np.empty(len(x))
    for n in range(len(x)):
        found[n] = road_at(of, x[n], y[n])
    return found
