"""Reads decimals in words: "two point five kilometres", "zwei Komma fünf", "deux virgule vingt-cinq"."""

from collections.abc import Sequence
from dataclasses import replace

from roadgpt.brief.readers.model.measures import Number, unit_at
from roadgpt.brief.readers.model.number_words import number_word, numbers_in_words
from roadgpt.brief.readers.model.units import ONES

POINTS = frozenset({"point", "komma", "virgule", "coma", "virgola"})
"""The words between a whole number and its decimals."""
MOST_WORDS = 3
"""The most words of decimals, a hyphen included."""


def with_decimals(number: Number, tokens: Sequence[str]) -> Number:
    """Returns a number with the decimals in words behind it, if it has any and a unit follows."""
    if not number.is_bare or number.unit or number.value != int(number.value):
        return number
    if tokens[number.last + 1 : number.last + 2] == [] or tokens[number.last + 1] not in POINTS:
        return number
    decimals, key = "", tuple[str, ...]()
    last = end = number.last + 1
    for word in tokens[number.last + 2 : number.last + 2 + MOST_WORDS]:
        end += 1
        key += (word,) if word != "-" else ()
        digits = "".join("1" if each in ONES else _digits((each,)) for each in key)
        both = _digits(key)
        if len(both) == 2 or (len(digits) == len(key) > 0):  # "vingt-cinq", or "two five"
            decimals, last = both if len(both) == 2 else digits, end
    if not decimals or unit_at(tokens, last + 1) is None:  # "point one a dip point two a left"
        return number
    return replace(number, value=float(f"{number.value:.0f}.{decimals}"), last=last)


def one_with_decimals(tokens: Sequence[str], at: int) -> Number | None:
    """Reads "one point five" and "due virgola cinque": such words are numbers only with decimals."""
    value = 1 if tokens[at] in ONES else number_word(tokens[at])
    found = with_decimals(Number(float(value), at, at), tokens) if value else None
    return found if found is not None and found.last > at else None


def _digits(key: tuple[str, ...]) -> str:
    return str(next(iter(numbers_in_words(key).values()), ""))
