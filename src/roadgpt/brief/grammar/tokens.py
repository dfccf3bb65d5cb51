"""Splits a description into words, numbers and signs."""

import re
import unicodedata
from dataclasses import dataclass
from typing import Literal

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
_THOUSANDS = re.compile(r"\d{1,3}(,\d{3})+|\d{1,3}(\.\d{3})+")
LARGEST = 1e9  # numbers beyond are as impossible as this one
Sort = Literal["word", "number", "ratio", "sign"]


@dataclass(frozen=True, slots=True)
class Token:
    """A piece of the description: ``text`` to be looked up, ``raw`` as it was written."""

    text: str
    raw: str
    sort: Sort = "word"
    value: float = 0.0


def plain(text: str) -> str:
    """Lower case, one sort of quotes and dashes, no accents: 'Größe' -> 'grosse'."""
    folded = unicodedata.normalize("NFKC", text).translate(_PLAIN).casefold()
    if folded.isascii():
        return folded
    return "".join(c for c in unicodedata.normalize("NFKD", folded) if not unicodedata.combining(c))


def tokens(text: str) -> list[Token]:
    """The tokens of a description, in order; signs that mean nothing here are left out."""
    found = []
    for match in _TOKEN.finditer(plain(text)):
        sort, raw = match.lastgroup, match.group()
        if sort == "tag":
            continue
        if sort == "number":
            found.append(Token("#", raw, "number", _number(raw)))
        elif sort == "ratio":
            found.append(Token("1:n", raw, "ratio", _ratio(raw)))
        elif sort == "word":
            found.append(Token(raw.removesuffix("'s"), raw))
        elif sort == "arrow":
            found.append(Token("→", raw, "sign"))
        elif sort == "dash":
            found.append(Token("--", raw, "sign"))
        else:
            found.append(Token(raw, raw, "sign"))
    return found


def _number(raw: str) -> float:
    if _THOUSANDS.fullmatch(raw.lstrip("-")):
        value = float(raw.replace(",", "").replace(".", ""))
    else:
        value = float(raw.replace(",", "."))
    return max(-LARGEST, min(LARGEST, value))


def _ratio(raw: str) -> float:
    """Percent of a slope written as a ratio, '1:8' -> 12.5; a slope of 1:0 is as steep as a wall."""
    run = float(raw.split(":")[1])
    return 100.0 / run if run else 1e6
