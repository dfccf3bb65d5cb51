"""Goes through drafts of networks until the rules accept one."""

from collections import Counter
from collections.abc import Callable, Iterable
from typing import TypeVar

from roadgpt import check
from roadgpt.brief.model import Brief
from roadgpt.errors import UsageError
from roadgpt.network import MapDesign, NetworkDesign, Route
from roadgpt.road import World

LANES_DIFFER = (
    "at a junction, lanes of one road would lead nowhere or nothing would lead to them, because the roads "
    "have different numbers of lanes"
)
"""The reason for which drafts fail whose roads have more lanes than the other roads at a junction take."""
Draft = TypeVar("Draft", NetworkDesign, MapDesign)


def first_accepted(
    drafts: Iterable[Draft | None],
    build: Callable[[Draft, World], Route],
    brief: Brief,
    world: World,
    failed: Counter[str],
    most: int,
) -> Draft | None:
    """Returns the first draft from which a route can be built that breaks no rule; None if there is none.

    Args:
        drafts: the drafts; None for one that found no place.
        build: builds the route of a draft.
        brief: the requirements.
        world: limits that the rules check.
        failed: counts why drafts were not accepted; it is added to.
        most: number of drafts that are built at most.
    """
    built = 0
    for draft in drafts:
        if draft is None:
            continue
        built += 1
        try:
            findings = check.inspect(build(draft, world), brief, world)
        except UsageError as error:
            failed[str(error)] += 1
        else:
            if not findings:
                return draft
            is_lane = findings[0].rule == "unreachable"
            failed[LANES_DIFFER if is_lane else findings[0].sentence] += 1
        if built == most:
            break
    return None
