"""``roadgpt plot``: pictures of roads that exist."""

from pathlib import Path
from typing import Any

import click

from roadgpt.cli.named import choice_of, choice_options, roads_named
from roadgpt.cli.options import (
    files_argument,
    folder,
    pictures_options,
    setup_options,
    world_of,
    world_options,
)
from roadgpt.cli.roads import run_of
from roadgpt.errors import UsageError

UNREADABLE = 2  # exit status


@click.command()
@files_argument
@choice_options
@click.option(
    "--out", type=folder, default=Path("plots"), show_default=True, help="Folder; each road gets one in it."
)
@pictures_options
@world_options("map_size")
@setup_options("geometry")
@click.option("--quiet", "-q", is_flag=True, help="Say nothing but errors.")
def command(
    files: tuple[str, ...],
    out: Path,
    axes: Any,
    picture_formats: Any,
    geometry: Any,
    quiet: bool,
    **rest: Any,
) -> int | None:
    """Draw roads that exist: from above, height over distance, curvature and grade.

    ROAD.json is a RoadGPT design, an SBFT test, a list of points [x, y] or [x, y, z], the folder or test file
    of a run, or a test of a campaign, as CAMPAIGN/c01/17; then the drive is drawn as well. The pictures of
    straight.json go into a new folder OUT/straight, or OUT/straight-2 and so on where that exists. Prints the
    names of the pictures.

    \b
    roadgpt plot DIR/runs/0001 --format pdf
    roadgpt plot CAMPAIGN --faults
    """
    from roadgpt.report import draw

    choice, world = choice_of(rest), world_of(rest)
    status = None

    def complain(error: UsageError) -> None:
        nonlocal status
        click.echo(f"roadgpt: {error}", err=True)
        status = UNREADABLE

    for each in roads_named(files, choice, complain=complain):
        try:
            run = run_of(each, world, geometry)
            place = _place(out, each.stem)
            pictures = draw(run, place, axes, picture_formats)
        except UsageError as error:
            complain(error)
            continue
        if not quiet:
            click.echo("\n".join(str(picture) for picture in pictures))
    return status


def _place(out: Path, name: str) -> Path:
    """A new folder for one road's pictures."""
    number = 1
    while True:
        place = out / (name if number == 1 else f"{name}-{number}")
        try:
            place.mkdir(parents=True)
        except FileExistsError:
            number += 1
        except OSError as error:
            raise UsageError(f"cannot make a folder in {out}: {error.strerror}; say --out FOLDER") from error
        else:
            return place
