"""Requires the lanes of connecting roads to continue the lanes of the arms without gaps or steps.

Where two lanes are joined, each edge of one lane must meet the same edge of the other within 1 mm. So both
lanes have the same width, and the same heading within about a milliradian. The lanes that a connection
names must exist.
Source: OpenDRIVE 1.8, road linkage: linked lanes connect without gaps."""

import math
from functools import lru_cache

from roadgpt.check.finding import Finding, junction_finding
from roadgpt.check.footprint import footprint
from roadgpt.network import Connection, LaneLink, Network, RoadEnd, Route
from roadgpt.road import World
from roadgpt.road.profile import width_at

MOST = 1e-3  # m

Point = tuple[float, float]
LaneEnd = tuple[RoadEnd, int]
"""One end of one lane: the end of its road, and the id of the lane."""


def inspect(network: Network, route: Route | None, world: World) -> tuple[Finding, ...]:
    """Reports each lane link that names a missing arm or a missing lane, or joins lanes that do not meet."""
    found = []
    for junction in network.junctions:
        arms = {arm.end for arm in junction.arms}
        for each in junction.connections:
            for lanes in each.lanes:
                if (what := _no_arm(each, arms) or _wrong(network, each, lanes)) is not None:
                    found.append(junction_finding("lanes_do_not_match", route, junction, what))
    return tuple(found)


def _no_arm(each: Connection, arms: set[RoadEnd]) -> str | None:
    for end in (each.incoming, each.outgoing):
        if end not in arms:
            joined = f"connecting road {each.road} meets the {end.contact} of road {end.road}"
            return f"{joined}, which is no arm; join it to an arm"
    return None


def _wrong(network: Network, each: Connection, lanes: LaneLink) -> str | None:
    lane, own, target = lanes
    start, finish = RoadEnd(each.road, "start"), RoadEnd(each.road, "end")
    if lane not in network.lanes_into(each.incoming):
        return f"road {each.incoming.road} has no lane {lane} that leads into it; name a lane that does"
    if own not in network.lanes_out_of(start):
        return f"connecting road {each.road} has no lane {own} along it; name a lane that it has"
    apart = _gap(network, (each.incoming, lane), (start, own))
    if apart > MOST:
        return _said(each.road, each.incoming.road, apart)
    if target not in network.lanes_out_of(each.outgoing):
        return f"road {each.outgoing.road} has no lane {target} that leads out of it; name a lane that does"
    apart = _gap(network, (finish, own), (each.outgoing, target))
    return _said(each.road, each.outgoing.road, apart) if apart > MOST else None


def _said(connecting: int, road: int, apart: float) -> str:
    return (
        f"the lanes of roads {connecting} and {road} do not meet: their edges are {apart:.3f} m apart; give "
        "both the same place, heading and width there"
    )


def _gap(network: Network, one: LaneEnd, other: LaneEnd) -> float:
    """Returns the larger of two distances in metres: of the inner and of the outer edges of two lanes."""
    points = _points(network)
    (a, b), (c, d) = points[one], points[other]
    return max(math.dist(a, c), math.dist(b, d))


@lru_cache(maxsize=2)
def _points(network: Network) -> dict[LaneEnd, tuple[Point, Point]]:
    found: dict[LaneEnd, tuple[Point, Point]] = {}
    for end, pose in footprint(network).ends.items():
        member = network.road(end.road)
        s = 0.0 if end.contact == "start" else member.road.length
        profile = member.profile
        begin = width_at(profile.offset, s)
        for ids, lanes, t in (
            (profile.along_ids, profile.along, begin),
            (profile.against_ids, profile.against, begin - profile.side * profile.median),
        ):
            outer = pose.beside(t)
            for lane, own in zip(ids, lanes, strict=False):
                width = width_at(own.width, s)
                t = t - width if lane < 0 else t + width
                inner, outer = outer, pose.beside(t)
                found[(end, lane)] = (inner, outer)
    return found
