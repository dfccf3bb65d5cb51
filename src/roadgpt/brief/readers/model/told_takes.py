"""Counts how often a route turns left, turns right or goes straight on, where the words say it in no order:
"left at two of them, and right at the other two". The network loses count of them.
"""

import re
from collections.abc import Mapping

from roadgpt.brief.junctions import JunctionClause, Take
from roadgpt.brief.model import Brief
from roadgpt.brief.readers.model.denial import TAKEN_BACK
from roadgpt.brief.readers.model.exit_words import COUNTS
from roadgpt.brief.readers.model.ordinals import OTHERS
from roadgpt.brief.readers.model.slots import SlottedText
from roadgpt.brief.readers.model.told_junctions import CROSSINGS

WAYS: Mapping[Take, str] = {
    "left": "left|links|gauche|izquierda|sinistra",
    "right": "right|rechts|droite|derecha|destra",
    "straight": "straight(?: on| ahead| over| across)?|geradeaus|tout droit|recto|dritto",
}
ONCE = {"once": 1, "einmal": 1, "twice": 2, "zweimal": 2, "thrice": 3, "dreimal": 3, "viermal": 4}
"""Adverbs that count; other numbers of times are written with a number."""
NUMBERS = {**COUNTS, "une": 1, "una": 1}
TIMES = rf"{'|'.join(ONCE)}|(?:\d+|{'|'.join(NUMBERS)}) (?:times|mal|fois|veces|vez|volte|volta)"
EXACTLY = "(?:exactly |only |just |genau |nur |exactement |exactamente |esattamente )?"
TO = "(?:a la |a |nach )?"
PLURALS: Mapping[Take, str] = {"left": "lefts|left turns", "right": "rights|right turns"}
"""Nouns that a number counts, in English only."""
REST_STRAIGHT = re.compile(rf"\b{OTHERS} (?:of them |all )?(?:go |fahr\w* )?{TO}(?:{WAYS['straight']})\b")
"""Words with which the route crosses all other junctions."""
NEVER = "never|nie|niemals|jamais|nunca|mai"


def with_told_takes(brief: Brief, text: SlottedText) -> Brief:
    """Returns a route that goes left, right and straight on as often as the words say.

    The Brief is returned unchanged if the words give no such numbers, or too many for its junctions, or if it
    has junctions of which ways are not told by sides. Junctions beyond the told numbers are crossed straight
    on.
    """
    told = told_takes(text)
    junctions = brief.junctions
    if not told or any(each.kind not in CROSSINGS for each in junctions):
        return brief
    left = len(junctions) - sum(told.values())
    sides = [(each.take or "").rpartition("_")[2] for each in junctions]
    if left < 0 or all(sides.count(take) == number for take, number in told.items()):
        return brief
    rest: Take | None = "straight" if "straight" not in told else None
    if left and rest is None:
        return brief
    return brief.model_copy(update={"junctions": _taken(junctions, sides, told, rest)})


def _taken(
    junctions: tuple[JunctionClause, ...], sides: list[str], told: Mapping[Take, int], rest: Take | None
) -> tuple[JunctionClause, ...]:
    """Returns the junctions with the told takes; those that have one of them keep it as long as it lasts."""
    missing = dict(told)
    kept = set[int]()
    for n, side in enumerate(sides):
        take = next((take for take in missing if take == side), None)
        if take and missing[take]:
            missing[take] -= 1
            kept.add(n)
    takes = [take for take, number in missing.items() for _ in range(number)]
    out = []
    for n, each in enumerate(junctions):
        if n not in kept:
            each = each.model_copy(update={"take": takes.pop(0) if takes else rest})
        out.append(each)
    return tuple(out)


def told_takes(text: SlottedText) -> dict[Take, int]:
    """Returns how often the words ask for each way; empty unless they say it of two ways at least, and each
    only once.
    """
    said = text.text
    if TAKEN_BACK.search(said):
        return {}
    found: dict[Take, int] = {}
    for take, way in WAYS.items():
        patterns = (
            rf"\b(?:{way}) {EXACTLY}({TIMES})\b",
            rf"\b({TIMES}) {EXACTLY}{TO}(?:{way})\b",
            rf"\b(?:{way}) at {EXACTLY}(\d+)(?: of (?:them|these|those)\b|(?= [,.;]|$))",
            rf"\b(?:{way}) at the other (\d+)\b",
            *([rf"\b(\d+) (?:{PLURALS[take]})\b"] if take in PLURALS else []),
        )
        numbers = {_number(each) for pattern in patterns for each in re.findall(pattern, said)}
        if re.search(rf"\b(?:{NEVER}) (?:turn |go )?{TO}(?:{way})\b", said):
            numbers.add(0)
        if len(numbers) > 1:
            return {}
        if numbers:
            found[take] = numbers.pop()
    # a single number may be that of the bends of a road
    is_clear = len(found) > 1 or REST_STRAIGHT.search(said) is not None
    return found if is_clear and any(found.values()) else {}


def _number(said: str) -> int:
    word = said.split()[0]
    return int(word) if word.isdecimal() else ONCE.get(word) or NUMBERS[word]
