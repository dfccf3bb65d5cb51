"""Checks roads against rules. A Finding describes one violation of a rule. Main function: ``inspect``.

A rule is a function in a file of its own under ``rules/``. It checks one property of the road and returns one
Finding, with measured values, for each violation; an empty tuple means that the road satisfies the rule:

    def inspect(road: Road, brief: Brief | None, world: World) -> tuple[Finding, ...]

A rule set is a named, ordered list of rules. Rules that other packages register as plug-ins (entry points of
the group ``roadgpt.rules``) are appended to ``strict``.

A road that leads through junctions is a Route, and its whole network is checked against other rules, which
are under ``network_rules/`` (entry points of the group ``roadgpt.network_rules``):

    def inspect(network: Network, route: Route | None, world: World) -> tuple[Finding, ...]"""

from collections.abc import Callable, Iterator
from functools import cache
from typing import TYPE_CHECKING, TypeAlias, cast

from roadgpt import plugins
from roadgpt.brief.model import Brief
from roadgpt.check.finding import Finding
from roadgpt.check.sbft import sbft_verdict
from roadgpt.errors import UsageError
from roadgpt.network import has_no_route, is_route
from roadgpt.road import Road, World

if TYPE_CHECKING:
    from roadgpt.network import Network, Route

RULE_SETS = {
    "strict": (
        "finite",
        "number_of_points",
        "too_short",
        "inside_map",
        "below_floor",
        "too_steep",
        "too_abrupt",
        "too_tight",
        "no_overlap",
        "promises",
    ),
    "sbft": ("sbft",),
}
"""The names of the rules of each set, in the order in which they are applied."""
NETWORK_RULES = (
    "finite",
    "too_short",
    "leaves_map",
    "below_floor",
    "too_steep",
    "too_abrupt",
    "too_tight",
    "ring_too_small",
    "ramp_too_short",
    "arms_too_close",
    "conflicting_overlap",
    "kerb_too_tight",
    "connection_too_tight",
    "junction_not_level",
    "lanes_do_not_match",
    "unreachable",
)
"""The names of the rules of networks, in the order in which they are applied. Rules that other packages
register are applied after these."""


Rule = Callable[[Road, Brief | None, World], tuple[Finding, ...]]
"""A function that checks one property of a road; the findings are in driving order."""
NetworkRule: TypeAlias = "Callable[[Network, Route | None, World], tuple[Finding, ...]]"
"""A function that checks one property of a network; stations of the findings are those of the route."""


def inspect(road: Road, brief: Brief | None, world: World, rules: str = "strict") -> tuple[Finding, ...]:
    """Returns the findings of all rules of a set, in the order of the rules.

    A road without findings is valid. If there are findings, the first one is given as the reason why the road
    is invalid. After a finding with ``stops``, no further rules of the set are applied. With "strict", the
    network of a Route is checked by the rules of networks, and the Route is compared with the brief.

    Raises UsageError if there is no rule set of this name, and PartError if no rules are installed or one of
    the set is missing, so that no road passes because rules are missing."""
    rules_of(rules)
    if is_route(road) and rules == "strict":
        found_there = inspect_network(road.network, None if has_no_route(road) else road, world)
        if brief is None:
            return found_there
        from roadgpt.check.network_promises import broken_map, broken_promises  # not for single roads

        if brief.map is not None:
            return (*found_there, *broken_map(road, brief.map, brief.length))
        return (*found_there, *broken_promises(road, brief, world.site.map_size))
    laid = world.lay(road)
    return _until_one_stops(rule(laid, brief, world) for _, rule in rules_of(rules))


def inspect_network(network: "Network", route: "Route | None", world: World) -> tuple[Finding, ...]:
    """Returns the findings of all rules of networks, in the order of the rules, up to one with ``stops``.
    ``route`` leads through this network."""
    return _until_one_stops(rule(network, route, world) for _, rule in network_rules_of())


def _until_one_stops(inspected: Iterator[tuple[Finding, ...]]) -> tuple[Finding, ...]:
    found = list[Finding]()
    for findings in inspected:
        found += findings
        if any(finding.stops for finding in findings):
            break
    return tuple(found)


@cache
def network_rules_of() -> tuple[tuple[str, NetworkRule], ...]:
    """Returns the name and the function of each rule of networks, in the order in which they are applied."""
    others = tuple(name for name in plugins.names("network_rules") if name not in NETWORK_RULES)
    names = (*NETWORK_RULES, *others)
    return tuple((name, cast(NetworkRule, plugins.find("network_rules", name))) for name in names)


@cache
def rules_of(rules: str) -> tuple[tuple[str, Rule], ...]:
    """Returns the name and the function of each rule of a set, in the order in which they are applied."""
    if rules not in RULE_SETS:
        raise UsageError(f"no rule set called '{rules}'; there are: {', '.join(RULE_SETS)}")
    ours = RULE_SETS[rules]
    shelf = plugins.names("rules")
    if rules == "strict":
        known = {name for names in RULE_SETS.values() for name in names}
        ours += tuple(name for name in shelf if name not in known)
    return tuple((name, cast(Rule, plugins.find("rules", name))) for name in ours)


__all__ = [
    "NETWORK_RULES",
    "RULE_SETS",
    "Finding",
    "NetworkRule",
    "Rule",
    "inspect",
    "inspect_network",
    "network_rules_of",
    "rules_of",
    "sbft_verdict",
]
