"""``roadgpt view --format``: draws pictures of roads and drives."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from roadgpt.cli.road_names import roads_named
from roadgpt.cli.roads import run_of
from roadgpt.errors import UsageError

if TYPE_CHECKING:
    from roadgpt.campaign.selection import Choice
    from roadgpt.report import Format, Scale
    from roadgpt.road import Geometry, World

UNREADABLE = 2  # exit status
PLOTS = Path("plots")


def draw_pictures(
    files: Sequence[str],
    choice: "Choice | None",
    out: Path,
    axes: "Scale",
    formats: "Sequence[Format]",
    world: "World",
    geometry: "Geometry",
    quiet: bool,
) -> int:
    """Draws pictures of each road into a new folder named after the road, and prints their paths.

    Args:
        files, choice: As for ``roads_named``.
        out: Folder in which the new folders are made.
        axes: "equal" for axes to scale, "thesis" for the fixed ranges of RoadGPT's thesis.
        formats: Formats of the pictures: png, svg or pdf.
        world, geometry: World and geometry for road files, which do not contain them.
        quiet: Whether to print errors only.

    Returns:
        The exit status: 2 if a name could not be used (the other roads are still drawn), else 0.
    """
    from roadgpt.report import draw

    status = 0

    def complain(error: UsageError) -> None:
        nonlocal status
        click.echo(f"roadgpt: {error}", err=True)
        status = UNREADABLE

    for each in roads_named(files, choice, complain=complain):
        try:
            run = run_of(each, world, geometry)
            place = _place(out, each.stem)
            pictures = draw(run, place, axes, tuple(formats))
        except UsageError as error:
            complain(error)
            continue
        if not quiet:
            click.echo("\n".join(str(picture) for picture in pictures))
    return status


def _place(out: Path, name: str) -> Path:
    """Makes and returns a new folder for one road's pictures."""
    number = 1
    while True:
        place = out / (name if number == 1 else f"{name}-{number}")
        try:
            place.mkdir(parents=True)
        except FileExistsError:
            number += 1
        except OSError as error:
            raise UsageError(
                f"cannot make a folder in {out}: {error.strerror}; give another one with --out"
            ) from error
        else:
            return place
