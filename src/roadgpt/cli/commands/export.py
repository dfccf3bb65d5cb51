"""``roadgpt export``: roads in the formats of other people's tools."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource

from roadgpt.cli.flags import WORLD
from roadgpt.cli.options import folder, formats_option, setup_options, world_of, world_options
from roadgpt.cli.roads import blueprint_of
from roadgpt.errors import ExportError, PartError, UsageError

if TYPE_CHECKING:
    from roadgpt.road import Geometry, World
    from roadgpt.run import Run

FAILED = 1  # exit status: a format cannot hold a road
UNREADABLE = 2
OPENDRIVE = ".xodr"
ENDINGS = (".json", OPENDRIVE, ".csv", ".tsv", ".sbft")


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

    RUN is the folder of a run, or a folder of runs; each brings its own lanes, limits and drive. ROAD is a
    RoadGPT design, an SBFT test, a list of points, or an OpenDRIVE file, which brings its own lanes and
    limits where no option says otherwise. Files are named after what they are made of, those of a
    folder of runs after it and the run, and replace those of the same name. Prints their names.

    \b
    roadgpt export roadgpt-runs/hairpins-7 --to opendrive
    roadgpt export my_road.json --to opendrive,csv --out for-carla
    """
    from roadgpt.export import exporter_of
    from roadgpt.run.exporting import export

    for format_ in formats:
        exporter_of(format_)
    source, status = _source(rest, geometry, quiet), 0
    names = _Names()
    for file in names.new(files):
        try:
            run = source.run_of(file)
            written = export(run, out, formats, names.name(file))
        except PartError:
            raise
        except (ExportError, UsageError) as error:
            click.echo(f"roadgpt: {error}", err=True)
            status = max(status, FAILED if isinstance(error, ExportError) else UNREADABLE)
            continue
        if not quiet:
            click.echo("\n".join(map(str, written)))
    return status


@dataclass
class _Source:
    """Makes Runs of files, with what the command line says of those that do not say it themselves."""

    world: "World"
    said: dict[str, float]
    """Fields of the World that were asked for, rather than left as usual."""
    geometry: "Geometry"
    is_quiet: bool
    has_warned: bool = False

    def run_of(self, file: str) -> "Run":
        """The Run in a folder or of a campaign's test file, or one of a road that nobody drove.

        Raises:
            UsageError: there is none, or it cannot be read.
        """
        from roadgpt.road import Design, build, read_opendrive
        from roadgpt.run import Request, Run, read_run
        from roadgpt.run.folder import is_run, run_of_test

        path = Path(file)
        if is_run(path) or run_of_test(path) is not None:
            self._warn()
            run = read_run(file)
            return replace(run, description=f"{file}: {run.description}")
        if path.suffix.lower() == OPENDRIVE:
            found = read_opendrive(path)
            self._tell(file, found.remarks)
            world = found.world(self.world).model_copy(update=self.said)
            return Run(Request(world=world), 1, 0, road=found.road)
        blueprint, remarks = blueprint_of(file)
        self._tell(file, remarks)
        road = build(blueprint, self.geometry) if isinstance(blueprint, Design) else blueprint
        return Run(Request(world=self.world), 1, 0, road=road)

    def _tell(self, file: str, remarks: tuple[str, ...]) -> None:
        for remark in () if self.is_quiet else remarks:
            click.echo(f"roadgpt: {file}: {remark}", err=True)

    def _warn(self) -> None:
        """Once, of options that change nothing."""
        if self.said and not (self.has_warned or self.is_quiet):
            flags = ", ".join(flag.flag for flag in WORLD if flag.field in self.said)
            click.echo(f"roadgpt: runs keep their own lanes and limits; {flags} is for road files", err=True)
        self.has_warned = True


def _source(rest: dict[str, Any], geometry: "Geometry", is_quiet: bool) -> _Source:
    context = click.get_current_context()
    asked = [name for name in rest if context.get_parameter_source(name) is not ParameterSource.DEFAULT]
    world = world_of(rest)
    return _Source(world, {name: getattr(world, name) for name in asked}, geometry, is_quiet)


class _Names:
    """Each source once, and a name for its files that no earlier source has."""

    def __init__(self) -> None:
        self._seen: set[Path] = set()
        self._taken: set[str] = set()

    def new(self, files: tuple[str, ...]) -> Iterator[str]:
        """Every file that was not there before; of a campaign, all its runs."""
        from roadgpt.run.card import CARD
        from roadgpt.run.folder import RUNS, is_run

        for file in files:
            runs = [str(path) for path in sorted(Path(file, RUNS).glob("*")) if is_run(path)]
            for each in runs if runs and Path(file, CARD).is_file() else [file]:
                if Path(each).resolve() not in self._seen:
                    self._seen.add(Path(each).resolve())
                    yield each

    def name(self, file: str) -> str:
        """That of the source, numbered where an earlier source has the same."""
        from roadgpt.run.card import CARD
        from roadgpt.run.folder import RUNS, is_run

        path = Path(file).resolve()
        stem, campaign = path.name, path.parent.parent
        if is_run(path) and path.parent.name == RUNS and (campaign / CARD).is_file():
            stem = f"{campaign.name}-{stem}"
        for ending in ENDINGS:
            stem = stem.removesuffix(ending)
        name, number = stem, 1
        while name in self._taken:
            number += 1
            name = f"{stem}-{number}"
        self._taken.add(name)
        return name
