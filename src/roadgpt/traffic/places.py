"""Finds where the others of a scene are and which ways they go: geometry without time.

Offsets are in metres, positive to the left; ``near side`` is the side on which traffic drives."""

import math
from bisect import bisect_right
from typing import TYPE_CHECKING, NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike

from roadgpt.brief.amount import span
from roadgpt.brief.junctions import Side
from roadgpt.brief.scene import Role, Where
from roadgpt.errors import UsageError
from roadgpt.network import is_route
from roadgpt.network.markings import CROSSWALK
from roadgpt.road.road import GOAL
from roadgpt.traffic.actor import FloatArray
from roadgpt.traffic.way import SPACING, Way

if TYPE_CHECKING:
    from roadgpt.road import Profile, Road, World

BESIDE = 2.0  # m, from the outermost driving lane to the middle of who stands or walks beside it
CLEAR = 0.15  # m, from a driving lane to a parked vehicle: 1 m to a car in a lane of 3.5 m (Euro NCAP, CPNCO)
BEFORE, BEHIND = 5.0, 8.0  # m, from a junction to those who cross the road before and behind it
SIGN = {"left": 1.0, "right": -1.0}


class Section(NamedTuple):
    """The cross-section of the map at a place of the tested car's path."""

    road: "Road"
    """The road of the map, which may lead against the tested car's direction."""
    profile: "Profile"
    lane: int
    """The lane of the tested car."""
    station: float
    """The station on this road."""
    x: float
    y: float
    heading: float
    """The direction of the road as the tested car drives it."""

    @classmethod
    def at(cls, s: float, road: "Road", world: "World") -> Self:
        """Returns the cross-section at a station of the tested car's road."""
        middle = world.profile_of(road).middle(s)
        x, y, _ = road.at(s, middle).tolist()
        if not is_route(road):
            profile = world.profile_of(road)
            return cls(road, profile, profile.driven_id, s, x, y, float(road.heading(s)))
        leg = road.legs[min(max(bisect_right(road.starts, s) - 1, 0), len(road.legs) - 1)]
        member = road.network.road(leg.road)
        station = float(member.road.locate(x, y)[0])
        turn = 0.0 if member.profile.leads_along(leg.lane) else math.pi
        heading = float(member.road.heading(station)) + turn
        return cls(member.road, member.profile, leg.lane, station, x, y, heading)

    @property
    def is_along(self) -> bool:
        """Whether the tested car drives in the direction of the road."""
        return self.profile.leads_along(self.lane)

    @property
    def near_side(self) -> Side:
        """The side on which traffic drives."""
        return "left" if self.profile.left_hand else "right"

    def offset(self, t: ArrayLike) -> FloatArray:
        """Returns how far to the left of the tested car's path something is that is ``t`` to the left of the
        road's centre line."""
        x, y, _ = np.moveaxis(self.road.at(self.station, t), -1, 0)
        return np.asarray((y - self.y) * math.cos(self.heading) - (x - self.x) * math.sin(self.heading))

    def middle(self, lane: int) -> float:
        """Returns the offset of the middle of a lane."""
        return float(self.offset(np.mean(self.profile.edges_of(lane, self.station))))

    def lanes(self, width: float, against: bool = False) -> list[int]:
        """Returns the lanes of the tested car's direction, or those against it, that have this width, from
        the middle of the road outwards; the tested car's own lane is among them."""
        profile, here = self.profile, self.station
        ids = profile.along_ids if self.is_along != against else profile.against_ids
        edges = [(each, profile.edges_of(each, here)) for each in ids]
        return [each for each, (left, right) in edges if each == self.lane or left - right >= width]

    def edge(self, side: str) -> float:
        """Returns the offset of the outer edge of the outermost driving lane of a side."""
        edges = self.offset(np.array(self.profile.edges(self.station)))
        return float(edges.max() if side == "left" else edges.min())

    def parking(self, side: str) -> int | None:
        """Returns the parking lane next to the driving lanes of a side, if there is one."""
        is_left = (side == "left") == self.is_along
        number = self.profile.carriageway[0 if is_left else 1]
        strip = (self.profile.left if is_left else self.profile.right)[max(number, 0) :][:1]
        has_one = number >= 0 and bool(strip) and strip[0].kind == "parking"
        return (number + 1) * (1 if is_left else -1) if has_one else None


