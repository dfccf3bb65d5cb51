"""Splits a description into tokens: words, numbers and punctuation marks."""

import re
import unicodedata
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Literal

from roadgpt.brief.grammar.english import ROAD_WORDS
from roadgpt.brief.grammar.english_function_words import FUNCTION_WORDS
from roadgpt.brief.grammar.german import GERMAN
from roadgpt.brief.grammar.romance import ROMANCE

_PLAIN = str.maketrans(
    {
        "’": "'",
        "‘": "'",
        "`": "'",
        "´": "'",
        "“": '"',
        "”": '"',
        "„": '"',
        "–": "-",
        "—": "-",
        "−": "-",
        "‑": "-",
        "‐": "-",
        "×": " x ",
        "⇒": "→",
        "➔": "→",
        "➜": "→",
        "…": ".",
        "º": "°",
        "⁰": "°",
    }
)
_TOKEN = re.compile(
    r"""
      (?P<tag></?(?:b|i|u|em|strong|p|br|div|span|h\d|li|ul|ol)\s*/?>)
    | (?P<ratio>(?<![\w.:])1\s?:\s?\d{1,4}(?:\.\d{1,3})?(?![\w:]))
    | (?P<number>(?:(?<![\w.,)°%])-)?
        (?:\d{1,3}(?:,\d{3})+(?!\d)|[1-9]\d{0,2}(?:\.\d{3})+(?!\d)|\d+(?:[.,]\d+)?))
    | (?P<arrow>-+>|=+>|→)
    | (?P<bound>>=|<=|≥|≤|>|<|~|≈|±)
    | (?P<word>[^\W\d_]+(?:'[^\W\d_]+)?)
    | (?P<dash>(?<=\s)-+(?=\s)|--+)
    | (?P<hyphen>(?<![^\W\d_])-|-(?![^\W\d_]))
    | (?P<sign>[%°,;:.!?()\[\]/+&\n])
    """,
    re.VERBOSE,
)
_GROUPS = re.compile(r"[1-9]\d{0,2}(?P<mark>[.,])\d{3}(?P<more>(?:(?P=mark)\d{3})*)")
LARGEST = 1e9  # larger numbers are just as impossible
Sort = Literal["word", "number", "ratio", "sign"]


@dataclass(frozen=True, slots=True)
class Token:
    """A word, number or punctuation mark: ``raw`` is its original spelling, ``text`` the spelling used for
    look-up.
    """

    text: str
    raw: str
    sort: Sort = "word"
    value: float = 0.0


def plain(text: str) -> str:
    """Returns the text in lower case, with plain quotes and dashes, without accents: 'Größe' -> 'grosse'."""
    return text.lower() if text.isascii() else "".join(map(_plain_letter, text))


@cache
def _plain_letter(letter: str) -> str:
    """Returns the plain form of one letter, which may have no letter, one or several."""
    folded = unicodedata.normalize("NFKC", letter).translate(_PLAIN).casefold()
    return "".join(c for c in unicodedata.normalize("NFKD", folded) if not unicodedata.combining(c))


def tokens(text: str) -> list[Token]:
    """Returns the tokens of a description in order; punctuation without a meaning is left out."""
    folded, places = plain(text), _places(text)
    found = [
        (match.lastgroup, match.group(), match.span())
        for match in _TOKEN.finditer(folded)
        if match.lastgroup != "tag"
    ]
    commas = _has_decimal_commas([said for sort, said, _ in found if sort == "word"])
    return [
        _token(sort, said, text[places[start] : places[stop - 1] + 1], commas)
        for sort, said, (start, stop) in found
    ]


def _places(text: str) -> Sequence[int]:
    """Returns, for every letter of the plain text, where it was written."""
    if text.isascii():
        return range(len(text))
    return [at for at, letter in enumerate(text) for _ in _plain_letter(letter)]


def _token(sort: str | None, said: str, raw: str, commas: bool) -> Token:
    match sort:
        case "number":
            return Token("#", raw, "number", _number(said, commas))
        case "ratio":
            return Token("1:n", raw, "ratio", _ratio(said))
        case "word":
            return Token(said.removesuffix("'s"), raw)
        case "arrow":
            return Token("→", raw, "sign")
        case "dash":
            return Token("--", raw, "sign")
        case _:
            return Token(said, raw, "sign")


def _has_decimal_commas(words: Sequence[str]) -> bool:
    """True if the words are of a language that writes 12,5 for twelve and a half and 1.250 for 1250."""
    theirs, english = _vocabularies()
    abroad = sum(word in theirs and word not in english for word in words)
    return abroad > 0 and abroad >= sum(word in english and word not in theirs for word in words)


@cache
def _vocabularies() -> tuple[frozenset[str], frozenset[str]]:
    """Returns the words of German, French, Spanish and Italian, and those of English."""
    both = ((GERMAN, ROMANCE), (ROAD_WORDS, FUNCTION_WORDS))
    theirs, english = (
        frozenset(word for listed in some for said in listed.values() for word in said.split())
        for some in both
    )
    return theirs, english


def _number(said: str, commas: bool) -> float:
    """Returns the value of a number; one group of three digits is a thousand if its mark is no decimal
    mark.
    """
    groups = _GROUPS.fullmatch(said.lstrip("-"))
    if groups and (groups["more"] or groups["mark"] == ("." if commas else ",")):
        value = float(said.replace(",", "").replace(".", ""))
    else:
        value = float(said.replace(",", "."))
    return max(-LARGEST, min(LARGEST, value))


def _ratio(said: str) -> float:
    """Returns the percent of a slope written as a ratio, '1:8' -> 12.5; 1:0 becomes an impossibly large
    number.
    """
    run = float(said.split(":")[1])
    return 100.0 / run if run else 1e6
