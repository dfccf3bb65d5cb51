"""Requires the middle of the lane of every connecting road to have a radius of at least 5 m.

A car 4.7 m long can just follow this radius: its turning circle between kerbs usually has a diameter of 11 m.
Then its outer front wheel runs on a radius of 5.5 m, and the middle of the car on a radius of about 4.7 m.
"""

from roadgpt.check.finding import Finding
from roadgpt.check.lane_bends import tightest_bend
from roadgpt.check.network_places import junction_finding, more_room
from roadgpt.network import Network, Route
from roadgpt.road import World

LEAST = 5.0  # m
MIDDLE = 0.5  # of the width of the lane
ROUNDING = 1e-9  # m


def inspect(network: Network, route: Route | None, world: World) -> tuple[Finding, ...]:
    """Reports each junction with a connecting road that is too tight, and the smallest radius there."""
    found = []
    for _, junctions in network.nodes:
        ways = [each.road for junction in junctions for each in junction.connections]
        bends = [tightest_bend(network.right_hand.road(way), MIDDLE) for way in ways]
        least = min((bend.radius for bend in bends if bend is not None), default=LEAST)
        if least < LEAST - ROUNDING:
            what = (
                f"the lane of a connecting road has a radius of {least:.1f} m in its middle, tighter than "
                f"{LEAST:g} m; {more_room(junctions[0])}"
            )
            found.append(junction_finding("connection_too_tight", route, junctions[0], what))
    return tuple(found)