def offset_of(where: Where, side: Side | None, s: float, road: "Road", world: "World", width: float) -> float:
    """Returns how far to the left of the middle of the tested car's lane, at a station of its road, the
    middle of a place is: of the next "lane" of the same direction or the one beyond, which is "far", of the
    nearest "oncoming" lane, of a box that is "parked" beside the driving lanes, or of who is "beside" them.

    Without a side, "lane" is on the passing side if there is one, and the others are on the near side.
    ``far`` is beside the road where there is no such lane. Within junctions, lanes lead evenly from where
    they come in to where they go out. Raises UsageError if there is no such place."""
    for passage in road.passages:
        if passage.start < s < passage.end:
            if where in ("parked", "beside"):
                raise UsageError(
                    f"there is a junction at {s:.0f} m, where nobody can be {where}; give another place"
                )
            share = (s - passage.start) / (passage.end - passage.start)
            ends = [passage.start - SPACING, passage.end + SPACING]
            before, after = (offset_of(where, side, each, road, world, width) for each in ends)
            return float(before + share * (after - before))
    here = Section.at(s, road, world)
    passing = "left" if here.near_side == "right" else "right"
    if where == "oncoming":
        lanes = here.lanes(width, against=True)
        if not lanes:
            raise UsageError(f"the road has no oncoming lane at {s:.0f} m; write for example against=1")
        return here.middle(lanes[0])
    if where in ("lane", "far"):
        own = here.lanes(width)
        at = own.index(here.lane)
        beside = {passing: own[:at][::-1], here.near_side: own[at + 1 :]}
        number = 0 if where == "lane" else 1
        for each in [side] if side else [passing, here.near_side]:
            if len(beside[each]) > number:
                return here.middle(beside[each][number])
        if where == "lane":
            asked = f" on the {side}" if side else ""
            raise UsageError(
                f"the road has no second lane of the same direction{asked} at {s:.0f} m; write for example "
                "lanes=2, or give another side or place"
            )
    side = side or here.near_side
    if where == "parked":
        parking = here.parking(side)
        return here.edge(side) + SIGN[side] * (CLEAR + width / 2) if parking is None else here.middle(parking)
    return here.edge(side) + SIGN[side] * BESIDE


def way_of(role: Role, near: float, road: "Road", world: "World") -> Way:
    """Returns the way of somebody who crosses the tested car's path or comes to it along other lanes; where
    they meet is at station ``near`` of the tested car's road or later. ``role`` has numbers, and no ranges.
    Raises UsageError if the road has no such place."""
    if role.where == "crosswalk":
        return _across(role, _crosswalk(near, road), road, world)
    return _across(role, _outside_junctions(near, road), road, world)


def _outside_junctions(near: float, road: "Road") -> float:
    s = near
    for passage in road.passages:
        if passage.start - BEFORE < s < passage.end + BEHIND:
            s = passage.end + BEHIND
    if near > road.length - GOAL:
        raise UsageError(f"the road ends at {road.length:.0f} m, before anybody can cross it; make it longer")
    return s if s <= road.length - GOAL else near


def _crosswalk(near: float, road: "Road") -> float:
    away = CROSSWALK[0] + CROSSWALK[1] / 2
    crossed = road.network.crossed if is_route(road) else ()
    for passage in road.passages:
        places = ((passage.arrival, passage.start - away), (passage.departure, passage.end + away))
        for end, s in places:
            if end in crossed and s >= near:
                return float(s)
    raise UsageError(
        f"the route passes no crosswalk after {near:.0f} m; write crosswalk behind a junction, or give "
        "another place"
    )


def _across(role: Role, s: float, road: "Road", world: "World") -> Way:
    """Returns the way straight across the road at a station, at right angles to the tested car's path."""
    here = Section.at(s, road, world)
    side = str(role.side or here.near_side)
    sign = SIGN[side]
    begin = span(role.away).lo if role.away else max(sign * here.edge(side), 0.0) + BESIDE
    end = max(-sign * here.edge("left" if side == "right" else "right"), 0.0) + BESIDE
    along = np.linspace(0.0, begin + end, math.ceil((begin + end) / SPACING) + 1)
    left = sign * (begin - along)
    x, y = here.x - left * math.sin(here.heading), here.y + left * math.cos(here.heading)
    z = here.road.at(here.station, np.clip(here.road.locate(x, y)[1], *here.profile.rims(here.station)[::-1]))
    heading = np.full(len(along), here.heading - sign * math.pi / 2)
    return Way(np.column_stack([x, y, z[:, 2], heading]), (begin, s))
