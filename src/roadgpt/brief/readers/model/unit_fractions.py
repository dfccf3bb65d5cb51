"""Reads fractions of a unit of length in the words of a text, such as "3/4 mile", "two and a half miles" and
"deux kilomètres et demi", and decimals in words: "two point five kilometres", "zwei Komma fünf".
"""

import re
from collections.abc import Sequence
from dataclasses import replace

from roadgpt.brief.readers.model.measures import Number, unit_at
from roadgpt.brief.readers.model.nouns import COUNTED, ONE_TURN
from roadgpt.brief.readers.model.numerals import SIZES, number_word, numbers_in_words
from roadgpt.brief.readers.model.units import ONES, SHARE_FILLERS, SHARES

FAR = 100
"""A unit of this many metres or more, without a number, means one unit, as in "mile and a half"."""
DENOMINATORS = ("2", "3", "4", "5", "8", "10")
"""What may stand below the stroke of a fraction of a unit: "3/4 mile"."""
SHARE = re.compile(r"0[.,]\d+")
"""A share of a unit in decimals: "0.3 of a mile"."""
WHOLE_AND = frozenset({"-", "and", "und", "et", "y", "e"})
"""Words between a whole number and a fraction: "1 and 1/2 miles"."""
GERMAN_HALF = re.compile(r"(ander|\w*?)(?:ein|und|t)?(halb|viertel)(tausend)?")
"""A German number with its fraction in one word: "zweieinhalb", "dreieinviertel"."""
OF_A_CIRCLE = frozenset(
    {"circle", "loop", "kreis", "kehre", "drehung", "cercle", "tour", "boucle", "vuelta", "circulo", "giro"}
    | {"cerchio", "hour", "minute", "hora", "ora", "heure", "stunde", "-"}
)
"""Words that show that a fraction is no part of the unit before it: "two kilometres and a half turn"."""
POINTS = frozenset({"point", "komma", "virgule", "coma", "virgola"})
"""The words between a whole number and its decimals."""
MOST_WORDS = 3
"""The largest number of words that decimals have; a hyphen counts as a word."""


def unit_fraction(tokens: list[str], at: int) -> Number | None:
    """Reads "3/4 mile", "1 1/2 miles" and "0.3 of a mile"."""
    if SHARE.fullmatch(tokens[at]) and tokens[at + 1 : at + 2] == ["of"]:
        return _of_unit(float(tokens[at].replace(",", ".")), tokens, at, at)
    is_number_of_turn = at > 0 and tokens[at - 1] in ONE_TURN | COUNTED
    for first in (at + 1, at + 2) if tokens[at].isdecimal() and not is_number_of_turn else ():
        share = _share(tokens, first)
        is_joined = first == at + 1 or WHOLE_AND.issuperset(tokens[at + 1 : at + 2])
        if share and is_joined and tokens[first + 3 : first + 4] != ["-"]:
            return _of_unit(int(tokens[at]) + share, tokens, at, first + 2)
    share = _share(tokens, at)
    return _of_unit(share, tokens, at, at + 2) if share else None


def _share(tokens: list[str], at: int) -> float | None:
    """Returns the value of a fraction such as "3/4" at this place; None if there is none."""
    above, stroke, below = (*tokens[at : at + 3], "", "", "")[:3]
    is_fraction = stroke == "/" and above.isdecimal() and below in DENOMINATORS
    return int(above) / int(below) if is_fraction else None


def _of_unit(value: float, tokens: list[str], at: int, last: int) -> Number | None:
    """Returns a number from token ``at`` to ``last`` and the words before its unit, a length.

    None if no unit follows, or if it is a fraction of a unit as small as a metre: "turns 3/4 m wide".
    """
    while tokens[last + 1 : last + 2] and tokens[last + 1] in SHARE_FILLERS:
        last += 1
    unit = unit_at(tokens, last + 1)
    is_small = unit is not None and unit[1] < FAR and (value < 1 or last - at < 3)
    return None if unit is None or unit[0] != "metres" or is_small else Number(value, at, last, "", False)


