"""Requires more than 20 m of road to drive, and room for a car on every road outside junctions.

The limit is that of the SBFT competition.
If the car is already at the goal when it starts, nothing can be driven at all. Of several roads, each must be
at least as long as the car, 4.7 m. The first road of a route needs 4.85 m, because the middle of the car
starts 2.5 m along it. The last road needs 8 m, because the car has arrived 8 m before its end."""

from roadgpt.brief.model import Brief
from roadgpt.check.finding import Finding, road_finding
from roadgpt.network import Network, legs_of
from roadgpt.road import Road, World
from roadgpt.road.road import GOAL, SHORTEST_DRIVE, START

CAR = 4.7  # m, length of the tested car


def inspect(network: Network, route: Road | None, brief: Brief | None, world: World) -> tuple[Finding, ...]:
    """Reports the length of the route if it is too short, and each road without room for a car."""
    found, limit = [], world.limits.min_length
    least: dict[int, float] = {}
    if route is not None:
        length = route.length
        if length <= SHORTEST_DRIVE:
            sentence = (
                f"the road is {length:.1f} m long, too short to be driven: a car starts {START:g} m along a "
                f"road and has arrived {GOAL:g} m before its end"
            )
            return (Finding("too_short", sentence, stops=True),)
        if length <= limit:
            sentence = f"the road is {length:.1f} m long, and a road is longer than {limit:g} m"
            found.append(Finding("too_short", sentence))
        legs = legs_of(route, world)
        least = {legs[0].road: START + CAR / 2}
        least[legs[-1].road] = max(least.get(legs[-1].road, 0.0), GOAL)
    for member in network.roads_outside:
        length, wanted = member.road.length, least.get(member.id, CAR)
        if length < wanted:
            what = f"the road is {length:.1f} m long, too short for a car; give it {wanted:.3g} m or more"
            found.append(road_finding("too_short", route, member, 0.0, what))
    return tuple(found)
