"""Prints the progress of a running campaign, and its results."""

import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from roadgpt.cli.next_steps import lines, of_status
from roadgpt.cli.progress import duration, progress
from roadgpt.cli.result_row import COLOURS, driver_and_oracle, metres
from roadgpt.cli.streams import apart, resumable
from roadgpt.errors import command_line

if TYPE_CHECKING:
    from rich.console import RenderableType

    from roadgpt.campaign.faults.fault import Faults
    from roadgpt.campaign.gate import Gate
    from roadgpt.campaign.scheduler import Progress
    from roadgpt.campaign.status import CellStatus, Status

COMPARED = 500  # largest number of failures, evenly spread, that are grouped (if untested): under a second
MOST_CELLS = 40  # largest number of cells that are shown one by one
HEAD = ("cell", "done", "pass", "fail", "other", "least margin", "what")
GAP = "  "  # between columns
LEAST = 12  # letters of the last column, below which it is left out
LONGEST = 60  # letters of a description, in a line of a table
MOST_WATCHED, MOST_WORKERS = 12, 16  # rows of the screen


def watch(folder: Path, steps: "Iterator[Progress]", as_json: bool, quiet: bool, gate: "Gate") -> None:
    """Runs a campaign, shows its progress and prints its results; after Ctrl-C, prints how to resume it."""
    from roadgpt.campaign.folder_record import is_store
    from roadgpt.campaign.status import status_of
    from roadgpt.cli.repeat_commands import to_resume

    advice = f"finished tests are kept; continue with: {to_resume(folder)}"
    with resumable(advice), progress("tests", None, quiet, has_lines=False) as tell:
        for step in apart(steps):
            tell(step.done, total=step.total, rate=outcomes_line(step.outcomes))
    status = status_of(folder)
    found = None if quiet and not as_json else faults_of(status)
    gate.add_folder(folder)
    if as_json:
        click.echo(as_line(status, found, gate))
    elif not quiet:
        for line in told(status, found):
            click.echo(line)
        tables = f"tables: {folder / 'results.csv'} and {folder / 'cells.csv'}"
        click.echo(tables if is_store(folder) else f"tests and tables: {folder}")
    if gate.remark and not quiet:
        click.echo(gate.remark, err=as_json)


def faults_of(status: "Status") -> "Faults | None":
    """Returns the distinct faults of a campaign; None if no test was driven. Before ``roadgpt faults``
    has tried small changes, returns groups of similar failures among at most ``COMPARED`` failures.
    """
    from roadgpt.campaign.faults.fault import faults_in

    if not status.outcomes.get("PASS") and not status.outcomes.get("FAIL"):
        return None
    return faults_in(Path(status.folder), COMPARED)


def as_line(status: "Status", found: "Faults | None", gate: "Gate | None" = None) -> str:
    """Returns a campaign's status as one line of JSON; ``gate`` has received its tests."""
    import json

    counts = found and {
        "faults": found.distinct if found.is_tested else None,
        "groups": len(found.alone) or len(found.them) - found.distinct,
        "failures": found.failures,
        "compared": found.compared,
    }
    judged = {"gate": gate.sentence, "worse": gate.worse} if gate else {}
    return json.dumps({**status.to_json(), "distinct": counts, **judged})


def outcomes_line(outcomes: Mapping[str, int]) -> str:
    """Returns the number of tests with each outcome as text, such as '120 PASS, 31 FAIL'."""
    names = [*COLOURS, *sorted(outcomes.keys() - COLOURS.keys())]
    return ", ".join(f"{outcomes[name]:,} {name}" for name in names if outcomes.get(name)) or "nothing yet"


