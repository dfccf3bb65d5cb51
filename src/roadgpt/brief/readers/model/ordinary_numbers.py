"""Rewrites descriptions that the network would refuse because of unusually large or small numbers.

The network was trained for one map of 250 m and refuses roads that do not fit on it. But other maps may hold
such a road. So if the network calls a road impossible, it reads the same description again with ordinary
numbers, and the original numbers are then restored in its plan. Later checks compare the plan with the actual
map and its limits. The network still refuses what is impossible on any map ("with a roundabout").
"""

from typing import NamedTuple

from roadgpt.brief.readers.model.nouns import COUNTED
from roadgpt.brief.readers.model.slots import SlottedText, Word, slot_name

MARKS = frozenset({"[unused21]", "[unused22]", "[unused23]"})
"""Tokens that follow a measure that is too large, too small, or rather small."""
MOST_TURNS = 12
"""The largest number of turns that the network was trained to write."""
STAND_INS = ("9", "11", "7", "10", "8", "12")
"""Counts that replace larger ones in the text; the network reads them as ordinary."""
BEFORE_NOUN = 3
"""The largest number of words between a number and the noun it counts: "40 very sharp turns"."""


class OrdinaryNumbers(NamedTuple):
    """A description with small counts of turns in place of unusually large ones."""

    text: SlottedText
    counts: dict[str, str]
    """The original of each small count."""


def with_ordinary_numbers(text: SlottedText) -> OrdinaryNumbers:
    """Returns the description with ordinary numbers; it is unchanged if all its numbers are ordinary."""
    free = [number for number in STAND_INS if all(word.text != number for word in text.words)]
    counts: dict[str, str] = {}
    out: list[Word] = []
    for at, word in enumerate(text.words):
        if word.text in MARKS and not word.written:
            continue
        count = _large_count(text, at)
        if count and free:
            counts[free[0]] = count
            out.append(Word(free.pop(0), word.written))
        else:
            out.append(word)
    return OrdinaryNumbers(SlottedText(tuple(out), text.slots), counts)


def _large_count(text: SlottedText, at: int) -> str:
    """Returns the number in a word as text if it counts more than MOST_TURNS turns; otherwise empty."""
    word = text.words[at].text
    values = {slot_name(i): slot.value for i, slot in enumerate(text.slots) if not slot.unit}
    value = float(word) if word.isdecimal() else values.get(word, 0.0)
    follow = {later.text for later in text.words[at + 1 : at + 2 + BEFORE_NOUN]}
    return f"{value:g}" if value > MOST_TURNS and value == int(value) and follow & COUNTED else ""
