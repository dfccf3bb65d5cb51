"""Reads a change request with the networks that read descriptions of single roads."""

import re
from collections.abc import Callable, Mapping
from typing import NamedTuple

from roadgpt.brief.readers.model.confidence import DOUBT, confidence, features
from roadgpt.brief.readers.model.ensemble import Ensemble
from roadgpt.brief.readers.model.slots import SlottedText, slotted
from roadgpt.brief.readers.model.test_time_augmentation import ScoredPlan, scored_plans
from roadgpt.errors import BriefError

ALMOST = 2.0  # difference of score
LIKELY = 2.5  # difference of score to another plan that may be meant
DENIAL = re.compile(
    r"(?:please )?(?:do not|don'?t|never) [^,;:.]*[.!]*"
    r"|(?:bitte )?mach\w* [^,;:.]*\bnicht \w+er[.!]*"
    r"|ne (?:fais|rends|mets|change)[^,;:.]* pas [^,;:.]*[.!]*"
    r"|no (?:hagas|pongas|cambies) [^,;:.]*[.!]*"
    r"|non (?:fare|rendere|cambiare|mettere) [^,;:.]*[.!]*",
    re.IGNORECASE,
)
SWAP = re.compile(
    r"\b(?:swap|exchange|switch|interchange|trade places|change places|(?:ver)?tausch\w*|echang\w*|"
    r"intervert\w*|permut\w*|intercambi\w*|scambi\w*|invertendo di posto)\b"
)
TAKEN = re.compile(r"(.+?) ?: (angle|radius|length|slope) =([a-z].*)")
"""A change that takes a value from another place."""


class ChangeReading(NamedTuple):
    """The reading of a change request."""

    plan: str
    """A plan of changes, or a refusal."""
    confidence: float
    unused: tuple[str, ...]
    """Words that the plan does not depend on."""
    others: tuple[str, ...] = ()
    """Other plans that are likely and no refusals, the likeliest first."""


def read_change(
    roads: Ensemble, weights: Mapping[str, float], words: str, key: Callable[[str], str]
) -> ChangeReading:
    """Returns what a change request asks for, as a plan; for ``key`` see ``ModelReader.read_change``.

    Raises:
        BriefError: the network wrote no plan that can be read.
    """
    text = slotted(words, is_change=True)
    found = scored_plans(roads.networks, words, roads.refuse_from, key=key)
    if not found:
        raise BriefError("this could not be read as changes; use shorter sentences")
    near = [draft for draft in found if draft.score >= found[0].score - ALMOST]
    draft = next((draft for draft in near if not _lost_numbers(draft, text)), found[0])
    likely = [each for each in found if each.score >= found[0].score - LIKELY and each is not draft]
    others = tuple(each.line for each in likely if not each.is_refusal)
    found_in = features(roads.networks, draft, text)
    if draft.is_refusal:
        sure = confidence(weights, found_in, (), text)
        return ChangeReading(draft.line, sure, (), others)
    lost = _lost_numbers(draft, text)
    unused = roads.unused(text, draft.tokens)
    sure = confidence(weights, found_in, (*lost, *unused), text)
    sure = min(sure, DOUBT) if is_denial(words) else sure
    unused = tuple(dict.fromkeys([*lost, *unused]))
    return ChangeReading(_with_both_ways(draft.line, text), sure, unused, others)


def _lost_numbers(draft: ScoredPlan, text: SlottedText) -> tuple[str, ...]:
    """Returns the small numbers of a change request (positions and counts) that its plan lacks."""
    if draft.is_refusal:
        return ()
    return tuple(
        word.written
        for word in text.words
        if word.written and word.text.isdecimal() and word.text not in (*draft.tokens, "1")
    )


def _with_both_ways(line: str, text: SlottedText) -> str:
    """Returns a plan that lets one place take a value of another, with the other taking that of the first, if
    the words ask to swap and the plan asks for nothing else; any other plan unchanged.
    """
    said = " ".join(word.text for word in text.words)
    parts = [TAKEN.fullmatch(part.strip()) for part in line.split(";")]
    if not parts[0] or len(parts) > 2 or not SWAP.search(said) or " for " in said:
        return line
    one, what, other = parts[0].groups()
    if len(parts) == 2 and not (parts[1] and parts[1][2] == what and parts[1][1].strip() in (one, other)):
        return line
    return f"{one}: {what} ={other}; {other}: {what} ={one}"


def is_denial(words: str) -> bool:
    """Returns whether a change request says only what must not change, such as "don't make it longer"."""
    return DENIAL.fullmatch(words.strip().replace("’", "'")) is not None
