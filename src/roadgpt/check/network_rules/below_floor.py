"""Requires all roads of a network to stay on or above the ground of BeamNG's level.

The limit is that of the rule ``below_floor`` for single roads."""

from roadgpt.check.finding import Finding, road_finding
from roadgpt.check.rules.below_floor import low_place
from roadgpt.network import Network, Route
from roadgpt.road import World


def inspect(network: Network, route: Route | None, world: World) -> tuple[Finding, ...]:
    """Reports the lowest place of each road that is below the ground."""
    found = []
    for member in network.roads:
        if (low := low_place(member.road, world)) is not None:
            found.append(road_finding("below_floor", route, member, *low))
    return tuple(found)
