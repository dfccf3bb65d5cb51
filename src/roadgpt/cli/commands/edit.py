"""``roadgpt edit``: changes a road as a request in words says."""

from pathlib import Path
from typing import Any

import click

from roadgpt.cli.edit_job import EditJob, edit_road
from roadgpt.cli.leading_dash import DescribedCommand
from roadgpt.cli.option_groups import under
from roadgpt.cli.options import (
    OUTPUT,
    chat_of,
    chat_options_but,
    driver_again_option,
    folder,
    format_option,
    no_drive_option,
    no_plot_option,
    quiet_option,
    world_of,
    world_options,
)
from roadgpt.cli.screen import Screen


@click.command(cls=DescribedCommand)
@click.argument("run", metavar="RUN")
@click.argument("words", nargs=-1, required=True, metavar="CHANGE")
@click.option("--out", type=folder, default=None, help="Folder for the changed road. [default: a new one]")
@click.option(
    "--designer",
    default="planner",
    show_default=True,
    help="What changes the road: planner (by rules) or chat (a language model).",
)
@chat_options_but("repair", "strategy")
@world_options("map_size")
@driver_again_option
@no_drive_option
@no_plot_option
@format_option
@under(OUTPUT, click.option("--json", "as_json", is_flag=True, help="Print one JSON line."))
@quiet_option
def command(
    run: str,
    words: tuple[str, ...],
    out: Path | None,
    designer: str,
    driver: str | None,
    no_drive: bool,
    no_plot: bool,
    picture_formats: Any,
    as_json: bool,
    quiet: bool,
    **rest: Any,
) -> None:
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
    chat = chat_of(rest, designer=designer)
    job = EditJob(
        run,
        " ".join(words),
        out,
        designer,
        world_of(rest),
        chat=chat,
        driver=driver,
        drives=not no_drive,
        pictures=() if no_plot else picture_formats,
    )
    edit_road(job, Screen(1, as_json, quiet))
