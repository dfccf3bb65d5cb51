"""Commands for files of other tools: ``roadgpt export`` and ``import``."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from roadgpt.cli import options, roads
from roadgpt.cli.option import PATH, Argument, Option, named
from roadgpt.cli.option_groups import GroupedCommand
from roadgpt.cli.streams import warn
from roadgpt.errors import RoadGPTError, UsageError, command_line, explained

if TYPE_CHECKING:
    from roadgpt.network.source import RoadSource

TO = "Name a format: --to opendrive; 'roadgpt config plugins' lists them."
FORMATS = "Formats to write: opendrive, csv, ...; 'roadgpt config plugins' lists them; or runs."
RUNS = "runs"  # the format of which the folders of runs are
EXPORT_OPTIONS = (
    Argument("files...", "RUN|ROAD...", "Name one or more folders of runs, or road files."),
    options.formats_option("--to formats", FORMATS, required=True, advice=TO),
    *options.CHOICES,
    options.out("Folder for the files.", default=Path("exports")),
    *named(options.WORLD, "speed_limit", *roads.LANES, "friction"),
    *(*named(options.SETUP, "geometry"), options.QUIET),
)


@click.command(cls=GroupedCommand, params=[*EXPORT_OPTIONS])
def export(
    files: tuple[str, ...], formats: tuple[str, ...], out: Path, geometry: Any, quiet: bool, **rest: Any
) -> int:
    """Write roads in the formats of other tools, such as OpenDRIVE.

    RUN is a run, a folder of runs, a campaign, or a test of a campaign, such as CAMPAIGN/c01/17; the lane
    widths, speed limits and drive that were recorded with it are exported. ROAD is a RoadGPT design, an SBFT
    test, a list of points, or an OpenDRIVE file; the lanes and speed limits of an OpenDRIVE file are kept
    unless an option changes them. Each file is named after its RUN or ROAD, and replaces a file of the same
    name. The names of the files are printed.

    The format runs writes the tests of a campaign as folders of runs, or the folders and tables of RUN again,
    in RUN itself if --out is left out.

    \b
    roadgpt export roadgpt-runs/hairpins-7 --to opendrive
    roadgpt export CAMPAIGN --failures --to opendrive,openscenario
    roadgpt export my_road.json --to opendrive,csv --out for-carla"""
    from roadgpt.export import exporter_of
    from roadgpt.run.exporting import export

    typed = options.typed(click.get_current_context())
    if RUNS in formats:
        if unused := sorted(typed & {*rest, "geometry"}):
            named = ", ".join(f"--{name.replace('_', '-')}" for name in unused)
            raise UsageError(f"runs are written as they were recorded, all of them; leave out {named}")
        return _write_runs(files, formats, out if "out" in typed else None, quiet)
    for format_ in formats:
        exporter_of(format_)
    choice = options.choice_of(rest)
    asked = typed & rest.keys()
    world, taken = options.world_of(rest), set[str]()
    unheeded = "" if quiet else ", ".join(flag.flag for flag in options.WORLD if flag.field in asked)

    def write(each: roads.NamedRoad) -> None:
        nonlocal unheeded
        if each.run is not None and unheeded:
            warn(f"runs keep their own lanes and limits; {unheeded} is for road files")
            unheeded = ""  # it is said once
        taken.add(name := next(name for name in roads.numbered(each.stem) if name not in taken))

        def tell(said: str) -> None:
            if not quiet:
                warn(f"{each.said}: {said}")

        with roads.named_in_errors(each.said):
            run = roads.run_of(each, world, geometry, quiet)
            written = export(run, out, formats, tell, name)
        if not quiet:
            click.echo("\n".join(map(str, written)))

    return roads.use_each(files, choice, write, takes_all=True)


def _write_runs(files: tuple[str, ...], formats: tuple[str, ...], out: Path | None, quiet: bool) -> int:
    from roadgpt.campaign.folder_record import is_store, write_runs

    if len(formats) > 1:
        raise UsageError("runs are whole folders, not files of roads; ask for them alone: --to runs")
    for file in map(Path, files):
        if not file.is_dir():
            raise UsageError(f"{file} is no folder; give a campaign, or a folder of runs")
        name = file.resolve().name
        place = out / name if out else Path("exports", name) if is_store(file) else file
        for folder in write_runs(file, place):
            if not quiet:
                click.echo(folder)
    return 0


IMPORT_OPTIONS = (
    Option("--road wanted", "Id of the road. [default: the longest with a driving lane; all of a list]"),
    Option("--out", "Road file to write; for a list, the folder. [default: named after FILE]", PATH),
    Option("--keep-place", "Keep the coordinates, even if the road is off the map.", bool),
    options.QUIET,
)


@click.command(
    cls=GroupedCommand, params=[Argument("file", "FILE", "Name a file with a road.", PATH), *IMPORT_OPTIONS]
)
def import_(file: Path, wanted: str | None, out: Path | None, keep_place: bool, quiet: bool) -> int:
    """Read a road from a file of another tool, write it as a road file, and describe it in words.

    FILE is OpenDRIVE (.xodr), a test of SBFT or SDC-Scissor, a list of points or tests (.json, .jsonl), or a
    table of points (.csv). Of a list, all tests are read into a new folder; --road takes one by its id.

    Of OpenDRIVE, lines, arcs, spirals, poly3, paramPoly3, elevation and widths are read. The centre line of
    the imported road is the inner edge of the innermost driving lane: the edge nearest to lane 0. A road that
    is off the map is moved onto it. The file can then be checked, driven and viewed like any other road: it
    holds the size of the map, the move, and the lane width, speed limit and friction that FILE states.

    \b
    roadgpt import town.xodr --road 12"""
    from roadgpt.network.source import read_sources

    found, taken = read_sources(file, wanted), set[str]()
    folder = (out or _free(file.stem, "")) if len(found) > 1 else None
    for source in found:
        try:
            if isinstance(source, UsageError):
                raise source
            if source.is_ours:
                raise UsageError(
                    f"{file} is a file of RoadGPT, which needs no import: {command_line('drive', file)}"
                )
            own = next(own for own in roads.numbered(_plain(source.name), ".json") if own not in taken)
            stem = file.stem if source.name == file.stem else f"{file.stem}-{source.name}"
            place = folder / own if folder else out or _free(stem, ".json")
            said = _write(file, source, place, keep_place, quiet)
        except UsageError as error:
            if folder is None:
                raise
            warn(error)
            continue
        taken.add(own)
        if not quiet:
            click.echo(f"road {source.name}{source.label and f' ({source.label})'}: {said}")
    if taken and not quiet:
        what = ("them", folder) if folder else ("it", place)
        click.echo(f"written to {what[1]}; drive {what[0]}: {command_line('drive', what[1])}")
    return roads.UNREADABLE if len(taken) < len(found) else 0


def _plain(name: str) -> str:
    return "".join(c if c.isalnum() or c in "-_." else "_" for c in name)[:100].lstrip(".") or "road"


def _free(stem: str, ending: str) -> Path:
    return next(path for path in map(Path, roads.numbered(_plain(stem), ending)) if not path.exists())


def _write(file: Path, source: "RoadSource", out: Path, keep_place: bool, quiet: bool) -> str:
    """Writes a road file, prints remarks, and returns in a sentence what the road is like."""
    from roadgpt import plugins
    from roadgpt.brief import sentence
    from roadgpt.check.describing import describe
    from roadgpt.check.measures import ups_and_downs
    from roadgpt.road import Road, World

    assert isinstance(source.blueprint, Road)
    road, size, moved_by, told = roads.on_a_map(source.blueprint, World().changed(**source.world), keep_place)
    world = {**source.world, "map_size": size}
    short = plugins.find("rules", "too_short")(road, None, World().changed(**world))
    for remark in () if quiet else (*source.remarks, *told, *(finding.sentence for finding in short)):
        warn(f"{file}: {remark}")
    origin = {"origin": [0.0 - each for each in moved_by]} if any(moved_by) else {}
    with explained(RoadGPTError, f"cannot write {out}", "name another file with --out"):
        out.parent.mkdir(parents=True, exist_ok=True)
        out.write_text(json.dumps({"world": world, **origin, **road.to_json()}) + "\n", encoding="utf-8")
    heights = ups_and_downs(road.sample().z)
    return sentence(describe(road)) + (f" Up and down: {heights} m." if " " in heights else "")
