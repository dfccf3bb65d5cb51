"""A description as it would be for the usual map: its numbers without the marks of their size.

The network was trained for one map, of 250 m, and refuses what fits on no such map. Whether a road fits is
not for it to say: where it calls one impossible it is shown the same words with ordinary numbers, and what it
reads then has the numbers that were said. The checks hold that against the real map and the limits of the
world. What is impossible on any map ("with a roundabout") it refuses again.
"""

from collections.abc import Sequence
from typing import NamedTuple

from roadgpt.brief.readers.model.nouns import COUNTED
from roadgpt.brief.readers.model.slots import SlottedText, Word, slot_name

MARKS = frozenset({"[unused21]", "[unused22]", "[unused23]"})
"""Behind a measure: too large, too small, rather small."""
MOST_TURNS = 12
"""Of a road that the network was trained to write."""
STAND_INS = ("9", "11", "7", "10", "8", "12")
"""Counts that the network takes for ordinary."""
BEFORE_NOUN = 3
"""Words between a number and what it counts, at most: "40 very sharp turns"."""


class OrdinaryNumbers(NamedTuple):
    """The words with ordinary numbers, and the count that each stand-in stands for."""

    text: SlottedText
    counts: dict[str, str]

    def told(self, tokens: Sequence[str]) -> tuple[str, ...]:
        """A plan with the counts that were said."""
        return tuple(self.counts.get(token, token) for token in tokens)


def with_ordinary_numbers(text: SlottedText) -> OrdinaryNumbers:
    """The description for the usual map; the same where that is what it is."""
    free = [number for number in STAND_INS if all(word.text != number for word in text.words)]
    counts: dict[str, str] = {}
    out: list[Word] = []
    for at, word in enumerate(text.words):
        if word.text in MARKS and not word.said:
            continue
        count = _large_count(text, at)
        if count and free:
            counts[free[0]] = count
            out.append(Word(free.pop(0), word.said))
        else:
            out.append(word)
    return OrdinaryNumbers(SlottedText(tuple(out), text.slots), counts)


def _large_count(text: SlottedText, at: int) -> str:
    """How many turns there are to be, where there are more than usual; empty for any other word."""
    word = text.words[at].text
    values = {slot_name(i): slot.value for i, slot in enumerate(text.slots) if not slot.unit}
    value = float(word) if word.isdecimal() else values.get(word, 0.0)
    follow = {later.text for later in text.words[at + 1 : at + 2 + BEFORE_NOUN]}
    return f"{value:g}" if value > MOST_TURNS and value == int(value) and follow & COUNTED else ""
