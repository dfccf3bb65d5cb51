"""``roadgpt view``: one page with the road in 3-D and the drive as a replay."""

import webbrowser
from pathlib import Path
from typing import Any

import click

from roadgpt.cli.named import choice_of, choice_options
from roadgpt.cli.options import setup_options, world_of, world_options
from roadgpt.cli.roads import shown_runs
from roadgpt.errors import UsageError

MOST = 2  # roads side by side
PAGE = Path("roadgpt-view.html")
ENDINGS = (".html", ".htm")


@click.command()
@click.argument("files", nargs=-1, required=True, metavar="FILE|RUN [FILE|RUN]")
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    default=PAGE,
    show_default=True,
    metavar="PAGE.html",
    help="The page; one of that name is replaced.",
)
@choice_options
@click.option("--open", "opens", is_flag=True, help="Open the page in the browser.")
@world_options("map_size")
@setup_options("geometry")
def command(files: tuple[str, ...], out: Path, opens: bool, geometry: Any, **rest: Any) -> None:
    """Look at a road in 3-D, and at its drive as a replay; of two roads, side by side.

    FILE is a RoadGPT design, an SBFT test, a list of points or an OpenDRIVE file; RUN is the folder of a run,
    DIR/runs/0001 or DIR/test.0001.json, or a test of a campaign, as CAMPAIGN/c01/17; it brings its drive.
    Writes one page that needs no server and no
    network, so it can be kept and sent, and prints its name.

    \b
    roadgpt view roadgpt-runs/hairpins-7/runs/0001 --open
    roadgpt view DIR/runs/0001 DIR/runs/0002 --out compared.html
    roadgpt view CAMPAIGN --worst --open
    """
    if out.is_dir():
        raise UsageError(f"{out} is a folder; give the name of a page, such as {out / PAGE}")
    if out.suffix.lower() not in ENDINGS:
        raise UsageError(f"{out} would be a web page; give it a name that ends in .html")
    from roadgpt.report.view import write

    runs = shown_runs(files, choice_of(rest), world_of(rest), geometry, MOST, "a page")
    page = write(runs, out)
    click.echo(str(page))
    if opens and not webbrowser.open(page.resolve().as_uri()):
        click.echo(f"roadgpt: no browser could be started; open {page} in one", err=True)
