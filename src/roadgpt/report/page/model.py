"""Defines the Page and its parts."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

Raw = str | int | float | None


class TableCell(NamedTuple):
    """One cell of a table, or one piece of a line of text, such as a link."""

    value: Raw  # the value that is written into CSV files
    text: str  # the text that people read
    href: str = ""  # relative address of the cell's link; empty for no link
    colour: str = ""  # name of the colour of its ground in style.css


def cell(value: Raw, text: str | None = None, href: str = "", colour: str = "") -> TableCell:
    """Returns a cell. Without ``text``, the cell shows the value itself, or a dash for None."""
    if text is None:
        text = "–" if value is None else f"{value:,}" if isinstance(value, int) else str(value)
    return TableCell(value, text, href, colour)


def linked(text: str, href: str) -> TableCell:
    """Returns text that links to an address."""
    return TableCell(text, text, href)


@dataclass(frozen=True)
class Table:
    """A table with caption and column heads."""

    name: str  # name of the table's files: letters, digits and '-'
    caption: str
    heads: Sequence[str]
    rows: Sequence[Sequence[TableCell]]
    note: str = ""  # small text below the table
    has_total: bool = False  # whether the last row holds totals

    def columns_with_numbers(self) -> list[bool]:
        """Returns for each column whether it has numbers."""
        return [
            any(isinstance(row[n].value, (int, float)) for row in self.rows) for n in range(len(self.heads))
        ]


@dataclass(frozen=True)
class Figure:
    """A picture as SVG, with a caption of a sentence or two."""

    name: str
    caption: str
    svg: str


@dataclass(frozen=True)
class Details:
    """Blocks that are hidden until the reader opens them."""

    title: str
    blocks: Sequence["Block"]


class ShellCommand(str):
    """A shell command within a line of text."""

    __slots__ = ()


Line = str | Sequence[str | TableCell]
"""A paragraph: text, or pieces of text with links and commands among them."""


class FigureCard(NamedTuple):
    """One picture of Cards, with a title and lines of text."""

    title: Line
    svg: str
    lines: Sequence[Line]


@dataclass(frozen=True)
class Cards:
    """Pictures with text, arranged in rows."""

    cards: Sequence[FigureCard]


Block = Line | Table | Figure | Details | Cards


@dataclass(frozen=True)
class Section:
    """A heading and the blocks below it."""

    title: str
    blocks: Sequence[Block]


@dataclass(frozen=True)
class Page:
    """The content of a report, which ``write`` writes as HTML, CSV and LaTeX."""

    title: str
    summary: Sequence[Line]  # the main results in about five lines
    sections: Sequence[Section]
    card: Mapping[str, str] = field(default_factory=dict)
    """How the page was made: seeds, versions, and the command that repeats it."""
    lead: str = ""  # one line under the title

    def facts(self) -> list[tuple[str, str]]:
        """Returns the entries of ``card``; values of names that begin with "command" are ShellCommands."""
        return [
            (name, ShellCommand(value) if name.startswith("command") else value)
            for name, value in self.card.items()
        ]

    def tables(self) -> list[Table]:
        """Returns all tables in order, including the tables in Details."""
        return _tables([block for section in self.sections for block in section.blocks])


def _tables(blocks: Sequence[Block]) -> list[Table]:
    found: list[Table] = []
    for block in blocks:
        if isinstance(block, Table):
            found.append(block)
        elif isinstance(block, Details):
            found += _tables(block.blocks)
    return found
