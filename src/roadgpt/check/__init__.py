"""Checks roads against rules. A Finding describes one violation of a rule. Main function: ``inspect``.

A rule is a function in a file under ``rules/``. It checks one property of a network of roads and of the way
that is driven through it, and returns one Finding, with measured values, for each violation; an empty tuple
means that the network satisfies the rule:

    def inspect(
        network: Network, route: Road | None, brief: Brief | None, world: World
    ) -> tuple[Finding, ...]

A single road is a network of one road, and ``route`` is the road itself. Through junctions, ``route`` is a
Route; it is None for a map through which no route was asked for.

A rule set is a named, ordered list of rules. Rules that other packages register as plug-ins (entry points of
the group ``roadgpt.rules``) are appended to ``strict``."""

from collections.abc import Callable
from functools import cache
from typing import TypeAlias, cast

from roadgpt import plugins
from roadgpt.brief.model import Brief
from roadgpt.check.finding import Finding
from roadgpt.errors import UsageError
from roadgpt.network import Network, network_of
from roadgpt.road import Road, World

RULE_SETS = {
    "strict": (
        "finite", "number_of_points", "too_short", "inside_map", "below_floor", "too_steep", "too_abrupt",
        "too_tight", "ring_too_small", "ramp_too_short", "arms_too_close", "no_overlap",
        "connection_too_tight", "junction_not_level", "lanes_do_not_match", "unreachable", "not_in_land",
        "sight_too_short", "promises",
    ),
    "sbft": ("sbft",),
}  # fmt: skip
"""The names of the rules of each set, in the order in which they are applied."""
OF_JOINED_ROADS = {
    "ring_too_small", "ramp_too_short", "arms_too_close", "connection_too_tight", "junction_not_level",
    "lanes_do_not_match", "unreachable",
}  # fmt: skip
"""The names of our rules that find nothing in a network of one road, and are not loaded for it."""


Rule: TypeAlias = "Callable[[Network, Road | None, Brief | None, World], tuple[Finding, ...]]"
"""A function that checks one property of a network and its route; the findings on a route are in driving
order, and their stations are those of the route."""


def inspect(road: Road, brief: Brief | None, world: World, rules: str = "strict") -> tuple[Finding, ...]:
    """Returns the findings of all rules of a set, in the order of the rules.

    A road without findings is valid. If there are findings, the first one is given as the reason why the road
    is invalid. After a finding with ``stops``, no further rules of the set are applied.

    Raises UsageError if there is no rule set of this name, and PartError if no rules are installed or one of
    the set is missing, so that no road passes because rules are missing."""
    laid = world.lay(road)
    network, found = network_of(laid, world), list[Finding]()
    route = laid if laid.has_way else None
    for _, rule in rules_of(rules, len(network.roads) > 1):
        findings = rule(network, route, brief, world)
        found += findings
        if any(finding.stops for finding in findings):
            break
    return tuple(found)


@cache
def rules_of(rules: str, are_joined: bool = False) -> tuple[tuple[str, Rule], ...]:
    """Returns the name and the function of each rule of a set, in the order in which they are applied. Those
    about several roads are left out unless ``are_joined``."""
    if rules not in RULE_SETS:
        raise UsageError(f"no rule set called '{rules}'; there are: {', '.join(RULE_SETS)}")
    names, installed = RULE_SETS[rules], plugins.names("rules")
    if rules == "strict":
        known = {name for names in RULE_SETS.values() for name in names}
        names += tuple(name for name in installed if name not in known)
    wanted = (name for name in names if are_joined or name not in OF_JOINED_ROADS)
    return tuple((name, cast(Rule, plugins.find("rules", name))) for name in wanted)


__all__ = ["RULE_SETS", "Finding", "Rule", "inspect", "rules_of"]
