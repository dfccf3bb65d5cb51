"""``roadgpt export``: roads in the formats of other people's tools."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from roadgpt.cli.options import folder, formats_option, setup_options, world_of, world_options
from roadgpt.cli.roads import blueprint_of
from roadgpt.errors import ExportError, PartError, UsageError

if TYPE_CHECKING:
    from roadgpt.road import World
    from roadgpt.run import Run

FAILED = 1  # exit status: a format cannot hold a road
UNREADABLE = 2
ENDINGS = (".json", ".xodr", ".csv", ".tsv", ".sbft")


@click.command()
@click.argument("files", nargs=-1, required=True, metavar="RUN|ROAD...")
@formats_option("--to", required=True)
@click.option("--out", type=folder, default=Path("exports"), show_default=True, help="Folder for the files.")
@world_options("lane_width", "verge", "speed_limit", "friction")
@setup_options("geometry")
@click.option("--quiet", "-q", is_flag=True, help="Say nothing but errors.")
def command(
    files: tuple[str, ...], formats: tuple[str, ...], out: Path, geometry: Any, quiet: bool, **rest: Any
) -> int:
    """Write roads in the formats of other people's tools.

    RUN is the folder of a run or of a whole campaign; it brings its own lanes, limits and drive. ROAD is a
    RoadGPT design, an SBFT test, a list of points, or an OpenDRIVE file. Files are named after what they are
    made of, and replace those of the same name. Prints their names.

    \b
    roadgpt export roadgpt-runs/hairpins-7 --to opendrive
    roadgpt export my_road.json --to opendrive,csv --out for-carla
    """
    from roadgpt.export import exporter_of
    from roadgpt.run.exporting import export

    for format_ in formats:
        exporter_of(format_)
    world, status = world_of(rest), 0
    taken: set[str] = set()
    for file in _each(files):
        try:
            run = _run_of(file, world, geometry)
            written = export(run, out, formats, _name(file, taken))
        except PartError:
            raise
        except (ExportError, UsageError) as error:
            click.echo(f"roadgpt: {error}", err=True)
            status = max(status, FAILED if isinstance(error, ExportError) else UNREADABLE)
            continue
        if not quiet:
            click.echo("\n".join(map(str, written)))
    return status


def _each(files: tuple[str, ...]) -> Iterator[str]:
    """Every file; of a campaign, all its runs."""
    from roadgpt.run.card import CARD
    from roadgpt.run.folder import RUNS, is_run

    for file in files:
        if Path(file, CARD).is_file():
            yield from (str(path) for path in sorted(Path(file, RUNS).iterdir()) if is_run(path))
        else:
            yield file


def _run_of(file: str, world: "World", geometry: Any) -> "Run":
    """The Run in a folder, or one of a road that nobody drove."""
    from roadgpt.road import Design, build
    from roadgpt.run import Request, Run, read_run
    from roadgpt.run.folder import is_run

    if is_run(Path(file)):
        run = read_run(file)
        return replace(run, description=f"{file}: {run.description}")
    blueprint, remarks = blueprint_of(file)
    for remark in remarks:
        click.echo(f"roadgpt: {file}: {remark}", err=True)
    road = build(blueprint, geometry) if isinstance(blueprint, Design) else blueprint
    return Run(Request(world=world), 1, 0, road=road)


def _name(file: str, taken: set[str]) -> str:
    """Of the exported files: that of the source, numbered where an earlier source has the same."""
    stem = Path(file).resolve().name
    for ending in ENDINGS:
        stem = stem.removesuffix(ending)
    name, number = stem, 1
    while name in taken:
        number += 1
        name = f"{stem}-{number}"
    taken.add(name)
    return name
