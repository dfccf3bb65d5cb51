"""``roadgpt faults``: why roads failed, how often they fail again, and which failures are one fault."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import click

from roadgpt.cli.options import folder, whole

if TYPE_CHECKING:
    from roadgpt.campaign.faults import Failure, Line
    from roadgpt.campaign.faults.book import Draws


@click.command()
@click.argument("place", type=folder, metavar="DIR")
@click.option(
    "--repeat", type=whole(1, 1000, "drives"), default=10, show_default=True, help="Disturbed drives of each."
)
@click.option("--minimise", is_flag=True, help="Also look for the simplest road that fails alike, per fault.")
@click.option("-j", "workers", type=whole(1, 256, "processes"), default=1, show_default=True)
@click.option("--no-plot", is_flag=True, help="Draw no pictures.")
@click.option("--quiet", "-q", is_flag=True, help="Say nothing but errors.")
def command(place: Path, repeat: int, minimise: bool, workers: int, no_plot: bool, quiet: bool) -> None:
    """Look into the failures of a run or a campaign: why, how often again, and how many faults they are.

    Each failing road is driven again and again with friction, start and the age of what the driver sees off
    a little. Failures whose 60 m of road around the departure are alike are one fault. DIR/faults gets a
    picture and a sentence of each, and faults.csv. What was done before is not done again.

    \b
    roadgpt faults roadgpt-runs/hairpins-7
    roadgpt faults roadgpt-runs/hairpins-7 --repeat 30 --minimise -j 2
    """
    from roadgpt.campaign.faults import cells_of
    from roadgpt.campaign.faults.book import FOLDER

    found = 0
    with _spread(workers) as spread:
        for cell in cells_of(place):
            work = _Work(place, cell, place / FOLDER / cell, repeat, _draws(not no_plot), spread, quiet)
            found += _looked_into(work, minimise)
    if not found:
        click.echo("no road failed: there is no fault to look into")


class _Work(NamedTuple):
    """What is to be done for one cell."""

    place: Path
    cell: str
    base: Path
    repeat: int
    draw: "Draws | None"
    spread: "Callable[..., Any]"
    quiet: bool


def _looked_into(work: _Work, minimise: bool) -> int:
    """Look into the failures of a cell, and tell; how many there are."""
    from roadgpt.campaign.faults import failed_runs, look_into, table, write_table

    found: list[Failure] = []
    runs = failed_runs(work.place, work.cell)
    for failure in look_into(runs, work.base, work.repeat, work.draw, work.spread):
        found.append(failure)
        if not work.quiet:
            click.echo(_line(failure), err=True)
    if not found:
        return 0
    lines = table(found)
    path = write_table(lines, work.base)
    if not work.quiet:
        click.echo("\n".join([*([work.cell] if work.cell else []), _summary(lines)]))
    if minimise:
        _minimise(work, lines)
    click.echo(f"{path}" if work.quiet else f"table: {path}; pictures: {work.base}/*.png")
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
    first = {line.fault: line for line in reversed(lines)}
    rows = [f"{'fault':>5} {'failures':>8} {'again':>7}  road  why"]
    for number in sorted(first):
        line, its = first[number], first[number].failure.stability
        again = f"{its.failed}/{len(its.drives)}"
        what = f"{line.failure.number:>4}  {line.failure.why.sentence}"
        rows.append(f"{number:>5} {line.of_it:>8} {again:>7}  {what}")
    stable = sum(line.failure.stability.share >= 0.5 for line in lines)
    rows.append(
        f"{len(lines)} failures, {stable} of them fail every second time or oftener; {len(first)} faults"
    )
    return "\n".join(rows)


def _minimise(work: _Work, lines: "list[Line]") -> None:
    """The simplest road of each fault's most stable failure, beside its picture."""
    from roadgpt.campaign.faults import failed_runs, simplest
    from roadgpt.run.folder import write_run

    chosen = {line.fault: line.failure.number for line in reversed(lines)}
    wanted = {number: fault for fault, number in chosen.items()}
    for run in failed_runs(work.place, work.cell):
        fault = wanted.get(run.index)
        if fault is None or run.design is None:
            continue
        found = simplest(run)
        written = write_run(found.run, work.base / f"simplest-{fault:02d}")
        if not work.quiet:
            click.echo(f"fault {fault}: {found.sentence}: {written}", err=True)
