"""Builds drafts of networks one after another until the rules accept one."""

import re
from collections import Counter
from collections.abc import Callable, Iterable
from itertools import islice
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
"""The reason why a draft fails if a lane does not continue at a junction (rule ``unreachable``)."""
RUN_TOGETHER = "two of its roads would meet where no junction is, and bridges cannot be built yet"
"""The reason why a draft fails if two roads overlap outside junctions (rule ``conflicting_overlap``)."""
REASONS = {"unreachable": LANES_DIFFER, "conflicting_overlap": RUN_TOGETHER}
NUMBER = re.compile(r"\d[\d.]*")
PLACE = re.compile(r"^at s = [\d.]+ m: | near \([^)]*\)")
"""Matches the place of a fault in a message; it is cut out, because the user never sees the draft."""
Draft = TypeVar("Draft", NetworkDesign, MapDesign)


def first_accepted(
    drafts: Iterable[Draft | None],
    build: Callable[[Draft, World], Route],
    brief: Brief,
    world: World,
    failed: Counter[str],
    most: int,
) -> Draft | None:
    """Returns the first draft whose route can be built and breaks no rule; None if there is no such draft.

    A draft of None did not fit on the map, and is skipped; at most ``most`` drafts are built. ``failed``
    counts the drafts that failed for each reason; this function adds to it. Reasons that differ only in
    places and numbers count together, under the first of them; so do findings of one rule."""
    reasons: dict[str, str] = {}
    for draft in islice((draft for draft in drafts if draft is not None), most):
        try:
            findings = check.inspect(build(draft, world), brief, world)
        except UsageError as error:
            why = PLACE.sub("", str(error))
            failed[reasons.setdefault(NUMBER.sub("", why), why)] += 1
        else:
            if not findings:
                return draft
            first = findings[0]
            why = REASONS.get(first.rule) or PLACE.sub("", first.sentence)
            failed[reasons.setdefault(first.rule, why)] += 1
    return None
