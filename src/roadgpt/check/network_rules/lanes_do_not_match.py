"""Requires the lanes of connecting roads to continue the lanes of the arms without gaps or steps.

Where two lanes are joined, each edge of one lane must meet the same edge of the other within 1 mm. So both
lanes have the same width, and the same heading within about a milliradian. The lanes that a connection
names must exist.
Source: OpenDRIVE 1.8, road linkage: linked lanes connect without gaps.
"""

from roadgpt.check.finding import Finding
from roadgpt.check.lanes_at_ends import gap, lanes_into, lanes_out_of
from roadgpt.check.network_places import junction_finding
from roadgpt.network import Connection, LaneLink, Network, RoadEnd, Route
from roadgpt.road import World

MOST = 1e-3  # m


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
    if lane not in lanes_into(network, each.incoming):
        return f"road {each.incoming.road} has no lane {lane} that leads into it; name a lane that does"
    if own not in lanes_out_of(network, start):
        return f"connecting road {each.road} has no lane {own} along it; name a lane that it has"
    apart = gap(network, (each.incoming, lane), (start, own))
    if apart > MOST:
        return _said(each.road, each.incoming.road, apart)
    if target not in lanes_out_of(network, each.outgoing):
        return f"road {each.outgoing.road} has no lane {target} that leads out of it; name a lane that does"
    apart = gap(network, (finish, own), (each.outgoing, target))
    return _said(each.road, each.outgoing.road, apart) if apart > MOST else None


def _said(connecting: int, road: int, apart: float) -> str:
    return (
        f"the lanes of roads {connecting} and {road} do not meet: their edges are {apart:.3f} m apart; give "
        "both the same place, heading and width there"
    )
