"""Finds negative numbers where they make no sense: "minus three turns", "a straight of -50 m".

The network ignores the sign. Grades and climbs may be negative, and a dash may be just punctuation, so only
negative numbers that are certainly lengths, radii or counts are reported.
"""

from collections.abc import Sequence

from roadgpt.brief.readers.model.nouns import COUNTED, ONE_TURN
from roadgpt.brief.readers.model.slots import SlottedText, slot_name
from roadgpt.brief.readers.model.word_set import word_set

MINUS = frozenset(["minus", "negative", "negativ", "negativen", "negatif", "negativo"])
BEFORE_DASH = word_set(
    "of with has have having exactly precisely is are = : radius length mit von hat avec de con tiene",
    "di r",
)
"""Words after which a dash right before a number is a minus sign."""
LENGTHS = word_set(
    "straight straights radius radii r length long lang gerade geraden lange kurvenradius longueur",
    "droite rayon recta longitud radio rettilineo lunghezza raggio tangent",
)
NEAR = 4


def negative_number(text: SlottedText) -> str | None:
    """Returns the first negative length, radius or count, for example "minus three turns"; None if there is
    none.
    """
    words = [word.text for word in text.words]
    for at, word in enumerate(words):
        if not _is_number(word) or not _is_below_nothing(words, at):
            continue
        after = words[at + 1 : at + 3]
        said = text.words[at].written
        noun = next((word for word in after if word in COUNTED | ONE_TURN), None)
        if noun:
            return f"minus {said} {noun}"
        if after[:1] == ["metres"] and LENGTHS.intersection(words[max(at - NEAR, 0) : at + 1 + NEAR]):
            return f"minus {said}"
    return None


def _is_number(word: str) -> bool:
    return word.isdecimal() or word.startswith(slot_name(0)[:-2])


def _is_below_nothing(words: Sequence[str], at: int) -> bool:
    before = words[at - 1] if at else ""
    if before in MINUS:
        # "five minus two", "5 plus or minus 1" are sums
        return at < 2 or not (_is_number(words[at - 2]) or words[at - 2] in ("or", "/", "plus"))
    return before == "-" and at > 1 and words[at - 2] in BEFORE_DASH
