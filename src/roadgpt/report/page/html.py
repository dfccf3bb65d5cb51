"""Writes a Page as one HTML file that needs no other file."""

from html import escape
from pathlib import Path

from roadgpt.report.page.model import (
    Block,
    Cards,
    Details,
    Figure,
    Line,
    Page,
    Section,
    Table,
    TableCell,
    spelled,
)

STYLE = Path(__file__).parent / "style.css"
SHORT = 24  # letters; a shorter cell is not broken into lines
MANY = 9  # columns; if there are more, they are set closer together
TOTAL = ' class="total"'
# The content security policy: the page runs no script and fetches nothing.
POLICY = "default-src 'none'; style-src 'unsafe-inline'; img-src data:"


def html_of(page: Page) -> str:
    """Returns the whole page, to be written as UTF-8; the same Page gives the same text."""
    lead = f'<p class="lead">{escape(page.lead)}</p>' if page.lead else ""
    summary = "".join(f"<li>{_line(line)}</li>" for line in page.summary)
    nav = "".join(f'<a href="#s{n}">{escape(s.title)}</a>' for n, s in enumerate(page.sections, 1))
    sections = "\n".join(_section(number, section) for number, section in enumerate(page.sections, 1))
    return (
        "<!doctype html>\n"
        '<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f'<meta http-equiv="Content-Security-Policy" content="{POLICY}">'
        '<meta name="color-scheme" content="light dark">'
        f"<title>{escape(page.title)}</title><style>\n{STYLE.read_text(encoding='utf-8')}</style></head>\n"
        f"<body><main>\n<header><h1>{escape(page.title)}</h1>{lead}</header>\n"
        f'<ul class="summary">{summary}</ul>\n<nav>{nav}</nav>\n{sections}\n{_card(page)}'
        "</main></body></html>\n"
    )


def _section(number: int, section: Section) -> str:
    blocks = "\n".join(_block(block) for block in section.blocks)
    return f'<section id="s{number}"><h2>{escape(section.title)}</h2>\n{blocks}\n</section>'


def _block(block: Block) -> str:
    if isinstance(block, Table):
        return _table(block)
    if isinstance(block, Figure):
        return (
            f'<figure><div class="wide">{block.svg}</div>'
            f"<figcaption>{escape(block.caption)}</figcaption></figure>"
        )
    if isinstance(block, Cards):
        cards = (
            f"<article>{card.svg}<h3>{_line(card.title)}</h3>{''.join(map(_block, card.lines))}</article>"
            for card in block.cards
        )
        return f'<div class="cards">{"".join(cards)}</div>'
    if isinstance(block, Details):
        inside = "\n".join(_block(each) for each in block.blocks)
        return f"<details><summary>{escape(block.title)}</summary>\n{inside}\n</details>"
    return f"<p>{_line(block)}</p>"


def _line(line: Line) -> str:
    return spelled(line, escape, lambda command: f"<code>{escape(command)}</code>", _anchored)


def _anchored(cell: TableCell) -> str:
    text = escape(cell.text)
    return f'<a href="{escape(cell.href)}">{text}</a>' if cell.href else text


def _table(table: Table) -> str:
    numeric = table.columns_with_numbers()
    heads = "".join(
        f'<th scope="col"{_class(is_number)}>{escape(head)}</th>'
        for head, is_number in zip(table.heads, numeric, strict=True)
    )
    rows = []
    for number, row in enumerate(table.rows, 1):
        cells = "".join(
            f"<td{_class(is_number, len(each.text) <= SHORT)}>{_anchored(each)}</td>"
            for each, is_number in zip(row, numeric, strict=True)
        )
        is_total = table.has_total and number == len(table.rows)
        rows.append(f"<tr{TOTAL if is_total else ''}>{cells}</tr>")
    note = f'<p class="note">{escape(table.note)}</p>' if table.note else ""
    kind = "table many" if len(table.heads) > MANY else "table"
    return (
        f'<div class="{kind}"><p class="caption">{escape(table.caption)}</p>'
        f'<div class="wide"><table aria-label="{escape(table.caption)}">'
        f"<thead><tr>{heads}</tr></thead><tbody>\n{chr(10).join(rows)}\n</tbody></table></div>{note}</div>"
    )


def _class(is_number: bool, is_short: bool = False) -> str:
    return ' class="n"' if is_number else ' class="short"' if is_short else ""


def _card(page: Page) -> str:
    if not page.card:
        return ""
    rows = "".join(f"<dt>{escape(name)}</dt><dd>{_line(value)}</dd>" for name, value in page.facts())
    return f'<section class="card"><h2>How this was made</h2><dl>{rows}</dl></section>\n'
