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
    """Returns the largest distance in metres between the edges of two lanes at ends of their roads.

    The edges nearer to the centre lines are compared with each other, and so are the outer ones.
    """
    points = _points(network)
    (a, b), (c, d) = points[one], points[other]
    return max(math.dist(a, c), math.dist(b, d))


def reached(network: Network, connection: Connection) -> Iterator[LaneEnd]:
    """Yields the lanes out of a junction to which the lanes of a connection lead."""
    for lanes in connection.lanes:
        yield connection.outgoing, lanes.outgoing


@lru_cache(maxsize=2)
def _lanes(network: Network) -> dict[RoadEnd, tuple[tuple[int, ...], tuple[int, ...]]]:
    """Returns, for each end of each road, the ids of the lanes towards it and of those away from it."""
    found = {}
    for member in network.roads:
        forward = member.profile.count[0]
        right, left = tuple(range(-1, -forward - 1, -1)), tuple(member.profile.left_ids)
        found[RoadEnd(member.id, "end")] = (right, left)
        found[RoadEnd(member.id, "start")] = (left, right)
    return found


@lru_cache(maxsize=2)
def _points(network: Network) -> dict[LaneEnd, tuple[Point, Point]]:
    """Returns the points of the inner and of the outer edge of every lane at both ends of its road."""
    found: dict[LaneEnd, tuple[Point, Point]] = {}
    for end, (into, out_of) in _lanes(network).items():
        pose, member = footprint(network).ends[end], network.road(end.road)
        s = 0.0 if end.contact == "start" else member.road.length
        for lanes in (into, out_of):
            begin, profile = width_at(member.profile.offset, s), member.profile
            t = begin + profile.median if lanes and lanes[0] > 0 else begin
            for lane in lanes:
                own = profile.right[-lane - 1] if lane < 0 else profile.left[lane - profile.left_ids[0]]
                width = width_at(own.width, s)
                inner, t = t, t - width if lane < 0 else t + width
                found[(end, lane)] = (pose.beside(inner), pose.beside(t))
    return found
