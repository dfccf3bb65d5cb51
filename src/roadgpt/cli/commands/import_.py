"""``roadgpt import``: a road out of somebody else's OpenDRIVE file."""

import json
import shlex
from pathlib import Path
from typing import TYPE_CHECKING

import click

from roadgpt.cli.flags import WORLD
from roadgpt.errors import RoadGPTError

if TYPE_CHECKING:
    from roadgpt.road import Imported, Road

ROOM = 20.0  # m kept free around a road that is moved onto the map
LARGEST_MAP = 10_000.0  # m
ROUND = 50.0  # m, to which a map's size is rounded up


@click.command()
@click.argument("file", metavar="FILE.xodr", type=click.Path(path_type=Path))
@click.option("--road", "wanted", default=None, help="Its id. [default: the longest outside of junctions]")
@click.option(
    "--out",
    type=click.Path(path_type=Path, dir_okay=False),
    default=None,
    help="Road file to write. [default: a new one named after FILE and the road]",
)
@click.option("--keep-place", is_flag=True, help="Leave its coordinates as they are, on the map or off it.")
@click.option("--quiet", "-q", is_flag=True, help="Say nothing but errors.")
def command(file: Path, wanted: str | None, out: Path | None, keep_place: bool, quiet: bool) -> None:
    """Take a road out of an OpenDRIVE file, and say in words what it is like.

    Lines, arcs, spirals, poly3, paramPoly3, elevation and widths are read; the centre line of the road is the
    inner edge of the lane that is driven. The road can be checked, driven and drawn like any other. Where it
    lies off the map it is moved onto it.

    \b
    roadgpt import town.xodr --road 12
    """
    from roadgpt.brief import sentence
    from roadgpt.check.describing import describe
    from roadgpt.road import World, read_opendrive

    found = read_opendrive(file, wanted)
    road, size, told = (found.road, World().map_size, "") if keep_place else _on_a_map(found.road)
    for remark in () if quiet else (*found.remarks, *([told] if told else [])):
        click.echo(f"roadgpt: {file}: {remark}", err=True)
    out = out or _new(Path.cwd(), f"{file.stem}-{found.id}")
    try:
        out.parent.mkdir(parents=True, exist_ok=True)
        out.write_text(json.dumps(road.to_json()) + "\n", encoding="utf-8")
    except OSError as error:
        raise RoadGPTError(f"cannot write {out}: {error.strerror}; name another file with --out") from error
    if not quiet:
        name = f" ({found.name})" if found.name else ""
        click.echo(f"road {found.id}{name}: {sentence(describe(road))}")
        click.echo(f"written to {out}; drive it: {_drive(out, found, size)}")


def _on_a_map(road: "Road") -> tuple["Road", float, str]:
    """The road on a map that is large enough, the map's size, and what was done."""
    from roadgpt.road import World, moved

    points = road.centreline()[:, :2]
    low, high = points.min(axis=0), points.max(axis=0)
    wide = float((high - low).max()) + 2 * ROOM
    size = max(World().map_size, ROUND * -(-wide // ROUND))
    if size > LARGEST_MAP:
        return road, LARGEST_MAP, f"it is {wide:.0f} m wide, too large for a map; its place is kept"
    if (low >= 0).all() and (high <= size).all():
        return road, size, ""
    x, y = (round(float(each), 3) for each in size / 2 - (low + high) / 2)
    return moved(road, x, y), size, f"it is moved by ({x:g}, {y:g}) m into the middle of the map"


def _drive(file: Path, found: "Imported", size: float) -> str:
    """The command that drives the road, with lanes and limits as the OpenDRIVE file has them."""
    from roadgpt.road import World

    world = found.world(World(map_size=size))
    # as a sign shows it: files in m/s are no whole km/h to the last digit
    world = world.model_copy(update={"speed_limit": round(world.speed_limit * 3.6, 3) / 3.6})
    words = [word for flag in WORLD for word in flag.written(getattr(world, flag.field))]
    return shlex.join(["roadgpt", "drive", str(file), *words])


def _new(folder: Path, stem: str) -> Path:
    """A file name that is not taken."""
    plain = "".join(c if c.isalnum() or c in "-_." else "_" for c in stem)[:100]
    number, path = 1, Path(f"{plain}.json")
    while (folder / path).exists():
        number += 1
        path = Path(f"{plain}-{number}.json")
    return path
