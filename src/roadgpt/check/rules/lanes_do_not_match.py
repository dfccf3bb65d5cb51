"""Requires the lanes of connecting roads to continue the lanes of the arms without gaps or steps.

Where two lanes are joined, each edge of one lane must meet the same edge of the other within 1 mm. So both
lanes have the same width, and the same heading within about a milliradian. The lanes that a connection
names must exist.
Source: OpenDRIVE 1.8, road linkage: linked lanes connect without gaps."""

import math
from functools import lru_cache

from roadgpt.brief.model import Brief
from roadgpt.check.finding import Finding, junction_finding
from roadgpt.check.footprint import footprint
from roadgpt.network import Connection, LaneLink, Network, RoadEnd
from roadgpt.road import Road, World
from roadgpt.road.profile import width_at

MOST = 1e-3  # m

Point = tuple[float, float]
LaneEnd = tuple[RoadEnd, int]
"""One end of one lane: the end of its road, and the id of the lane."""


def inspect(network: Network, route: Road | None, brief: Brief | None, world: World) -> tuple[Finding, ...]:
    """Reports each lane link that names a missing arm or a missing lane, or joins lanes that do not meet."""
    found = []
    for junction in network.junctions:
        arms = {arm.end for arm in junction.arms}
        for each in junction.connections:
            for lanes in each.lanes:
                if (what := _wrong(network, arms, each, lanes)) is not None:
                    found.append(junction_finding("lanes_do_not_match", route, junction, what))
    return tuple(found)


def _wrong(network: Network, arms: set[RoadEnd], each: Connection, lanes: LaneLink) -> str | None:
    for end in (each.incoming, each.outgoing):
        if end not in arms:
            joined = f"connecting road {each.road} meets the {end.contact} of road {end.road}"
            return f"{joined}, which is no arm; join it to an arm"
    lane, own, target = lanes
    start, finish, points = RoadEnd(each.road, "start"), RoadEnd(each.road, "end"), _points(network)
    if lane not in network.lanes_into(each.incoming):
        return f"road {each.incoming.road} has no lane {lane} that leads into it; name a lane that does"
    if own not in network.lanes_out_of(start):
        return f"connecting road {each.road} has no lane {own} along it; name a lane that it has"
    for arm, its_lane, end in ((each.incoming, lane, start), (each.outgoing, target, finish)):
        if end is finish and target not in network.lanes_out_of(arm):
            return f"road {arm.road} has no lane {target} that leads out of it; name a lane that does"
        apart = max(map(math.dist, points[arm, its_lane], points[end, own]))  # of inner and outer edges
        if apart > MOST:
            return (
                f"the lanes of roads {each.road} and {arm.road} do not meet: their edges are {apart:.3f} m "
                "apart; give both the same place, heading and width there"
            )
    return None


@lru_cache(maxsize=2)
def _points(network: Network) -> dict[LaneEnd, tuple[Point, Point]]:
    found: dict[LaneEnd, tuple[Point, Point]] = {}
    for end, pose in footprint(network).ends.items():
        member = network.road(end.road)
        s = 0.0 if end.contact == "start" else member.road.length
        profile = member.profile
        for sign, lanes in ((1, profile.left), (-1, profile.right)):
            t = width_at(profile.offset, s)
            outer = pose.beside(t)
            for number, lane in enumerate(lanes, 1):
                t += sign * width_at(lane.width, s)
                inner, outer = outer, pose.beside(t)
                found[(end, sign * number)] = (inner, outer)
    return found
