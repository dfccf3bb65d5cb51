"""Commands that show roads: ``roadgpt show``, ``view``, ``compare`` and ``scenarios``."""

import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

import click

from roadgpt.cli import options, roads
from roadgpt.cli.options import PATH, Argument, GroupedCommand, Heading, Option, named, picture_formats
from roadgpt.cli.options import folder as folder_of
from roadgpt.errors import RoadGPTError, UsageError, explained

MOST = 2  # roads side by side
SHOW_OPTIONS = (
    Argument("folders...", "RUN...", "Name the folder of a run, a folder of runs, or a campaign."),
    *options.CHOICES,
    Option("--rejudge", "Judge stored drives again: which outcomes would be others today, and why.", bool),
    options.json_option("Print one JSON object for each campaign or road.", heading=Heading.OUTPUT),
)


@click.command(cls=GroupedCommand, params=[*SHOW_OPTIONS])
def show(folders: tuple[str, ...], as_json: bool, rejudge: bool, **rest: Any) -> None:
    """Summarise a run, a folder of runs or a campaign, and print the command that repeats it.

    RUN is a run, such as DIR/runs/0001 or DIR/test.0001.json; the folder DIR that holds the runs; a campaign;
    a cell of a campaign, such as CAMPAIGN/c01; or a test of a campaign, such as CAMPAIGN/c01/17.

    \b
    roadgpt show roadgpt-runs/hairpins-7
    roadgpt show CAMPAIGN --failures
    roadgpt show --rejudge DIR"""
    from roadgpt.cli.summary import json_lines, rejudged_lines, text_lines

    choice = options.choice_of(rest)
    if rejudge:
        if choice:
            raise UsageError(f"--rejudge judges all drives of a folder again; leave out --{choice}")
        for line in rejudged_lines(folders, as_json):
            click.echo(line)
        return
    for folder in folders:
        for line in (json_lines if as_json else text_lines)(folder, choice):
            click.echo(line)


PAGE, PLOTS = "-view.html", Path("plots")  # the end of the name of a page
VIEW_ENDINGS = (".html", ".htm")
VIEW_OPTIONS = (
    Argument("files...", "ROAD|RUN...", "Name a road file or the folder of a run, or two to see them side by "
             "side."),
    *options.CHOICES,
    Option("--out", f"The page, or the folder for pictures. [default: ROAD{PAGE}, {PLOTS}]", PATH,
           metavar="PATH", heading=Heading.FILES),
    options.OPEN.but(heading=Heading.FILES),
    Option("--format formats", "Draw pictures instead of the page: png, svg, pdf.", picture_formats,
           metavar="FORMAT,...", heading=Heading.FILES),
    *(options.AXES, *named(options.WORLD, "map_size", "ground"), *named(options.SETUP, "geometry")),
    options.QUIET,
)  # fmt: skip


