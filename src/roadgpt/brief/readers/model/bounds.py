"""Uses the words next to each number, such as "at least", to correct the bounds of lengths and other measured
values in a plan.

A small network sometimes reads "no larger than" as "at least", or drops the bound. Only phrases that have the
same meaning throughout the training pairs are used for corrections; "over 60 m" is ignored, because it often
means "over a distance of 60 m".
"""

from collections.abc import Sequence
from typing import Literal

from roadgpt.brief.readers.model.slots import SlottedText, slot_name
from roadgpt.brief.readers.model.vocabulary import SLOT_TOKENS
from roadgpt.brief.readers.model.word_set import word_set

Bound = Literal["lo", "hi", "none"]
"""'lo' is a lower bound, 'hi' an upper bound; 'none' means certainly no bound ("60 m or so")."""
KEYS = frozenset(["deg=", "r=", "d=", "len=", "pct=", "steepest="])
"""Plan keys whose bounds are corrected. The climb is left out: downhill it is negative, so
its lower and upper bounds change places."""
SMALLER = word_set(
    "below under less smaller shorter fewer lower inside unter weniger kleiner kurzer geringer",
    "unterhalb moins inferieur inferieure inferieurs inferieures sous menos menor inferior inferiores",
    "meno minore minori inferiore inferiori sotto",
)
LARGER = word_set(
    "above over more larger longer greater higher exceed exceeds exceeding exceeded beyond past uber",
    "ueber mehr grosser langer laenger hoher oberhalb uberschreiten uberschreitet plus superieur",
    "superieure depasse depasser depassant mas mayor superior supera superar superando superare piu",
    "maggiore superiore dessus encima oltre bigger",
)
BELOW = word_set("below under less unter inferieur inferieure inferior inferiore")
"""Words that mean "at most" on their own, unless negated; other comparatives ("smaller") may refer to
something that was mentioned earlier."""
LEAST = word_set("least minimum min mindestens minimal wenigstens moins minimo minima menos meno almeno")
MOST = word_set("most maximum max hochstens hoechstens maximal massimo maximo maxima massima")
ALONE = word_set("min max minimum maximum mindestens wenigstens hochstens hoechstens maximal almeno")
"""Words that are bounds on their own, such as "minimum"; others need a word like "at" before them."""
AT = word_set("at au al por lo du como come")
NOT = word_set(
    "no not never none neither nor nowhere without t nothing cannot dont doesnt kein keine keinen",
    "keiner keines nicht nichts nie niemals nirgends nirgendwo ohne pas sans aucun aucune jamais nulle",
    "sin nunca ningun ninguna nada non senza mai nessun nessuna niente ne",
)
RULED_OUT = word_set("exclude excludes excluded avoid avoids free ban banned forbidden rule ruled")
UNITS = word_set("metres degrees percent")
OR = word_set("or oder ou o")
OR_MORE = word_set("more longer larger greater above over wider mehr langer darueber davantage plus mas piu")
OR_LESS = word_set("less shorter smaller fewer below under tighter weniger kurzer darunter moins menos meno")
FILLERS = word_set("than als de que di a the of von da about mit um at su um ein eine einem un une una")
STOPS = frozenset(",.;:()|-")
SENTENCE_STOPS = frozenset(".;")
MOST_FILLERS = 2
REACH = 4
"""How many words before a comparative are searched for a negation."""


def bounded(tokens: Sequence[str], text: SlottedText) -> tuple[str, ...]:
    """Returns the tokens of a plan, with the bounds of measured values corrected to those in the text."""
    words = [word.text for word in text.words]
    out: list[str] = []
    at = 0
    while at < len(tokens):
        size = _size(tokens, at)
        amount = tokens[at + 1 : at + 1 + size]
        out += [tokens[at], *_with_bound(amount, words)] if size else [tokens[at]]
        at += 1 + size
    return tuple(out)


def _size(tokens: Sequence[str], at: int) -> int:
    """Returns how many tokens the amount after a key has: 1 (a slot), 2 (a slot and a bound), else 0."""
    if tokens[at] not in KEYS:
        return 0
    after = [*tokens[at + 1 : at + 4], "", "", ""]
    if after[0] == ".." and after[1] in SLOT_TOKENS:
        return 2
    if after[0] in SLOT_TOKENS:
        if after[1] != "..":
            return 1
        return 0 if after[2] in SLOT_TOKENS or after[2].isdecimal() else 2
    return 0


def _with_bound(amount: Sequence[str], words: list[str]) -> list[str]:
    slot = next(token for token in amount if token in SLOT_TOKENS)
    name = slot_name(SLOT_TOKENS.index(slot))
    if words.count(name) != 1:
        return [*amount]
    bound = bound_before(words, words.index(name)) or bound_behind(words, words.index(name))
    if bound is None:
        return [*amount]
    return {"hi": ["..", slot], "lo": [slot, ".."], "none": [slot]}[bound]


def bound_before(words: Sequence[str], at: int) -> Bound | None:
    """Returns the bound that the words right before the number at index ``at`` give ("at least"), or None."""
    last = at - 1
    while last >= 0 and words[last] in FILLERS and at - 1 - last < MOST_FILLERS:
        last -= 1
    if last < 0:
        return None
    word, before = words[last], _since_stop(words, last)
    is_at = word in ALONE or bool(before and before[0] in AT)
    if is_at and word in LEAST | MOST:
        return "lo" if word in LEAST else "hi"
    if word not in SMALLER | LARGER:
        return None
    if NOT.intersection(before):
        return "lo" if word in SMALLER else "hi"
    return "hi" if word in BELOW and not (NOT | RULED_OUT).intersection(_sentence(words, at)) else None


def _sentence(words: Sequence[str], at: int) -> Sequence[str]:
    first = max((place + 1 for place in range(at) if words[place] in SENTENCE_STOPS), default=0)
    last = next((place for place in range(at, len(words)) if words[place] in SENTENCE_STOPS), len(words))
    return words[first:last]


def bound_behind(words: Sequence[str], at: int) -> Bound | None:
    """Returns the bound that the words right after a number and its unit give ("40 m or more"), or None.

    ``at`` is the index of the number.
    """
    after = [word for word in words[at + 1 : at + 5] if word not in UNITS and not word.startswith("[unused2")]
    if len(after) < 2 or after[0] not in OR:
        return None
    if after[:2] == ["or", "so"]:
        return "none"
    return "lo" if after[1] in OR_MORE else "hi" if after[1] in OR_LESS else None


def _since_stop(words: Sequence[str], last: int) -> list[str]:
    """Returns up to REACH words before this place, the nearest first, back to a punctuation mark."""
    out: list[str] = []
    for place in range(last - 1, max(-1, last - 1 - REACH), -1):
        if words[place] in STOPS:
            break
        out.append(words[place])
    return out
