"""``roadgpt import``: writes what a file of another tool holds as road files, and routes through its maps."""

import json
from pathlib import Path
from typing import TYPE_CHECKING

import click

from roadgpt.cli import options, roads
from roadgpt.cli.options import PATH, Argument, GroupedCommand, Option, whole
from roadgpt.cli.streams import warn
from roadgpt.errors import RoadGPTError, UsageError, command_line, explained

if TYPE_CHECKING:
    from collections.abc import Sequence

    from roadgpt.network import ImportedMap, Leg
    from roadgpt.network.source import RoadSource

ROUTES = whole(1, 1_000, "a number of routes")
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
    cls=GroupedCommand, params=[Argument("file", "FILE", "Name a file with a road.", PATH), *IMPORT_OPTIONS],
    heading="Exchange", short_help="Read a road from an OpenDRIVE file.",
)  # fmt: skip
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
        return [between(lanes, *(options.point(each or "") for each in ends))]
    if count is not None:
        ways = random_routes(lanes, count, seed)
        if not ways:
            raise UsageError("no route leads through the map; view it, and name roads with --route")
        if len(ways) < count:
            warn(f"{len(ways)} different routes were found, and {count} asked for")
        return ways
    return [()]


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
