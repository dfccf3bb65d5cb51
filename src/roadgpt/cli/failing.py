"""How commands look into failures: ``roadgpt faults``, and a campaign that has come to its end."""

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import click

from roadgpt.cli.options import together, whole

if TYPE_CHECKING:
    from roadgpt.campaign.faults import Failure, Line
    from roadgpt.campaign.faults.book import Draws
    from roadgpt.run import Run

REPEAT = 10  # disturbed drives of each failure, where nobody says how many
DRIVES = whole(1, 1000, "drives")

fault_options = together(
    click.option(
        "--faults", is_flag=True, help="At the end, look into the failures, as roadgpt faults does."
    ),
    click.option("--minimise", is_flag=True, help="The same, and look for the simplest road of each fault."),
    click.option(
        "--repeat", type=DRIVES, default=None, help=f"The same; disturbed drives of each. [default: {REPEAT}]"
    ),
)


class Look(NamedTuple):
    """How failures are looked into."""

    repeat: int = REPEAT
    minimise: bool = False
    workers: int = 1
    has_pictures: bool = True
    is_quiet: bool = False
    is_apart: bool = False
    """Standard output is for something else."""

    def say(self, text: str, is_news: bool = False) -> None:
        """Tell, unless nothing is to be said; what is news on the way goes to standard error."""
        if not self.is_quiet:
            click.echo(text, err=is_news or self.is_apart)


class _Cell(NamedTuple):
    """One cell whose failures are looked into."""

    place: Path
    name: str
    base: Path
    """Folder of what is found."""


def asked(
    faults: bool, minimise: bool, repeat: int | None, workers: int, is_quiet: bool, is_apart: bool
) -> Look | None:
    """What the ``fault_options`` of a campaign ask for; None: nothing."""
    if not faults and not minimise and repeat is None:
        return None
    # the campaign's workers may be on other machines
    here = min(workers, os.cpu_count() or 1)
    return Look(repeat or REPEAT, minimise, here, is_quiet=is_quiet, is_apart=is_apart)


def look_into_failures(place: Path, look: Look) -> None:
    """Look into all failures of a run or a campaign, and tell.

    Raises:
        UsageError: there are no roads, or a file cannot be read.
        RoadGPTError: a file cannot be written.
    """
    from roadgpt.campaign.faults import cells_of
    from roadgpt.campaign.faults.book import FOLDER

    found = 0
    try:
        with _spread(look.workers) as spread:
            for name in cells_of(place):
                found += _looked_into(_Cell(place, name, place / FOLDER / name), look, spread)
    except KeyboardInterrupt:
        click.echo(f"roadgpt: stopped; what is done is kept, go on with: roadgpt faults {place}", err=True)
        raise
    if not found:
        look.say("no road failed: there is no fault to look into")


def _looked_into(cell: _Cell, look: Look, spread: Callable[..., Any]) -> int:
    """Look into the failures of a cell; how many there are."""
    from roadgpt.campaign.faults import failed_runs, look_into, table, write_table

    found: list[Failure] = []
    runs = failed_runs(cell.place, cell.name)
    for failure in look_into(runs, cell.base, look.repeat, _draws(look.has_pictures), spread):
        found.append(failure)
        look.say(_line(failure), is_news=True)
    if not found:
        return 0
    lines = table(found)
    path = write_table(lines, cell.base)
    look.say("\n".join([*([cell.name] if cell.name else []), _summary(lines)]))
    if look.minimise:
        _minimise(cell, lines, look)
    look.say(f"table: {path}; pictures: {cell.base}/*.png")
    return len(found)


def _draws(has_pictures: bool) -> "Draws | None":
    if not has_pictures:
        return None
    from roadgpt.report.fault import draw_fault

    return draw_fault


@contextmanager
def _spread(workers: int) -> "Iterator[Callable[..., Any]]":
    """A map over so many processes."""
    if workers == 1:
        yield map
        return
    from concurrent.futures import ProcessPoolExecutor
    from multiprocessing import get_context

    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        yield pool.map


def _line(failure: "Failure") -> str:
    its = failure.stability
    return f"road {failure.number}: failed again {its.failed}/{len(its.drives)}; {failure.why.sentence}"


def _summary(lines: "list[Line]") -> str:
    """One row per fault: how often, how stable its most stable failure is, and why that one failed."""
    from roadgpt.study.chapters.saying import plural

    first = {line.fault: line for line in reversed(lines)}
    rows = [f"{'fault':>5} {'failures':>8} {'again':>7}  road  why"]
    for number in sorted(first):
        line, its = first[number], first[number].failure.stability
        again = f"{its.failed}/{len(its.drives)}"
        what = f"{line.failure.number:>4}  {line.failure.why.sentence}"
        rows.append(f"{number:>5} {line.of_it:>8} {again:>7}  {what}")
    stable = sum(line.failure.stability.is_stable for line in lines)
    rows.append(
        f"{plural(len(lines), 'failure')}, of which {stable} fail every second time or oftener; "
        f"{plural(len(first), 'fault')}"
    )
    return "\n".join(rows)


def _minimise(cell: _Cell, lines: "list[Line]", look: Look) -> None:
    """The simplest road of each fault's most stable failure, beside its picture."""
    from roadgpt.campaign.faults import failed_runs, simplest
    from roadgpt.run.folder import run_folder, write_run

    faults = {line.failure.number: line.fault for line in reversed(lines)}
    first = {fault: number for number, fault in faults.items()}
    for run in failed_runs(cell.place, cell.name, {*first.values()}):
        place = cell.base / f"simplest-{faults[run.index]:02d}"
        if run.design is None or _is_there(run_folder(place, run.index), run):
            continue
        found = simplest(run)
        written = write_run(found.run, place)
        look.say(f"fault {faults[run.index]}: {found.sentence}: {written}", is_news=True)


def _is_there(folder: Path, failure: "Run") -> bool:
    """Does the simplest road of this failure lie there already?"""
    from roadgpt.run.folder import is_run, read_run

    if not is_run(folder):
        return False
    there = read_run(folder)
    return (there.request, there.seed) == (failure.request, failure.seed)
