"""``roadgpt export``: writes roads in the formats of other tools."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource

from roadgpt.cli import options
from roadgpt.cli.option import Argument, named
from roadgpt.cli.option_groups import GroupedCommand
from roadgpt.cli.roads import NamedRoad, blueprint_of, named_in_errors, numbered, roads_named
from roadgpt.cli.streams import warn
from roadgpt.errors import ExportError, PartError, RoadGPTError, UsageError

if TYPE_CHECKING:
    from roadgpt.road import Geometry, World
    from roadgpt.run import Run

FAILED = 1  # exit status: a format cannot hold a road
UNREADABLE = 2
OPENDRIVE = ".xodr"


TO = "Name a format: --to opendrive; 'roadgpt config plugins' lists them."
ADVICE = "Name one or more folders of runs, or road files."
FORMATS = "Formats to write: opendrive, csv, ...; 'roadgpt config plugins' lists them."
OPTIONS = (
    options.formats_option("--to formats", FORMATS, required=True, advice=TO),
    *options.CHOICES,
    options.out("Folder for the files.", default=Path("exports")),
    *named(
        options.WORLD, "speed_limit", "lanes", "lane_width", "lane_width_end", "shoulder", "bank", "friction"
    ),
    *(*named(options.SETUP, "geometry"), options.QUIET),
)


@click.command(cls=GroupedCommand, params=[Argument("files...", "RUN|ROAD...", ADVICE), *OPTIONS])
def command(
    files: tuple[str, ...], formats: tuple[str, ...], out: Path, geometry: Any, quiet: bool, **rest: Any
) -> int:
    """Write roads in the formats of other tools, such as OpenDRIVE.

    RUN is a run, a folder of runs, a campaign, or a test of a campaign, such as CAMPAIGN/c01/17; the lane
    widths, speed limits and drive that were recorded with it are exported. ROAD is a RoadGPT design, an SBFT
    test, a list of points, or an OpenDRIVE file; the lanes and speed limits of an OpenDRIVE file are kept
    unless an option changes them. Each file is named after its RUN or ROAD, and replaces a file of the same
    name. The names of the files are printed.

    \b
    roadgpt export roadgpt-runs/hairpins-7 --to opendrive
    roadgpt export CAMPAIGN --failures --to opendrive,openscenario
    roadgpt export my_road.json --to opendrive,csv --out for-carla
    """
    from roadgpt.export import exporter_of
    from roadgpt.run.exporting import export

    for format_ in formats:
        exporter_of(format_)
    choice, status = options.choice_of(rest), 0
    source, taken = _source(rest, geometry, quiet), set[str]()

    def complain(error: RoadGPTError) -> None:
        nonlocal status
        warn(error)
        status = max(status, FAILED if isinstance(error, ExportError) else UNREADABLE)

    for each in roads_named(files, choice, takes_all=True, complain=complain):
        taken.add(name := next(name for name in numbered(each.stem) if name not in taken))
        try:
            with named_in_errors(each.said):
                written = export(source.run_of(each), out, formats, name)
        except PartError:
            raise
        except (ExportError, UsageError) as error:
            complain(error)
            continue
        if not quiet:
            click.echo("\n".join(map(str, written)))
    return status


@dataclass
class _Source:
    """Makes a Run of each road; for road files, options supply what the file does not contain."""

    world: "World"
    said: dict[str, float]
    """Fields of the World that were given as options."""
    geometry: "Geometry"
    is_quiet: bool
    has_warned: bool = False

    def run_of(self, named: NamedRoad) -> "Run":
        """Returns the Run of a road, or a new Run without a drive for a road file.

        Raises:
            UsageError: The road cannot be read.
        """
        from roadgpt.network import made_from
        from roadgpt.road import read_opendrive
        from roadgpt.run import Request, Run

        file = named.said
        if named.run is not None:
            self._warn()
            run = named.run()
            return replace(run, description=f"{file}: {run.description}")
        if Path(file).suffix.lower() == OPENDRIVE:
            found = read_opendrive(Path(file))
            self._tell(file, found.remarks)
            world = found.world(self.world).changed(**self.said)
            return Run(Request(world=world), 1, 0, road=found.road)
        blueprint, remarks = blueprint_of(file, self.world)
        self._tell(file, remarks)
        return Run(Request(world=self.world), 1, 0, road=made_from(blueprint, self.world, self.geometry))

    def _tell(self, file: str, remarks: tuple[str, ...]) -> None:
        for remark in () if self.is_quiet else remarks:
            warn(f"{file}: {remark}")

    def _warn(self) -> None:
        """Says once that options do not change the lanes and limits of runs."""
        if self.said and not (self.has_warned or self.is_quiet):
            flags = ", ".join(flag.flag for flag in options.WORLD if flag.field in self.said)
            warn(f"runs keep their own lanes and limits; {flags} is for road files")
        self.has_warned = True


def _source(rest: dict[str, Any], geometry: "Geometry", is_quiet: bool) -> _Source:
    context = click.get_current_context()
    asked = [name for name in rest if context.get_parameter_source(name) is ParameterSource.COMMANDLINE]
    world = options.world_of(rest)
    return _Source(world, {name: world.values()[name] for name in asked}, geometry, is_quiet)
