"""``roadgpt view``: writes a page with the road in 3-D and a replay of its drive, or pictures."""

import webbrowser
from pathlib import Path
from typing import Any

import click
from click.core import ParameterSource

from roadgpt.cli.draw_pictures import PLOTS, draw_pictures
from roadgpt.cli.option import FILES, Option, named
from roadgpt.cli.option_groups import GroupedCommand
from roadgpt.cli.option_types import PATH, picture_formats
from roadgpt.cli.option_types import folder as folder_of
from roadgpt.cli.options import AXES, CHOICES, OPEN, QUIET, SETUP, WORLD, choice_of, world_of
from roadgpt.cli.roads import shown_runs
from roadgpt.errors import UsageError

MOST = 2  # roads side by side
PAGE = Path("roadgpt-view.html")
ENDINGS = (".html", ".htm")


OPTIONS = (
    *CHOICES,
    Option("--out", f"The page, or the folder for pictures. [default: {PAGE}, {PLOTS}]", PATH, metavar="PATH",
           heading=FILES),
    OPEN.under(FILES),
    Option("--format formats", "Draw pictures instead of the page: png, svg, pdf.", picture_formats,
           metavar="FORMAT,...", heading=FILES),
    *(AXES, *named(WORLD, "map_size"), *named(SETUP, "geometry"), QUIET),
)  # fmt: skip


@click.command(
    cls=GroupedCommand,
    params=[click.Argument(["files"], nargs=-1, required=True, metavar="ROAD|RUN..."), *OPTIONS],
)
@click.pass_context
def command(
    ctx: click.Context, /, files: tuple[str, ...], out: Path | None, opens: bool, formats: Any, axes: Any,
    geometry: Any, quiet: bool, **rest: Any,
) -> int | None:  # fmt: skip
    """View a road in 3-D with a replay of its drive, or two roads side by side; or draw pictures.

    ROAD is a RoadGPT design, an SBFT test, a list of points or an OpenDRIVE file. RUN is a run, such as
    DIR/runs/0001 or DIR/test.0001.json, or a test of a campaign, such as CAMPAIGN/c01/17; its drive is shown.

    Without --format, writes one page that needs no server and no network. With --format, saves pictures of
    each road (top view, height, curvature and grade) in a new folder OUT/NAME. Prints the names of the files.

    \b
    roadgpt view roadgpt-runs/hairpins-7/runs/0001 --open
    roadgpt view DIR/runs/0001 DIR/runs/0002 --out compared.html
    roadgpt view CAMPAIGN --worst --format pdf
    """
    choice, world = choice_of(rest), world_of(rest)
    if formats:
        if opens:
            raise UsageError("--open is for the page; leave out --format")
        place = folder_of(str(out)) if out is not None else PLOTS
        return draw_pictures(files, choice, place, axes, formats, world, geometry, quiet) or None
    if ctx.get_parameter_source("axes") is ParameterSource.COMMANDLINE:
        raise UsageError("--axes is for pictures; say --format png as well")
    out = out or PAGE
    if out.is_dir():
        raise UsageError(f"{out} is a folder; give the name of a page, such as {out / PAGE}")
    if out.suffix.lower() not in ENDINGS:
        raise UsageError(f"{out} does not end in .html; give the page such a name")
    from roadgpt.report.view import write

    page = write(shown_runs(files, choice, world, geometry, MOST, "a page"), out)
    if not quiet:
        click.echo(str(page))
    if opens and not webbrowser.open(page.resolve().as_uri()):
        click.echo(f"roadgpt: no browser could be started; open {page} in one", err=True)
    return None
