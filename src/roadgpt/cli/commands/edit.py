"""``roadgpt edit``: changes a road that exists, by words."""

from pathlib import Path
from typing import Any

import click

from roadgpt.cli.changing import Wish, change
from roadgpt.cli.dashes import DescribedCommand
from roadgpt.cli.options import (
    chat_of,
    chat_options_but,
    driver_again_option,
    folder,
    format_option,
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
    help="Who changes the road: planner, by rules; chat, a language model.",
)
@chat_options_but("repair", "strategy")
@world_options("map_size")
@driver_again_option
@click.option("--no-drive", is_flag=True, help="Change and check only.")
@click.option("--no-plot", is_flag=True, help="Draw no pictures.")
@format_option
@click.option("--json", "as_json", is_flag=True, help="One JSON line on standard output.")
@click.option("--quiet", "-q", is_flag=True, help="Say nothing but errors.")
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
    """Change a road that exists, by words.

    RUN is the folder of a run, a folder of runs that holds one, or a RoadGPT design. The changed road goes
    into a new folder; what the words do not speak of stays as it was, number by number. World, driver and
    rules are those of the run; --map-size is for a design from a file.

    \b
    roadgpt edit my-roads/runs/0001 "make the second turn sharper and the end downhill"
    roadgpt edit design.json "add a hairpin after the first turn, then remove the last straight"

    The exit status is 2 when the words cannot be read, name what is not on the road, or ask for what no valid
    road can be; then nothing is written.
    """
    chat = chat_of(rest, designer=designer)
    wish = Wish(
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
    change(wish, Screen(1, as_json, quiet))