def whole_and_share(tokens: list[str], at: int) -> Number | None:
    """Reads "two and a half kilometres", "three and a quarter miles", "zweieinhalb Kilometer" and "one and a
    half thousand metres".
    """
    value = _german_half(tokens[at])
    if value is not None:
        return _before_unit(value, tokens, at, at)
    whole = float(tokens[at]) if tokens[at].isdecimal() else float(number_word(tokens[at]))
    whole = 1.0 if tokens[at] in ONES else whole
    if not whole or tokens[at + 1 : at + 2] == [] or tokens[at + 1] not in WHOLE_AND - {"-"}:
        return None
    share, last = _share_in_words(tokens, at + 2)
    return _before_unit(whole + share, tokens, at, last) if share else None


def take_share(number: Number, tokens: list[str]) -> None:
    """Adds to "two kilometres" the half of a kilometre in "two kilometres and a half"."""
    joint = tokens[number.last + 1 : number.last + 2]
    if number.unit != "metres" or number.factor < FAR or not joint or joint[0] not in WHOLE_AND - {"-"}:
        return
    share, last = _share_in_words(tokens, number.last + 2)
    behind = [token for token in tokens[last + 1 :] if token not in SHARE_FILLERS - {"-"}][:1]
    if not share or (behind and (behind[0] in OF_A_CIRCLE | ONE_TURN | COUNTED or unit_at(behind, 0))):
        return
    number.value, number.last = round(number.value + share * number.factor, 1), last


def _share_in_words(tokens: list[str], at: int) -> tuple[float, int]:
    """Returns the fraction that begins at a token, and its last token; 0 if there is none."""
    many, place = 1, at
    if tokens[at : at + 1] and (tokens[at] in ONES or number_word(tokens[at]) == 3):  # three quarters
        many, place = (1 if tokens[at] in ONES else 3), at + 1
    share = SHARES.get(tokens[place], 0.0) if place < len(tokens) else 0.0
    return (many * share, place) if many * share < 1 else (0.0, place)


def _german_half(word: str) -> float | None:
    """Returns the value of "zweieinhalb", "anderthalb" or "dreieinhalbtausend"; None for any other word."""
    found = GERMAN_HALF.fullmatch(word)
    if found is None:
        return None
    whole, share, thousand = found.groups()
    many = {"ander": 1, "ein": 1}.get(whole) or number_word(whole)
    if not many or (whole == "ander" and share != "halb"):
        return None
    if share == "viertel" and "ein" not in word.removeprefix(whole):
        value = many / 4 if many == 3 else 0.0  # "dreiviertel" is 3/4
    else:
        value = many + (0.5 if share == "halb" else 0.25)
    return value * (1000 if thousand else 1) or None


def _before_unit(value: float, tokens: list[str], at: int, last: int) -> Number | None:
    """Returns a number from token ``at`` to ``last``, or to "thousand" behind it; None if no unit follows."""
    size = SIZES.get(tokens[last + 1], 1) if tokens[last + 1 : last + 2] else 1
    last += size > 1
    while tokens[last + 1 : last + 2] and tokens[last + 1] in SHARE_FILLERS - {"-"}:
        last += 1
    return Number(value * size, at, last, "", False) if unit_at(tokens, last + 1) else None


def with_decimals(number: Number, tokens: Sequence[str]) -> Number:
    """Returns a number with the decimals that follow in words; unchanged without decimals and a unit."""
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
    """Reads "one point five" and "due virgola cinque": "one" and "due" are numbers only with decimals."""
    value = 1 if tokens[at] in ONES else number_word(tokens[at])
    found = with_decimals(Number(float(value), at, at), tokens) if value else None
    return found if found is not None and found.last > at else None


def _digits(key: tuple[str, ...]) -> str:
    return str(next(iter(numbers_in_words(key).values()), ""))
