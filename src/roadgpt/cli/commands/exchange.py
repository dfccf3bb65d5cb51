"""``roadgpt export`` and ``ground``."""

import json
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from roadgpt.cli import options, roads
from roadgpt.cli.options import Argument, GroupedCommand, Heading, Option, named
from roadgpt.cli.streams import warn
from roadgpt.errors import ExportError, RoadGPTError, UsageError, explained

if TYPE_CHECKING:
    from roadgpt.ground.relief import Relief

TO = "Name a format: --to opendrive; 'roadgpt config plugins' lists them."
FORMATS = "Formats to write: opendrive, csv, ...; 'roadgpt config plugins' lists them; or runs."
RUNS = "runs"  # the format of which the folders of runs are
EXPORT_OPTIONS = (
    Argument("files...", "RUN|ROAD...", "Name one or more folders of runs, or road files."),
    options.formats_option("--to formats", FORMATS, required=True, advice=TO),
    *options.CHOICES,
    options.out("Folder for the files.", default=Path("exports")),
    *named(options.WORLD, "speed_limit", *roads.LANES, "friction", "ground"),
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

    The format runs writes the tests of a campaign, or of a folder of runs, as files of runs with their
    tables.

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
        return _write_runs(files, formats, out, quiet)
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
            written, refused = export(run, out, formats, tell, name)
            if not quiet and written:
                click.echo("\n".join(map(str, written)))
            if refused:
                raise ExportError("; ".join(map(str, refused.values())))

    return roads.use_each(files, choice, write, takes_all=True)


def _write_runs(files: tuple[str, ...], formats: tuple[str, ...], out: Path, quiet: bool) -> int:
    from roadgpt.campaign.run_folder import write_runs

    if len(formats) > 1:
        raise UsageError("runs are whole folders, not files of roads; ask for them alone: --to runs")
    for file in map(Path, files):
        if not file.is_dir():
            raise UsageError(f"{file} is no folder; give a campaign, or a folder of runs")
        for folder in write_runs(file, out / file.resolve().name):
            if not quiet:
                click.echo(folder)
    return 0


GROUND_OPTIONS = (
    Argument("words...", "DESCRIPTION|FILE", "Say what land you want, or name a file of heights."),
    Option("--size", "Side of the land, m.", options.measure(100, 8000), 1000.0),
    Option("--cell", "Distance between heights, m.", options.measure(0.5, 100), 2.0),
    options.seed("Seed of the land.", 0),
    Option("--out", "File for the heights: .png (16 bits and a world file), .asc, .npy. [default: land.png]",
           options.PATH, metavar="FILE", heading=Heading.FILES),
    Option("--from start", "Where a road over the land begins: --from X,Y, in metres.", metavar="X,Y"),
    Option("--to goal", "Where it ends.", metavar="X,Y"),
    Option("--max-grade", "Steepest grade of the road, %.", options.measure(1, 15), 8.0),
    Option("--min-radius", "Least radius of its bends, m.", options.measure(14.5, 500), 20.0),
    Option("--road", "Road file to write. [default: road.json]", options.PATH, metavar="FILE",
           heading=Heading.FILES),
    options.json_option(heading=Heading.OUTPUT),
)  # fmt: skip


@click.command(cls=GroupedCommand, params=[*GROUND_OPTIONS])
def ground(
    words: tuple[str, ...], size: float, cell: float, seed: int, out: Path | None, as_json: bool, **road: Any
) -> None:
    """Make land from words, or read heights from a file, and write them; or find a way for a road over it.

    With --from and --to, the road keeps the grade and the radius, and needs little earthworks.

    Roads are laid into the land with --ground of run, drive, export and others. FILE is a 16-bit PNG, an
    ESRI ASCII grid (.asc), a NumPy array (.npy) or a GeoTIFF (.tif).

    \b
    roadgpt ground "a valley between two ridges" --size 1000 --seed 3
    roadgpt ground alps.tif --out alps.png
    roadgpt ground alps.tif --from 100,200 --to 900,1400 --max-grade 8
    roadgpt run "5 turns" --ground land.png"""
    import numpy as np

    from roadgpt.ground.files import MOST, READERS, read_ground, write_ground
    from roadgpt.ground.relief import Way, made, stretches

    text, typed = " ".join(words), options.typed(click.get_current_context())
    unused: tuple[str, ...] = ()
    if len(words) == 1 and Path(text).suffix.lower() in READERS:
        if unheeded := sorted(typed & {"size", "seed", "cell"}):
            raise UsageError(f"a file has its own heights; leave out --{unheeded[0]}")
        relief = read_ground(Path(text)).relief
    else:
        from roadgpt.brief.land_words import land_in

        if (size / cell + 1) ** 2 > MOST:
            raise UsageError(
                f"land of {size:g} m with a height every {cell:g} m has too many; enlarge --cell"
            )
        wish = land_in(text)
        if wish.kind is None and not wish.lands:
            raise UsageError(f"'{text}' names no land; say flat, rolling, hilly, mountain, valley, lake ...")
        unused = wish.unused
        way = Way.through_the_middle(size, 100.0, seed)
        box = np.zeros(2), np.full(2, size)
        kind = wish.kind or "hilly"
        relief = made(way, kind, stretches(wish.lands, size), seed, box)
        x = np.arange(0.0, size + cell / 2, cell)
        grid = relief.at(*map(np.ravel, np.meshgrid(x, x))).reshape(len(x), len(x))
        relief = replace(relief, x=0.0, y=0.0, cell=cell, heights=grid)
        out = out or Path("land.png")
    if out is not None:
        with explained(RoadGPTError, f"cannot write {out}", "name another file with --out"):
            write_ground(relief.heights, relief.cell, out)
    steep = np.hypot(*np.gradient(relief.heights, relief.cell))
    rows, columns = relief.heights.shape
    told: dict[str, Any] = {
        "file": None if out is None else str(out),
        "width": (columns - 1) * relief.cell,
        "height": (rows - 1) * relief.cell,
        "cell": relief.cell,
        "lowest": float(relief.heights.min()),
        "highest": float(relief.heights.max()),
        "mean_slope": float(steep.mean()),
        "unused": list(unused),
    }
    if road["start"] or road["goal"]:
        told |= _way(relief, **road)
    if as_json:
        return click.echo(json.dumps(told))
    for word in unused:
        warn(f"not used: '{word}'")
    click.echo(
        f"{told['width']:.0f} m x {told['height']:.0f} m, a height every {told['cell']:g} m: "
        f"{told['lowest']:.1f} to {told['highest']:.1f} m, mean slope {100 * told['mean_slope']:.0f} %"
    )
    if "road" in told:
        click.echo(
            f"road of {told['length']:.0f} m, {told['deepest']:.1f} m above or below the land at most: "
            f"cut {told['cut']:.0f} m3, fill {told['fill']:.0f} m3 with slopes of 1:{1 / told['slope']:.2g}"
        )
    click.echo("\n".join(str(told[name]) for name in ("file", "road") if told.get(name)))
    return None


def _way(
    relief: "Relief", start: str | None, goal: str | None, max_grade: float, min_radius: float,
    road: Path | None,
) -> dict[str, Any]:  # fmt: skip
    """Finds a way over land, writes it as a road file, and returns what is told about it."""
    from roadgpt.brief.words import LARGEST_MAP
    from roadgpt.ground.ground import Ground, slope_for
    from roadgpt.ground.wayfinding import way_between
    from roadgpt.network import network_of
    from roadgpt.network.surface import pavement_of
    from roadgpt.road import Road, World

    if not (start and goal):
        raise UsageError("a road needs both ends; give --from X,Y and --to X,Y")
    found = way_between(relief, options.point(start), options.point(goal), max_grade / 100, min_radius)
    made, path = Road(found.plan, found.elevation), road or Path("road.json")
    world = World().changed(map_size=min(max(relief.size), LARGEST_MAP))
    slope = slope_for(relief, made.centreline())
    works = Ground.of(relief, pavement_of(network_of(made, world)), slope).earthworks
    with explained(RoadGPTError, f"cannot write {path}", "name another file with --road"):
        path.write_text(json.dumps(made.to_json()) + "\n", encoding="utf-8")
    told = {"road": str(path), "length": made.length, "deepest": found.deepest, "slope": slope}
    return {**told, "cut": works.cut, "fill": works.fill}
