"""Applies single rules of networks."""

from network.changing import WORLD
from roadgpt import plugins
from roadgpt.check import Finding
from roadgpt.network import Network, Route
from roadgpt.road import World


def findings(rule: str, network: Network | Route, world: World = WORLD) -> tuple[Finding, ...]:
    route = network if isinstance(network, Route) else None
    found: tuple[Finding, ...] = plugins.find("network_rules", rule)(
        route.network if route else network, route, world
    )
    return found


def the_finding(rule: str, network: Network | Route, world: World = WORLD) -> Finding:
    (found,) = findings(rule, network, world)
    assert found.rule == rule
    return found
