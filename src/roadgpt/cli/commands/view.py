"""``roadgpt view``: writes a page with the road in 3-D and a replay of its drive, or pictures."""

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from roadgpt.cli import options
from roadgpt.cli.option import Argument, Heading, Option, named
from roadgpt.cli.option_groups import GroupedCommand
from roadgpt.cli.option_types import PATH, picture_formats
from roadgpt.cli.option_types import folder as folder_of
from roadgpt.cli.roads import NamedRoad, check_file, numbered, open_page, run_of, shown_roads, use_each
from roadgpt.errors import UsageError, explained

if TYPE_CHECKING:
    from roadgpt.report import Format, Scale
    from roadgpt.road import Geometry, World

MOST = 2  # roads side by side
PAGE, PLOTS = "-view.html", Path("plots")  # the end of the name of a page
ENDINGS = (".html", ".htm")


ADVICE = "Name a road file or the folder of a run, or two to see them side by side."
OPTIONS = (
    *options.CHOICES,
    Option("--out", f"The page, or the folder for pictures. [default: ROAD{PAGE}, {PLOTS}]", PATH,
           metavar="PATH", heading=Heading.FILES),
    options.OPEN.but(heading=Heading.FILES),
    Option("--format formats", "Draw pictures instead of the page: png, svg, pdf.", picture_formats,
           metavar="FORMAT,...", heading=Heading.FILES),
    *(options.AXES, *named(options.WORLD, "map_size"), *named(options.SETUP, "geometry"), options.QUIET),
)  # fmt: skip


@click.command(cls=GroupedCommand, params=[Argument("files...", "ROAD|RUN...", ADVICE), *OPTIONS])
@click.pass_context
def command(
    ctx: click.Context, /, files: tuple[str, ...], out: Path | None, opens: bool, formats: Any, axes: Any,
    geometry: Any, quiet: bool, **rest: Any,
) -> int | None:  # fmt: skip
    """View a road in 3-D with a replay of its drive, or two roads side by side; or draw pictures.

    ROAD is a RoadGPT design, an SBFT test, a list of points or an OpenDRIVE file. RUN is a run, such as
    DIR/runs/0001 or DIR/test.0001.json, or a test of a campaign, such as CAMPAIGN/c01/17; its drive is shown.

    Without --format, writes one page that needs no server and no network, named after the road. With
    --format, saves pictures of each road (top view, height, curvature and grade) in a subfolder of --out.
    Prints the names of the files.

    \b
    roadgpt view roadgpt-runs/hairpins-7/runs/0001 --open
    roadgpt view DIR/runs/0001 DIR/runs/0002 --out compared.html
    roadgpt view CAMPAIGN --worst --format pdf
    """
    choice, world = options.choice_of(rest), options.world_of(rest)
    if formats:
        if opens:
            raise UsageError("--open is for the page; leave out --format")
        place = folder_of(str(out)) if out is not None else PLOTS
        draw_one = partial(_draw_pictures, place, axes, formats, world, geometry, quiet)
        return use_each(files, choice, draw_one) or None
    if "axes" in options.typed(ctx):
        raise UsageError("--axes is for pictures; say --format png as well")
    roads = shown_roads(files, choice, MOST, "a page")
    out = out or Path("-and-".join(each.stem for each in roads) + PAGE)
    check_file(out, "page", Path(roads[0].stem + PAGE), ENDINGS)
    from roadgpt.report.view import write

    page = write([run_of(each, world, geometry) for each in roads], out)
    if not quiet:
        click.echo(str(page))
    if opens:
        open_page(page)
    return None


def _draw_pictures(
    out: Path,
    axes: "Scale",
    formats: "tuple[Format, ...]",
    world: "World",
    geometry: "Geometry",
    quiet: bool,
    named: NamedRoad,
) -> None:
    """Draws pictures of a road into a new folder in ``out``, named after the road, and prints their paths.
    ``world`` and ``geometry`` are for road files, which do not contain them.
    """
    from roadgpt.report import draw

    run = run_of(named, world, geometry)
    pictures = draw(run, _place(out, named.stem), axes, formats)
    if not quiet:
        click.echo("\n".join(str(picture) for picture in pictures))


def _place(out: Path, name: str) -> Path:
    with explained(UsageError, f"cannot make a folder in {out}", "give another one with --out"):
        for place in (out / own for own in numbered(name)):
            try:
                place.mkdir(parents=True)
            except FileExistsError:
                continue
            return place
    raise AssertionError("some number is always free")
