"""``roadgpt redrive``: tests of a campaign again, as folders of runs that other commands open."""

from pathlib import Path
from typing import Any

import click

from roadgpt.cli.campaigns import one_line
from roadgpt.cli.options import driver_again_option, folder, pictures_options
from roadgpt.errors import UsageError

DIGITS = 18  # of a number that a store can look for


@click.command()
@click.argument("campaign", metavar="CAMPAIGN", type=click.Path(path_type=Path))
@click.argument("tests", nargs=-1, required=True, metavar="TEST...")
@click.option("--out", type=folder, default=None, help="Folder for the runs. [default: CAMPAIGN/again]")
@click.option("--no-plot", is_flag=True, help="Draw no pictures.")
@driver_again_option
@pictures_options
def command(
    campaign: Path,
    tests: tuple[str, ...],
    out: Path | None,
    no_plot: bool,
    driver: str | None,
    axes: Any,
    picture_formats: Any,
) -> None:
    """Drive tests of a campaign again, into folders that show, view, plot and export open.

    TEST is the number of a test, as in results.csv, with its cell in front where there are several: c02/17.
    The stored design and seed give the same drive, byte for byte.

    \b
    roadgpt redrive roadgpt-runs/an-uphill-road-with-3-turns-7 17
    roadgpt view roadgpt-runs/an-uphill-road-with-3-turns-7/again/c01/runs/0017
    """
    from roadgpt.campaign.again import is_same, run_again
    from roadgpt.campaign.faults.failed import drivers_of
    from roadgpt.drive.trust import expect
    from roadgpt.report import drawing
    from roadgpt.run import write_run

    expect(driver, drivers_of(campaign), campaign)
    out = out or campaign / "again"
    draw = None if no_plot else drawing(axes, picture_formats)
    for cell, number in [_named(campaign, test) for test in tests]:
        run, result = run_again(campaign, cell, number)
        written = write_run(run, _made(out / cell), draw)
        click.echo(f"{run.outcome:<8} {cell}/{number}  {written}  {one_line(run.description)}")
        if not is_same(run, result):
            said = f"{result.outcome} in the campaign ({one_line(result.description)})"
            click.echo(
                f"roadgpt: test {number} of {cell} was {said}; another version of roadgpt or another machine "
                "drove it then",
                err=True,
            )


def _made(path: Path) -> Path:
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UsageError(f"cannot make {path}: {error.strerror}; name another folder with --out") from error
    return path


def _named(campaign: Path, test: str) -> tuple[str, int]:
    """Cell and number of a test."""
    from roadgpt.campaign.record import Record

    cell, _, number = test.rpartition("/")
    if not number.isdecimal() or len(number) > DIGITS:
        raise UsageError(f"'{one_line(test, 40)}' is no test; give its number, as 17 or c02/17")
    with Record.opened(campaign) as record:
        names = [name for (name,) in record.query("SELECT name FROM cells ORDER BY name LIMIT 3")]
        if not cell and len(names) > 1:
            raise UsageError(
                f"{campaign} has several cells; say of which one test {number} is, as {names[0]}/{number}"
            )
        return cell or names[0], int(number)
