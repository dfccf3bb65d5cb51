"""Computes where the lane of a route lies on one of its roads, and what lies beside it.

    left shoulder | left: all other lanes | the lane | right: outer lanes | right shoulder
                                          ^ offset

A lane change is a smooth curve from one lane to the next, within part of the road.
"""

from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from roadgpt.geometry import CubicProfile
from roadgpt.geometry.curve import Array
from roadgpt.geometry.elevation import Cubic
from roadgpt.road import Road
from roadgpt.road.profile import Lane, Width, as_cubics

LONGEST = 65.0  # m, length of a lane change: 4.6 s (Toledo and Zohar 2007) at 50 km/h
SHARE = 0.8  # largest share of the room for a lane change that the change takes
PARTS = 8  # number of cubics that describe a lane change
ROUNDING = 1e-9


class LaneAlong(NamedTuple):
    """The lane of a route on one road, and what lies beside the lane. Each field is in metres, constant or a
    function of the station.
    """

    left_shoulder: Width
    left: Width
    """The width between the lane and the left shoulder: all lanes there, oncoming lanes included, and the
    median.
    """
    offset: Width
    """The offset of the left edge of the lane from the reference line, positive to the left."""
    width: Width
    right: Width
    """The width of all lanes to the right of the lane."""
    right_shoulder: Width


Term = tuple[float, Width]
"""A factor and the width that is multiplied by it."""


def lane_along(road: Road, lanes: Sequence[int]) -> LaneAlong:
    """Returns the lane that a route follows on a road. The road leads in the direction of the route, and
    traffic drives on the right. ``lanes`` are the indices of the lanes that the route follows one after
    another, counted from 0 at the centre line. Each index differs by 1 from the index before.
    """
    profile = road.profile
    assert profile is not None
    count = profile.count
    right = [lane.width for lane in profile.right[: count[0]]]
    oncoming = [profile.median, *(lane.width for lane in profile.left[: count[1]])]
    length = road.length
    offsets = [added([(1, profile.offset), *((-1, w) for w in right[:k])], length) for k in lanes]
    stations = {
        s for each in (profile.offset, *right) if isinstance(each, CubicProfile) for s in each.stations
    }
    offset = _through(offsets, length, stations)
    width = _through([right[k] for k in lanes], length, stations)
    left = added([(1, profile.offset), *((1, w) for w in oncoming), (-1, offset)], length)
    outer = added([(1, offset), (-1, width), (-1, profile.offset), *((1, w) for w in right)], length)
    return LaneAlong(
        _shoulder(profile.left[count[1] :], length),
        left,
        offset,
        width,
        outer,
        _shoulder(profile.right[count[0] :], length),
    )


def _shoulder(lanes: Sequence[Lane], length: float) -> Width:
    return added([(1, lane.width) for lane in lanes], length)


def change_windows(length: float, count: int) -> list[tuple[float, float]]:
    """Returns the stations in metres at which each lane change begins and ends: each in the middle of one of
    ``count`` equal parts of a road that is ``length`` metres long.
    """
    part = length / count if count else 0.0
    half = min(LONGEST, SHARE * part) / 2
    return [(part * (n + 0.5) - half, part * (n + 0.5) + half) for n in range(count)]


def added(terms: Sequence[Term], length: float) -> Width:
    """Returns the weighted sum of lane widths along a road of ``length`` metres. If every width is a number,
    the sum is a number, too.
    """
    numbers = [factor * width for factor, width in terms if not isinstance(width, CubicProfile)]
    if len(numbers) == len(terms):
        return sum(numbers)
    varying = [width for _, width in terms if isinstance(width, CubicProfile)]
    inside = {s for width in varying for s in width.stations if 0 < s < length - ROUNDING}
    ordered = sorted({0.0, *inside})
    # of stations that differ by rounding only, the last one: from there on, every width has its next cubic
    stations = [*(s for s, after in pairwise(ordered) if after - s > ROUNDING), ordered[-1]]
    total = np.zeros((len(stations), 4))
    for factor, width in terms:
        total += factor * np.array(cubics_at(width, stations))
    return CubicProfile.of_table(stations, total)


def cubics_at(width: Width, stations: Sequence[float]) -> list[Cubic]:
    """Returns the cubic of a width at each station, as a function of the distance from this station."""
    if not isinstance(width, CubicProfile):
        return [(float(width), 0.0, 0.0, 0.0)] * len(stations)
    cubics = as_cubics(width)
    return [cubics.cubic(s) for s in stations]


def _through(values: Sequence[Width], length: float, stations: Iterable[float]) -> Width:
    """Returns one width after another, with smooth changes between them.

    ``stations`` are those at which the cubics of the offset and of the lane widths begin.
    """
    found = values[0]
    for (start, end), after in zip(change_windows(length, len(values) - 1), values[1:], strict=True):
        knots = np.linspace(start, end, PARTS + 1)
        own = [s for s in stations if start < s < end and np.abs(knots - s).min() > ROUNDING]
        found = _blended(found, after, np.sort([*knots, *own]))
    return found


def _blended(one: Width, other: Width, knots: Array) -> Width:
    """Returns a width that changes to another one from the first to the last knot.

    Between two knots, a cubic has the values and slopes of the blended widths at both knots. What remains
    beside the lane then has its true width and is nowhere negative.
    """
    if one == other:
        return one
    start, end = knots[0], knots[-1]
    before, after = as_cubics(one), as_cubics(other)
    smooth = CubicProfile.smooth([(start, 0.0), (end, 1.0)])
    share, rise, step = smooth.height(knots), smooth.grade(knots), np.diff(knots)
    value = (1 - share) * before.height(knots) + share * after.height(knots)
    slope = (1 - share) * before.grade(knots) + share * after.grade(knots)
    slope += rise * (after.height(knots) - before.height(knots))
    mean = np.diff(value) / step
    rows = [
        value[:-1],
        slope[:-1],
        (3 * mean - 2 * slope[:-1] - slope[1:]) / step,
        (slope[:-1] + slope[1:] - 2 * mean) / step**2,
    ]
    early = [s for s in before.stations if s < start - ROUNDING]
    late = [s for s in after.stations if s > end + ROUNDING]
    at_end = max([end, *(s for s in after.stations if abs(s - end) <= ROUNDING)])
    table = np.concatenate(
        (before.cubics(np.array(early)), np.stack(rows, axis=-1), after.cubics(np.array([at_end, *late])))
    )
    return CubicProfile.of_table([*early, *knots.tolist(), *late], table)
