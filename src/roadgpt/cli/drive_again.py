"""``roadgpt drive --again``: drives tests of a campaign again, and writes them as runs."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from roadgpt.cli.campaigns import one_line
from roadgpt.cli.roads import made
from roadgpt.errors import UsageError

if TYPE_CHECKING:
    from roadgpt.campaign.selection import Choice, Selection
    from roadgpt.report import Format, Scale

AGAIN = "again"  # folder of a campaign


def drive_again(
    names: Sequence[str],
    choice: "Choice | None",
    out: Path | None,
    driver: str | None,
    axes: "Scale",
    formats: "tuple[Format, ...]",
) -> None:
    """Drives tests of a campaign again, writes their runs, and prints which results differ from the stored
    ones.

    Args:
        names: A campaign and numbers of its tests, or tests with the folders of their campaigns.
        choice: Which tests to drive if a name means a whole campaign.
        out: Folder for the runs; None: ``again`` in the campaign's folder.
        driver: The campaign's driver as given with ``--driver``; None if it was not given.
        axes: "equal" for axes to scale, "thesis" for the fixed ranges of RoadGPT's thesis.
        formats: Formats of the pictures; none are drawn if empty.

    Raises:
        UsageError: A name is wrong, or the driver is not that of the campaign.
    """
    from roadgpt.campaign.faults.failures import drivers_of
    from roadgpt.campaign.rerun import is_same, run_again
    from roadgpt.drive.permission import check_named_driver
    from roadgpt.report import drawing
    from roadgpt.run import write_run

    tests = _named(names, choice)
    for folder_ in {place.folder for place in tests}:
        check_named_driver(driver, drivers_of(folder_), folder_)
    draw = drawing(axes, formats) if formats else None
    for place in tests:
        cell, number = place.cell, place.number or 0
        run, result = run_again(place.folder, cell, number)
        home = (out or place.folder / AGAIN) / cell
        written = write_run(run, _made(home), draw)
        click.echo(f"{run.outcome:<8} {cell}/{number}  {written}  {one_line(run.description)}")
        if not is_same(run, result):
            said = f"{result.outcome} in the campaign ({one_line(result.description)})"
            click.echo(
                f"roadgpt: test {number} of {cell} was {said}; it was driven with another version of roadgpt "
                "or on another machine",
                err=True,
            )


def _made(path: Path) -> Path:
    from roadgpt.run.atomic import refuse_links

    refuse_links(*([path.parent] if path.parent.name == AGAIN else []), path)
    return made(path)


def _named(names: Sequence[str], choice: "Choice | None") -> "list[Selection]":
    """Returns the tests that the names mean; numbers belong to the campaign that comes first."""
    from roadgpt.campaign.record import no_campaign
    from roadgpt.campaign.selection import chosen, selection_of

    first = selection_of(names[0])
    if first is None or not first.is_campaign:
        raise no_campaign(Path(names[0]))
    if first.number is None and choice is None and len(names) == 1:
        raise UsageError(
            f"say which tests of {first.said}: their numbers, such as 17 or c02/17, or --worst, --faults or "
            "--failures"
        )
    out = [] if first.number is None and choice is None else chosen(first, choice)
    for name in names[1:]:
        is_number = name.rpartition("/")[2].isdecimal()
        place = (
            (selection_of(f"{first.folder}/{name}") or selection_of(name)) if is_number or choice else None
        )
        if place is None or not place.is_campaign or (place.number is None and choice is None):
            raise UsageError(f"'{one_line(name, 40)}' is not a test; give its number, such as 17 or c02/17")
        out += chosen(place, choice)
    if not out:
        raise UsageError(f"{first.said} has no test for --{choice}")
    return out
