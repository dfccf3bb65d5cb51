"""Finds the criteria by which people rate a road, and computes scores of the road for the same criteria."""

from roadgpt.brief.model import Brief, Clause
from roadgpt.brief.normal import BUMPS, STRAIGHT
from roadgpt.brief.sentence import WAVY
from roadgpt.errors import UsageError
from roadgpt.run import Run
from roadgpt.study.road_record import kept_of
from roadgpt.study.similarity import likeness, similarity
from roadgpt.study.survey.questions import CRITERIA, OVERALL

MATCH = {OVERALL: "general"} | {CRITERIA[name]: name for name in ("turns", "incline", "order")}
"""For each criterion of a road and its description, the measured criterion of ``study.criteria``."""
ALIKE = MATCH | {CRITERIA["order"]: "sequence", CRITERIA["length"]: "length"}
"""For each criterion of two roads, the measured criterion of ``study.similarity``."""


def criteria_of(brief: Brief | None) -> tuple[str, ...]:
    """Returns the criteria that a description mentions: "turns", "incline", "order".

    A general description such as "a road" mentions no criterion: its roads are rated only as a whole, as in
    the thesis.
    """
    if brief is None:
        return ()
    clauses = [*brief.clauses, *filter(None, (brief.starts, brief.ends))]
    # "at least one turn" says nothing, since every road has one
    amounts = [(each.lo, each.hi) for each in (brief.turns, brief.left, brief.right) if each]
    slopes = (brief.slope, brief.incline, brief.steepest, brief.climb, brief.hills)
    rises = [each for each in clauses if each.slope or each.incline or each.kind in BUMPS]
    mentioned = {
        "turns": any(amount != (1, None) for amount in amounts) or any(map(_has_a_number, clauses)),
        "incline": any(slopes) or rises,
        "order": len(clauses) > 1,
    }
    return tuple(name for name, is_mentioned in mentioned.items() if is_mentioned)


def _has_a_number(clause: Clause) -> bool:
    """Returns whether a clause says how many turns there are."""
    if clause.kind in STRAIGHT:
        return False
    return clause.kind not in WAVY or clause.count.lo != 1 or clause.count.hi != 1


def match_scores(run: Run, prompt: str) -> dict[str, float]:
    """Returns, for each criterion, 1 if a road meets it and 0 if not.

    Only the criteria of the thesis are measured. The result is empty if the road was not made from the
    description ``prompt``.
    """
    if run.road is None or run.brief is None or prompt != run.words.strip():
        return {}
    kept = {str(name): good for name, good in kept_of(run.road, run.brief, run.world).items()}
    return {ours: float(kept[measured]) for ours, measured in MATCH.items() if measured in kept}


def similarity_scores(one: Run, other: Run) -> dict[str, float]:
    """Returns, for each criterion, how similar two roads are (0 to 1); empty if one of them cannot be
    compared."""
    if one.road is None or other.road is None:
        return {}
    try:
        found = similarity(likeness(one.road), likeness(other.road))
    except UsageError:
        return {}
    return {ours: float(getattr(found, measured)) for ours, measured in ALIKE.items()}
