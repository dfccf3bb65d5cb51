"""Applies single rules to networks and to roads."""

from network.changing import WORLD
from roadgpt import plugins
from roadgpt.brief.model import Brief
from roadgpt.check import Finding
from roadgpt.network import Network, Route, network_of
from roadgpt.road import Road, World

RULE_OF = {
    "leaves_map": "inside_map",
    "conflicting_overlap": "no_overlap",
    "kerb_too_tight": "connection_too_tight",
}
"""The rules whose findings have more than one name, by the other name."""


def all_findings(
    rule: str, place: Network | Road, world: World | None = None, brief: Brief | None = None
) -> tuple[Finding, ...]:
    """What a rule finds on a network without a route, on a Route or on a single road: without a world, on a
    map of 500 m, and for a single road on one of 250 m."""
    route = None if isinstance(place, Network) else place
    world = world or (WORLD if route is None or isinstance(route, Route) else World())
    network = place if isinstance(place, Network) else network_of(place, world)
    found: tuple[Finding, ...] = plugins.find("rules", rule)(network, route, brief, world)
    return found


def findings(
    name: str, place: Network | Road, world: World | None = None, brief: Brief | None = None
) -> tuple[Finding, ...]:
    """What a rule finds under this name."""
    found = all_findings(RULE_OF.get(name, name), place, world, brief)
    return tuple(each for each in found if each.rule == name)


def the_finding(name: str, place: Network | Road, world: World | None = None) -> Finding:
    (found,) = findings(name, place, world)
    return found
