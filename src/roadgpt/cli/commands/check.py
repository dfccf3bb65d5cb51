"""``roadgpt check``: checks roads from files against the rules."""

import time
from dataclasses import replace
from typing import Any

import click

from roadgpt.cli import options
from roadgpt.cli.option import named
from roadgpt.cli.option_groups import GroupedCommand
from roadgpt.cli.result_row import Row, row_of
from roadgpt.cli.roads import LANES, UNREADABLE, each_road, roads_in, source_of
from roadgpt.cli.screen import Screen

INVALID = 1  # exit status, so that a script can ask


OPTIONS = (
    *named(options.SETUP, "rules"),
    *named(options.WORLD, "map_size", *LANES),
    *named(options.SETUP, "geometry"),
    *options.SCREEN,
)


@click.command(cls=GroupedCommand, params=[options.ROADS, *OPTIONS])
def command(files: tuple[str, ...], rules: str, geometry: str, verbose: bool, **rest: Any) -> int:
    """Check roads against the rules.

    ROAD is a RoadGPT design, a test of SBFT or SDC-Scissor, a list of points [x, y] or [x, y, z], a table of
    points (.csv) or OpenDRIVE (.xodr). A folder of such files, a folder of runs and a campaign stand for all
    their roads. The exit status is 0 if all roads are valid, 1 if one is not, 2 if one cannot be read.
    """
    world = options.world_of(rest)
    roads = roads_in(files)
    screen = Screen(len(roads), rest["as_json"], rest["quiet"], verbose)
    each_road(roads, screen, lambda file: _checked(screen, file, rules, geometry, world))
    outcomes = {row.test_outcome for row in screen.rows}
    return UNREADABLE if "ERROR" in outcomes else INVALID if "INVALID" in outcomes else 0


def _checked(screen: Screen, file: str, rules: str, geometry: Any, world: Any) -> tuple[Row, None]:
    from roadgpt.network import has_no_route
    from roadgpt.run import Setup, prove

    begun = time.perf_counter()
    blueprint, world, remarks = source_of(file, world)
    run = prove(blueprint, world=world, setup=Setup(rules=rules, geometry=geometry, drives=False))
    row = row_of(run, file)
    if is_only_map := run.road is not None and has_no_route(run.road):
        remarks = (*remarks, "the map has no route, so only its roads and junctions are checked")
    for remark in remarks:
        screen.say(f"{file}: {remark}")
    for sentence in row.findings[1:]:
        screen.detail(f"{file}: also, {sentence}")
    said = row.description if row.findings else f"valid by the rules '{rules}'"
    length, seconds = None if is_only_map else row.length_m, time.perf_counter() - begun
    return replace(row, description=said, length_m=length, seconds=seconds), None
