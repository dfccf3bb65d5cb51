"""Computes which junctions lie ahead of a driver, and how many lanes are beside the driver's own lane."""

from bisect import bisect_right
from typing import TYPE_CHECKING

from roadgpt.drive.view import JunctionAhead
from roadgpt.geometry import wrap_angle
from roadgpt.network import is_route

if TYPE_CHECKING:
    from roadgpt.network import Passage, Route
    from roadgpt.road import Profile, Road, World


def passages(road: "Road") -> "tuple[Passage, ...]":
    """Returns the passages of a route through its junctions in driving order; empty for a single road."""
    return road.passages if is_route(road) else ()


class Outlook:
    """The junctions ahead and the lanes beside the driver's own lane, at each station of a road or route."""

    def __init__(self, road: "Road", world: "World") -> None:
        self._route = road if is_route(road) else None
        self._junctions = [_junction(road, each) for each in passages(road)]
        self._ends = [end for _, end, _ in self._junctions]
        if self._route is None:
            profile = world.profile_of(road)
            self._starts, self._beside = [0.0], [_beside(profile, profile.along_ids[profile.driven])]
        else:
            profiles = [self._route.network.road(leg.road).profile for leg in self._route.legs]
            legs = zip(profiles, self._route.legs, strict=True)
            self._starts = list(self._route.starts[:-1])
            self._beside = [_beside(profile, leg.lane) for profile, leg in legs]
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
    """Returns between which stations a junction lies, and what a driver sees of it from anywhere."""
    turn = float(wrap_angle(road.heading(passage.end) - road.heading(passage.start)))
    return passage.start, passage.end, (passage.entered.kind, turn, passage.exit, passage.control)


def _beside(profile: "Profile", lane: int) -> tuple[int, int]:
    own, oncoming = profile.along_ids, profile.against_ids
    if not profile.leads_along(lane):
        own, oncoming = oncoming, own
    inside = own.index(lane) + len(oncoming)
    outside = len(own) - 1 - own.index(lane)
    return (outside, inside) if profile.left_hand else (inside, outside)
