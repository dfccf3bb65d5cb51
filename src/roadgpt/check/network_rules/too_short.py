"""Requires a route of more than 20 m, and room for a car on every road outside junctions and roundabouts.

A road must be at least as long as the car, 4.7 m. The first road of a route needs 4.85 m, because the middle
of the car starts 2.5 m along it. The last road needs 8 m, because the car has arrived 8 m before its end. The
limit for the whole route is that of the SBFT competition."""

from roadgpt.check.finding import Finding, road_finding
from roadgpt.check.rules.too_short import shorter_than_allowed, without_room
from roadgpt.network import Network, Route
from roadgpt.road import World
from roadgpt.road.road import GOAL, SHORTEST_DRIVE, START

CAR = 4.7  # m, length of the tested car


def inspect(network: Network, route: Route | None, world: World) -> tuple[Finding, ...]:
    """Reports the length of the route if it is too short, and each road without room for a car."""
    found = []
    least = {}
    if route is not None:
        if route.length <= SHORTEST_DRIVE:
            return (without_room(route.length),)
        if route.length <= world.limits.min_length:
            found.append(shorter_than_allowed(route.length, world))
        least[route.legs[0].road] = START + CAR / 2
        least[route.legs[-1].road] = max(least.get(route.legs[-1].road, 0.0), GOAL)
    for member in network.roads_outside:
        length, wanted = member.road.length, least.get(member.id, CAR)
        if length < wanted:
            what = f"the road is {length:.1f} m long, too short for a car; give it {wanted:.3g} m or more"
            found.append(road_finding("too_short", route, member, 0.0, what))
    return tuple(found)
