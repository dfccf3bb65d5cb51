"""Writes reports on many roads as one self-contained HTML file, and their tables as CSV and LaTeX.

A Page holds a short summary, sections with text, tables and figures, and information on how it was made.
``write`` writes it into a folder:

    report.html            the page, for screen (light and dark) and print; needs no scripts and no network
    tables/NAME.csv .tex   every table, as CSV with plain numbers and as LaTeX (booktabs)

Figures are SVG in the page's colours. matplotlib draws ``forest`` (shares with intervals), ``heat`` (a
matrix, or a feature map), ``lines`` and ``bars``; ``gallery`` (small maps of roads, each a link) writes
SVG itself, and ``close_up`` (the place of a failure) holds a PNG."""

from functools import cache
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined, Template

from roadgpt.errors import RoadGPTError, explained
from roadgpt.report.page.model import Page, Raw, Table
from roadgpt.run.atomic import csv_text, refuse_links, write_whole

HERE = Path(__file__).parent
PAGE, BRIEF, TABLES = "report.html", "brief.html", "tables"
STYLE = HERE / "style.css"
LATEX = {letter: f"\\{letter}" for letter in "&%$#_{}"} | {
    "\\": r"\textbackslash{}",
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
    "<": r"\textless{}",
    ">": r"\textgreater{}",
    "|": r"\textbar{}",
    "²": r"\textsuperscript{2}",
    "χ": r"$\chi$",
    "–": "--",
    "−": "$-$",
    "×": r"$\times$",
}

FORMULA = ("=", "+", "-", "@", "\t")  # spreadsheets treat a cell that begins with one of these as a formula


def write(page: Page, folder: Path | str) -> Path:
    """Writes ``report.html`` and ``tables/`` into a folder, and returns the path of the page; files of these
    names are replaced."""
    folder = Path(folder)
    with explained(RoadGPTError, f"cannot write the report into {folder}", "name another folder"):
        refuse_links(folder / TABLES)
        (folder / TABLES).mkdir(parents=True, exist_ok=True)
        for table in page.tables():
            write_whole(folder / TABLES / f"{table.name}.csv", csv_of(table))
            write_whole(folder / TABLES / f"{table.name}.tex", latex_of(table))
        write_whole(folder / PAGE, html_of(page))
    return folder / PAGE


def html_of(page: Page, is_brief: bool = False) -> str:
    """Returns the whole page, to be written as UTF-8; the same Page gives the same text. A brief one is laid
    out for a sheet of A4."""
    style = STYLE.read_text(encoding="utf-8")
    return _template().render(page=page, style=style, is_brief=is_brief)


@cache
def _template() -> Template:
    environment = Environment(
        loader=FileSystemLoader(HERE), autoescape=True, undefined=StrictUndefined, trim_blocks=True,
        lstrip_blocks=True, keep_trailing_newline=True,
    )  # fmt: skip
    environment.tests["of"] = lambda value, name: type(value).__name__ == name
    return environment.get_template(PAGE)


def csv_of(table: Table) -> str:
    """Returns a table as CSV with raw values; None becomes an empty field, and an apostrophe is put in
    front of text that a spreadsheet would treat as a formula."""
    values = (
        [None if each.value is None else unformulated(each.value) for each in row] for row in table.rows
    )
    return csv_text(table.heads, values)


def unformulated(value: Raw) -> Raw:
    """Returns a value for a CSV file. In text, line ends become newlines; text that a spreadsheet would treat
    as a formula is prefixed with an apostrophe."""
    if not isinstance(value, str):
        return value
    words = value.replace("\r\n", "\n").replace("\r", "\n")  # csv would end the row there
    return f"'{words}" if words.startswith(FORMULA) else words


def latex_of(table: Table) -> str:
    """Returns a table as a LaTeX float that uses booktabs; columns with numbers are right-aligned."""
    places = "".join("r" if is_number else "l" for is_number in table.columns_with_numbers())
    body = [" & ".join(_latex(each.text) for each in row) + r" \\" for row in table.rows]
    if table.has_total and body:
        body.insert(-1, r"\midrule")
    lines = [
        r"% needs \usepackage{booktabs}",
        r"\begin{table}",
        r"\centering",
        rf"\caption{{{_latex(table.caption)}}}",
        rf"\label{{tab:{table.name}}}",
        rf"\begin{{tabular}}{{{places}}}",
        r"\toprule",
        " & ".join(_latex(head) for head in table.heads) + r" \\",
        r"\midrule",
        *body,
        r"\bottomrule",
        r"\end{tabular}",
        r"\end{table}",
    ]
    return "\n".join(lines) + "\n"


def _latex(text: str) -> str:
    return "".join(LATEX.get(letter, letter) for letter in text)
