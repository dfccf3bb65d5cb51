"""Commands for files of other tools: ``roadgpt export``, ``import`` and ``ground``."""

import json
from dataclasses import replace
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from roadgpt.cli import options, roads
from roadgpt.cli.options import PATH, Argument, GroupedCommand, Heading, Option, named, whole
from roadgpt.cli.streams import warn
from roadgpt.errors import ExportError, RoadGPTError, UsageError, command_line, explained

if TYPE_CHECKING:
    from collections.abc import Sequence

    from roadgpt.ground.relief import Relief
    from roadgpt.network import ImportedMap, Leg
    from roadgpt.network.source import RoadSource

ROUTES = whole(1, 1_000, "a number of routes")
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
    found = way_between(relief, _point(start), _point(goal), max_grade / 100, min_radius)
    made, path = Road(found.plan, found.elevation), road or Path("road.json")
    world = World().changed(map_size=min(max(relief.size), LARGEST_MAP))
    slope = slope_for(relief, made.centreline())
    works = Ground.of(relief, pavement_of(network_of(made, world)), slope).earthworks
    with explained(RoadGPTError, f"cannot write {path}", "name another file with --road"):
        path.write_text(json.dumps(made.to_json()) + "\n", encoding="utf-8")
    told = {"road": str(path), "length": made.length, "deepest": found.deepest, "slope": slope}
    return {**told, "cut": works.cut, "fill": works.fill}


IMPORT_OPTIONS = (
    Option("--road wanted", "Id of one road. [default: all of a map, or of a list]"),
    Option("--route", "Roads of a map, in driving order: --route 12,7,3."),
    Option("--from start", "Where a route through a map begins: --from X,Y, in metres.", metavar="X,Y"),
    Option("--to goal", "Where it ends.", metavar="X,Y"),
    Option("--random-routes count", "Number of routes to draw through a map.", ROUTES),
    options.seed("Seed of these routes.", 0),
    Option("--out", "Road file to write; for several, the folder. [default: named after FILE]", PATH),
    Option("--keep-place", "Keep the coordinates, even if the road is off the map.", bool),
    options.QUIET,
)


@click.command(
    cls=GroupedCommand, params=[Argument("file", "FILE", "Name a file with a road.", PATH), *IMPORT_OPTIONS]
)
def import_(
    file: Path, wanted: str | None, route: str | None, start: str | None, goal: str | None,
    count: int | None, seed: int, out: Path | None, keep_place: bool, quiet: bool,
) -> int:  # fmt: skip
    """Read a map or a road from a file of another tool, and write it as a road file.

    FILE is OpenDRIVE (.xodr), a test of SBFT or SDC-Scissor, a list of points or tests (.json, .jsonl), or a
    table of points (.csv). Of a list, all tests are read into a new folder; --road takes one by its id.

    Of an OpenDRIVE map, all roads for cars are read, with their lanes, junctions, roundabouts, signs, lights,
    crosswalks, speed limits and friction; what is left out is said. The map can be viewed, checked and
    exported. To drive on it, name the roads of a route, or the points from which and to which it leads, or
    let routes be drawn; each is written as a file of its own.

    With --road, or of a file with a single road, one road is read, with all its lanes; its centre line is the
    reference line of the file. A road or a map that is off RoadGPT's map is moved onto it. The file can then
    be checked, driven and viewed like any other road: it holds the size of the map, the move, and the
    lane width, speed limit and friction that FILE states.

    \b
    roadgpt import town.xodr
    roadgpt import town.xodr --random-routes 20 --out routes
    roadgpt import town.xodr --road 12"""
    from roadgpt.network.maps import is_map_file
    from roadgpt.network.source import map_in, read_sources

    asked = {"--route": route, "--from": start, "--to": goal, "--random-routes": count}
    given = [flag for flag, value in asked.items() if value is not None]
    if (found_map := map_in(file) if wanted is None and is_map_file(file) else None) is not None:
        if len(given) > 1 and given != ["--from", "--to"]:
            raise UsageError(f"{' and '.join(given)} ask for different routes; give one of them")
        ways = _routes(found_map, route, (start, goal), count, seed)
        return _write_map(file, found_map, ways, out, keep_place, quiet)
    if given:
        raise UsageError(f"{given[0]} is for a map, an OpenDRIVE file with several roads; leave it out")
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
            said = _write(file, source, place, keep_place, quiet, set())
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


def _routes(
    found: "ImportedMap", route: str | None, ends: tuple[str | None, str | None], count: int | None, seed: int
) -> "list[tuple[Leg, ...]]":
    """Returns the routes that are asked for; one without legs if none is."""
    from roadgpt.network.lanes import lanes_of
    from roadgpt.network.routing import between, over_roads, random_routes

    lanes = lanes_of(found.network)
    if route is not None:
        names = [name.strip() for name in route.split(",")]
        if not all(names):
            raise UsageError("--route needs the ids of roads, with commas between them, such as 12,7,3")
        if unknown := [name for name in names if name not in found.roads]:
            there = ", ".join([*found.roads][:12]) + (", ..." if len(found.roads) > 12 else "")
            raise UsageError(f"there is no road {unknown[0]} on the map; there are: {there}")
        return [over_roads(lanes, [found.roads[name] for name in names])]
    if any(ends):
        if not all(ends):
            raise UsageError("a route needs both ends; give --from X,Y and --to X,Y")
        return [between(lanes, *(_point(each or "") for each in ends))]
    if count is not None:
        ways = random_routes(lanes, count, seed)
        if not ways:
            raise UsageError("no route leads through the map; view it, and name roads with --route")
        if len(ways) < count:
            warn(f"{len(ways)} different routes were found, and {count} asked for")
        return ways
    return [()]


