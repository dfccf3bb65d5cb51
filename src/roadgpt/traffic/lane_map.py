"""The driving lanes near a road as arrays, for compiled code: their middles, what continues them, what lies
beside them, where they meet, and which lanes a box touches."""

import math
from collections.abc import Sequence
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from roadgpt.compiled import compiled, inlined
from roadgpt.network.lanes import Lane, Lanes
from roadgpt.network.network import Leg
from roadgpt.road.speed_profile import GRAVITY
from roadgpt.traffic.actor import FloatArray

IntArray = NDArray[np.int64]
STEP = 1.0  # m, desired distance between the samples of a lane
CELL = 2.0  # m, side of the cells in which samples are looked up
LEAST = 2.4  # m, width of a lane from which on vehicles use it
PASSES = 1.3  # m, from the middle of a lane to who stands there, beside whom a truck of 2.5 m drives
TOUCH = 0.15  # m by which a box has to reach into a lane to count as being in it
APART = 0.8  # m, most between the points of a box that are looked up
PX, PY, PZ, PH, PW, PV, PC, PS, PG, PF = range(10)
"""Columns of a sample: place in metres, heading in radians (unwrapped along its lane), half the lane's width
in metres, the highest speed in m/s of its bend, cosine and sine of the heading, the radius of the friction
circle (at friction 1, up to ``on_friction``), and how much gravity pulls back along the lane, in m/s^2."""
WIDEST = 2.5  # m, width of the widest vehicles
OVER = 0.2  # m, by which the corner of a vehicle may reach over the edge of its lane in a bend
ACROSS = 2.0  # m/s^2, lateral acceleration of others in bends; ISO 11270 allows lane keeping 3
CALM = 0.4  # share of the friction circle that takes at most
PER_CHANGE = 1e6  # m, that a change of lane counts on a way, so that there are as few as possible


class LaneMap(NamedTuple):
    """The lanes as arrays; a lane is its number in ``ids``, the ids of the network's lanes."""

    sample: FloatArray
    """Shape (samples, 10), lane after lane, see PX."""
    first: IntArray
    """The first sample of each lane and, as the last entry, the number of samples."""
    lane_of: IntArray
    """The lane of each sample."""
    station: FloatArray
    """The station on its road of each sample, counted in the direction of its lane."""
    step: FloatArray
    """The distance in metres between the samples of each lane."""
    length: FloatArray
    usable: FloatArray
    """Shape (lanes, 2): the stations in metres between which a lane is wide enough to be driven."""
    limit: FloatArray
    """The speed limit of each lane in m/s."""
    beside: IntArray
    """Shape (lanes, 2): the lanes to the left and to the right into which one may change; -1 for none."""
    junction: IntArray
    """The id of the junction through which a lane leads; -1 for the others."""
    onward: IntArray
    """The lanes that continue the lanes, one lane after another; ``onward_of`` has where each lane begins
    there."""
    onward_of: IntArray
    stop: FloatArray
    """The station at which traffic waits that may not enter the junction at the lane's end."""
    has_stop_sign: NDArray[np.bool_]
    ends: NDArray[np.bool_]
    """Whether a lane ends while its road goes on in the lanes beside it."""
    begins: NDArray[np.bool_]
    """Whether vehicles come onto the map at the start of a lane."""
    longest: FloatArray
    """The length in metres of the longest vehicle that keeps within the lane in its bends."""
    leaves_ring: NDArray[np.bool_]
    """Whether a lane of a junction continues the ring of a roundabout, around it or out of it."""
    exits: IntArray
    """The lanes that lead off the map, and those from where no way does."""
    to_exit: FloatArray
    """Shape (exits, lanes): the metres from the start of each lane to the end of each exit, on the shortest
    way, and PER_CHANGE for each change of lane on it; infinite if there is none."""
    conflict: IntArray
    """Shape (conflicts, 2): the other lane, and 1 if the own lane gives way to it, -1 if the other does, 0 if
    neither; ``conflict_of`` has where each lane begins."""
    conflict_at: FloatArray
    """Shape (conflicts, 4): between which stations of the own and of the other lane they meet."""
    conflict_of: IntArray
    cells: IntArray
    """The samples in each cell of the grid, one cell after another; ``cell_of`` has where each cell
    begins."""
    cell_of: IntArray
    grid: FloatArray
    """x and y of the grid's corner, its columns and its rows."""


