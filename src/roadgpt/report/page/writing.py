"""Writes a Page into a folder."""

from pathlib import Path

from roadgpt.errors import RoadGPTError
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
    try:
        refuse_links(folder / TABLES)
        (folder / TABLES).mkdir(parents=True, exist_ok=True)
        for table in page.tables():
            write_whole(folder / TABLES / f"{table.name}.csv", csv_of(table))
            write_whole(folder / TABLES / f"{table.name}.tex", latex_of(table))
        write_whole(folder / f"{PAGE}.md", markdown_of(page))
        write_whole(folder / f"{PAGE}.html", html_of(page))
    except OSError as error:
        raise RoadGPTError(
            f"cannot write the report into {folder}: {error.strerror or error}; name another folder"
        ) from error
    return folder / f"{PAGE}.html"
