"""Pages that tell of many roads: one self-contained HTML file, and Markdown, CSV and LaTeX beside it.

A Page is a value: what a reader wants to know in a few lines, sections of text, tables and figures, and a
card that says how it was made. ``write`` puts it into a folder:

    report.html            the page: no script, no network, printable, on any screen, light and dark
    report.md              the same words and tables
    tables/NAME.csv .tex   every table, with plain numbers and for LaTeX (booktabs)

Figures are SVG that takes its colours from the page; the modules here draw them: ``forest`` (shares with
their intervals), ``heat`` (a matrix, or a map of cells), ``lines``, ``bars``, ``gallery`` (roads by the
hundred, each a link) and ``spot`` (the place of a failure).
"""

from roadgpt.report.page.html import html_of
from roadgpt.report.page.model import (
    Block,
    Card,
    Cards,
    Cell,
    Command,
    Details,
    Figure,
    Line,
    Page,
    Section,
    Table,
    cell,
    linked,
)
from roadgpt.report.page.text import csv_of, latex_of, markdown_of
from roadgpt.report.page.writing import write

__all__ = [
    "Block",
    "Card",
    "Cards",
    "Cell",
    "Command",
    "Details",
    "Figure",
    "Line",
    "Page",
    "Section",
    "Table",
    "cell",
    "csv_of",
    "html_of",
    "latex_of",
    "linked",
    "markdown_of",
    "write",
]
