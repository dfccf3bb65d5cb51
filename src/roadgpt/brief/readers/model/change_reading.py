"""Reads a change request with the networks that read descriptions of single roads.

Rules read the requests to swap two turns or straights, which these networks often take for unclear.
"""

import re
from collections.abc import Callable, Mapping
from typing import NamedTuple

from roadgpt.brief.readers.model.confidence import DOUBT, confidence, features
from roadgpt.brief.readers.model.ensemble import Ensemble
from roadgpt.brief.readers.model.ordinals import PLACE, place_of
from roadgpt.brief.readers.model.slots import SlottedText, slotted
from roadgpt.brief.readers.model.test_time_augmentation import ScoredPlan, scored_plans
from roadgpt.errors import BriefError

CERTAIN = 0.97
"""The confidence in a request that rules read: to swap two turns or straights."""
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
TURNS = (
    r"(?:turns?|bends?|curves?|corners?|kurven?|kehren?|bogen|virages?|courbes?|curvas?|curve?|tornanti|"
    r"giros?)"
)
STRAIGHTS = r"(?:straights?|geraden?|lignes? droites?|droites?|rectas?|rettiline[oi]|rettifil[oi])"
NUMBER = rf"(?:(?:the|die|der|le|la|les|las|el|il) )?(\d|{PLACE})(?:st|nd|rd|th| \.|e|eme|a)?"
AND = r"(?:and|with|und|mit|et|avec|y|con|e)"
EACH = r"(?:the (?:two|2|both)|both|die (?:2|zwei|beiden)|les (?:2|deux)|las (?:2|dos)|(?:le|i) (?:2|due))"
THINGS = {"turn": TURNS, "straight": STRAIGHTS}
TWO = {
    noun: re.compile(
        rf"\b{nouns} (?:no |nr |number )?{NUMBER} {AND} (?:{nouns} )?{NUMBER}\b|"
        rf"\b{NUMBER} (?:{nouns} )?{AND} {NUMBER} {nouns}\b|"
        rf"\b{NUMBER} {nouns} {AND} {NUMBER}(?= |$)"
    )
    for noun, nouns in THINGS.items()
}
"""Two turns or straights that are named by their numbers, such as "turn 1 and the third"."""
BOTH = {noun: re.compile(rf"\b{EACH} {nouns}\b") for noun, nouns in THINGS.items()}
BETWEEN = re.compile(
    rf"\b{EACH} {STRAIGHTS} (?:\w+ ){{0,4}}(?:between|in between|zwischen|entre|tra|fra) "
    rf"(?:(?:the|den|les|las|le) )?{TURNS}\b"
)
"""The two straights that lie between the three turns of a road."""
SWAP = re.compile(
    r"\b(?:swap|exchange|switch|interchange|trade places|change places|(?:ver)?tausch\w*|echang\w*|"
    r"intervert\w*|permut\w*|intercambi\w*|scambi\w*|invertendo di posto)\b"
)
MORE = re.compile(
    r"\b(?:left|right|links|rechts|gauche|droite|izquierda|derecha|sinistra|destra|start|end|finish|anfang|ziel|"
    r"lengths?|sharpness|steepness|width|height|to|then|remove|make|from|back|aus|off|gentle|"
    r"sharp|hairpins?|second last|vorletzt\w*|for|directions?|sides?|richtung\w*|sens|sentido\w*|"
    r"langen?|longueurs?|longitud\w*|lunghezz\w*|"
    r"radi\w+|raggi\w*|rayon\w*|angle\w*|winkel\w*|angul\w*|angol\w*|slope\w*|grade\w*|not|nicht|pas|no|non)\b"
)
"""Words that show that a request does not just swap the places of two turns or straights."""
STAYS = re.compile(
    r" [,;.] (?:and |but |und |aber |et |mais |y |pero |e |ma )?[^,;.]*\b(?:stays?|keep|kept|remains?|"
    r"unchanged|untouched|bleib\w*|unverandert|reste(?:nt)?|inchange\w*|qued\w+|igual|sin cambi\w+|"
    r"rest(?:a|ano)|invariat\w)\b[^,;.]*(?: , wie [^,;.]*)?(?: \.)?$"
)
"""A phrase at the end of a request that says what stays as it is."""
TAKEN = re.compile(r"(.+?) ?: (angle|radius|length|slope) =([a-z].*)")
"""A change that takes a value from another place."""
LINE = re.compile(r"\blignes? droites?\b")
"""French for a straight; "droite" alone is the right side."""
MOST_WORDS = 12  # words of a request at most


class ChangeReading(NamedTuple):
    """The reading of a change request, by the networks or by rules."""

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
    swapped = _things_to_swap(text)
    if swapped:
        return ChangeReading(f"{swapped}: swap", CERTAIN, ())
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


def _things_to_swap(text: SlottedText) -> str | None:
    """Returns the two turns or straights that a change request asks to swap; None if it asks for anything
    else.

    They are named as in plans of changes: "turn 1,3", or "turn all" for "the two turns".
    """
    said = STAYS.sub("", " ".join(word.text for word in text.words if word.written))
    if not SWAP.search(said) or MORE.search(LINE.sub(" ", said)) or len(said.split()) > MOST_WORDS:
        return None
    if BETWEEN.search(said):
        return "straight all but(straight 1,-1)"
    there = [noun for noun, nouns in THINGS.items() if re.search(rf"\b{nouns}\b", said)]
    if len(there) != 1:
        return None
    noun = there[0]
    found = TWO[noun].findall(said)
    if len(found) == 1:
        one, other = (place_of(word) or int(word) for word in found[0] if word)
        return f"{noun} {one},{other}"
    return f"{noun} all" if BOTH[noun].search(said) else None
