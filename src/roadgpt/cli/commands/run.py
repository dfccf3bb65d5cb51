"""``roadgpt run``: designs, checks, drives, judges and draws roads from a description."""

from pathlib import Path
from typing import Any

import click

from roadgpt.cli.beamng import beamng_options
from roadgpt.cli.junit import junit_option
from roadgpt.cli.leading_dash import DescribedCommand
from roadgpt.cli.options import (
    ROADS,
    SEED,
    chat_of,
    chat_options,
    folder,
    formats_option,
    no_drive_option,
    no_plot_option,
    pictures_options,
    screen_options,
    setup_options,
    world_of,
    world_options,
)
from roadgpt.cli.run_job import RunJob, carry_out
from roadgpt.cli.screen import Screen


@click.command(cls=DescribedCommand)
@click.argument("words", nargs=-1, required=True, metavar="DESCRIPTION")
@click.option("-n", "--roads", type=ROADS, default=1, show_default=True, help="Number of roads.")
@click.option("--seed", type=SEED, default=None, help="The same seed gives the same roads. [default: random]")
@click.option("--out", type=folder, default=None, help="Folder for the runs. [default: a new one]")
@setup_options("reader", "designer", "driver", "simulator", "keep_driving")
@world_options()
@setup_options("geometry", "rules")
@no_drive_option
@no_plot_option
@pictures_options
@formats_option("--export", is_settable=True)
@chat_options
@beamng_options
@junit_option
@screen_options
def command(
    words: tuple[str, ...], roads: int, as_json: bool, quiet: bool, verbose: bool, **rest: Any
) -> None:
    """Make roads from a description: design, check, drive and judge them.

    \b
    roadgpt run "an uphill road with 3 turns" -n 5
    roadgpt run "two hairpins, then a straight" -n 20 --seed 7 --friction 0.6
    roadgpt run "a winding road" --designer chat --max-cost 0.50

    \b
    Exit status:
      0  every road has an outcome, even if it is FAIL, INVALID or ERROR
      2  the description or an option cannot be used
      3  nothing could be designed
      4  a language model could not be used, or its token or cost limit was hit
    Roads finished before an error are saved in full.
    """
    carry_out(job_of(" ".join(words), roads, **rest), Screen(roads, as_json, quiet, verbose))


def job_of(
    words: str,
    roads: int,
    seed: int | None,
    out: Path | None,
    no_drive: bool,
    no_plot: bool,
    axes: Any,
    picture_formats: Any,
    formats: tuple[str, ...],
    junit: Path | None,
    **rest: Any,
) -> RunJob:
    """Returns the job that the values of the options describe.

    Raises:
        UsageError: The options contradict each other, or a setting cannot be used.
    """
    from roadgpt.run import Setup

    world = world_of(rest)
    chat = chat_of(rest, rest["reader"], rest["designer"])
    setup = Setup(drives=not no_drive, chat=chat, **rest)
    pictures = () if no_plot else picture_formats
    return RunJob(words, roads, world, setup, seed, out, axes, pictures, formats, junit)


def usual_job(words: str, roads: int) -> RunJob:
    """Returns the job of ``roadgpt run`` without options: with the defaults and the settings of configuration
    files.

    Raises:
        UsageError: A setting cannot be used.
    """
    parent = click.get_current_context(silent=True)
    values = command.make_context("run", ["-n", str(roads), "--", words], parent).params
    for name in ("words", "roads", "as_json", "quiet", "verbose"):
        values.pop(name)
    return job_of(words, roads, **values)
