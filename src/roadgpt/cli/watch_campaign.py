"""``roadgpt show --watch``: shows the progress of a campaign on the screen."""

import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING

from roadgpt.cli.campaigns import cell_lines, headline, outcomes_line

if TYPE_CHECKING:
    from rich.console import RenderableType

    from roadgpt.campaign.cell_status import CellStatus
    from roadgpt.campaign.status import Status

MOST_CELLS, MOST_WORKERS = 12, 16  # rows of the screen


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
    from rich.padding import Padding
    from rich.progress_bar import ProgressBar
    from rich.text import Text

    bar = ProgressBar(total=status.total or max(status.done, 1), completed=status.done)
    workers = [
        f"{lease.worker}  test {lease.number} of {lease.cell}" for lease in status.under_way[:MOST_WORKERS]
    ]
    lines = [outcomes_line(status.outcomes), "", *cell_lines(_chosen(status), width), "", *workers]
    table = Text("\n".join(lines), no_wrap=True, overflow="ellipsis")
    # without colours a bar does not fill its line, so that the next line would follow it
    return Group(Text(headline(status), style="bold"), Padding(bar), table)


def _chosen(status: "Status") -> "list[CellStatus]":
    """Returns the cells to show: first those that are being worked on, then those with most failures."""
    busy = {lease.cell for lease in status.under_way}
    return sorted(
        status.cells, key=lambda cell: (cell.name not in busy, -cell.outcomes.get("FAIL", 0), cell.name)
    )[:MOST_CELLS]
