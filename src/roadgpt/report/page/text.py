"""Writes a Page as Markdown, and its tables as CSV and LaTeX."""

from collections.abc import Sequence

from roadgpt.report.page.model import (
    Block,
    Cards,
    Details,
    Figure,
    Line,
    Page,
    Raw,
    Table,
    TableCell,
    spelled,
)
from roadgpt.run.atomic import csv_text

LATEX = {
    "\\": r"\textbackslash{}",
    "&": r"\&",
    "%": r"\%",
    "$": r"\$",
    "#": r"\#",
    "_": r"\_",
    "{": r"\{",
    "}": r"\}",
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
HTML = str.maketrans({"<": "&lt;", "&": "&amp;"})  # Markdown passes HTML tags through


def markdown_of(page: Page) -> str:
    """Returns a page as Markdown: its text, its tables, and the captions of its figures."""
    parts = [f"# {_escaped(page.title)}", *([_escaped(page.lead)] if page.lead else [])]
    parts.append("\n".join(f"- {_line(line)}" for line in page.summary))
    for section in page.sections:
        parts += [f"## {_escaped(section.title)}", *_blocks(section.blocks)]
    if page.card:
        parts += ["## How this was made", "\n".join(f"- {k}: {_line(v)}" for k, v in page.facts())]
    return "\n\n".join(parts) + "\n"


def _escaped(words: str) -> str:
    """Returns text on one line, escaped so that none of it is markup."""
    return " ".join(words.translate(HTML).splitlines())


def _blocks(blocks: Sequence[Block]) -> list[str]:
    out = []
    for block in blocks:
        if isinstance(block, Table):
            out.append(_table(block))
        elif isinstance(block, Figure):
            out.append(f"*{_escaped(block.caption)}* (figure: see report.html)")
        elif isinstance(block, Cards):
            out += [f"**{_line(card.title)}** {' '.join(map(_line, card.lines))}" for card in block.cards]
        elif isinstance(block, Details):
            out += [f"**{_escaped(block.title)}**", *_blocks(block.blocks)]
        else:
            out.append(_line(block))
    return out


def _line(line: Line) -> str:
    return spelled(line, _escaped, lambda command: f"`{command}`", _linked)


def _linked(cell: TableCell) -> str:
    text = _escaped(cell.text).replace("|", "\\|")
    return f"[{text}]({cell.href.replace(' ', '%20')})" if cell.href else text


def _table(table: Table) -> str:
    heads = " | ".join(_escaped(head).replace("|", "\\|") for head in table.heads)
    rows = [f"| {heads} |", f"|{'---|' * len(table.heads)}"]
    rows += [f"| {' | '.join(_linked(each) for each in row)} |" for row in table.rows]
    note = f"\n\n{_escaped(table.note)}" if table.note else ""
    return f"**{_escaped(table.caption)}**\n\n" + "\n".join(rows) + note


def csv_of(table: Table) -> str:
    """Returns a table as CSV with raw values; None becomes an empty field, and an apostrophe is put in
    front of text that a spreadsheet would treat as a formula.
    """
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