@lru_cache(maxsize=8)
def lane_map(
    lanes: Lanes, limit: float, near: frozenset[Leg] | None = None
) -> tuple[LaneMap, tuple[Leg, ...]]:
    """Returns the driving lanes, and their ids in the order of the arrays. ``limit`` is the speed limit in
    m/s of lanes that have none; ``near`` names the lanes to be used, all others do not exist then."""
    used = [each for each in lanes if each.kind == "driving" and (near is None or each.id in near)]
    number = {lane.id: n for n, lane in enumerate(used)}
    samples, stations, steps, usable, longest = [], [], [], [], []
    for lane in used:
        sample, step, stretch = _sampled(lane)
        samples.append(sample)
        station = lane.station(np.arange(len(sample)) * step)
        stations.append(station if lane.is_along else lane.member.road.length - station)
        steps.append(step)
        usable.append(stretch)
        spare = np.maximum(sample[:, PW] - WIDEST / 2 + OVER, 0.0)
        longest.append(float(np.sqrt(8.0 * spare * (sample[:, PV] ** 2 / ACROSS)).min()))
    first = np.cumsum([0, *map(len, samples)])
    table = np.concatenate(samples)
    rows, onward_of = _rows([[number[key] for key in lane.successors if key in number] for lane in used])
    onward = np.array(rows, np.int64)
    flat, conflict_of = _rows([_conflicts(lanes, lane, number) for lane in used])
    cells, cell_of, grid = _grid(table, np.repeat(steps, np.diff(first)))
    length = np.array([lane.length for lane in used])
    sides = np.array([[_beside(lane, side, number) for side in ("left", "right")] for lane in used])
    ends = np.array([_ends(lanes, lane) for lane in used])
    return LaneMap(
        table,
        first,
        np.repeat(np.arange(len(used)), np.diff(first)),
        np.concatenate(stations),
        np.array(steps),
        length,
        np.array(usable),
        np.array([lane.member.profile.lanes[lane.id.lane].speed_limit or limit for lane in used]),
        sides,
        np.array([-1 if lane.member.junction is None else lane.member.junction for lane in used]),
        onward,
        onward_of,
        np.array([lane.length if lane.stop is None else lane.stop for lane in used]),
        np.array([lane.control == "stop" for lane in used]),
        ends,
        np.array([_begins(lanes, lane, number) for lane in used]),
        np.array(longest),
        np.array([_leaves_ring(lanes, lane) for lane in used]),
        *_to_exits(length, sides, onward, np.diff(onward_of), ends),
        np.array([row[:2] for row in flat], np.int64).reshape(-1, 2),
        np.array([row[2:] for row in flat], float).reshape(-1, 4),
        conflict_of,
        cells,
        cell_of,
        grid,
    ), tuple(number)


def _sampled(lane: Lane) -> tuple[FloatArray, float, tuple[float, float]]:
    """Returns the samples of a lane, their distance, and between which stations it is wide enough."""
    count = max(2, math.ceil(lane.length / STEP) + 1)
    s = np.linspace(0.0, lane.length, count)
    step = float(s[1])
    place, width = lane.at(s), lane.width(s)
    heading = np.unwrap(lane.heading(s))
    ahead = np.diff(place[:, :2], axis=0)
    course = np.unwrap(np.r_[heading[:1], np.arctan2(ahead[:, 1], ahead[:, 0])])[1:]
    bend = np.zeros(count)
    if count > 2:
        bend[1:-1] = np.abs(np.diff(course)) / step
        bend[[0, -1]] = bend[[1, -2]]
    speed = np.sqrt(ACROSS / np.maximum(bend, 1e-6))
    wide = np.flatnonzero(width >= LEAST)
    stretch = (float(s[wide[0]]), float(s[wide[-1]])) if len(wide) else (0.0, 0.0)
    turned = [(math.cos(each), math.sin(each)) for each in heading.tolist()]
    slope = np.arctan(np.gradient(place[:, 2], step))
    load = GRAVITY * np.column_stack([np.cos(slope), np.sin(slope)])
    return np.column_stack([place, heading, width / 2, speed, turned, load]), step, stretch


def on_friction(lanes: LaneMap, friction: FloatArray | float) -> LaneMap:
    """Returns the lanes with the friction of each sample, at which bends are driven more slowly."""
    sample = lanes.sample.copy()
    sample[:, PG] *= friction
    sample[:, PV] *= np.minimum(np.sqrt(CALM * sample[:, PG] / ACROSS), 1.0)
    return lanes._replace(sample=sample)


def _beside(lane: Lane, side: str, number: dict[Leg, int]) -> int:
    may = lane.may_change_left if side == "left" else lane.may_change_right
    other = lane.left if side == "left" else lane.right
    return number.get(other, -1) if may and other is not None and lane.member.junction is None else -1


