"""Reads tolerances: "four turns, plus or minus one" is read as three to five turns, "60 m ± 5 m" as 55 to
65 m.
"""

from collections.abc import Sequence

from roadgpt.brief.readers.model.measures import Number, is_count, unit_at
from roadgpt.brief.readers.model.nouns import COUNTED
from roadgpt.brief.readers.model.numerals import numbers_in_words, plain
from roadgpt.brief.readers.model.units import ONES

SIGNS = frozenset(
    tuple(sign.split())
    for sign in (
        *("±", "+ / -", "+ -", "+ or -", "plus or minus", "plus / minus", "plus minus", "give or take"),
        *("plus oder minus", "plus ou moins", "mas o menos", "mas menos", "piu o meno", "piu meno"),
        *("a tolerance of", "tolerance"),
    )
)
OPENING = frozenset([",", "(", "-"])
LONGEST = 4
"""The number of words of the longest expression for "plus or minus", including a bracket before it."""


def tolerances_first(said: Sequence[str]) -> list[str]:
    """Moves a noun behind a tolerance: "five turns, give or take 1" becomes "five, give or take 1 turns"."""
    words = [*said]
    tokens = [plain(word) for word in words]
    for at in range(1, len(words) - 2):
        if tokens[at] not in COUNTED:
            continue
        for last in range(at + 2, min(at + 2 + LONGEST, len(words))):
            if _is_tolerance(tokens[at + 1 : last]) and _is_count(tokens, last):
                last += "(" in tokens[at:last] and tokens[last + 1 : last + 2] == [")"]
                words[at : last + 1] = [*words[at + 1 : last + 1], words[at]]
                return words
    return words


def _is_count(tokens: Sequence[str], at: int) -> bool:
    token = tokens[at]
    return (token.isdecimal() or token in ONES or numbers_in_words((token,)) != {}) and not unit_at(
        tokens, at + 1
    )


def with_tolerances(numbers: Sequence[Number], tokens: Sequence[str]) -> list[Number]:
    """Removes the numbers that are tolerances; the number that has the tolerance keeps it as ``spread``."""
    out: list[Number] = []
    for number in numbers:
        if out and _is_tolerance(tokens[out[-1].last + 1 : number.first]) and number.value < out[-1].value:
            _take(out[-1], number, tokens)
        else:
            out.append(number)
    for number in out:
        _take_one(number, tokens)
    return out


def _take_one(number: Number, tokens: Sequence[str]) -> None:
    """Sets the tolerance of a count to 1 if the text gives the tolerance as a word such as "one" or "eine".

    Such words are not read as numbers elsewhere, since they are mostly articles.
    """
    if not (number.is_bare and is_count(tokens, number)) or number.spread:
        return
    for place in range(number.last + 1, min(number.last + 2 + LONGEST, len(tokens))):
        if tokens[place] in ONES and _is_tolerance(tokens[number.last + 1 : place]):
            number.spread, number.last = 1, place
            return


def _is_tolerance(between: Sequence[str]) -> bool:
    words = [*between]
    while words and words[0] in OPENING:
        words = words[1:]
    return tuple(words) in SIGNS


def _take(number: Number, tolerance: Number, tokens: Sequence[str]) -> None:
    both_counts = number.is_bare and tolerance.is_bare and is_count(tokens, number)
    if number.is_bare and tolerance.unit in ("metres", "degrees"):
        number.value = round(number.value * tolerance.factor, 1)
        number.unit, number.is_bare = tolerance.unit, False
    if not both_counts:
        number.spread = _in_unit_of(number, tolerance)
    elif tolerance.value == int(tolerance.value):
        number.spread = tolerance.value
    is_open = "(" in tokens[number.last + 1 : tolerance.first]
    closes = tolerance.last + 1 < len(tokens) and tokens[tolerance.last + 1] == ")"
    number.last = tolerance.last + (is_open and closes)


def _in_unit_of(number: Number, tolerance: Number) -> float:
    """Returns the tolerance of a measure in the unit of its value; a percentage of a length is one of it."""
    if tolerance.unit == number.unit:
        return tolerance.value
    if tolerance.unit == "percent":
        return number.value * tolerance.value / 100
    return tolerance.value * number.factor if tolerance.is_bare else 0
