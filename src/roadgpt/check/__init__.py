"""Checks: makes Findings, the sentences of rules about places on a road. Verb: ``inspect``.

A rule is a function in a file of its own under ``rules/``. It looks at one thing, and returns a Finding with
numbers in it for every place that it objects to, or nothing:

    def inspect(road: Road, brief: Brief | None, world: World) -> tuple[Finding, ...]

A rule set is a named, ordered row of rules. Rules that other packages put on the shelf (entry points of the
group ``roadgpt.rules``) join the end of ``strict``.
"""

from functools import cache
from typing import Protocol, cast

from roadgpt import plugins
from roadgpt.brief.model import Brief
from roadgpt.check.finding import Finding
from roadgpt.check.sbft import sbft_verdict
from roadgpt.errors import UsageError
from roadgpt.road import Road, World

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
"""Rules in the order in which they are asked; the first objection is the verdict."""


class Rule(Protocol):
    """Looks at one thing about a road."""

    def __call__(self, road: Road, brief: Brief | None, world: World) -> tuple[Finding, ...]:
        """All that is wrong with it, in driving order; nothing where it is right."""
        ...


def inspect(road: Road, brief: Brief | None, world: World, rules: str = "strict") -> tuple[Finding, ...]:
    """All findings of a rule set, in its order; the first one is the verdict, and none means a valid road.

    Args:
        road: the road to look at.
        brief: what was asked for, if anything was.
        world: map and limits.
        rules: name of the rule set, "strict" or "sbft".

    Raises:
        UsageError: no rule set of that name.
        PartError: the shelf is empty, or a rule of the set is not on it; no road passes for want of rules.
    """
    found: list[Finding] = []
    for _, rule in rules_of(rules):
        found += rule(road, brief, world)
        if any(finding.stops for finding in found):
            break  # there is nothing that the others could measure
    return tuple(found)


@cache
def rules_of(rules: str) -> tuple[tuple[str, Rule], ...]:
    """Names and functions of a rule set's rules, in order.

    Raises:
        UsageError: no rule set of that name.
        PartError: the shelf is empty, or a rule of the set is not on it.
    """
    if rules not in RULE_SETS:
        raise UsageError(f"no rule set called '{rules}'; there are: {', '.join(RULE_SETS)}")
    ours = RULE_SETS[rules]
    shelf = plugins.names("rules")
    if rules == "strict":
        known = {name for names in RULE_SETS.values() for name in names}
        ours += tuple(name for name in shelf if name not in known)
    return tuple((name, cast(Rule, plugins.find("rules", name))) for name in ours)


__all__ = ["RULE_SETS", "Finding", "Rule", "inspect", "rules_of", "sbft_verdict"]
