"""Finds the lanes that a route follows on the roads of a network, with the necessary lane changes, and
computes where its lane lies on one of its roads, and what lies beside it.

    left shoulder | left: all other lanes | the lane | right: outer lanes | right shoulder
                                          ^ offset

A lane change is a smooth curve from one lane to the next, within part of the road."""

from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise

import numpy as np

from roadgpt.errors import UsageError
from roadgpt.geometry import CubicProfile
from roadgpt.geometry.curve import Array
from roadgpt.geometry.elevation import Cubic
from roadgpt.network.network import Leg, Network
from roadgpt.road import Road
from roadgpt.road.profile import Width, as_cubics

LONGEST = 65.0  # m, length of a lane change: 4.6 s (Toledo and Zohar 2007) at 50 km/h
SHARE = 0.8  # largest share of the room for a lane change that the change takes
PARTS = 8  # number of cubics that describe a lane change
ROUNDING = 1e-9
Term = tuple[float, Width]
"""A factor and the width that is multiplied by it."""
Ways = dict[int, int]
"""Maps the id of a lane to the id of the lane that continues it on the next road."""


LaneAlong = tuple[Width, Width, Width, Width, Width, Width]
"""Widths in metres, constant or by the station: of the left shoulder, of all lanes between it and the lane
(oncoming lanes and the median included), of the offset of the lane's left edge, positive to the left, of the
lane, of all lanes to its right, and of the right shoulder."""


def lane_along(road: Road, lanes: Sequence[int]) -> LaneAlong:
    """Returns the lane that a route follows on a road, which leads in the direction of the route, for traffic
    on the right. ``lanes`` are the indices of the lanes that the route follows one after another, counted
    from 0 at the centre line; each differs by 1 from the index before."""
    profile = road.profile
    assert profile is not None
    edges = [max(number, 0) for number in profile.carriageway]
    right = [lane.width for lane in profile.right[: edges[1]]]
    oncoming = [lane.width for lane in profile.left[: edges[0]]]
    length = road.length
    offsets = [added([(1, profile.offset), *((-1, w) for w in right[:k])], length) for k in lanes]
    stations = {
        s for each in (profile.offset, *right) if isinstance(each, CubicProfile) for s in each.stations
    }
    offset = _through(offsets, length, stations)
    width = _through([right[k] for k in lanes], length, stations)
    left = added([(1, profile.offset), *((1, w) for w in oncoming), (-1, offset)], length)
    outer = added([(1, offset), (-1, width), (-1, profile.offset), *((1, w) for w in right)], length)
    beside = profile.left[edges[0] :], profile.right[edges[1] :]
    shoulders = [added([(1, lane.width) for lane in side], length) for side in beside]
    return shoulders[0], left, offset, width, outer, shoulders[1]


def change_windows(length: float, count: int) -> list[tuple[float, float]]:
    """Returns the stations in metres at which each of ``count`` lane changes on a road of this length begins
    and ends: in the middle of equal parts of the road."""
    part = length / count if count else 0.0
    half = min(LONGEST, SHARE * part) / 2
    return [(part * (n + 0.5) - half, part * (n + 0.5) + half) for n in range(count)]


def added(terms: Sequence[Term], length: float) -> Width:
    """Returns the weighted sum of widths along a road of ``length`` metres; of numbers only, the sum is a
    number."""
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
    """Returns one width after another, with smooth changes between them. ``stations`` are those at which the
    cubics of the offset and of the lane widths begin."""
    found = values[0]
    for (start, end), after in zip(change_windows(length, len(values) - 1), values[1:], strict=True):
        knots = np.linspace(start, end, PARTS + 1)
        own = [s for s in stations if start < s < end and np.abs(knots - s).min() > ROUNDING]
        found = _blended(found, after, np.sort([*knots, *own]))
    return found


