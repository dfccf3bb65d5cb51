"""Reads a change request with the networks that read descriptions of single roads."""

from collections.abc import Callable, Mapping
from typing import NamedTuple

from roadgpt.brief.readers.model.confidence import DOUBT, confidence, features, is_denial
from roadgpt.brief.readers.model.ensemble import Ensemble
from roadgpt.brief.readers.model.reverse_words import asks_to_reverse
from roadgpt.brief.readers.model.slots import SlottedText, slotted
from roadgpt.brief.readers.model.swap_words import turns_to_swap
from roadgpt.brief.readers.model.test_time_augmentation import ScoredPlan, scored_plans
from roadgpt.errors import BriefError

REVERSED = "road: reverse"
CERTAIN = 0.97
"""The confidence in a request that is read by its words: to reverse the road, or to swap two turns."""
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
    swapped = turns_to_swap(text)
    if swapped:
        return ChangeReading(f"{swapped}: swap", CERTAIN, ())
    found = scored_plans(roads.networks, words, roads.refuse_from, key=key)
    if not found:
        raise BriefError("this could not be read as changes; use shorter sentences")
    near = [draft for draft in found if draft.score >= found[0].score - ALMOST]
    draft = next((draft for draft in near if not _lost_numbers(draft, text)), found[0])
    others = (each.line for each in near if each is not draft and not each.is_refusal)
    other = next(others, "")
    found_in = features(roads.networks, draft, text)
    if draft.is_refusal:
        sure = confidence(weights, found_in, (), text)
        return ChangeReading(draft.line, sure, (), other)
    lost = _lost_numbers(draft, text)
    unused = roads.unused(text, draft.tokens)
    sure = confidence(weights, found_in, (*lost, *unused), text)
    sure = min(sure, DOUBT) if is_denial(words) else sure
    unused = tuple(dict.fromkeys([*lost, *unused]))
    return ChangeReading(draft.line, sure, unused, other)


def _lost_numbers(draft: ScoredPlan, text: SlottedText) -> tuple[str, ...]:
    """Returns the small numbers of a change request (positions and counts) that its plan lacks."""
    if draft.is_refusal:
        return ()
    return tuple(
        word.written
        for word in text.words
        if word.written and word.text.isdecimal() and word.text not in (*draft.tokens, "1")
    )
