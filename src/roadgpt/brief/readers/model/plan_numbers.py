"""The part of the grammar of plans that concerns numbers: which numbers may follow which key.

A measured number is either a slot of the text with a suitable unit, or a number that a word implies
("right angle": 90). Apart from those in ``ALWAYS``, a number that the text does not state is allowed only if
some word, in any of the five languages, can imply it.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from math import inf

from roadgpt.brief.readers.model.computed_numbers import FACTORS, KEYS, ONE, SIGNS, STEPS, Compared, value_of
from roadgpt.brief.readers.model.measures import LARGEST_SEEN
from roadgpt.brief.readers.model.slots import NumberSlot
from roadgpt.brief.readers.model.token_grammar import Stack, Symbol, any_of, one_of, sequel
from roadgpt.brief.readers.model.vocabulary import FIXED, SLOT_TOKENS, UNIT_OF

UNSAID = {"deg=": FIXED, "angle=": FIXED, "turning=": ("180",), "steepest=": ("4", "5")}
"""Numbers that a plan may contain although they are not in the text, by plan key, if words imply them."""
ALWAYS = {"angle": FIXED, "slope": ("1",), "climb=": ("0",)}
"""Numbers that a plan may contain whatever the text says, by plan key: a right angle, one percent."""
COUNTS = tuple(str(number) for number in range(LARGEST_SEEN + 1))
BOUND, MINUS = "..", "-"
LEAST = {"arms=": 3}  # "a two-lane roundabout" has no two arms
ANGLE = re.compile(
    r"kink|dog|leg|square|right.angle|angle|wink|knick|orthog|perpend|angolo|angulo|equerre|coude|quiebr|codo|gomito"
    r"|piega|quarter|decroch|recod|baionn|ninety|neunzig|quatre|noventa|novanta|forty|\d|unused"
    r"|hairpin|switchback|haarnadel|kehre|epingle|lacet|horquilla|tornant"
    r"|half|halb|semi|demi|medi[oa]|mezz|round|back|opposite|turned|facing|headed|way we came"
    r"|gegen|zuruck|retour|contrari|vuelta|inver|empez|comin|stair|trepp|escal|scal"
    r"|letter|buchstab|lettre|letra|lettera|outline|form|shape|\b[zluvn]\b"
)
MOUNTAIN = re.compile(
    r"mount|mont|berg|alp|pass|\bcol\b|puerto|gebirg|sierra|valico|dolomit|andes|pyren|serra|vette|cordill|himal"
    r"|steep|steil|raide|pente|pentu|empinad|pendiente|pendenz|ripid|erto|erta|brusc"
    r"|grade|gradient|slope|inclin|neig|roll|wav|well|ond|hill|hugel|colin|coll|lom|vallon|bosse|up.{1,6}down|auf.{1,6}ab"
)
HILLY = re.compile(
    r"hill|roll|undul|wave|wavy|up.{1,20}down|wellig|welle|hugel|auf.{1,6}ab|vallon|colin|coll|ond|saliscend|russ|coaster"
    r"|rise|climb|bosse|lomas|subid|dune|hump|crest|heav|hoch.*runter|vagues|vaux"
    r"|flat|level|eben|flach|platt?|llan|plan|pian|lomer|inver|fall|gefall|steig|rasant|pendenz|pendient|pente"
)


@dataclass(frozen=True, slots=True)
class Evidence:
    """The numbers that a description can imply: angles ("right angle"), a grade ("mountain road"), a number
    of hills ("rolling"), and numbers relative to other numbers ("twice as long").
    """

    angles: bool = True
    mountains: bool = True
    hills: bool = True
    compared: Compared | None = None

    @classmethod
    def of(cls, text: str) -> "Evidence":
        """Returns which numbers a description can imply; the text must be in lower case and without
        accents.
        """
        patterns = (ANGLE, MOUNTAIN, HILLY)
        angles, mountains, hills = (pattern.search(text) is not None for pattern in patterns)
        return cls(angles, mountains, hills, Compared.of(text))


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
            return [each for each in (*COUNTS, *fitting) if value_of(each, self.slots) >= LEAST.get(key, 0)]
        unsaid = UNSAID.get(key, ())
        is_meant = self.evidence.mountains if key == "steepest=" else self.evidence.angles
        plain = [number for number in (*COUNTS, *unsaid) if number in self.said]
        implied = ALWAYS.get(key, unsaid if is_meant else ())
        return [*dict.fromkeys([*fitting, *plain, *implied])]

    def keyed(self, key: str, is_signed: bool = False) -> Symbol:
        """Returns a key and its amount, such as "len=60"; never written if no number suits the key.

        The amount is a number, a bound or a range, and with ``is_signed`` also a negative number.
        """
        amount = Symbol(
            lambda: [BOUND, *self.of(key), *([MINUS] if is_signed else [])],
            lambda token: self._after_begin_of_amount(key, token),
        )
        return Symbol(lambda: [key] if self.of(key) else [], lambda token: (amount,))

    def percents(self) -> list[str]:
        """Returns the numbers of the text that can be percentages."""
        return self._fitting("percent")

    def _fitting(self, unit: str) -> list[str]:
        return [SLOT_TOKENS[index] for index, slot in enumerate(self.slots) if slot.unit in ("", unit)]

    def _after_begin_of_amount(self, key: str, token: str) -> Stack:
        """Returns the rest of a number, a bound or a range that begins with a token."""
        number = self._number(key)
        if token == BOUND:
            return (number,)
        if token == MINUS:  # "-9" or "-9..-6"
            return (number, sequel(one_of(BOUND), sequel(one_of(MINUS), number), is_open=True))
        above = self._number(key, value_of(token, self.slots), may_be_empty=True)
        return (*number.after(token), sequel(one_of(BOUND), above, is_open=True))

    def _number(self, key: str, above: float = -inf, may_be_empty: bool = False) -> Symbol:
        """Returns a number that may follow a key, or a sum or a multiple of numbers."""
        return Symbol(
            lambda: [each for each in self.of(key) if value_of(each, self.slots) > above],
            lambda token: self._computed(key, token),
            may_be_empty,
        )

    def _computed(self, key: str, base: str) -> Stack:
        """Returns what may follow a number if the words compare figures: a factor, or a sum with another
        number."""
        compared = self.evidence.compared
        if key not in KEYS or compared is None:
            return ()
        ways: list[Symbol] = [sequel(one_of("x"), one_of(*FACTORS))] if compared.by_factor else []
        small = [each for each in COUNTS if each in self.said or (each == "1" and key in ONE)]
        others = [number for number in (*self._fitting(UNIT_OF[key]), *small) if number != base]
        if others and compared.by_difference:
            often = sequel(one_of("x"), one_of(*STEPS), is_open=True)
            ways.append(sequel(one_of(*SIGNS), one_of(*others), often))
        return (sequel(any_of(*ways), is_open=True),) if ways else ()
