"""The values of a page."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

Raw = str | int | float | None


class Cell(NamedTuple):
    """One cell of a table, or one piece of a line."""

    value: Raw
    """As CSV has it."""
    text: str
    """As people read it."""
    href: str = ""
    """Relative address of what is behind it; empty: nothing."""


def cell(value: Raw, text: str | None = None, href: str = "") -> Cell:
    """A cell; a number without a text is shown as it is, None as a dash."""
    if text is None:
        text = "–" if value is None else f"{value:,}" if isinstance(value, int) else str(value)
    return Cell(value, text, href)


def linked(text: str, href: str) -> Cell:
    """Words that lead somewhere."""
    return Cell(text, text, href)


@dataclass(frozen=True)
class Table:
    """Rows of cells under their heads."""

    name: str
    """Of its files: letters, digits and '-'."""
    caption: str
    heads: Sequence[str]
    rows: Sequence[Sequence[Cell]]
    note: str = ""
    """Below it, small."""
    has_total: bool = False
    """Is the last row a sum?"""


@dataclass(frozen=True)
class Figure:
    """A picture as SVG, with what it shows in a sentence or two."""

    name: str
    caption: str
    svg: str


@dataclass(frozen=True)
class Details:
    """What only some readers open."""

    title: str
    blocks: Sequence["Block"]


class Command(str):
    """What can be typed, among the words of a line."""

    __slots__ = ()


Line = str | Sequence[str | Cell]
"""A paragraph: words, or words with links and commands among them."""


class Card(NamedTuple):
    """One of many pictures with what has to be said of it."""

    title: Line
    svg: str
    lines: Sequence[Line]


@dataclass(frozen=True)
class Cards:
    """Pictures side by side, as many in a row as there is room for."""

    cards: Sequence[Card]


Block = Line | Table | Figure | Details | Cards


@dataclass(frozen=True)
class Section:
    """A heading and what stands under it."""

    title: str
    blocks: Sequence[Block]


@dataclass(frozen=True)
class Page:
    """All of a page."""

    title: str
    summary: Sequence[Line]
    """What a reader wants to know, about five lines."""
    sections: Sequence[Section]
    card: Mapping[str, str] = field(default_factory=dict)
    """How it was made: seeds, versions, the command that makes it again."""
    lead: str = ""
    """One line under the title."""

    def tables(self) -> list[Table]:
        """All tables, those in details included, in their order."""
        return _tables([block for section in self.sections for block in section.blocks])


def _tables(blocks: Sequence[Block]) -> list[Table]:
    found: list[Table] = []
    for block in blocks:
        if isinstance(block, Table):
            found.append(block)
        elif isinstance(block, Details):
            found += _tables(block.blocks)
    return found


def pieces_of(line: Line) -> Sequence[str | Cell]:
    """The words and links of a line."""
    return (line,) if isinstance(line, str) else line
