"""The table of the words of five languages that are recognised without the network: ``languages.toml``; the
language of a text, and its numbers, which each language writes in its own way."""

import re
import tomllib
from collections.abc import Collection
from pathlib import Path
from typing import Any

from roadgpt.reading import read_text

TABLE: dict[str, Any] = tomllib.loads(read_text(Path(__file__).with_name("languages.toml")))


def word_set(name: str) -> frozenset[str]:
    """Returns the words that have this name in the table."""
    return frozenset(TABLE["words"][name].split())


def pattern_of(name: str, part: str = "patterns", flags: int = 0) -> re.Pattern[str]:
    """Returns the pattern that has this name in a part of the table, where it may have several lines."""
    return re.compile(TABLE[part][name].replace("\n", ""), flags)


FUNCTION_WORDS: dict[str, frozenset[str]] = {
    code: frozenset(words.split()) for code, words in TABLE["function_words"].items()
}
SPACED = re.compile(r"(?<![\d.,])[1-9]\d{0,2}(?:[\u00a0\u2009\u202f'’]\d{3})+(?![\d'’])")
"""A number in groups of three digits, with spaces that keep it on one line, or with apostrophes."""
LOOSELY_SPACED = re.compile(
    r"(?<![\d.,])(?<!\d )[1-9]\d{0,2}(?: \d{3})+(?=(?:[.,]\d+)? ?(?:k?m|m[eè]t|kilo|chilo))"
)
GROUPED = re.compile(r"(?<![\d.,])[1-9]\d{0,2}(?:(?:,\d{3})+|(?:\.\d{3})+)(?:[.,]\d+)?(?![.,]?\d)")
MOST_DIGITS = 15  # of a number; the computer keeps no more of them


def language_of(words: Collection[str]) -> str:
    """Returns the code, such as "de", of the language with the most function words among some words.

    If several languages have the most, English ("en") is preferred, then the first in ``FUNCTION_WORDS``."""
    found = set(words)
    return max(FUNCTION_WORDS, key=lambda code: (len(found & FUNCTION_WORDS[code]), code == "en"))


def with_plain_numbers(text: str) -> str:
    """Returns a text without the marks between thousands in its numbers: "1,200 m" and, in other languages
    than English, "1.200 m" and "1 200 m" become "1200 m". Of two different marks, the last one is that of the
    decimals."""
    is_english = language_of(re.findall(r"[^\W\d_]+", text.lower())) == "en"
    text = re.sub(r"\d+", lambda digits: digits[0][:MOST_DIGITS], text)
    for pattern in (SPACED,) if is_english else (SPACED, LOOSELY_SPACED):
        text = pattern.sub(lambda number: re.sub(r"\D", "", number[0]), text)
    return GROUPED.sub(lambda number: _without_thousands(number[0], "," if is_english else "."), text)


def _without_thousands(number: str, mark: str) -> str:
    marks = re.sub(r"\d", "", number)
    first, last = marks[0], marks[-1]
    are_thousands = marks.count(last) == 1 if first != last else len(marks) > 1 or marks == mark
    return number.replace(first, "") if are_thousands else number
