"""``roadgpt compare``: measures how alike two roads are."""

import json
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from roadgpt.cli.option_groups import GroupedCommand
from roadgpt.cli.options import axes_option, setup_options, world_of, world_options
from roadgpt.cli.roads import shown_run
from roadgpt.errors import RoadGPTError, UsageError

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


@click.command(cls=GroupedCommand)
@click.argument("one", metavar="A")
@click.argument("other", metavar="B")
@click.option(
    "--out", type=click.Path(path_type=Path), default=PICTURE, show_default=True, metavar="FILE.png",
    help="The picture: .png, .svg or .pdf. An existing file is replaced.",
)  # fmt: skip
@click.option("--no-plot", is_flag=True, help="Draw no picture.")
@click.option("--mirror", is_flag=True, help="Treat a road and its mirror image as alike.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
@axes_option
@world_options("map_size")
@setup_options("geometry")
def command(
    one: str,
    other: str,
    out: Path,
    no_plot: bool,
    mirror: bool,
    as_json: bool,
    axes: Any,
    geometry: Any,
    **rest: Any,
) -> None:
    """Measure how similar two roads are, and plot one above the other, as in RoadGPT's thesis.

    A and B are runs, tests of campaigns or road files. A similarity is a number from 0 (nothing in
    common) to 1 (identical). Moving or rotating a road does not change it.

    \b
    roadgpt compare DIR/runs/0001 DIR/runs/0002
    roadgpt compare a.json b.json --axes thesis --mirror
    """
    from roadgpt.report.canvas import format_of
    from roadgpt.study import compare

    if not no_plot:
        format_of(out)
    world = world_of(rest)
    runs = [shown_run(file, world, geometry) for file in (one, other)]
    roads = [run.road for run in runs if run.road is not None]
    if len(roads) < 2:
        missing = one if runs[0].road is None else other
        raise UsageError(f"there is no road in {missing}; give a run that has one")
    found = compare(roads[0], roads[1], mirror)
    if as_json:
        click.echo(json.dumps({**asdict(found), "general": found.general, "duplicate": found.is_duplicate}))
    else:
        _tell(found)
    if not no_plot:
        _draw(runs, out, axes)
        click.echo(str(out), err=as_json)


def _tell(found: "Similarity") -> None:
    for name, said in NAMES.items():
        more = {"shape": f"  {found.metres:.1f} m apart", "incline": f"  {found.points:.1f} points apart"}
        click.echo(f"{said:<30} {getattr(found, name):5.2f}{more.get(name, '')}")
    if found.is_duplicate:
        click.echo("near duplicates: they are one test rather than two")


def _draw(runs: list[Any], out: Path, axes: Any) -> None:
    from roadgpt.report.canvas import save
    from roadgpt.report.pair import pair

    if out.is_dir():
        raise UsageError(f"{out} is a folder; give the name of a picture, such as {out / PICTURE}")
    try:
        out.parent.mkdir(parents=True, exist_ok=True)
        save(pair(runs[0], runs[1], axes), out)
    except OSError as error:
        raise RoadGPTError(
            f"cannot write {out}: {error.strerror or error}; name another file with --out"
        ) from error
