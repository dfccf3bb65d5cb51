"""The plan reader: reads descriptions in the plan language, which needs no interpretation."""

from roadgpt.brief.feasible import check
from roadgpt.brief.model import Brief
from roadgpt.brief.normal import STRAIGHT
from roadgpt.brief.plan import read_plan
from roadgpt.errors import BriefError

OF_TURNS = {"side", "alternating", "sharpness", "degrees", "radius"}
"""Fields that only turns have; only straights have a size."""


class PlanReader:
    """Reads plans, such as ``turn left 90 r30; straight 40``."""

    def read(self, words: str) -> Brief:
        """Returns the Brief that a plan describes.

        Raises:
            BriefError: the plan is empty, has an unknown word, or contradicts itself."""
        if not words.strip():
            raise BriefError("the plan is empty; write for example 'turn left 90 r30; straight 40'")
        brief = read_plan(words)
        for clause in filter(None, (*brief.clauses, brief.starts, brief.ends)):
            unsuited = clause.model_fields_set & (OF_TURNS if clause.kind in STRAIGHT else {"size"})
            if unsuited:
                raise BriefError(f"a {clause.kind} has no {min(unsuited)}; leave it out of the plan")
        check(brief, map_size=None, min_radius=0.0)  # the limits of a World are checked in brief.read
        return brief.model_copy(update={"words": words})
