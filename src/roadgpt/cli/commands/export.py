"""``roadgpt export``: writes roads in the formats of other tools."""

from pathlib import Path
from typing import Any

import click

from roadgpt.cli import options
from roadgpt.cli.option import Argument, named
from roadgpt.cli.option_groups import GroupedCommand
from roadgpt.cli.roads import LANES, NamedRoad, named_in_errors, numbered, run_of, use_each
from roadgpt.cli.streams import warn

TO = "Name a format: --to opendrive; 'roadgpt config plugins' lists them."
ADVICE = "Name one or more folders of runs, or road files."
FORMATS = "Formats to write: opendrive, csv, ...; 'roadgpt config plugins' lists them."
OPTIONS = (
    options.formats_option("--to formats", FORMATS, required=True, advice=TO),
    *options.CHOICES,
    options.out("Folder for the files.", default=Path("exports")),
    *named(options.WORLD, "speed_limit", *LANES, "friction"),
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
    choice = options.choice_of(rest)
    asked = options.typed(click.get_current_context()) & rest.keys()
    world, taken = options.world_of(rest), set[str]()
    unheeded = "" if quiet else ", ".join(flag.flag for flag in options.WORLD if flag.field in asked)

    def write(each: NamedRoad) -> None:
        nonlocal unheeded
        if each.run is not None and unheeded:
            warn(f"runs keep their own lanes and limits; {unheeded} is for road files")
            unheeded = ""  # it is said once
        taken.add(name := next(name for name in numbered(each.stem) if name not in taken))

        def tell(said: str) -> None:
            if not quiet:
                warn(f"{each.said}: {said}")

        with named_in_errors(each.said):
            run = run_of(each, world, geometry, quiet)
            written = export(run, out, formats, tell, name)
        if not quiet:
            click.echo("\n".join(map(str, written)))

    return use_each(files, choice, write, takes_all=True)
