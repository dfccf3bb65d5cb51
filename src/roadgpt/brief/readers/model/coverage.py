"""Finds words of a description that had no effect on its plan.

These are numbers and sides (left, right) that the plan does not use, and words that the reader has not
learnt.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from roadgpt.brief.readers.model.slots import SlottedText
from roadgpt.brief.readers.model.vocabulary import SLOT_TOKENS
from roadgpt.reading import read_text

SIDES = frozenset({"left", "right"})
TRACES = frozenset({"left", "right", "lefts=", "rights=", "alternating"})
"""The tokens of a plan that show that a side was read; "first left, then right" leaves only 'left'."""
SHORTEST = 3  # letters; shorter words are function words in all five languages


@dataclass(frozen=True, slots=True)
class Coverage:
    """The words that a reader has learnt: words that affected plans in the training data, and function
    words.
    """

    known: frozenset[str]

    @classmethod
    def read(cls, path: Path) -> "Coverage":
        """Reads the words from a file with one word per line."""
        return cls(frozenset(read_text(path).split("\n")))

    def unused(self, text: SlottedText, tokens: Sequence[str]) -> tuple[str, ...]:
        """Returns the words that the plan does not reflect, in their original spelling, each once and in text
        order.
        """
        out: list[str] = []
        slot = 0
        has_side = bool(TRACES & {*tokens})
        for word in text.words:
            if word.text.startswith("[unused") and word.written:
                if slot < len(text.slots) and SLOT_TOKENS[slot] not in tokens:
                    out.append(word.written)
                slot += 1
            elif word.written and (self._is_strange(word.text) or (word.text in SIDES and not has_side)):
                out.append(word.written)
        return tuple(dict.fromkeys(out))

    def _is_strange(self, word: str) -> bool:
        is_long = len(word) >= SHORTEST or not word.isascii()  # a single Chinese character is a word
        return word.isalpha() and is_long and word not in self.known
