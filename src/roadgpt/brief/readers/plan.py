"""The plan reader: reads descriptions in the plan language, which needs no interpretation."""

from roadgpt.brief.feasible import check
from roadgpt.brief.model import Brief
from roadgpt.brief.normal import STRAIGHT
from roadgpt.brief.plan import objections, read_plan
from roadgpt.errors import BriefError
from roadgpt.language.table import PARTS

MANY = 2


class PlanReader:
    """Reads plans, such as ``turn left 90 r30; straight 40``."""

    def read(self, words: str) -> Brief:
        """Returns the Brief that a plan describes.

        Raises:
            BriefError: the plan is empty, has an unknown word, or contradicts itself; the message says all
                that is wrong."""
        if not words.strip():
            raise BriefError("the plan is empty; write for example 'turn left 90 r30; straight 40'")
        try:
            brief, parts = read_plan(words), PARTS["clause"]
        except BriefError:
            if len(said := objections(words)) < MANY:
                raise
            raise BriefError("\n- ".join([f"{len(said)} things are wrong with the plan:", *said])) from None
        for clause in filter(None, (*brief.clauses, brief.starts, brief.ends)):
            other = "turns" if clause.kind in STRAIGHT else "straights"
            unsuited = {field for field in clause.model_fields_set & parts.keys() if parts[field].of == other}
            if unsuited:
                raise BriefError(f"a {clause.kind} has no {min(unsuited)}; leave it out of the plan")
        check(brief, map_size=None, min_radius=0.0)  # the limits of a World are checked in brief.read
        return brief.model_copy(update={"words": words})