def _all_beside(lanes: Lanes, lane: Lane) -> list[Lane]:
    """Returns the lanes of the same direction beside a lane, to the left and to the right of it."""
    found = list[Lane]()
    for side in ("left", "right"):
        key = getattr(lane, side)
        while key is not None:
            found.append(lanes[key])
            key = getattr(lanes[key], side)
    return found


def _ends(lanes: Lanes, lane: Lane) -> bool:
    return not lane.successors and any(each.successors for each in _all_beside(lanes, lane))


def _begins(lanes: Lanes, lane: Lane, number: dict[Leg, int]) -> bool:
    """Returns whether vehicles come from outside: where the map begins, or where the used part of it does."""
    if any(each in number for each in lane.predecessors) or float(lane.width(0.0)) < LEAST:
        return False
    return bool(lane.predecessors) or not any(each.predecessors for each in _all_beside(lanes, lane))


def _conflicts(lanes: Lanes, lane: Lane, number: dict[Leg, int]) -> list[tuple[float, ...]]:
    """Returns for each lane that a lane of a junction meets there: its number, which of both gives way, and
    where they meet (see LaneMap). Ways that begin in the same lane are followed one after another, and are
    no conflict."""
    if lane.member.junction is None:
        return []
    over = {*lanes.gives_way_to(lane.id)}
    found = list[tuple[float, ...]]()
    for key in lanes.met_by(lane.id):
        other, place = lanes[key], lanes.meeting(lane.id, key)
        is_there = other.member.junction == lane.member.junction and key in number
        if is_there and place is not None and not {*other.predecessors} & {*lane.predecessors}:
            rank = (key in over) - (lane.id in lanes.gives_way_to(key))
            found.append((number[key], rank, *place.own, *place.others))
    return found


def _leaves_ring(lanes: Lanes, lane: Lane) -> bool:
    rings = lanes.network.roundabout_of
    ring = None if lane.member.junction is None else rings.get(lane.member.junction)
    return ring is not None and any(each.road in ring.ring for each in lane.predecessors)


def _to_exits(
    length: FloatArray, beside: IntArray, onward: IntArray, ways_on: IntArray, ends: NDArray[np.bool_]
) -> tuple[IntArray, FloatArray]:
    """Returns the exits of a map, and how far each lane is from each of them."""
    from scipy.sparse.csgraph import dijkstra

    count, (lane, side) = len(length), np.nonzero(beside >= 0)
    begin = np.r_[np.repeat(np.arange(count), ways_on), lane]
    to = np.r_[onward, beside[lane, side]]
    cost = np.r_[np.repeat(length, ways_on), np.full(len(lane), PER_CHANGE)]
    back = csr_array((cost, (to, begin)), shape=(count, count))
    leaves = (ways_on == 0) & ~ends
    far = dijkstra(back, indices=np.flatnonzero(leaves))
    exits = np.flatnonzero(leaves | ~np.isfinite(far).any(axis=0))
    return exits, dijkstra(back, indices=exits) + length[exits, None]


def _rows(rows: Sequence[Sequence[Any]]) -> tuple[list[Any], IntArray]:
    """Returns what is in some rows, one row after another, and where each row begins there."""
    return [each for row in rows for each in row], np.cumsum([0, *map(len, rows)])


