"""Makes the line of a route along the middle of its lane, where reference lines do not continue each other.

On roads that RoadGPT designs, the reference line of one road begins where that of the road before ends. On
maps of other tools it may begin beside it, so no line of all stations leads along the reference lines."""

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from roadgpt.errors import UsageError
from roadgpt.geometry import CubicProfile, wrap_angle
from roadgpt.geometry.curve import Array
from roadgpt.geometry.elevation import Row, closed
from roadgpt.geometry.fitting import SampledLine, fitted
from roadgpt.network.lane_along import LaneAlong
from roadgpt.road import Road
from roadgpt.road.profile import Width, as_cubics

APART, TURNED = 0.01, 0.01  # m and rad, between the end of a reference line and the start of the next
STEP = 1.0  # m, between the places of the lane through which the line leads


def continue_each_other(roads: Sequence[Road]) -> bool:
    """Returns whether the reference line of each road begins where that of the road before ends."""
    for one, two in pairwise(roads):
        apart = one.plan.at(one.length) - two.plan.at(0.0)
        turned = wrap_angle(one.heading(one.length) - two.heading(0.0))
        if math.hypot(*apart.tolist()) > APART or abs(float(turned)) > TURNED:
            return False
    return True


def along_lanes(roads: Sequence[Road], lanes: Sequence[LaneAlong]) -> tuple[Road, list[Width], list[float]]:
    """Returns the road whose centre line is the middle of the route's lane on roads that follow each other in
    the direction of the route, for traffic on the right; what lies beside this line; and the stations in
    metres of the starts of the roads and of the end. Raises UsageError if no curve follows the lane."""
    parts = [_sampled(road, lane) for road, lane in zip(roads, lanes, strict=True)]
    rows = np.concatenate(parts)
    at = np.cumsum([len(part) for part in parts])
    gaps, kinks = np.zeros(len(rows)), np.zeros(len(rows))
    for n in at[:-1]:
        gaps[n] = math.dist(rows[n - 1, 1:3], rows[n, 1:3])
        kinks[n] = float(wrap_angle(rows[n, 3] - rows[n - 1, 3]))
        rows[n, 1:3] = (rows[n - 1, 1:3] + rows[n, 1:3]) / 2
        rows[n, 3] = rows[n - 1, 3] + kinks[n] / 2
    kept = np.ones(len(rows), bool)
    kept[at[:-1] - 1] = False  # the first place of the next road stands for both
    way = np.r_[0.0, np.cumsum(np.hypot(*np.diff(rows[:, 1:3], axis=0).T))]
    line = SampledLine(way[kept], rows[kept, 1:4], gaps[kept], kinks[kept], rows[at[:-1], 1:3])
    fit = fitted(line)
    if fit is None:
        raise UsageError("no curve follows the lanes of the route; leave out the roads where they jump")
    plan, known, stations = fit
    own = np.asarray(np.interp(way, known, stations))
    s, first = np.unique(own, return_index=True)
    rows = np.asarray(rows)
    heights = closed(CubicProfile.through(s, rows[first, 4], rows[first, 5]).rows, plan.length)
    starts = [0.0, *own[at[:-1]].tolist(), plan.length]
    return Road(plan, heights), [_straight(own, rows[:, n], plan.length) for n in range(6, 12)], starts


def _sampled(road: Road, lane: LaneAlong) -> Array:
    """Returns rows (station, x, y, heading, z, grade, and the six widths of ``LaneAlong``) along a lane."""
    s = np.linspace(0.0, road.length, max(2, math.ceil(road.length / STEP) + 1))
    inside = np.clip(s, min(1e-6, road.length / 4), road.length - min(1e-6, road.length / 4))
    cubics = [as_cubics(width) for width in lane]
    values = [each.height(inside) for each in cubics]
    offset, width = values[2], values[3]
    middle = offset - width / 2
    slope = cubics[2].grade(inside) - cubics[3].grade(inside) / 2
    points = road.at(s, middle)
    heading = road.heading(s) + np.arctan2(slope, 1 - middle * road.curvature(s))
    values[2] = width / 2
    return np.column_stack([s, points[:, :2], heading, points[:, 2], road.grade(inside), *values])


def _straight(s: Array, values: Array, length: float) -> CubicProfile:
    """Returns the values at the stations, with straight lines between them; a station may have two."""
    rows = list[Row]()
    for (a, b), (one, two) in zip(pairwise(s.tolist()), pairwise(values.tolist()), strict=True):
        if b > a:
            same = abs(two - one) < 1e-9
            rows.append((a, (one, 0.0 if same else (two - one) / (b - a), 0.0, 0.0)))
    return closed(rows, length)
