"""Numbers that are not of the road or its traffic: years, ages, clock times, dates, numbers of routes and of
documents. The network reads a word such as "year" in the place of each, so that none can become a measure."""

import re
from collections.abc import Sequence

from roadgpt.brief.languages import pattern_of, word_set

PERSON = pattern_of("person")
"""The end of a word for a person, whose age follows in brackets."""
AGES, MONTHS, ROUTES, DAY = (word_set(name) for name in ("ages", "months", "numbered_routes", "time_of_day"))
DATE = re.compile(r"(?=.*\d{4})\d{1,4}([-/.])\d{1,4}\1\d{1,4}")
YEARS = range(1950, 2036)
ROUND_YEAR = 2000  # more often metres than a year
PREFIXES = (["i"], ["us"], ["sr"], ["cr"])
LARGE = 20
"""A number behind "route" that is not larger may count something: "a route, 3 turns"."""
NEAR = 5
"""How many words before and behind a number are looked at."""


def stands_for(tokens: Sequence[str], first: int, last: int) -> str:
    """Returns the word for a number without a unit that is set aside, from one word to another; empty if the
    number is of the road or may be."""
    said = tokens[first]
    before = [each for each in tokens[max(first - NEAR, 0) : first] if each not in "-.,"]
    after = [each for each in tokens[last + 1 : last + 1 + NEAR] if each not in "-.,'"]
    if first != last or not said[0].isdecimal():
        return "age" if AGES.intersection(after[:1]) and _is_age(after) else ""
    if before[-1:] == ["aged"] or (AGES.intersection(after[:1]) and _is_age(after)):
        return "age"
    brackets = [*tokens[first - 1 : first], *tokens[last + 1 : last + 2]] if first > 1 else []
    if brackets == ["(", ")"] and PERSON.search(tokens[first - 2]):
        return "age"
    if not MONTHS.isdisjoint([*before[-1:], *after[:1]]) or _is_of_date(tokens, first):
        return "date"
    if _is_clock(tokens, first) or not DAY.isdisjoint(after[:1]):
        return "time"
    if said.isdecimal() and len(said) == 4 and int(said) in YEARS and int(said) != ROUND_YEAR:
        return "year"
    if not said.isdecimal():
        return ""
    if said[0] == "0" and len(said) > 1:
        return "number"
    is_named = before[-1:] in PREFIXES and tokens[first - 1] == "-"
    is_alone = tokens[last + 1 : last + 2] == [] or not tokens[last + 1].isalpha() or int(said) > LARGE
    return "number" if is_named or (not ROUTES.isdisjoint(before[-1:]) and is_alone) else ""


def _is_age(after: Sequence[str]) -> bool:
    is_of_years = after[0] in ("year", "years", "jahre", "anos", "anni")
    return not is_of_years or after[1:2] in (["old"], ["alt"])


def _is_clock(tokens: Sequence[str], at: int) -> bool:
    """Returns whether a number is one of the two of a time such as "18:40"."""
    hour, minute = (at, at + 2) if tokens[at + 1 : at + 2] == [":"] else (at - 2, at)
    if hour < 0 or minute >= len(tokens) or tokens[hour + 1] != ":":
        return False
    both = tokens[hour], tokens[minute]
    is_minute = both[1].isdecimal() and len(both[1]) == 2 and int(both[1]) < 60
    return is_minute and both[0].isdecimal() and int(both[0]) < 25


def _is_of_date(tokens: Sequence[str], at: int) -> bool:
    """Returns whether a number is one of three of a date such as "12/05/2012" or "2012-05-12"."""
    dates = ("".join(tokens[first : first + 5]) for first in (at, at - 2, at - 4) if first >= 0)
    return any(map(DATE.fullmatch, dates))
