"""Roads that exist, one file after the other: one that cannot be read does not stop the others."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from roadgpt.cli.rows import Row, unreadable
from roadgpt.cli.screen import Screen
from roadgpt.errors import PartError, UsageError

if TYPE_CHECKING:
    from roadgpt.road import Design, Geometry, Road, World
    from roadgpt.run import Run


def blueprint_of(file: str) -> tuple["Design | Road", tuple[str, ...]]:
    """What a file holds, a Design or a Road, and remarks on what had to be settled.

    Raises:
        UsageError: it holds no road, or is a folder of runs, or of something else.
    """
    from roadgpt.road import read_blueprint
    from roadgpt.run.card import CARD

    if Path(file, CARD).is_file():
        raise UsageError(f"{file} is a folder of runs; give the runs themselves: {Path(file, 'runs')}/*")
    if Path(file).is_dir() and not Path(file, "road.json").is_file():
        raise UsageError(
            f"{file} is a folder without a road; give a road file, or the folder of a run such as "
            "DIR/runs/0001, which roadgpt redrive makes of a test of roadgpt campaign"
        )
    return read_blueprint(file)


def shown_run(file: str, world: "World", geometry: "Geometry") -> "Run":
    """The Run in a folder or of a campaign's test file, or one made of a road that nobody drove, to be shown;
    tells remarks.

    Raises:
        UsageError: as for ``blueprint_of``, or the folder's run cannot be read.
    """
    from roadgpt.run import Setup, prove, read_run
    from roadgpt.run.folder import is_run, only_run, run_of_test

    if Path(file).is_dir():
        file = str(only_run(Path(file)))
    if is_run(Path(file)) or run_of_test(Path(file)) is not None:
        return read_run(file)
    blueprint, remarks = blueprint_of(file)
    for remark in remarks:
        click.echo(f"roadgpt: {file}: {remark}", err=True)
    run = prove(blueprint, world=world, setup=Setup(geometry=geometry, drives=False))
    return replace(run, source=Path(file).name)


def each_road(files: Sequence[str], screen: Screen, look: Callable[[str], Row]) -> None:
    """Look at every file, and show the rows with their table.

    Raises:
        UsageError: there is one file only, and it cannot be used; that needs no table.
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
