"""Requires a connection from every lane that enters a junction, and one to every lane that leaves it.

A lane that ends at a junction without a connection would be a trap for traffic, and a lane that no connection
reaches would stay empty. In a network of several roads, each road must meet a junction or another road.
Source: OpenDRIVE 1.8, junctions: connections describe all ways through a junction."""

from roadgpt.brief.model import Brief
from roadgpt.check.finding import Finding, junction_finding, road_finding
from roadgpt.network import Network, RoadEnd
from roadgpt.road import Road, World


def inspect(network: Network, route: Road | None, brief: Brief | None, world: World) -> tuple[Finding, ...]:
    """Reports each lane that lacks a connection at its junction, and each road that meets no other."""
    found = []
    for junction in network.junctions:
        left = {(each.incoming, lane) for each in junction.connections for lane, *_ in each.lanes}
        entered = {(each.outgoing, lanes.outgoing) for each in junction.connections for lanes in each.lanes}
        for arm in junction.arms:
            for lane in network.lanes_into(arm.end):
                if (arm.end, lane) not in left:
                    what = f"lane {lane} of road {arm.end.road} leads into it and has no way on; connect it"
                    found.append(junction_finding("unreachable", route, junction, what))
            for lane in network.lanes_out_of(arm.end):
                if (arm.end, lane) not in entered:
                    what = f"no way leads to lane {lane} of road {arm.end.road}, which leaves it; connect it"
                    found.append(junction_finding("unreachable", route, junction, what))
    if len(network.plain_roads) > 1:
        for member in network.plain_roads:
            ends = {RoadEnd(member.id, "start"), RoadEnd(member.id, "end")}
            if not ends & {*network.junction_at, *network.continued_at}:
                what = (
                    "the road meets no junction, so that no other road leads to it; join it or leave it out"
                )
                found.append(road_finding("unreachable", route, member, 0.0, what))
    return tuple(found)
