"""Briefs that are written as plans, with the words that a user may have said for them."""

from roadgpt.brief import Brief
from roadgpt.brief.readers.plan import PlanReader


def planned(line: str, words: str = "") -> Brief:
    """Returns the Brief of a plan; its description is ``words``, or the plan itself."""
    return PlanReader().read(line).model_copy(update={"words": words or line})
