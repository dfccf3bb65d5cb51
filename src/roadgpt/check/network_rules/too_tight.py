"""Requires turns with a radius of at least 14.326 m (47 ft) on roads outside junctions and roundabouts.

This is the limit of the SBFT competition, as in the rule for single roads. Connecting roads may be tighter:
see ``connection_too_tight``."""

from roadgpt.check.finding import Finding, road_finding
from roadgpt.check.rules.too_tight import tight_place
from roadgpt.network import Network, Route
from roadgpt.road import World


def inspect(network: Network, route: Route | None, world: World) -> tuple[Finding, ...]:
    """Reports the tightest place of each road whose radius is below the limit."""
    found = []
    for member in network.roads_outside:
        if (tight := tight_place(member.road, world)) is not None:
            found.append(road_finding("too_tight", route, member, *tight))
    return tuple(found)
