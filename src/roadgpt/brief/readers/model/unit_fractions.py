"""Reads fractions of a unit of length in the words of a text, such as "3/4 mile"."""

import re

from roadgpt.brief.readers.model.measures import Number, unit_at
from roadgpt.brief.readers.model.nouns import COUNTED, ONE_TURN
from roadgpt.brief.readers.model.units import SHARE_FILLERS

FAR = 100
"""A unit of at least this many metres means one such unit if it has no number, as in "mile and a half"."""
DENOMINATORS = ("2", "3", "4", "5", "8", "10")
"""What may stand below the stroke of a fraction of a unit: "3/4 mile"."""
SHARE = re.compile(r"0[.,]\d+")
"""A share of a unit in decimals: "0.3 of a mile"."""
WHOLE_AND = frozenset({"-", "and", "und", "et", "y", "e"})
"""Words between a whole number and a fraction: "1 and 1/2 miles"."""


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
