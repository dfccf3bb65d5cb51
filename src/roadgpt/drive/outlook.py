"""Computes which junctions lie ahead of a driver, and how many lanes are beside the driver's own lane."""

from bisect import bisect_right
from typing import TYPE_CHECKING

from roadgpt.drive.view import JunctionAhead
from roadgpt.geometry import wrap_angle
from roadgpt.network import is_route

if TYPE_CHECKING:
    from roadgpt.network import Leg, Passage, Route
    from roadgpt.road import Profile, Road, World


def route_of(road: "Road") -> "Route | None":
    """Returns the road if it is a route through a network, otherwise None."""
    return road if is_route(road) else None


def passages(road: "Road") -> "tuple[Passage, ...]":
    """Returns the passages of a route through its junctions in driving order; empty for a single road."""
    route = route_of(road)
    return () if route is None else route.passages


class Outlook:
    """The junctions ahead and the lanes beside the driver's own lane, at each station of a road or route."""

    def __init__(self, road: "Road", world: "World") -> None:
        """Prepares the junctions and the lanes of a road or a route."""
        self._route = route_of(road)
        self._junctions = [_junction(road, each) for each in passages(road)]
        self._ends = [end for _, end, _ in self._junctions]
        self._starts, self._beside = [0.0], [_beside_on_road(road, world)]
        if self._route is not None:
            self._starts = list(self._route.starts[:-1])
            self._beside = [_beside_on_leg(self._route, leg) for leg in self._route.legs]
        self._plain = (self._route, (), *self._beside[0])

    def at(self, s: float) -> "tuple[Route | None, tuple[JunctionAhead, ...], int, int]":
        """Returns ``route``, ``junctions``, ``lanes_left`` and ``lanes_right`` of a View at station ``s``."""
        if self._route is None:
            return self._plain
        first = bisect_right(self._ends, s)
        ahead = tuple(
            [
                JunctionAhead(max(start - s, 0.0), *seen, end - max(start, s))
                for start, end, seen in self._junctions[first:]
            ]
        )
        return self._route, ahead, *self._beside[max(bisect_right(self._starts, s) - 1, 0)]


def _junction(road: "Road", passage: "Passage") -> tuple[float, float, tuple[str, float, int, str]]:
    """Returns the stations between which a junction lies, and what a driver sees of it from any station."""
    turn = float(wrap_angle(road.heading(passage.end) - road.heading(passage.start)))
    return passage.start, passage.end, (passage.entered.kind, turn, passage.exit, passage.control)


def _beside_on_road(road: "Road", world: "World") -> tuple[int, int]:
    """Returns the number of driving lanes to the left and to the right of the driven lane."""
    profile = world.profile_of(road)
    forward, backward = profile.count
    return _left_and_right(profile, profile.driven + backward, forward - 1 - profile.driven)


def _beside_on_leg(route: "Route", leg: "Leg") -> tuple[int, int]:
    profile = route.network.road(leg.road).profile
    forward, backward = profile.count
    if profile.leads_along(leg.lane):
        index = profile.along_ids.index(leg.lane)
        return _left_and_right(profile, index + backward, forward - 1 - index)
    index = profile.against_ids.index(leg.lane)
    return _left_and_right(profile, index + forward, backward - 1 - index)


def _left_and_right(profile: "Profile", inside: int, outside: int) -> tuple[int, int]:
    """Returns the numbers of lanes to the left and to the right, from those on the side of oncoming traffic
    and those on the other side.
    """
    return (outside, inside) if profile.left_hand else (inside, outside)
