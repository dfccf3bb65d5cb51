"""``roadgpt redrive``: tests of a campaign again, as folders of runs that other commands open."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from roadgpt.cli.campaigns import one_line
from roadgpt.cli.named import choice_of, choice_options
from roadgpt.cli.options import driver_again_option, folder, pictures_options
from roadgpt.errors import UsageError

if TYPE_CHECKING:
    from roadgpt.campaign.selection import Choice, Selection

AGAIN = "again"  # folder of a campaign


@click.command()
@click.argument("names", nargs=-1, required=True, metavar="CAMPAIGN [TEST...]")
@choice_options
@click.option("--out", type=folder, default=None, help="Folder for the runs. [default: CAMPAIGN/again]")
@click.option("--no-plot", is_flag=True, help="Draw no pictures.")
@driver_again_option
@pictures_options
def command(
    names: tuple[str, ...],
    out: Path | None,
    no_plot: bool,
    driver: str | None,
    axes: Any,
    picture_formats: Any,
    **rest: Any,
) -> None:
    """Drive tests of a campaign again, into folders of runs, and say where one ends otherwise than it did.

    TEST is the number of a test, as in results.csv, with its cell in front where there are several: c02/17.
    The stored design and seed give the same drive, byte for byte. To look at tests, no driving is needed:
    view, plot, film, show and export take CAMPAIGN/c02/17, and show the drive that the campaign kept.

    \b
    roadgpt redrive roadgpt-runs/an-uphill-road-with-3-turns-7 17
    roadgpt redrive roadgpt-runs/an-uphill-road-with-3-turns-7/c01/17
    roadgpt redrive roadgpt-runs/an-uphill-road-with-3-turns-7 --faults
    """
    from roadgpt.campaign.faults.failures import drivers_of
    from roadgpt.campaign.rerun import is_same, run_again
    from roadgpt.drive.trust import expect
    from roadgpt.report import drawing
    from roadgpt.run import write_run

    tests = _named(names, choice_of(rest))
    for folder_ in {place.folder for place in tests}:
        expect(driver, drivers_of(folder_), folder_)
    draw = None if no_plot else drawing(axes, picture_formats)
    for place in tests:
        cell, number = place.cell, place.number or 0
        run, result = run_again(place.folder, cell, number)
        home = (out or place.folder / AGAIN) / cell
        written = write_run(run, _made(home), draw)
        click.echo(f"{run.outcome:<8} {cell}/{number}  {written}  {one_line(run.description)}")
        if not is_same(run, result):
            said = f"{result.outcome} in the campaign ({one_line(result.description)})"
            click.echo(
                f"roadgpt: test {number} of {cell} was {said}; another version of roadgpt or another machine "
                "drove it then",
                err=True,
            )


def _made(path: Path) -> Path:
    from roadgpt.run.atomic import refuse_links

    refuse_links(*([path.parent] if path.parent.name == AGAIN else []), path)
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UsageError(f"cannot make {path}: {error.strerror}; name another folder with --out") from error
    return path


def _named(names: tuple[str, ...], choice: "Choice | None") -> "list[Selection]":
    """The tests that are meant: of the campaign that comes first, or each with its own."""
    from roadgpt.campaign.record import no_campaign
    from roadgpt.campaign.selection import chosen, selection_of

    first = selection_of(names[0])
    if first is None or not first.is_campaign:
        raise no_campaign(Path(names[0]))
    if first.number is None and choice is None and len(names) == 1:
        raise UsageError(
            f"say which tests of {first.said}: their numbers, as 17 or c02/17, or --worst, --faults or "
            "--failures"
        )
    out = [] if first.number is None and choice is None else chosen(first, choice)
    for name in names[1:]:
        is_number = name.rpartition("/")[2].isdecimal()
        place = (
            (selection_of(f"{first.folder}/{name}") or selection_of(name)) if is_number or choice else None
        )
        if place is None or not place.is_campaign or (place.number is None and choice is None):
            raise UsageError(f"'{one_line(name, 40)}' is no test; give its number, as 17 or c02/17")
        out += chosen(place, choice)
    if not out:
        raise UsageError(f"no test of {first.said} is one of --{choice}")
    return out