def told(status: "Status", found: "Faults | None") -> Iterator[str]:
    """Yields a campaign's status as lines of text: progress, distinct faults, outcomes, and what to do
    next.
    """
    from roadgpt.campaign.folder_record import setups_of
    from roadgpt.cli.repeat_commands import to_resume
    from roadgpt.run.model import permissions

    yield headline(status)
    if found is not None and found.failures:
        yield f"  {found.headline}"
    yield f"  {outcomes_line(status.outcomes)}"
    if other := sum(cell.handed_over for cell in status.cells):
        yield f"  in {other:,} FAIL the driver had handed over: they are not its failures"
    if {"PASS", "FAIL"} & status.outcomes.keys():
        yield f"  {driver_and_oracle([cell.driver for cell in status.cells], status.cells[0].oracle)}"
    if found is not None and found.them:
        first = "" if found.is_tested else "how many faults these are, "
        look = command_line("faults", status.folder, *permissions(setups_of(Path(status.folder))))
        yield f"  {first}why, how often again, and pictures: {look}"
    if status.tokens:
        yield f"  language model: {status.tokens:,} tokens, {status.cost_usd:.4f} USD"
    if not status.is_finished and not status.is_running:
        yield f"  continue with: {to_resume(Path(status.folder))}"
    yield from cell_lines(status.cells[:MOST_CELLS])
    if len(status.cells) > MOST_CELLS:
        yield f"and {len(status.cells) - MOST_CELLS:,} more cells; --json tells of all"
    yield from outside_lines(status)
    yield from lines(of_status(status))
    yield from [cell.remark for cell in status.cells[:MOST_CELLS] if cell.remark]


def outside_lines(status: "Status") -> Iterator[str]:
    """Yields one line about passed tests with the car partly or mostly outside its lane, if there are any."""
    passed = status.outcomes.get("PASS", 0)
    partly = sum(cell.partly_outside for cell in status.cells)
    mostly = sum(cell.mostly_outside for cell in status.cells)
    if not partly + mostly:
        return
    from roadgpt.verdict import percent

    share = max(cell.max_oob or 0.0 for cell in status.cells)
    far = [cell.beyond for cell in status.cells if cell.beyond is not None]
    beyond = f"{max(far):.2f} m" if far else "an unknown distance (an older version wrote this store)"
    yield (
        f"of {passed:,} PASS, {partly:,} were partly and {mostly:,} mostly outside their lane, within the "
        f"tolerance: at most {percent(share)} of the car, {beyond} beyond the marking"
    )


def headline(status: "Status") -> str:
    """Returns the state of a campaign as one line: its folder, number of tests, running time and time
    left."""
    state = "finished" if status.is_finished else "at work" if status.is_running else "interrupted"
    of = "" if status.total is None else f" of {status.total:,}"
    pace = f", {status.rate:.1f} tests/s" if status.rate else ""
    left = status.seconds_left if status.rate and status.is_running else None
    more = f", {duration(left)} to go" if left else ""
    return f"{status.folder}: {state}, {status.done:,}{of} tests in {duration(status.seconds)}{pace}{more}"


def cell_lines(cells: "Sequence[CellStatus]", width: int = 10_000) -> list[str]:
    """Returns a table with a line for each cell; a column that ends beyond ``width`` is left out.

    A cell is one combination of the campaign's descriptions, designers, drivers and other settings. The
    last column counts as ``LEAST`` characters wide, so longer texts of this column extend beyond ``width``.
    """
    rows = [HEAD, *map(_columns, cells)]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    widths[-1] = LEAST
    ends = [sum(widths[: n + 1]) + n * len(GAP) for n in range(len(HEAD))]
    shown = sum(end <= width for end in ends)
    return [
        GAP.join(
            text.rjust(wide) if name not in (HEAD[0], HEAD[-1]) else text.ljust(wide)
            for name, text, wide in zip(HEAD[:shown], row, widths, strict=False)
        ).rstrip()
        for row in rows
    ]


def _columns(cell: "CellStatus") -> tuple[str, ...]:
    """Returns one cell's row in the table of cells, in the order of ``HEAD``."""
    passed, failed = cell.outcomes.get("PASS", 0), cell.outcomes.get("FAIL", 0)
    margin = "-" if cell.least_margin is None else metres(cell.least_margin)
    words = one_line(cell.words, LONGEST) or "any road"
    what = f"{words} ({one_line(cell.driver)}, {cell.generator}, seed {cell.seed})"
    why = f"; {one_line(cell.closed)}" if cell.closed else ""
    counts = (cell.done, passed, failed, cell.done - passed - failed)
    return (cell.name or "-", *(f"{count:,}" for count in counts), margin, what + why)


def one_line(text: str, most: int = 300) -> str:
    """Returns a text without line breaks and control characters, cut after ``most`` characters."""
    from roadgpt.chat.strict_json import plain

    return plain(text, most)


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
    )[:MOST_WATCHED]