def _point(text: str) -> tuple[float, float]:
    try:
        x, y = map(float, text.split(","))
    except ValueError as error:
        raise UsageError(f"'{text[:40]}' is no point; give x and y in metres, such as 120,45.5") from error
    if not (isfinite(x) and isfinite(y)):
        raise UsageError(f"'{text[:40]}' is not finite; give x and y in metres, such as 120,45.5")
    return x, y


def _write_map(
    file: Path, found: "ImportedMap", ways: "Sequence[tuple[Leg, ...]]", out: Path | None, keep_place: bool,
    quiet: bool,
) -> int:  # fmt: skip
    """Writes a map, or one file for each route through it, and prints what they are like."""
    from roadgpt.brief.junctions import NAMES
    from roadgpt.network import Route
    from roadgpt.network.source import RoadSource
    from roadgpt.plural import plural

    folder = (out or _free(f"{file.stem}-routes", "")) if len(ways) > 1 else None
    heard = set[str]()
    for number, legs in enumerate(ways, 1):
        values, told = found.world_values(legs)
        remarks = (*found.remarks, *told) if number == 1 else told
        place = folder / f"route-{number}.json" if folder else out or _free(file.stem, ".json")
        route = Route.along(found.network, legs)
        source = RoadSource(route, remarks, values, file.stem)
        _write(file, source, place, keep_place, quiet, heard)
        if not quiet:
            over = {name: None for leg in legs for name, own in found.roads.items() if leg.road in own}
            kinds = [NAMES[each.entered.kind][0] for each in route.passages]
            passed = f" through {_counted(kinds)}" if kinds else ""
            said = f"route {number}: {route.length:,.0f} m{passed}, over roads {', '.join(over)}"
            roads, kinds = found.network.roads_outside, [NAMES[kind][0] for kind, _ in found.network.nodes]
            metres = sum(each.road.length for each in roads)
            whole = f"map: {plural(len(roads), 'road')}, {metres:,.0f} m, with {_counted(kinds)}"
            click.echo(said if legs else whole)
    if not quiet:
        verb, what = "drive" if ways[0] else "view", "them" if folder else "it"
        click.echo(f"written to {folder or place}; {verb} {what}: {command_line(verb, folder or place)}")
    return 0


def _counted(kinds: "Sequence[str]") -> str:
    counts = {kind: kinds.count(kind) for kind in kinds}
    named = (f"{count} {kind}{'s' * (count > 1 and kind[-1] != 's')}" for kind, count in counts.items())
    return ", ".join(named) or "no junction"


def _plain(name: str) -> str:
    return "".join(c if c.isalnum() or c in "-_." else "_" for c in name)[:100].lstrip(".") or "road"


def _free(stem: str, ending: str) -> Path:
    return roads.free(_plain(stem), ending)


def _write(
    file: Path, source: "RoadSource", out: Path, keep_place: bool, quiet: bool, heard: set[str]
) -> str:
    """Writes a road file, prints remarks that were not ``heard`` before, and returns in a sentence what the
    road is like."""
    from roadgpt import plugins
    from roadgpt.brief import sentence
    from roadgpt.check.describing import describe
    from roadgpt.check.measures import ups_and_downs
    from roadgpt.network import network_of, only_road, road_from_json
    from roadgpt.network.maps import is_map_file
    from roadgpt.road import Road, World

    assert isinstance(source.blueprint, Road)
    road, size, moved_by, told = roads.on_a_map(source.blueprint, World().changed(**source.world), keep_place)
    world = {**source.world, "map_size": size}
    own = World().changed(**world)
    too_short = plugins.find("rules", "too_short")
    is_only = only_road(road, own) is not None
    found = too_short(network_of(road, own), road, None, own) if is_only else ()
    if is_map_file(file) and "speed_limit" not in world:
        usual = own.limits.speed_limit * 3.6
        told += (
            f"it states no speed limit; it is driven at {usual:g} km/h at most, or as --speed-limit says",
        )
    road_from_json(road.to_json())  # so that nothing is written that cannot be read
    for remark in () if quiet else (*source.remarks, *told, *(finding.sentence for finding in found)):
        if remark not in heard:
            warn(f"{file}: {remark}")
            heard.add(remark)
    origin = {"origin": [0.0 - each for each in moved_by]} if any(moved_by) else {}
    with explained(RoadGPTError, f"cannot write {out}", "name another file with --out"):
        out.parent.mkdir(parents=True, exist_ok=True)
        out.write_text(json.dumps({"world": world, **origin, **road.to_json()}) + "\n", encoding="utf-8")
    if not is_only:
        return f"{road.length:,.0f} m, for traffic on the left."
    heights = ups_and_downs(road.sample().z)
    return sentence(describe(road)) + (f" Up and down: {heights} m." if " " in heights else "")
