"""Writes reports on many roads as one self-contained HTML file, and as Markdown, CSV and LaTeX.

A Page holds a short summary, sections with text, tables and figures, and information on how it was made.
``write`` writes it into a folder:

    report.html            the page, for screen (light and dark) and print; needs no scripts and no network
    report.md              the same text and tables
    tables/NAME.csv .tex   every table, as CSV with plain numbers and as LaTeX (booktabs)

Figures are SVG in the page's colours. matplotlib draws ``forest`` (shares with intervals), ``heat`` (a
matrix, or a feature map), ``lines`` and ``bars``; ``gallery`` (small maps of roads, each a link) and
``draw_site`` (the place of a failure) write SVG themselves.
"""

from pathlib import Path

from roadgpt.errors import RoadGPTError, explained
from roadgpt.report.page.html import html_of
from roadgpt.report.page.model import Page
from roadgpt.report.page.text import csv_of, latex_of, markdown_of
from roadgpt.run.atomic import refuse_links, write_whole

PAGE, TABLES = "report", "tables"


def write(page: Page, folder: Path | str) -> Path:
    """Writes ``report.html``, ``report.md`` and ``tables/`` into a folder; files of these names are replaced.

    Returns:
        The path of the HTML page.

    Raises:
        RoadGPTError: a file cannot be written.
    """
    folder = Path(folder)
    with explained(RoadGPTError, f"cannot write the report into {folder}", "name another folder"):
        refuse_links(folder / TABLES)
        (folder / TABLES).mkdir(parents=True, exist_ok=True)
        for table in page.tables():
            write_whole(folder / TABLES / f"{table.name}.csv", csv_of(table))
            write_whole(folder / TABLES / f"{table.name}.tex", latex_of(table))
        write_whole(folder / f"{PAGE}.md", markdown_of(page))
        write_whole(folder / f"{PAGE}.html", html_of(page))
    return folder / f"{PAGE}.html"