def _grid(table: FloatArray, step: FloatArray) -> tuple[IntArray, IntArray, FloatArray]:
    """Returns which samples each cell holds: those whose slab of lane may reach into it."""
    reach = table[:, PW] + step
    low = np.floor((table[:, [PX, PY]] - reach[:, None]) / CELL).astype(np.int64)
    high = np.floor((table[:, [PX, PY]] + reach[:, None]) / CELL).astype(np.int64)
    corner = low.min(0)
    columns, rows = (int(each) for each in high.max(0) - corner + 1)
    wide, tall = (high - low + 1).T
    sample = np.repeat(np.arange(len(table)), wide * tall)
    nth = np.arange(len(sample)) - (np.cumsum(wide * tall) - wide * tall)[sample]
    cell = low[sample] + np.column_stack([nth // tall[sample], nth % tall[sample]])
    dx, dy = ((cell + 0.5) * CELL - table[sample][:, [PX, PY]]).T
    c, s = table[sample][:, [PC, PS]].T
    is_reached = np.abs(dy * c - dx * s) <= table[sample, PW] + 0.71 * CELL
    is_reached &= np.abs(dx * c + dy * s) <= step[sample] + 0.71 * CELL
    sample, (column, row) = sample[is_reached], (cell[is_reached] - corner).T
    order = np.argsort(row * columns + column, kind="stable")
    starts = np.searchsorted((row * columns + column)[order], np.arange(columns * rows + 1))
    grid = np.array([corner[0] * CELL, corner[1] * CELL, columns, rows], float)
    return sample[order], starts, grid


@compiled
def place_on(lanes: LaneMap, lane: int, s: float) -> tuple[float, float, float, float, float]:
    """Returns x, y, z, the heading, and the highest speed of the bend at a station of a lane. Beyond its
    ends the lane counts as going straight on."""
    first = lanes.first[lane]
    at = s / lanes.step[lane]
    i = min(max(int(at), 0), lanes.first[lane + 1] - first - 2)
    u, k = at - i, first + i
    one, two = lanes.sample[k], lanes.sample[k + 1]
    return (
        one[PX] + u * (two[PX] - one[PX]),
        one[PY] + u * (two[PY] - one[PY]),
        one[PZ] + u * (two[PZ] - one[PZ]),
        one[PH] + min(max(u, 0.0), 1.0) * (two[PH] - one[PH]),
        min(one[PV], two[PV]),
    )


@inlined
def across(lanes: LaneMap, lane: int, s: float, other: int) -> float:
    """Returns the station of another lane of the same road and direction beside station ``s`` of a lane."""
    at = s / lanes.step[lane]
    i = min(max(int(at), 0), lanes.first[lane + 1] - lanes.first[lane] - 2)
    k = lanes.first[lane] + i
    station = lanes.station[k] + (at - i) * (lanes.station[k + 1] - lanes.station[k])
    begin, end = lanes.first[other], lanes.first[other + 1]
    n = min(max(np.searchsorted(lanes.station[begin:end], station) - 1, 0), end - begin - 2)
    one, two = lanes.station[begin + n], lanes.station[begin + n + 1]
    return float((n + (station - one) / max(two - one, 1e-9)) * lanes.step[other])


@compiled
def touched(
    lanes: LaneMap, x: float, y: float, heading: float, length: float, width: float, speed: float,
    body: float, entries: FloatArray, count: int,
) -> int:  # fmt: skip
    """Adds a row to ``entries`` for each lane that a box touches: the lane, the first and the last station
    that the box touches, its speed along the lane, and the number of the body. Returns the number of rows
    then. A body that stands beside the way of a truck is not in that lane, nor is one past the lane's end."""
    begin = count
    c, s = math.cos(heading), math.sin(heading)
    along = max(2, math.ceil(length / APART) + 1)
    aside = max(width / 2 - TOUCH, 0.0)
    for i in range(along):
        u = length * (i / (along - 1) - 0.5)
        for side in range(-1, 2):
            px, py = x + u * c - side * aside * s, y + u * s + side * aside * c
            column = math.floor((px - lanes.grid[0]) / CELL)
            row = math.floor((py - lanes.grid[1]) / CELL)
            if column < 0 or row < 0 or column >= lanes.grid[2] or row >= lanes.grid[3]:
                continue
            cell = row * int(lanes.grid[2]) + column
            for at in range(lanes.cell_of[cell], lanes.cell_of[cell + 1]):
                k = lanes.cells[at]
                dx, dy = px - lanes.sample[k, PX], py - lanes.sample[k, PY]
                ch, sh = lanes.sample[k, PC], lanes.sample[k, PS]
                wide = PASSES if body < 0.0 and speed == 0.0 else LEAST + lanes.sample[k, PW]
                if abs(dy * ch - dx * sh) > min(wide, lanes.sample[k, PW]):
                    continue
                lane, ahead = lanes.lane_of[k], dx * ch + dy * sh
                if abs(ahead) > 0.51 * lanes.step[lane]:
                    continue
                station = (k - lanes.first[lane]) * lanes.step[lane] + ahead
                if body < 0.0 and speed == 0.0 and lanes.ends[lane] and station > lanes.usable[lane, 1]:
                    continue
                found = -1
                for n in range(begin, count):
                    if entries[n, 0] == lane:
                        found = n
                if found < 0:
                    if count == len(entries):
                        return count
                    found = count
                    entries[found, 0], entries[found, 1], entries[found, 2] = lane, station, station
                    entries[found, 3] = speed * math.cos(heading - lanes.sample[k, PH])
                    entries[found, 4] = body
                    count += 1
                entries[found, 1] = min(entries[found, 1], station)
                entries[found, 2] = max(entries[found, 2], station)
    return count
