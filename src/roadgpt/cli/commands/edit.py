"""``roadgpt edit``: changes a road as a request in words says."""

from typing import Any

import click

from roadgpt.cli import options
from roadgpt.cli.edit_job import EditJob, edit_road
from roadgpt.cli.option import Argument, Heading, Option, named
from roadgpt.cli.option_groups import GroupedCommand
from roadgpt.cli.screen import Screen

PARAMETERS = (
    Argument("run", "RUN", "Name the folder of a run, or the file of a design."),
    Argument("words...", "CHANGE", 'Say what to change: roadgpt edit RUN "make the second turn sharper"'),
    options.out("Folder for the changed road. [default: a new one]"),
    Option(
        "--designer", "What changes the road: planner (by rules) or chat (a language model).", str, "planner"
    ),
    *options.CHAT_WITHOUT_DRAFTS,
    *named(options.WORLD, "map_size"),
    *(options.DRIVER_AGAIN, options.NO_DRIVE, options.NO_PLOT, options.FORMAT),
    *(options.json_option("Print one JSON line.", heading=Heading.OUTPUT), options.QUIET),
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
        world=options.world_of(rest),
        chat=options.chat_of(rest, designer=rest["designer"]),
        pictures=options.pictures_of(rest),
        drives=not rest.pop("no_drive"),
        **rest,
    )
    edit_road(job, Screen(1, as_json, quiet))
