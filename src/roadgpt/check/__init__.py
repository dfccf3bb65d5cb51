"""Checks roads against rules. A Finding describes one violation of a rule. Main function: ``inspect``.

A rule is a function in a file of its own under ``rules/``. It checks one property of the road and returns one
Finding, with measured values, for each violation; an empty tuple means that the road satisfies the rule:

    def inspect(road: Road, brief: Brief | None, world: World) -> tuple[Finding, ...]

A rule set is a named, ordered list of rules. Rules that other packages register as plug-ins (entry points of
the group ``roadgpt.rules``) are appended to ``strict``.
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
"""The rules of each set in the order in which they are applied. The first Finding is given as the reason why
a road is invalid.
"""


class Rule(Protocol):
    """A function that checks one property of a road."""

    def __call__(self, road: Road, brief: Brief | None, world: World) -> tuple[Finding, ...]:
        """Returns one Finding for each violation, in driving order; an empty tuple if there is none."""
        ...


def inspect(road: Road, brief: Brief | None, world: World, rules: str = "strict") -> tuple[Finding, ...]:
    """Returns the findings of all rules of a set, in the order of the rules.

    A road without findings is valid. If there are findings, the first one is given as the reason why the road
    is invalid.

    Args:
        road: The road to check.
        brief: The requirements that the road should meet; None if there are none.
        world: The map and the limits, such as the minimum radius and the maximum grade.
        rules: Name of the rule set, "strict" or "sbft".

    Raises:
        UsageError: There is no rule set of this name.
        PartError: No rules are installed, or a rule of the set is missing. This ensures
            that no road passes because rules are missing.
    """
    road, found = world.lay(road), list[Finding]()
    for _, rule in rules_of(rules):
        found += rule(road, brief, world)
        if any(finding.stops for finding in found):
            break  # the other rules would have nothing to measure
    return tuple(found)


@cache
def rules_of(rules: str) -> tuple[tuple[str, Rule], ...]:
    """Returns the name and the function of each rule of a set, in the order in which they are applied.

    Raises:
        UsageError: There is no rule set of this name.
        PartError: No rules are installed, or a rule of the set is missing.
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
