"""Finds the lanes that a route follows on roads of a network, with the necessary lane changes."""

from collections.abc import Mapping, Sequence
from itertools import pairwise

from roadgpt.errors import UsageError
from roadgpt.network.network import Leg, Network

Ways = dict[int, int]
"""Maps the id of a lane to the id of the lane that continues it on the next road."""


def legs_along(network: Network, roads: Sequence[int], shifts: Mapping[int, int]) -> list[Leg]:
    """Returns the legs of a route: on each road, one leg for each lane that the route uses. ``roads`` are the
    ids of roads that follow each other.

    A route begins in the outermost lane from which the route can go on (the rightmost one, with traffic on
    the right). ``shifts`` are the required lane changes by road: the number of lanes to the left, negative to
    the right. Otherwise the route changes lanes only where its lane does not lead to the next road or would
    prevent a required change. Such a change is made as late as possible: on the last road before the new lane
    is needed. Raises UsageError if two roads are not joined, or a lane that is needed cannot be reached.
    """
    ways = [_ways(network, one, two) for one, two in pairwise(roads)]
    fit = _fit(network, roads, ways, shifts)
    ways = [
        each if shifts.get(roads[n]) else _kept(each, lanes)
        for n, (each, lanes) in enumerate(zip(ways, fit[1:], strict=True))
    ]
    lane = _first(network, roads[0], ways[0] if ways else None, shifts.get(roads[0], 0))
    found: list[Leg] = []
    for n, road in enumerate(roads):
        own = [lane]
        shift = shifts.get(road, 0)
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


def _first(network: Network, road: int, ways: Ways | None, shift: int) -> int:
    """Returns the lane in which a route begins: the outermost from which it can go on after its change."""
    profile = network.road(road).profile
    target = profile.side if ways is None else max(ways, key=abs)
    return target - shift if profile.leads_along(target) else target + shift


def _fit(
    network: Network, roads: Sequence[int], ways: Sequence[Ways], shifts: Mapping[int, int]
) -> list[set[int]]:
    """Returns for each road the lanes from which the lane changes in ``shifts`` are possible on this road
    and, where both roads have one, on the next road too.
    """
    found: list[set[int]] = [set()] * len(roads)
    for n, road in reversed(list(enumerate(roads))):
        lanes, shift = network.road(road).profile.along_ids, shifts.get(road, 0)
        found[n] = {lane for lane in lanes if lane + shift in lanes}
        if shift and n < len(ways):
            found[n] = {lane for lane in found[n] if ways[n].get(lane + shift) in found[n + 1]} or found[n]
    return found


def _kept(ways: Ways, lanes: set[int]) -> Ways:
    """Returns the ways that lead to some lanes; all ways, if none leads there."""
    return {lane: after for lane, after in ways.items() if after in lanes} or ways


def _beside(network: Network, road: int, lane: int, left: int) -> int:
    """Returns the lane to the left (1) or to the right (-1) of a lane."""
    profile = network.road(road).profile
    is_along = profile.leads_along(lane)
    beside = lane + left if is_along else lane - left
    if beside not in (profile.along_ids if is_along else profile.against_ids):
        word = "left" if left > 0 else "right"
        raise UsageError(f"the route cannot change to the {word} on road {road}: there is no lane")
    return beside


def _ways(network: Network, one: int, two: int) -> Ways:
    """Returns which lanes of one road continue on the next one. Raises UsageError if the roads are not
    joined.
    """
    if (found := network.connection_of.get(two)) is not None and found[1].incoming.road == one:
        return {way.incoming: way.own for way in found[1].lanes}
    if (found := network.connection_of.get(one)) is not None and found[1].outgoing.road == two:
        return {way.own: way.outgoing for way in found[1].lanes}
    for each in network.continuations:
        if (each.before.road, each.after.road) == (one, two):
            profile = network.road(one).profile
            return {lane: after for lane, after in each.lanes if profile.leads_along(lane)}
    raise UsageError(f"no way leads from road {one} to road {two}")
