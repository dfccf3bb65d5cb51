"""``roadgpt run``: designs, checks, drives, judges and draws roads from a description."""

from typing import Any

import click

from roadgpt.cli import options
from roadgpt.cli.option import Heading, Option, named
from roadgpt.cli.option_groups import GroupedCommand
from roadgpt.cli.option_types import ROADS
from roadgpt.cli.run_job import RunJob, carry_out
from roadgpt.cli.screen import Screen

OPTIONS = (
    Option("-n --roads", "Number of roads.", ROADS, 1),
    options.seed("The same seed gives the same roads. [default: random]"),
    options.out("Folder for the runs. [default: a new one]"),
    *named(options.SETUP, "reader", "designer", "driver", "simulator", "keep_driving"),
    *options.WORLD,
    *named(options.SETUP, "geometry", "rules"),
    *(options.NO_DRIVE, options.NO_PLOT, options.AXES, options.FORMAT),
    options.formats_option(
        "--export formats", "Also write road files: opendrive, csv, ...", heading=Heading.FILES, table="run"
    ),
    *(*options.CHAT, *options.BEAMNG, options.JUNIT, *options.SCREEN),
)


@click.command(cls=GroupedCommand, params=[options.WORDS, *OPTIONS])
def command(words: tuple[str, ...], as_json: bool, quiet: bool, verbose: bool, **rest: Any) -> None:
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
    roads = rest["roads"]
    carry_out(_job_of(" ".join(words), rest), Screen(roads, as_json, quiet, verbose))


def _job_of(words: str, given: dict[str, Any]) -> RunJob:
    """Returns the job that the values of the options describe; removes some of them from ``given``."""
    from roadgpt.run import Setup

    own = {name: given.pop(name) for name in ("roads", "seed", "out", "axes", "formats", "junit")}
    world, pictures = options.world_of(given), options.pictures_of(given)
    chat = options.chat_of(given, given["reader"], given["designer"])
    setup = Setup(drives=not given.pop("no_drive"), chat=chat, **given)
    return RunJob(words=words, world=world, setup=setup, pictures=pictures, **own)


def usual_job(words: str, roads: int) -> RunJob:
    """Returns the job of ``roadgpt run`` without options: with the defaults and the settings of configuration
    files.

    Raises:
        UsageError: A setting cannot be used.
    """
    parent = click.get_current_context(silent=True)
    values = command.make_context("run", ["-n", str(roads), "--", words], parent).params
    for name in ("words", "as_json", "quiet", "verbose"):
        values.pop(name)
    return _job_of(words, values)
