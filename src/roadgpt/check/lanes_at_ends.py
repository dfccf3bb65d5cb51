"""Measures where the lanes of a network lie at the ends of its roads."""

import math
from collections.abc import Iterator
from functools import lru_cache

from roadgpt.check.footprint import footprint
from roadgpt.network import Connection, Network, RoadEnd
from roadgpt.network.building import width_at

Point = tuple[float, float]
LaneEnd = tuple[RoadEnd, int]
"""One end of one lane: the end of its road, and the id of the lane."""


def lanes_into(network: Network, end: RoadEnd) -> tuple[int, ...]:
    """Returns the ids of the driving lanes that lead towards an end of a road."""
    return _lanes(network)[end][0]


def lanes_out_of(network: Network, end: RoadEnd) -> tuple[int, ...]:
    """Returns the ids of the driving lanes that lead away from an end of a road."""
    return _lanes(network)[end][1]


def gap(network: Network, one: LaneEnd, other: LaneEnd) -> float:
    """Returns the gap in metres between two lanes at the ends of their roads.

    The gap is the larger of two distances: that between the two inner edges (nearer to the centre lines), and
    that between the two outer edges.
    """
    points = _points(network)
    (a, b), (c, d) = points[one], points[other]
    return max(math.dist(a, c), math.dist(b, d))


def reached(network: Network, connection: Connection) -> Iterator[LaneEnd]:
    """Yields the lanes into which a connection through a junction leads, each as the end of the outgoing road
    and the id of the lane.
    """
    for lanes in connection.lanes:
        yield connection.outgoing, lanes.outgoing


@lru_cache(maxsize=2)
def _lanes(network: Network) -> dict[RoadEnd, tuple[tuple[int, ...], tuple[int, ...]]]:
    """Returns, for each end of each road, the ids of the lanes towards it and of those away from it."""
    found = {}
    for member in network.roads:
        along, against = tuple(member.profile.along_ids), tuple(member.profile.against_ids)
        found[RoadEnd(member.id, "end")] = (along, against)
        found[RoadEnd(member.id, "start")] = (against, along)
    return found


@lru_cache(maxsize=2)
def _points(network: Network) -> dict[LaneEnd, tuple[Point, Point]]:
    """Returns the points of the inner and of the outer edge of every lane at both ends of its road."""
    found: dict[LaneEnd, tuple[Point, Point]] = {}
    for end, (into, out_of) in _lanes(network).items():
        pose, member = footprint(network).ends[end], network.road(end.road)
        s = 0.0 if end.contact == "start" else member.road.length
        profile = member.profile
        for lanes in (into, out_of):
            begin, is_along = width_at(profile.offset, s), bool(lanes) and profile.leads_along(lanes[0])
            t = begin if is_along else begin - profile.side * profile.median
            outer = pose.beside(t)
            for lane, own in zip(lanes, profile.along if is_along else profile.against, strict=False):
                width = width_at(own.width, s)
                t = t - width if lane < 0 else t + width
                inner, outer = outer, pose.beside(t)
                found[(end, lane)] = (inner, outer)
    return found
