"""``roadgpt drive``: drive roads that exist."""

import sys
from contextlib import redirect_stdout
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from roadgpt.cli.beamng import beamng_options
from roadgpt.cli.junit import Junit, junit_option
from roadgpt.cli.options import (
    SEED,
    files_argument,
    screen_options,
    setup_options,
    world_of,
    world_options,
)
from roadgpt.cli.roads import blueprint_of, each_road
from roadgpt.cli.rows import Row, row_of
from roadgpt.cli.screen import Screen

if TYPE_CHECKING:
    from roadgpt.road import World
    from roadgpt.run.lost_drives import LostDrives
    from roadgpt.run.model import Setup

UNREADABLE = 2  # exit status


@click.command()
@files_argument
@click.option("--seed", type=SEED, default=1, show_default=True, help="Handed to the driver.")
@world_options()
@setup_options("driver", "simulator", "keep_driving", "geometry", "rules")
@beamng_options
@junit_option
@screen_options
def command(
    files: tuple[str, ...],
    seed: int,
    junit: Path | None,
    as_json: bool,
    quiet: bool,
    verbose: bool,
    **rest: Any,
) -> int:
    """Drive roads that exist.

    ROAD.json is a RoadGPT design, a test of SBFT or SDC-Scissor, a list of points [x, y] or [x, y, z], a
    table of points (.csv) or OpenDRIVE (.xodr). A road that the rules object to is driven all the same, and
    what they say is told beside the verdict; INVALID is what cannot be driven: numbers that are not finite,
    two points at one place, no room for a car. With --rules sbft every objection is INVALID, as in the
    competition. The exit status is 0 when all roads could be read.
    """
    from roadgpt.run import Request, Setup, check_parts
    from roadgpt.run.lost_drives import LostDrives

    world = world_of(rest)
    setup = Setup(**rest)
    with redirect_stdout(sys.stderr):
        check_parts(setup, world)  # a driver that does not exist is told of before any road is looked at
    asked = Request(seed=seed, world=world, setup=setup)
    screen = Screen(len(files), as_json, quiet, verbose, Junit.of(junit, asked))
    losses: LostDrives[str] = LostDrives()
    each_road(files, screen, lambda file: _driven(screen, file, seed, world, setup, losses))
    return UNREADABLE if any(row.cause == "unreadable" for row in screen.rows) else 0


def _driven(
    screen: Screen, file: str, seed: int, world: "World", setup: "Setup", losses: "LostDrives[str]"
) -> Row:
    from roadgpt.run import prove

    blueprint, remarks = blueprint_of(file)
    for remark in remarks:
        screen.say(f"{file}: {remark}")
    with redirect_stdout(sys.stderr):  # what a user's driver prints is no row
        run = prove(blueprint, seed, world, setup, despite_findings=setup.rules == "strict")
    screen.detail(f"{file}: {run.description}")
    for finding in run.findings:
        screen.detail(f"{file}: finding: {finding.sentence}")
    if losses.count(file, run.is_lost):
        raise losses.given_up(
            run.description, f"see to it and drive the roads from {losses.lost[0]} on again"
        )
    return row_of(run, file)
