"""``roadgpt drive``: drive roads that exist."""

from typing import TYPE_CHECKING, Any

import click

from roadgpt.cli.options import (
    SEED,
    files_argument,
    screen_options,
    setup_options,
    world_of,
    world_options,
)
from roadgpt.cli.rows import Row, row_of, unreadable
from roadgpt.cli.screen import Screen
from roadgpt.errors import PartError, UsageError

if TYPE_CHECKING:
    from roadgpt.road import World
    from roadgpt.run.model import Setup

UNREADABLE = 2  # exit status


@click.command()
@files_argument
@click.option("--seed", type=SEED, default=1, show_default=True, help="Handed to the driver.")
@world_options()
@setup_options("driver", "simulator", "keep_driving", "geometry", "rules")
@screen_options
def command(
    files: tuple[str, ...],
    seed: int,
    as_json: bool,
    quiet: bool,
    verbose: bool,
    **rest: Any,
) -> int:
    """Drive roads that exist.

    ROAD.json is a RoadGPT design, an SBFT test, or a list of points [x, y] or [x, y, z]. A road that the
    rules object to is INVALID and is not driven. The exit status is 0 when all roads could be read.
    """
    from roadgpt.run import Setup, roll_call

    world = world_of(rest)
    setup = Setup(**rest)
    roll_call(setup)  # a driver that does not exist is told of before any road is looked at
    with Screen(len(files), as_json, quiet, verbose) as screen:
        for file in files:
            try:
                screen.row(_driven(screen, file, seed, world, setup))
            except PartError:
                raise
            except UsageError as error:
                screen.row(unreadable(file, error))
        screen.close()
    return UNREADABLE if any(row.cause == "unreadable" for row in screen.rows) else 0


def _driven(screen: Screen, file: str, seed: int, world: "World", setup: "Setup") -> Row:
    from roadgpt.road import read_blueprint
    from roadgpt.run import prove

    blueprint, remarks = read_blueprint(file)
    for remark in remarks:
        screen.say(f"{file}: {remark}")
    run = prove(blueprint, seed, world, setup)
    screen.detail(f"{file}: {run.description}")
    return row_of(run, file)
