"""``roadgpt edit``: changes a road as a request in words says."""

from typing import Any

import click

from roadgpt.cli.edit_job import EditJob, edit_road
from roadgpt.cli.option import OUTPUT, Option, named
from roadgpt.cli.option_groups import GroupedCommand
from roadgpt.cli.options import (
    CHAT_WITHOUT_DRAFTS,
    DRIVER_AGAIN,
    FORMAT,
    NO_DRIVE,
    NO_PLOT,
    QUIET,
    WORLD,
    chat_of,
    json_option,
    out,
    pictures_of,
    world_of,
)  # fmt: skip
from roadgpt.cli.screen import Screen

PARAMETERS = (
    click.Argument(["run"], metavar="RUN"),
    click.Argument(["words"], nargs=-1, required=True, metavar="CHANGE"),
    out("Folder for the changed road. [default: a new one]"),
    Option(
        "--designer", "What changes the road: planner (by rules) or chat (a language model).", str, "planner"
    ),
    *CHAT_WITHOUT_DRAFTS,
    *named(WORLD, "map_size"),
    *(DRIVER_AGAIN, NO_DRIVE, NO_PLOT, FORMAT),
    *(json_option("Print one JSON line.", heading=OUTPUT), QUIET),
)


@click.command(cls=GroupedCommand, params=[*PARAMETERS])
def command(run: str, words: tuple[str, ...], as_json: bool, quiet: bool, **rest: Any) -> None:
    """Change a road with a request in plain words.

    RUN is a run, a folder that holds one run, or a file with a RoadGPT design. The changed road is written
    into a new folder. Everything that the request does not refer to stays the same. World, driver and rules
    are those of the run; --map-size applies only to a design from a file.

    \b
    roadgpt edit my-roads/runs/0001 "make the second turn sharper and the end downhill"
    roadgpt edit design.json "add a hairpin after the first turn, then remove the last straight"

    The exit status is 2 if the words cannot be read, refer to something that is not on the road, or ask for
    a road that cannot be valid. In these cases nothing is written.
    """
    job = EditJob(
        run,
        " ".join(words),
        world=world_of(rest),
        chat=chat_of(rest, designer=rest["designer"]),
        pictures=pictures_of(rest),
        drives=not rest.pop("no_drive"),
        **rest,
    )
    edit_road(job, Screen(1, as_json, quiet))
