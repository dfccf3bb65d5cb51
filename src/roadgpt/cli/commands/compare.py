"""``roadgpt compare``: measures how alike two roads are."""

import json
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from roadgpt.cli import options
from roadgpt.cli.option import Argument, Option, named
from roadgpt.cli.option_groups import GroupedCommand
from roadgpt.cli.option_types import PATH
from roadgpt.cli.roads import check_file, named_in_errors, run_of, shown_roads
from roadgpt.errors import RoadGPTError, UsageError, explained

if TYPE_CHECKING:
    from roadgpt.study.similarity import Similarity

PICTURE = Path("compared.png")
NAMES = {
    "turns": "number of turns",
    "sequence": "turns and straights in order",
    "direction": "sides of the turns",
    "length": "length",
    "incline": "incline",
    "shape": "shape from above",
    "general": "in general",
}


OPTIONS = (
    Option("--out", "The picture: .png, .svg or .pdf. An existing file is replaced.", PATH, PICTURE,
           metavar="FILE.png"),
    Option("--no-plot", "Draw no picture.", bool),
    Option("--mirror", "Treat a road and its mirror image as alike.", bool),
    options.json_option(),
    options.AXES,
    *named(options.WORLD, "map_size"),
    *named(options.SETUP, "geometry"),
)  # fmt: skip


@click.command(
    cls=GroupedCommand,
    params=[Argument("one", "A"), Argument("other", "B"), *OPTIONS],
)
def command(
    one: str, other: str, out: Path, no_plot: bool, mirror: bool, as_json: bool, axes: Any, **rest: Any
) -> None:
    """Measure how similar two roads are, and plot them in two panels, one above the other.

    A and B are runs, tests of campaigns or road files. A similarity is a number from 0 (nothing in
    common) to 1 (identical). Moving or rotating a road does not change the
    similarity.

    \b
    roadgpt compare DIR/runs/0001 DIR/runs/0002
    roadgpt compare a.json b.json --axes thesis --mirror
    """
    from roadgpt.network import refuse_without_route
    from roadgpt.report.canvas import format_of, save
    from roadgpt.report.pair import pair
    from roadgpt.study import compare

    if not no_plot:
        format_of(out)
    world = options.world_of(rest)
    named = [shown_roads([file], None, 1, "it")[0] for file in (one, other)]
    runs = [run_of(each, world, rest["geometry"]) for each in named]
    roads = [run.road for run in runs if run.road is not None]
    if len(roads) < 2:
        missing = one if runs[0].road is None else other
        raise UsageError(f"there is no road in {missing}; give a run that has one")
    for file, road in zip((one, other), roads, strict=True):
        with named_in_errors(file):
            refuse_without_route(road, "compared")
    found = compare(roads[0], roads[1], mirror)
    if as_json:
        click.echo(json.dumps({**asdict(found), "general": found.general, "duplicate": found.is_duplicate}))
    else:
        _tell(found)
    if not no_plot:
        check_file(out, "picture", PICTURE)
        with explained(RoadGPTError, f"cannot write {out}", "name another file with --out"):
            out.parent.mkdir(parents=True, exist_ok=True)
            save(pair(runs[0], runs[1], axes), out)
        click.echo(str(out), err=as_json)


def _tell(found: "Similarity") -> None:
    for name, said in NAMES.items():
        more = {"shape": f"  {found.metres:.1f} m apart", "incline": f"  {found.points:.1f} points apart"}
        click.echo(f"{said:<30} {getattr(found, name):5.2f}{more.get(name, '')}")
    if found.is_duplicate:
        click.echo("near duplicates: they are one test rather than two")
