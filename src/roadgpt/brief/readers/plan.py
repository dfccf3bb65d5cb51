"""The plan reader: reads descriptions in the plan language, which needs no interpretation."""

from roadgpt.brief.feasible import check
from roadgpt.brief.model import Brief, Clause
from roadgpt.brief.normal import STRAIGHT
from roadgpt.brief.plan import read_plan
from roadgpt.errors import BriefError

OF_TURNS = {"side", "alternating", "sharpness", "degrees", "radius"}


class PlanReader:
    """Reads plans, such as ``turn left 90 r30; straight 40``."""

    def read(self, words: str) -> Brief:
        """Returns the Brief that a plan describes.

        Raises:
            BriefError: the plan is empty, has an unknown word, or contradicts itself.
        """
        if not words.strip():
            raise BriefError("the plan is empty; write for example 'turn left 90 r30; straight 40'")
        brief = read_plan(words)
        for clause in (*brief.clauses, brief.starts, brief.ends):
            _reject_unsuited(clause)
        check(brief, map_size=None, min_radius=0.0)  # the limits of a World are checked in brief.read
        return brief.model_copy(update={"words": words})


def _reject_unsuited(clause: Clause | None) -> None:
    """Raises BriefError if a straight has a field of turns, such as a side, or a turn is long or short."""
    if clause is None:
        return
    unsuited = clause.model_fields_set & (OF_TURNS if clause.kind in STRAIGHT else {"size"})
    if unsuited:
        raise BriefError(f"a {clause.kind} has no {min(unsuited)}; leave it out of the plan")
