"""The part of the grammar of plans that concerns numbers: which numbers may follow which key.

A measured number is either a slot of the text with a suitable unit, or a number that a word implies
("right angle": 90).
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from roadgpt.brief.readers.model.evidence import Evidence
from roadgpt.brief.readers.model.measures import LARGEST_SEEN
from roadgpt.brief.readers.model.slots import NumberSlot
from roadgpt.brief.readers.model.token_grammar import OneOf, Sequel, Symbol
from roadgpt.brief.readers.model.vocabulary import FIXED, SLOT_TOKENS, UNIT_OF

UNSAID = {"deg=": FIXED, "angle=": FIXED, "turning=": ("180",), "steepest=": ("4", "5"), "climb=": ("0",)}
"""Numbers that a plan may contain although they are not in the text, by plan key, if words imply them."""
ALWAYS = {"angle": FIXED, "slope": ("1",), "climb=": ("0",)}
"""Numbers that a plan may contain whatever the text says, by plan key: a right angle, one percent."""
COUNTS = tuple(str(number) for number in range(LARGEST_SEEN + 1))
LEAST = {"arms=": 3}  # "a two-lane roundabout" has no two arms


@dataclass(frozen=True, slots=True)
class Numbers:
    """The numbers that may occur in the plan of a text."""

    slots: Sequence[NumberSlot]
    said: frozenset[str]
    evidence: Evidence

    def of(self, key: str) -> list[str]:
        """Returns the numbers that may follow a key such as "len="; if there are none, the key is never
        written."""
        fitting = self._fitting(UNIT_OF.get(key, ""))
        if key == "hills=" and not self.evidence.hills:
            return [number for number in COUNTS if number in self.said]
        if key not in UNIT_OF:
            return [each for each in (*COUNTS, *fitting) if self.value(each) >= LEAST.get(key, 0)]
        unsaid = UNSAID.get(key, ())
        is_meant = {
            "deg=": self.evidence.angles,
            "angle=": self.evidence.angles,
            "turning=": self.evidence.angles,
            "steepest=": self.evidence.mountains,
        }.get(key, True)
        plain = [number for number in (*COUNTS, *unsaid) if number in self.said]
        if key in ALWAYS:
            unsaid = ALWAYS[key]
        return [*dict.fromkeys([*fitting, *plain, *(unsaid if is_meant else ())])]

    def _fitting(self, unit: str) -> list[str]:
        return [SLOT_TOKENS[index] for index, slot in enumerate(self.slots) if slot.unit in ("", unit)]

    def percents(self) -> list[str]:
        """Returns the numbers of the text that can be percentages."""
        return self._fitting("percent")

    def value(self, word: str) -> float:
        """Returns the value of a number token."""
        return self.slots[SLOT_TOKENS.index(word)].value if word in SLOT_TOKENS else float(word)


@dataclass(frozen=True, slots=True)
class Keyed:
    """A key and its amount, such as "len=60" or "len=60..80"; never written if no number suits the key."""

    key: str
    numbers: Numbers
    may_be_empty: bool = False
    is_signed: bool = False
    """Whether the number may be negative."""

    def first(self) -> Iterable[str]:
        """Returns the key if there are numbers for it."""
        return [self.key] if self.numbers.of(self.key) else []

    def after(self, token: str) -> tuple[Symbol, ...]:
        """Returns the amount, which must follow the key."""
        return (AmountTokens(self.key, self.numbers, is_signed=self.is_signed),)


@dataclass(frozen=True, slots=True)
class AmountTokens:
    """The number, bound or range that follows a key; if ``low`` is set, only the upper end of the range that
    begins at ``low``."""

    key: str
    numbers: Numbers
    low: str = ""
    may_be_empty: bool = False
    is_signed: bool = False

    def first(self) -> Iterable[str]:
        """Returns the numbers and signs with which the amount can begin."""
        numbers = self.numbers.of(self.key)
        if self.low:
            low = self.numbers.value(self.low)
            return [number for number in numbers if self.numbers.value(number) > low]
        return ["..", *numbers, *(["-"] if self.is_signed else [])]

    def after(self, token: str) -> tuple[Symbol, ...]:
        """Returns the rest of the amount."""
        if self.low:
            return ()
        if token in ("..", "-"):
            return (OneOf(self.numbers.of(self.key)),)
        above = replace(self, low=token, may_be_empty=True)
        return (Sequel(OneOf(("..",)), (above,), is_open=True),)
