"""``roadgpt show --watch``: shows the progress of a campaign on the screen."""

import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING

from roadgpt.cli.campaigns import HEAD, cell_columns, outcomes_line
from roadgpt.cli.progress import duration

if TYPE_CHECKING:
    from rich.console import RenderableType

    from roadgpt.campaign.cell_status import CellStatus
    from roadgpt.campaign.status import Status

MOST_CELLS, MOST_WORKERS = 12, 16  # rows of the screen
GAP = 2  # between columns
LEAST = 12  # letters of a description, below which it is left out


def watch_campaign(campaign: Path, once: bool = False) -> None:
    """Shows the progress of a campaign until it ends or the user presses Ctrl-C; without a terminal, shows it
    once.

    Raises:
        UsageError: The folder holds no campaign.
    """
    from rich.console import Console
    from rich.live import Live

    from roadgpt.campaign.status import status_of

    console = Console(file=sys.stdout)
    if once or not sys.stdout.isatty():
        console.print(_picture(status_of(campaign), console.width))
        return
    with Live(console=console, auto_refresh=False, screen=False) as live:
        while True:
            status = status_of(campaign)
            live.update(_picture(status, console.width), refresh=True)
            if status.is_finished:
                return
            time.sleep(1.0)


def _picture(status: "Status", width: int) -> "RenderableType":
    from rich.console import Group
    from rich.progress_bar import ProgressBar
    from rich.table import Table
    from rich.text import Text

    state = "finished" if status.is_finished else "at work" if status.is_running else "nobody is at work"
    of = "" if status.total is None else f" of {status.total:,}"
    left = f", {duration(status.seconds_left)} to go" if status.seconds_left else ""
    head = Text(f"{status.folder}: {state}", style="bold")
    pace = Text(f"{status.done:,}{of} tests, {status.rate:.1f} tests/s, {duration(status.seconds)}{left}")
    bar = ProgressBar(total=status.total or max(status.done, 1), completed=status.done)
    workers = Table(box=None, pad_edge=False, show_header=False)
    for lease in status.under_way[:MOST_WORKERS]:
        workers.add_row(Text(lease.worker), f"test {lease.number} of {lease.cell}")
    outcomes = Text(outcomes_line(status.outcomes))
    return Group(head, pace, bar, outcomes, Text(""), _cells(status, width), Text(""), workers)


def _cells(status: "Status", width: int) -> "RenderableType":
    """Returns a table with as many columns as fit on the screen; the last one is cut if need be."""
    from rich.table import Table
    from rich.text import Text

    cells = Table(box=None, pad_edge=False)
    rows = [cell_columns(cell) for cell in _chosen(status)]
    shown = 0
    for name, *texts in zip(HEAD, *rows, strict=True):
        wide = max(map(len, [name, *texts]))
        is_words = name == "what"
        if is_words:
            wide = min(wide, width)
        if width < (LEAST if is_words else wide):
            break
        cells.add_column(
            name, justify="left" if name in ("cell", "what") else "right", width=wide, no_wrap=True
        )
        width, shown = width - wide - GAP, shown + 1
    for row in rows:
        cells.add_row(*(Text(text, overflow="ellipsis") for text in row[:shown]))
    return cells


def _chosen(status: "Status") -> "list[CellStatus]":
    """Returns the cells to show: first those that are being worked on, then those with most failures."""
    busy = {lease.cell for lease in status.under_way}
    return sorted(
        status.cells, key=lambda cell: (cell.name not in busy, -cell.outcomes.get("FAIL", 0), cell.name)
    )[:MOST_CELLS]