def _blended(one: Width, other: Width, knots: Array) -> Width:
    """Returns a width that changes to another one from the first to the last knot. Between two knots, a cubic
    has the values and slopes of the blended widths at both knots, so that what remains beside the lane has
    its true width and is nowhere negative."""
    if one == other:
        return one
    start, end = knots[0], knots[-1]
    before, after = as_cubics(one), as_cubics(other)
    smooth = CubicProfile.smooth([(start, 0.0), (end, 1.0)])
    share, rise = smooth.height(knots), smooth.grade(knots)
    value = (1 - share) * before.height(knots) + share * after.height(knots)
    slope = (1 - share) * before.grade(knots) + share * after.grade(knots)
    slope += rise * (after.height(knots) - before.height(knots))
    inside = CubicProfile.through(knots, value, slope)
    early = [s for s in before.stations if s < start - ROUNDING]
    late = [s for s in after.stations if s > end + ROUNDING]
    at_end = max([end, *(s for s in after.stations if abs(s - end) <= ROUNDING)])
    table = np.concatenate(
        (before.cubics(np.array(early)), inside.coefficients, after.cubics(np.array([at_end, *late])))
    )
    return CubicProfile.of_table([*early, *knots.tolist(), *late], table)


def legs_along(
    network: Network, roads: Sequence[int], shifts: Mapping[int, int], first: int | None = None
) -> list[Leg]:
    """Returns the legs of a route along the roads with these ids: on each road, one leg for each lane that it
    uses.

    A route begins in the outermost lane from which it can go on (the rightmost one, with traffic on the
    right), or in lane ``first``: 1 is the outermost one, -1 the innermost. ``shifts`` are the
    required lane changes by road: the number of lanes to the left, negative to the right. Otherwise the route
    changes lanes only where its lane does not lead to the next road or would
    prevent a required change, and as late as possible: on the last road before the new lane is needed. Raises
    UsageError if two roads are not joined, or a lane that is needed cannot be reached."""
    ways = [_ways(network, one, two) for one, two in pairwise(roads)]
    fit = _fit(network, roads, ways, shifts)
    ways = [
        each if shifts.get(roads[n]) else {lane: to for lane, to in each.items() if to in lanes} or each
        for n, (each, lanes) in enumerate(zip(ways, fit[1:], strict=True))
    ]
    profile, shift = network.road(roads[0]).profile, shifts.get(roads[0], 0)
    lane = max(ways[0], key=abs) if ways else profile.along_ids[-1]
    if first is not None and abs(first) <= len(profile.along_ids):
        lane = profile.along_ids[-first if first > 0 else -1 - first]
    lane += -shift if profile.leads_along(lane) else shift
    found: list[Leg] = []
    for n, road in enumerate(roads):
        own, shift = [lane], shifts.get(road, 0)
        for _ in range(abs(shift)):
            own.append(_beside(network, road, own[-1], 1 if shift > 0 else -1))
        if n < len(ways):
            target = min(ways[n], key=lambda each: (abs(each - own[-1]), -abs(each)))
            if network.road(road).junction is not None and target != own[-1]:
                raise UsageError(f"no way leads from lane {own[-1]} of road {road} to road {roads[n + 1]}")
            while own[-1] != target:
                own.append(own[-1] + (1 if target > own[-1] else -1))
            lane = ways[n][target]
        found += [Leg(road, each) for each in own]
    return found


def _fit(
    network: Network, roads: Sequence[int], ways: Sequence[Ways], shifts: Mapping[int, int]
) -> list[set[int]]:
    """Returns for each road the lanes from which the lane changes in ``shifts`` are possible on this road
    and, where both roads have one, on the next road too."""
    found: list[set[int]] = [set()] * len(roads)
    for n, road in reversed(list(enumerate(roads))):
        lanes, shift = network.road(road).profile.along_ids, shifts.get(road, 0)
        found[n] = {lane for lane in lanes if lane + shift in lanes}
        if shift and n < len(ways):
            found[n] = {lane for lane in found[n] if ways[n].get(lane + shift) in found[n + 1]} or found[n]
    return found


def _beside(network: Network, road: int, lane: int, left: int) -> int:
    profile = network.road(road).profile
    is_along = profile.leads_along(lane)
    beside = lane + left if is_along else lane - left
    if beside not in (profile.along_ids if is_along else profile.against_ids):
        word = "left" if left > 0 else "right"
        raise UsageError(f"the route cannot change to the {word} on road {road}: there is no lane")
    return beside


def _ways(network: Network, one: int, two: int) -> Ways:
    onward = network.following
    found = {
        lane: to.lane
        for lane in network.road(one).profile.lanes
        for to in onward.get(Leg(one, lane), ())
        if to.road == two
    }
    if not found:
        raise UsageError(f"no way leads from road {one} to road {two}")
    return found
