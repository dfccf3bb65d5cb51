"""Reads a change request with the networks that read descriptions of single roads, and by rules."""

from collections.abc import Callable, Mapping
from typing import NamedTuple

from roadgpt.brief.readers.model.change_rules import lost_numbers, read_by_rules
from roadgpt.brief.readers.model.confidence import DOUBT, confidence, features, is_denial
from roadgpt.brief.readers.model.ensemble import Ensemble
from roadgpt.brief.readers.model.height_words import is_doubtful_climb, with_sign
from roadgpt.brief.readers.model.reverse_words import asks_to_reverse
from roadgpt.brief.readers.model.slots import slotted
from roadgpt.brief.readers.model.test_time_augmentation import scored_plans
from roadgpt.errors import BriefError

REVERSED = "road: reverse"
CERTAIN = 0.97
"""The confidence in a change request that a rule reads."""
ALMOST = 2.0  # difference of score


class ChangeReading(NamedTuple):
    """The network's reading of a change request."""

    plan: str
    """A plan of changes, or a refusal."""
    confidence: float
    unused: tuple[str, ...]
    """Words that the plan does not depend on."""
    other: str = ""
    """The second likeliest plan that is no refusal; empty if none is likely."""


def read_change(
    roads: Ensemble, weights: Mapping[str, float], words: str, key: Callable[[str], str]
) -> ChangeReading:
    """Returns what a change request asks for, as a plan; for the other arguments see ``ModelReader``.

    Args:
        roads: the networks that read the request.
        weights: the weights of the confidence model for change requests, and its bias.

    Raises:
        BriefError: the network wrote no plan that can be read.
    """
    if asks_to_reverse(words):
        return ChangeReading(REVERSED, CERTAIN, ())
    text = slotted(words, is_change=True)
    found = scored_plans(roads.networks, words, roads.refuse_from, key=key)
    if not found:
        raise BriefError("this could not be read as changes; use shorter sentences")
    line = found[0].line
    known = read_by_rules(line, text, found[1].line if len(found) > 1 else "")
    if known is not None:
        return ChangeReading(known, CERTAIN, ())
    near = [draft for draft in found if draft.score >= found[0].score - ALMOST]
    draft = next((draft for draft in near if not lost_numbers(draft, text)), found[0])
    others = (with_sign(each.line, text) for each in near if each is not draft and not each.is_refusal)
    other = next(others, "")
    found_in = features(roads.networks, draft, text)
    if draft.is_refusal:
        sure = confidence(weights, found_in, (), text)
        return ChangeReading(draft.line, sure, (), other)
    lost = lost_numbers(draft, text)
    unused = roads.unused(text, draft.tokens)
    sure = confidence(weights, found_in, (*lost, *unused), text)
    sure = min(sure, DOUBT) if is_denial(words) or is_doubtful_climb(draft.line, text) else sure
    unused = tuple(dict.fromkeys([*lost, *unused]))
    return ChangeReading(with_sign(draft.line, text), sure, unused, other)
