"""``roadgpt run``: from a description to roads that were designed, checked, driven, judged and drawn."""

from pathlib import Path
from typing import Any

import click

from roadgpt.cli.beamng import beamng_options
from roadgpt.cli.dashes import DescribedCommand
from roadgpt.cli.junit import junit_option
from roadgpt.cli.options import (
    ROADS,
    SEED,
    chat_of,
    chat_options,
    folder,
    formats_option,
    pictures_options,
    screen_options,
    setup_options,
    world_of,
    world_options,
)
from roadgpt.cli.screen import Screen
from roadgpt.cli.work import Wish, work_off


@click.command(cls=DescribedCommand)
@click.argument("words", nargs=-1, required=True, metavar="DESCRIPTION")
@click.option("-n", "--roads", type=ROADS, default=1, show_default=True, help="How many roads.")
@click.option("--seed", type=SEED, default=None, help="The same seed gives the same roads. [default: drawn]")
@click.option("--out", type=folder, default=None, help="Folder for the runs. [default: a new one]")
@setup_options("reader", "designer", "driver", "simulator", "keep_driving")
@world_options()
@setup_options("geometry", "rules")
@click.option("--no-drive", is_flag=True, help="Design and check only.")
@click.option("--no-plot", is_flag=True, help="Draw no pictures.")
@pictures_options
@formats_option("--export")
@chat_options
@beamng_options
@junit_option
@screen_options
def command(
    words: tuple[str, ...],
    roads: int,
    seed: int | None,
    out: Path | None,
    no_drive: bool,
    no_plot: bool,
    axes: Any,
    picture_formats: Any,
    formats: tuple[str, ...],
    junit: Path | None,
    as_json: bool,
    quiet: bool,
    verbose: bool,
    **rest: Any,
) -> None:
    """Design, check, drive and judge roads from a description.

    The exit status is 0 when all roads were worked off, whatever became of them, 2 when something that was
    typed cannot be used, 3 when nothing could be designed, 4 when a language model could not be asked or a
    limit of tokens or money was reached; roads before that are complete.

    \b
    roadgpt run "an uphill road with 3 turns" -n 5
    roadgpt run "two hairpins, then a long straight" -n 20 --seed 7 --friction 0.6 --json
    roadgpt run "a winding road" --designer chat --model gpt-5-mini --max-cost 0.50
    """
    from roadgpt.run import Setup

    world = world_of(rest)
    chat = chat_of(rest, rest["reader"], rest["designer"])
    setup = Setup(drives=not no_drive, chat=chat, **rest)
    pictures = () if no_plot else picture_formats
    wish = Wish(" ".join(words), roads, world, setup, seed, out, axes, pictures, formats, junit)
    work_off(wish, Screen(roads, as_json, quiet, verbose))
