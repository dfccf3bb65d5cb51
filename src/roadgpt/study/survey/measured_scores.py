"""Measures the roads of a survey in its criteria, so that the results can be compared with what people say.

A road and its description: 1 if the road keeps the criterion, else 0, by ``study.criteria``. Two roads: their
similarity from 0 to 1, by ``study.similarity``. Criteria that a survey adds itself are not measured.
"""

from roadgpt.check.measures import measure
from roadgpt.check.rules.promises import promises_of
from roadgpt.errors import UsageError
from roadgpt.run import Run
from roadgpt.study.criteria import criteria_of_outline
from roadgpt.study.similarity import likeness, similarity
from roadgpt.study.survey.questions import CRITERIA, OVERALL

MATCH = {
    OVERALL: "general",
    CRITERIA["turns"]: "turns",
    CRITERIA["incline"]: "incline",
    CRITERIA["order"]: "order",
}
ALIKE = {
    OVERALL: "general",
    CRITERIA["turns"]: "turns",
    CRITERIA["incline"]: "incline",
    CRITERIA["order"]: "sequence",
    CRITERIA["length"]: "length",
}


def match_scores(run: Run, prompt: str) -> dict[str, float]:
    """Returns whether a road keeps each criterion, 1 or 0; empty if it was not made from this description."""
    if run.road is None or run.brief is None or prompt != run.words.strip():
        return {}
    asked = promises_of(run.brief, run.world)
    try:
        found = measure(run.road.centreline(), asked.widest)
    except UsageError:
        return {}
    kept = {str(name): good for name, good in criteria_of_outline(found, asked).items()}
    return {ours: float(kept[theirs]) for ours, theirs in MATCH.items() if theirs in kept}


def similarity_scores(one: Run, other: Run) -> dict[str, float]:
    """Returns how similar two roads are, 0 to 1, criterion by criterion."""
    if one.road is None or other.road is None:
        return {}
    try:
        found = similarity(likeness(one.road), likeness(other.road))
    except UsageError:
        return {}
    return {ours: float(getattr(found, theirs)) for ours, theirs in ALIKE.items()}
