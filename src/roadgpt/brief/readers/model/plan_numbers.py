"""The part of the grammar of plans that concerns numbers: which numbers may follow which key.

A measured number is either a slot of the text with a suitable unit, or a number that a word implies
("right angle": 90).
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from roadgpt.brief.readers.model.computed_numbers import FACTORS, KEYS, ONE, SIGNS, STEPS
from roadgpt.brief.readers.model.evidence import Evidence
from roadgpt.brief.readers.model.measures import LARGEST_SEEN
from roadgpt.brief.readers.model.slots import NumberSlot
from roadgpt.brief.readers.model.token_grammar import AnyOf, OneOf, Sequel, Symbol
from roadgpt.brief.readers.model.vocabulary import FIXED, SLOT_TOKENS, UNIT_OF

UNSAID = {"deg=": FIXED, "angle=": FIXED, "turning=": ("180",), "steepest=": ("4", "5"), "climb=": ("0",)}
"""Numbers that a plan may contain although they are not in the text, by plan key, if words imply them."""
ALWAYS = {"angle": FIXED, "slope": ("1",), "climb=": ("0",)}
"""Numbers that a plan may contain whatever the text says, by plan key: a right angle, one percent."""
COUNTS = tuple(str(number) for number in range(LARGEST_SEEN + 1))
BOUND, MINUS = "..", "-"
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

    def computed(self, key: str, base: str) -> tuple[Symbol, ...]:
        """Returns what may follow a number if the words compare figures: a factor, or a sum with another
        number."""
        compared = self.evidence.compared
        if key not in KEYS or compared is None:
            return ()
        ways: list[Symbol] = [Sequel(OneOf(("x",)), (OneOf(FACTORS),))] if compared.by_factor else []
        small = [each for each in COUNTS if each in self.said or (each == "1" and key in ONE)]
        others = [number for number in (*self._fitting(UNIT_OF[key]), *small) if number != base]
        if others and compared.by_difference:
            often = Sequel(OneOf(("x",)), (OneOf(STEPS),), is_open=True)
            ways.append(Sequel(OneOf(SIGNS), (OneOf(others), often)))
        return (Sequel(AnyOf(tuple(ways)), (), is_open=True),) if ways else ()

    def percents(self) -> list[str]:
        """Returns the numbers of the text that can be percentages."""
        return self._fitting("percent")

    def value(self, word: str) -> float:
        """Returns the value of a number token."""
        return self.slots[SLOT_TOKENS.index(word)].value if word in SLOT_TOKENS else float(word)


@dataclass(frozen=True, slots=True)
class OneNumber:
    """A number that may follow a key, or a sum or a multiple of numbers."""

    key: str
    numbers: Numbers
    may_be_empty: bool = False

    def first(self) -> Iterable[str]:
        """Returns the numbers."""
        return self.numbers.of(self.key)

    def after(self, token: str) -> tuple[Symbol, ...]:
        """Returns the rest of a sum or a multiple."""
        return self.numbers.computed(self.key, token)


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
            return self.numbers.computed(self.key, token)
        number = OneNumber(self.key, self.numbers)
        if token == BOUND:
            return (number,)
        if token == MINUS:  # "-9" or "-9..-6"
            nearer = Sequel(OneOf((MINUS,)), (number,))
            return (number, Sequel(OneOf(("..",)), (nearer,), is_open=True))
        above = replace(self, low=token, may_be_empty=True)
        return (*self.numbers.computed(self.key, token), Sequel(OneOf(("..",)), (above,), is_open=True))