@click.command(cls=GroupedCommand, params=[*VIEW_OPTIONS])
@click.pass_context
def view(
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
    roadgpt view CAMPAIGN --worst --format pdf"""
    choice, world = options.choice_of(rest), options.world_of(rest)
    if formats:
        if opens:
            raise UsageError("--open is for the page; leave out --format")
        place = folder_of(str(out)) if out is not None else PLOTS
        from roadgpt.report import draw

        def draw_one(named: roads.NamedRoad) -> None:
            run = roads.run_of(named, world, geometry)
            pictures = draw(run, roads.made(roads.free(place / named.stem)), axes, formats)
            if not quiet:
                click.echo("\n".join(map(str, pictures)))

        return roads.use_each(files, choice, draw_one) or None
    if "axes" in options.typed(ctx):
        raise UsageError("--axes is for pictures; say --format png as well")
    shown = roads.shown_roads(files, choice, MOST, "a page")
    out = out or Path("-and-".join(each.stem for each in shown) + PAGE)
    roads.check_file(out, "page", Path(shown[0].stem + PAGE), VIEW_ENDINGS)
    from roadgpt.report.view import write

    page = write([roads.run_of(each, world, geometry) for each in shown], out)
    if not quiet:
        click.echo(str(page))
    if opens:
        roads.open_page(page)
    return None


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
COMPARE_OPTIONS = (
    Argument("one", "A"),
    Argument("other", "B"),
    Option("--out", "The picture: .png, .svg or .pdf. An existing file is replaced.", PATH, PICTURE,
           metavar="FILE.png"),
    Option("--no-plot", "Draw no picture.", bool),
    Option("--mirror", "Treat a road and its mirror image as alike.", bool),
    options.json_option(),
    options.AXES,
    *named(options.WORLD, "map_size"),
    *named(options.SETUP, "geometry"),
)  # fmt: skip


@click.command(cls=GroupedCommand, params=[*COMPARE_OPTIONS])
def compare(
    one: str, other: str, out: Path, no_plot: bool, mirror: bool, as_json: bool, axes: Any, **rest: Any
) -> None:
    """Measure how similar two roads are, and plot them in two panels, one above the other.

    A and B are runs, tests of campaigns or road files. A similarity is a number from 0 (nothing in
    common) to 1 (identical). Moving or rotating a road does not change the
    similarity.

    \b
    roadgpt compare DIR/runs/0001 DIR/runs/0002
    roadgpt compare a.json b.json --axes thesis --mirror"""
    from roadgpt.network import refuse_without_route
    from roadgpt.report.canvas import format_of, save
    from roadgpt.report.pair import pair
    from roadgpt.report.similarity import compare

    if not no_plot:
        format_of(out)
    world = options.world_of(rest)
    named = [roads.shown_roads([file], None, 1, "it")[0] for file in (one, other)]
    runs = [roads.run_of(each, world, rest["geometry"]) for each in named]
    both = []
    for file, run in zip((one, other), runs, strict=True):
        if run.road is None:
            raise UsageError(f"there is no road in {file}; give a run that has one")
        with roads.named_in_errors(file):
            refuse_without_route(run.road, "compared")
        both.append(run.road)
    found = compare(both[0], both[1], mirror)
    if as_json:
        click.echo(json.dumps({**asdict(found), "general": found.general, "duplicate": found.is_duplicate}))
    else:
        more = {"shape": f"  {found.metres:.1f} m apart", "incline": f"  {found.points:.1f} points apart"}
        for name, said in NAMES.items():
            click.echo(f"{said:<30} {getattr(found, name):5.2f}{more.get(name, '')}")
        if found.is_duplicate:
            click.echo("near duplicates: they are one test rather than two")
    if not no_plot:
        roads.check_file(out, "picture", PICTURE)
        with explained(RoadGPTError, f"cannot write {out}", "name another file with --out"):
            out.parent.mkdir(parents=True, exist_ok=True)
            save(pair(runs[0], runs[1], axes), out)
        click.echo(str(out), err=as_json)


@click.command(
    cls=GroupedCommand,
    params=[
        Argument("names...", "NAME", required=False),
        options.json_option("Print one JSON object for each scenario.", heading=Heading.OUTPUT),
        Option(
            "--score",
            "Test a driver on scenarios, and colour the results by Euro NCAP's classes: "
            "--score 'ncap:*' lane_centring.",
            metavar="SET DRIVER",
            nargs=2,
        ),
        Option(
            "--grid",
            "With --score: nominal values, or the standard grid.",
            click.Choice(["nominal", "standard"]),
            "nominal",
        ),
        options.seed("With --score: the same seed gives the same.", 0),
        options.out(
            "With --score: folder for the tests, which goes on where it was interrupted. [default: a new one]"
        ),
    ],
)
def scenarios(
    names: tuple[str, ...], as_json: bool, score: tuple[str, str] | None, out: Path | None, **given: Any
) -> None:
    """List the scenarios of the catalogue, or show those of a name whole: with the units of their parameters,
    standard grid, scene and nominal road.

    The values behind a scenario are those that --scenario of run, drive and campaign can change.

    \b
    roadgpt scenarios
    roadgpt scenarios r157:cut_in
    roadgpt scenarios "ncap:CP*" --json
    roadgpt run "a country road with wide bends" --scenario "r157:cut_in gap=20"
    roadgpt scenarios --score "ncap:*" lane_centring --grid standard
    """
    if score:
        _score(*score, out, given)
        return
    from roadgpt.brief.scenarios import MISSING, Missing, chosen

    source = ""
    for each in (*chosen(",".join(names) or "*"), *(() if names else MISSING.values())):
        if as_json:
            told = each._asdict()
            if not isinstance(each, Missing):
                told |= {"scene": each.scene_text, "template": each.scene, "road": each.plan}
            click.echo(json.dumps(told, ensure_ascii=False))
            continue
        if each.source.partition(";")[0] != source:
            source = each.source.partition(";")[0]
            click.echo(f"{click.wrap_text(source, 80)}\n" if not names else "", nl=False)
        rows = [("", each.says)]
        if isinstance(each, Missing):
            rows.append(("", f"not possible: {each.impossible}"))
        elif names:
            rows += [("source", each.source), ("scene", each.scene_text), ("road", each.plan)]
            rows += [("avoidable", f"by {each.avoidable}"), ("judged", f"by {each.judged}")]
            rows += [("within", f"{limit}, {what}") for what, limit in each.tolerances.items()]
            known = each.parameters
            rows += [(f"{name}={value}", known[name][1] or "a word") for name, value in each.values.items()]
            for block in each.grid:
                lists = (f"{name} {' '.join(map(str, values))}" for name, values in block.items())
                rows.append(("grid", "; ".join(lists)))
        else:
            rows.append(("", " ".join(f"{name}={value}" for name, value in each.values.items())))
        click.echo(f"  {each.name}")
        wide = max(len(head) for head, _ in rows)
        for head, said in rows:
            indent = " " * (6 + wide)
            click.echo(click.wrap_text(said, 80, f"    {head:<{wide}}  ", indent))


def _score(names: str, driver: str, out: Path | None, given: dict[str, Any]) -> None:
    """Tests a driver on scenarios in a campaign, and prints the scores, which its report has, too."""
    from roadgpt.campaign.record import Record
    from roadgpt.cli.commands.evaluate import write_report
    from roadgpt.cli.commands.search import campaign
    from roadgpt.report.chapters.score import lines, score
    from roadgpt.run.folder import new_folder

    out = out or new_folder(f"score {names} {driver}", given["seed"])
    words = ["--scenario", names, "--driver", driver, "--out", str(out)]
    words += [word for name, value in given.items() for word in (f"--{name}", str(value))]
    campaign.main(words, "roadgpt campaign", standalone_mode=False)
    with Record.opened(out) as record:
        found = score(record)
    for line in lines(found) if found else ():
        click.echo(
            "".join(click.style(text, fg="black", bg=GROUNDS[to]) if to else text for text, to in line)
        )
    click.echo(f"page: {write_report(out)}")


GROUNDS = {
    "green": (63, 191, 107), "yellow": (255, 221, 51), "orange": (255, 153, 51), "brown": (185, 129, 79),
    "red": (255, 107, 107), "grey": (184, 184, 184),
}  # fmt: skip
"""Of colours on the terminal, as on pages."""
