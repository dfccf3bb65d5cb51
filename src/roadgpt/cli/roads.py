"""Reads roads from files; a file that cannot be read does not stop the reading of others."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from roadgpt.cli.result_row import Row, unreadable
from roadgpt.cli.road_names import NamedRoad, roads_named
from roadgpt.cli.screen import Screen
from roadgpt.errors import PartError, UsageError

if TYPE_CHECKING:
    from roadgpt.campaign.selection import Choice
    from roadgpt.road import Design, Geometry, Road, World
    from roadgpt.run import Run


def blueprint_of(file: str) -> tuple["Design | Road", tuple[str, ...]]:
    """Returns the Design or the Road in a file, and remarks on assumptions made in reading it.

    Raises:
        UsageError: The file holds no road, or it is a folder that is no run.
    """
    from roadgpt.road import read_blueprint
    from roadgpt.run.card import CARD

    if Path(file, CARD).is_file():
        raise UsageError(f"{file} is a folder of runs; give the runs themselves: {Path(file, 'runs')}/*")
    if Path(file).is_dir() and not Path(file, "road.json").is_file():
        raise UsageError(
            f"{file} is a folder without a road; give a road file, or the folder of a run such as "
            "DIR/runs/0001, which roadgpt drive --again makes from a test of a campaign"
        )
    return read_blueprint(file)


def shown_runs(
    files: Sequence[str],
    choice: "Choice | None",
    world: "World",
    geometry: "Geometry",
    most: int,
    what: str,
) -> "list[Run]":
    """Returns the named Runs, to show them together; a road file becomes a Run without a drive.

    Args:
        files, choice: As for ``roads_named``.
        world, geometry: World and geometry for road files.
        most: Maximum number of Runs that can be shown together.
        what: What shows them, such as 'a page'.

    Raises:
        UsageError: A name is wrong, a road cannot be read, or there are more than ``most``.
    """
    if len(files) > most:
        raise UsageError(f"{what} shows one road or two side by side; {len(files)} are given")
    named = [*roads_named(files, choice)]
    if len(named) > most:
        raise UsageError(
            f"{what} shows one road or two side by side; these are {len(named):,}: name one or two, as "
            f"{named[0].said}, or say --worst"
        )
    if len(named) < len(files):  # a road beside itself
        named = [each for file in files for each in roads_named([file], choice)]
    return [run_of(each, world, geometry) for each in named]


def shown_run(file: str, world: "World", geometry: "Geometry") -> "Run":
    """Returns the Run that a single name refers to, as ``shown_runs`` does."""
    return shown_runs([file], None, world, geometry, 1, "it")[0]


def run_of(named: NamedRoad, world: "World", geometry: "Geometry") -> "Run":
    """Returns the Run of a road, or a new Run without a drive for a road file; prints remarks.

    Raises:
        UsageError: The road cannot be read.
    """
    from roadgpt.run import Setup, prove

    if named.run is not None:
        return named.run()
    blueprint, remarks = blueprint_of(named.said)
    for remark in remarks:
        click.echo(f"roadgpt: {named.said}: {remark}", err=True)
    run = prove(blueprint, world=world, setup=Setup(geometry=geometry, drives=False))
    return replace(run, source=Path(named.said).name)


def each_road(files: Sequence[str], screen: Screen, look: Callable[[str], Row]) -> None:
    """Calls ``look`` for every file, and prints the resulting rows and a table of them.

    Raises:
        UsageError: The only file given cannot be used.
    """
    with screen:
        for file in files:
            try:
                row = look(file)
            except PartError:
                raise
            except UsageError as error:
                if len(files) == 1 and not screen.as_json:
                    raise
                row = unreadable(file, error)
            screen.row(row)
        screen.close()
