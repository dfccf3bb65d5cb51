"""Finds out whether a phrase of a description is denied, in five languages."""

import re
from collections.abc import Sequence

from roadgpt.brief.readers.model.word_set import word_set

WITHOUT = r"(?:no|without(?: any)?|kein\w*|ohne|aucune?|pas d '|sans|ningun\w*|sin|nessun\w*|senza)"
"""Words before a noun that say that there is none, in a text without accents."""
NOT = (
    r"(?:not|none|nothing|never|cannot|neither|nor|nicht|nie|niemals|pas|ni|jamais|nunca|tampoco|nada|non|ne|"
    r"mai|niente)"
)
"""Other words that deny something."""
NEGATIONS = word_set(
    "no not never none neither nor nowhere without t nothing cannot dont doesnt kein keine keinen",
    "keiner keines nicht nichts nie niemals nirgends nirgendwo ohne pas sans aucun aucune jamais nulle",
    "sin nunca ningun ninguna nada non senza mai nessun nessuna niente ne",
)
"""All words that deny something, each alone."""
DENIAL = rf"(?:{WITHOUT}|{NOT})"
DENIED = re.compile(rf"(?:\b{DENIAL}|n['’]t)\b[^.,;:!?]*$")

ENDS = frozenset([*".,;:!?()", "but", "aber", "sondern", "dafur", "mais", "pero", "sino", "ma"])
"""Marks and words at which the reach of a negation ends."""
TAKEN_BACK = re.compile(
    r"\bno ,|\bnein ,|\bnot\b(?! more\b(?! than))|\brather\b|\binstead\b|\bsondern\b|\bmake that\b|"
    r"\btoo many\b|\? (?:no|non|nein)\b"
)
"""Words with which a number may be taken back."""
CORRECTED = re.compile(
    r"\b(?:sorry|i mean|wait|oops|correction|actually|pardon|ich meine|entschuldigung|quatsch|besser gesagt|"
    r"je veux dire|ou plutot|perdon|quiero decir|mejor dicho|scusa\w*|anzi|volevo dire)\b"
)
"""Words that announce a correction of something said before."""


def places_reached(words: Sequence[str], at: int, most: int) -> range:
    """Returns the places of the words that a negation at the place ``at`` can deny: those up to the end of
    its part of the sentence, and at most ``most`` of them.
    """
    last = min(at + 1 + most, len(words))
    return range(at + 1, next((n for n in range(at + 1, last) if words[n] in ENDS), last))


def is_denied(before: str) -> bool:
    """Returns whether the text before a phrase, in lower case without accents, has a negation, such as "no"
    or "without", with no punctuation mark between it and the phrase.
    """
    return DENIED.search(before) is not None


def says(pattern: re.Pattern[str], said: str) -> bool:
    """Returns whether the pattern matches a phrase of the text that is not denied.

    The text ``said`` must be in lower case without accents.
    """
    return any(not is_denied(said[: found.start()]) for found in pattern.finditer(said))
