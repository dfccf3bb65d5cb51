"""``roadgpt import``: reads roads from files of other tools."""

import json
from pathlib import Path
from typing import TYPE_CHECKING

import click

from roadgpt.cli import options
from roadgpt.cli.option import Argument, Option
from roadgpt.cli.option_groups import GroupedCommand
from roadgpt.cli.option_types import PATH
from roadgpt.cli.roads import UNREADABLE, numbered, on_a_map
from roadgpt.cli.streams import warn
from roadgpt.errors import RoadGPTError, UsageError, command_line, explained

if TYPE_CHECKING:
    from roadgpt.network.source import RoadSource

OPTIONS = (
    Option("--road wanted", "Id of the road. [default: the longest with a driving lane; all of a list]"),
    Option("--out", "Road file to write; for a list, the folder. [default: named after FILE]", PATH),
    Option("--keep-place", "Keep the coordinates, even if the road is off the map.", bool),
    options.QUIET,
)


@click.command(
    cls=GroupedCommand, params=[Argument("file", "FILE", "Name a file with a road.", PATH), *OPTIONS]
)
def command(file: Path, wanted: str | None, out: Path | None, keep_place: bool, quiet: bool) -> int:
    """Read a road from a file of another tool, write it as a road file, and describe it in words.

    FILE is OpenDRIVE (.xodr), a test of SBFT or SDC-Scissor, a list of points or tests (.json, .jsonl), or a
    table of points (.csv). Of a list, all tests are read into a new folder; --road takes one by its id.

    Of OpenDRIVE, lines, arcs, spirals, poly3, paramPoly3, elevation and widths are read. The centre line of
    the imported road is the inner edge of the innermost driving lane: the edge nearest to lane 0. A road that
    is off the map is moved onto it. The file can then be checked, driven and viewed like any other road: it
    holds the size of the map, the move, and the lane width, speed limit and friction that FILE states.

    \b
    roadgpt import town.xodr --road 12
    """
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
            own = next(own for own in numbered(_plain(source.name), ".json") if own not in taken)
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
    return UNREADABLE if len(taken) < len(found) else 0


def _plain(name: str) -> str:
    return "".join(c if c.isalnum() or c in "-_." else "_" for c in name)[:100].lstrip(".") or "road"


def _free(stem: str, ending: str) -> Path:
    return next(path for path in map(Path, numbered(_plain(stem), ending)) if not path.exists())


def _write(file: Path, source: "RoadSource", out: Path, keep_place: bool, quiet: bool) -> str:
    """Writes a road file, prints remarks, and returns in a sentence what the road is like."""
    from roadgpt import plugins
    from roadgpt.brief import sentence
    from roadgpt.check.describing import describe
    from roadgpt.check.measures import ups_and_downs
    from roadgpt.road import Road, World

    assert isinstance(source.blueprint, Road)
    road, size, moved_by, told = on_a_map(source.blueprint, World().changed(**source.world), keep_place)
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
