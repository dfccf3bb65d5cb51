"""Measures the width of text, breaks lines, and shortens text."""

import re
from functools import cache

from matplotlib.font_manager import FontProperties, findfont, get_font

UNKNOWN = "□"  # in place of a letter that the font lacks
POINTS = 72.0  # per inch
ELLIPSIS = " …"
BREAK = re.compile(r"(?<!\d) | (?!(?:%|g|s|m|km|km/h|m/s|degrees)(?:\W|$))")


def plain(text: str) -> str:
    """Returns text as one line, with a box in place of each letter that the font lacks."""
    return "".join(letter if _advance(letter, False) else UNKNOWN for letter in " ".join(text.split()))


def inches(text: str, size: float, bold: bool = False) -> float:
    """Returns the width of the longest line in inches; ``size`` is the font size in points."""
    return max(sum(_advance(letter, bold) for letter in row) for row in text.split("\n")) * size / POINTS


def fitted(text: str, width: float, size: float, bold: bool = False, lines: int = 1) -> str:
    """Returns text wrapped to at most ``lines`` lines of ``width`` inches, with an ellipsis for what is cut
    off. A number and its unit stay on one line.
    """
    words = BREAK.split(plain(text))
    rows: list[str] = []
    while words and len(rows) < lines:
        count = 1
        while count < len(words) and inches(" ".join(words[: count + 1]), size, bold) <= width:
            count += 1
        is_last = len(rows) == lines - 1 and count < len(words)
        rows.append(_shortened(" ".join(words[:count]), width, size, bold, is_last))
        words = words[count:]
    return "\n".join(rows)


def _shortened(row: str, width: float, size: float, bold: bool, has_more: bool) -> str:
    """Returns the row, with an ellipsis if it is too wide or more text follows."""
    if not has_more and inches(row, size, bold) <= width:
        return row
    while row and inches(row + ELLIPSIS, size, bold) > width:
        row = row[:-1]
    return row.rstrip() + ELLIPSIS


@cache
def _advance(letter: str, bold: bool) -> float:
    """Returns the advance of a letter, relative to the font size; 0 if the font lacks the letter."""
    font = get_font(findfont(FontProperties(family="DejaVu Sans", weight="bold" if bold else "normal")))
    if not font.get_char_index(ord(letter)):
        return 0.0
    font.set_size(100.0, POINTS)
    return float(font.load_char(ord(letter)).linearHoriAdvance) / 65536 / 100
