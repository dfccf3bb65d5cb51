"""Computes which junctions and signs lie ahead of a driver, and how many lanes are beside the driver's own
lane."""

import math
from bisect import bisect_right
from typing import TYPE_CHECKING

from roadgpt.drive.view import JunctionAhead, SignAhead
from roadgpt.geometry import wrap_angle
from roadgpt.network import is_route, legs_of, network_of
from roadgpt.road import Profile, Road, World

if TYPE_CHECKING:
    from roadgpt.network import Passage, Route


class Outlook:
    """The junctions ahead and the lanes beside the driver's own lane, at each station of a road or route."""

    def __init__(self, road: Road, world: World) -> None:
        self._route = road if is_route(road) else None  # as drivers are promised: see ``View.route``
        self._junctions = [_junction(road, each) for each in road.passages]
        self._ends = [end for _, end, _ in self._junctions]
        network, self._starts = network_of(road, world), road.starts[:-1]
        self._beside = [_beside(network.road(each.road).profile, each.lane) for each in legs_of(road, world)]
        self._plain = (self._route, (), *self._beside[0]) if self._starts == (0.0,) else None
        limits = limits_of(road, world)
        ends = [*(start for start, _ in limits[1:]), math.inf]
        self._signs: list[tuple[float, float, SignAhead]] = [
            (at, end, SignAhead("speed limit", 0.0, limit))
            for (at, limit), end in zip(limits, ends, strict=False)
        ]
        """From which station to which a sign says something, and the sign."""
        for way in road.passages:
            if way.control == "stop" or way.control == "yield":
                self._signs.append((way.line, way.line, SignAhead(way.control, 0.0)))
        self._signs.sort()

    def at(self, s: float) -> "tuple[Route | None, tuple[JunctionAhead, ...], int, int]":
        """Returns ``route``, ``junctions``, ``lanes_left`` and ``lanes_right`` of a View at station ``s``."""
        if self._plain is not None:
            return self._plain
        first = bisect_right(self._ends, s)
        ahead = [
            JunctionAhead(max(start - s, 0.0), *seen, end - max(start, s))
            for start, end, seen in self._junctions[first:]
        ]
        return self._route, tuple(ahead), *self._beside[max(bisect_right(self._starts, s) - 1, 0)]

    def signs(self, s: float) -> tuple[SignAhead, ...]:
        """Returns ``signs`` of a View at station ``s``."""
        return tuple([sign._replace(distance=max(at - s, 0.0)) for at, end, sign in self._signs if s < end])


def limits_of(road: Road, world: World) -> list[tuple[float, float]]:
    """Returns the stations at which speed limits begin that the lanes of a road or route have, and the limits
    in m/s; of lanes that have none the limit is that of the world. Empty if no lane has one."""
    network, usual, found = network_of(road, world), world.limits.speed_limit, list[tuple[float, float]]()
    lanes = [network.road(leg.road).profile.lanes[leg.lane] for leg in legs_of(road, world)]
    if all(lane.speed_limit is None for lane in lanes):
        return []
    for start, lane in zip(road.starts, lanes, strict=False):
        limit = lane.speed_limit or usual
        if not found or found[-1][1] != limit:
            found.append((start, limit))
    return found


def _junction(road: Road, passage: "Passage") -> tuple[float, float, tuple[str, float, int, str]]:
    """Returns between which stations a junction lies, and what a driver sees of it from anywhere."""
    turn = float(wrap_angle(road.heading(passage.end) - road.heading(passage.start)))
    return passage.start, passage.end, (passage.entered.kind, turn, passage.exit, passage.control)


def _beside(profile: Profile, lane: int) -> tuple[int, int]:
    row = from_left(profile, lane)
    to_left = row.index(lane)
    return to_left, len(row) - 1 - to_left


def from_left(profile: Profile, lane: int) -> list[int]:
    """Returns the driving lanes of a road from left to right, as they are seen along one of them."""
    # OpenDRIVE's ids fall from left to right as seen along the road
    return sorted((*profile.along_ids, *profile.against_ids), reverse=profile.leads_along(lane))
