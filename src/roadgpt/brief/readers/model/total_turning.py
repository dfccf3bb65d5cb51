"""Reads the sum of all turning angles, as in "a total heading change of at least 300 deg".

The network's vocabulary cannot express this sum, so the phrase is removed before the network reads the rest.
"""

import re
from typing import NamedTuple

from roadgpt.brief.model import Amount, Brief, at_least, at_most, exactly
from roadgpt.brief.readers.model.numerals import plain
from roadgpt.brief.readers.model.slots import slot_name, slotted

TOTAL = r"(?:total|overall|cumulative|accumulated|combined|summed|absolute)"
CHANGE = r"(?:heading changes?|changes? (?:of|in) heading|turning(?: angle)?|turn angles?)"
IN_ALL = (
    r"(?:in (?:all|total|sum|summe|totale|tutto)|altogether|all in all|all together|combined|overall"
    r"|insgesamt|zusammen|au total|en tout|en total)"
)
BOUND = (
    r"(?:(?P<lo>at least|no less than|not less than|more than|mindestens|au moins|al menos|almeno)"
    r"|(?P<hi>at most|no more than|not more than|less than|below|under|hochstens|au plus|al massimo)"
    r"|about|around|roughly|exactly) "
)
OR = r"(?: or (?:(?P<or_more>more|above)|(?P<or_less>less|below)))?"
SLOT = rf"(?:{BOUND})?(?P<slot>\[unused(?:[1-9]|1[0-2])\])"
ANGLE = rf"{SLOT} degrees(?: \[unused2\d\])?{OR}"
OF_ALL = r" (?:for all(?: of (?:them|the turns|the bends|the curves))?(?: together)?|together)"
IS = r"(?: (?:of|:|is|=|be|should|shall|must))*"
LED = r"(?:(?:and|with|has|have|a|an|the|its|which|that|turning|bending|und|et|y|e|,) )*"
TURNING = r"of (?:turning|heading change|turn|steering)"
WAYS = tuple(
    re.compile(r"(?<!\S)" + LED + way)
    for way in (
        rf"(?:{TOTAL} )+{CHANGE}{IS} {ANGLE}",
        rf"(?:{TOTAL} )+angle{IS} {SLOT}(?: degrees)?{OF_ALL}{OR}",
        rf"(?:(?:all|angles|together) )*(?:add|sum)(?:s|ing|ming)?(?: up)? to (?:a total of )?{ANGLE}"
        rf"(?: {IN_ALL})?",
        rf"{ANGLE}(?: {TURNING})? {IN_ALL}",
        rf"{IN_ALL} {ANGLE}(?: {TURNING})?",
        rf"{CHANGE} {IN_ALL}{IS} {ANGLE}",
    )
)
EQUALLY = re.compile(
    r"\b(?:equal(?:ly)? (?:angles?|large|big)|of equal (?:angles?|size)|the same angle|"
    r"in equal (?:parts|shares)|(?:split|shared|spread|distributed) (?:evenly|equally)|"
    r"(?:evenly|equally) (?:split|shared|spread|distributed)|"
    r"gleiche[nrms]? winkel|gleich (?:gross|stark)|gleichmassig verteilt|zu gleichen teilen|a parts egales|"
    r"(?:du |le )?meme angle|angles? ega(?:l|ux)|angulos? iguales|mismo angulo|por igual|a partes iguales|"
    r"angoli uguali|stesso angolo|in parti uguali)\b"
)
"""Words for turns that have equal shares of the sum, in a text without accents."""


class TotalTurning(NamedTuple):
    """The required sum of all turning angles in degrees, and the description without this requirement."""

    degrees: Amount
    rest: str

    @property
    def is_more_said(self) -> bool:
        """True if ``rest`` has more than one word."""
        return len(self.rest.split()) > 1


def total_turning(words: str) -> TotalTurning | None:
    """Returns the required sum of turning angles and the remaining description; None if no sum is given."""
    text = slotted(words)
    line = " ".join(word.text for word in text.words)
    found = next((match for way in WAYS if (match := way.search(line))), None)
    if found is None:
        return None
    slot = next(slot for at, slot in enumerate(text.slots) if slot_name(at) == found["slot"])
    is_least, is_most = found["lo"] or found["or_more"], found["hi"] or found["or_less"]
    amount = (at_least if is_least else at_most if is_most else exactly)(slot.value)
    first = line[: found.start()].count(" ")
    last = first + found[0].count(" ") + 1
    rest = [word.written for word in (*text.words[:first], *text.words[last:]) if word.written]
    return TotalTurning(amount, " ".join(rest))


def with_equal_turns(brief: Brief, words: str) -> Brief:
    """Returns the Brief with turns that are alike, where the words share the sum of all angles equally."""
    is_shared = brief.turning is not None and EQUALLY.search(plain(words)) is not None
    return brief.model_copy(update={"alike": True}) if is_shared else brief
