"""``roadgpt import``: reads a road from an OpenDRIVE file."""

import json
import shlex
from pathlib import Path
from typing import TYPE_CHECKING

import click

from roadgpt.cli import options
from roadgpt.cli.option import Argument, Option, words_of
from roadgpt.cli.option_groups import GroupedCommand
from roadgpt.cli.option_types import PATH
from roadgpt.cli.roads import numbered
from roadgpt.cli.streams import warn
from roadgpt.errors import RoadGPTError, explained

if TYPE_CHECKING:
    from roadgpt.road import ImportedRoad, Road, World

ROOM = 20.0  # m kept free around a road that is moved onto the map
ROUND = 50.0  # m, to which a map's size is rounded up


OPTIONS = (
    Option("--road wanted", "Id of the road. [default: the longest with a driving lane]"),
    Option("--out", "Road file to write. [default: named after FILE and the road]",
           click.Path(path_type=Path, dir_okay=False)),
    Option("--keep-place", "Keep the coordinates, even if the road is off the map.", bool),
    options.QUIET,
)  # fmt: skip


@click.command(
    cls=GroupedCommand, params=[Argument("file", "FILE.xodr", "Name an OpenDRIVE file.", PATH), *OPTIONS]
)
def command(file: Path, wanted: str | None, out: Path | None, keep_place: bool, quiet: bool) -> None:
    """Read a road from an OpenDRIVE file, write it as a road file, and describe it in words.

    Lines, arcs, spirals, poly3, paramPoly3, elevation and widths are read. The centre line of the
    imported road is the inner edge of the innermost driving lane: the edge nearest to lane 0. A road that is
    off the map is moved onto it. The file can then be checked, driven and viewed like any other road.

    \b
    roadgpt import town.xodr --road 12
    """
    from roadgpt.brief import sentence
    from roadgpt.check.describing import describe
    from roadgpt.road import World, read_opendrive

    found = read_opendrive(file, wanted)
    road, world, told = (found.road, found.world(World()), []) if keep_place else _on_a_map(found)
    for remark in () if quiet else (*found.remarks, *told):
        warn(f"{file}: {remark}")
    stem = f"{file.stem}-{found.id}"
    plain = "".join(c if c.isalnum() or c in "-_." else "_" for c in stem)[:100]
    out = out or next(path for path in map(Path, numbered(plain, ".json")) if not path.exists())
    with explained(RoadGPTError, f"cannot write {out}", "name another file with --out"):
        out.parent.mkdir(parents=True, exist_ok=True)
        out.write_text(json.dumps(road.to_json()) + "\n", encoding="utf-8")
    if not quiet:
        name = f" ({found.name})" if found.name else ""
        click.echo(f"road {found.id}{name}: {sentence(describe(road))}")
        click.echo(f"written to {out}; drive it: {_drive(out, world)}")


def _on_a_map(found: "ImportedRoad") -> tuple["Road", "World", list[str]]:
    """Returns the road moved onto a map, the World with that map, and remarks on what was changed."""
    from roadgpt.brief.map_fit import LARGEST_MAP
    from roadgpt.check.extremes import lowest
    from roadgpt.check.ribbon import extent
    from roadgpt.check.sbft import SPLINE_REACH
    from roadgpt.road import World, moved

    road, world, remarks = found.road, found.world(World()), []
    low, high = extent(road.sample(), world.profile_of(road).edges(road.sample().s))
    wide = float((high - low).max()) + 2 * ROOM
    size = max(world.site.map_size, ROUND * -(-wide // ROUND))
    if size > LARGEST_MAP:
        remarks.append(f"with its lanes it is {wide:.0f} m wide, too large for a map; its place is kept")
        size, x, y = LARGEST_MAP, 0.0, 0.0
    elif (low > SPLINE_REACH).all() and (high < size - SPLINE_REACH).all():
        x, y = 0.0, 0.0
    else:
        x, y = (round(float(each), 3) for each in size / 2 - (low + high) / 2)
        remarks.append(f"it is moved by ({x:g}, {y:g}) m into the middle of the map")
    deepest = lowest(road.elevation, road.length)[1]
    z = round(-deepest, 3) if deepest < world.site.z_floor else 0.0
    if z:
        remarks.append(f"it is lifted by {z:g} m: its lowest place was below the ground of the map")
    return moved(road, x, y, z), world.changed(map_size=size), remarks


def _drive(file: Path, world: "World") -> str:
    """Returns the command that drives the road with the lanes and limits of the OpenDRIVE file."""
    from roadgpt.road import World

    # as a sign shows it: files in m/s are no whole km/h to the last digit
    world = world.changed(speed_limit=round(world.limits.speed_limit * 3.6, 3) / 3.6)
    words = words_of(options.WORLD, world.values(), World().values())
    return shlex.join(["roadgpt", "drive", str(file), *words])
