"""Commands of campaigns: ``roadgpt campaign`` and ``resume``."""

import os
import sys
from collections.abc import Set
from contextlib import redirect_stdout
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from roadgpt import plugins
from roadgpt.cli import options
from roadgpt.cli.commands.evaluate import write_report
from roadgpt.cli.commands.make import beside, understood
from roadgpt.cli.options import (
    PATH,
    Argument,
    GroupedCommand,
    Heading,
    Option,
    measure,
    named,
    refuse_file,
    whole,
)
from roadgpt.cli.roads import MOST_TOLD, named_in_errors, roads_in, source_of
from roadgpt.cli.streams import warn
from roadgpt.errors import PartError, UsageError, command_line
from roadgpt.plural import plural

if TYPE_CHECKING:
    from roadgpt.campaign.plan import Plan
    from roadgpt.chat import ChatSettings
    from roadgpt.report import Scale
    from roadgpt.run import Draw

MOST_TESTS = 10_000_000
TESTS = whole(1, MOST_TESTS, "the number of tests")
SECONDS = measure(0, 1e8, "s", above=True)
BESIDE_A_FILE = {
    "words", "out", "again", "workers", "executor", "address", "drivers", "junit", "as_json", "quiet",
    *(each.field for each in (*options.AT_END, *options.GATE)),
}  # fmt: skip


# fmt: off
CAMPAIGN_OPTIONS = (
    Argument("words...", "DESCRIPTION|FILE.toml",
             'Say what roads: roadgpt campaign "a winding road" --goal failures -n 200', required=False),
    Option("--on", "Test the roads of this folder instead: road files, such as the routes that 'roadgpt "
           "import' writes, runs, or a campaign.", metavar="FOLDER"),
    Option("-n --tests", "Number of tests. [default with --on: that of the roads]", TESTS),
    Option("--goal", "What to search for: failures, coverage (roads as diverse as possible), hardest (least "
           "margin), boundary (just between PASS and FAIL). [default: no search]",
           click.Choice(["failures", "coverage", "hardest", "boundary"])),
    Option("--generator", "Test generator. [default: 'quality_diversity' with --goal, else 'words', which "
           "does not search]"),
    Option("--scenario scenarios", "Test scenarios, on the roads of a description or on their own: 'ncap:*', "
           "r157:cut_in,ncap:CCRb.", metavar="NAME,...", heading=Heading.DRIVE),
    Option("--grid", "With --scenario: test each with its nominal values, or on its standard grid.",
           click.Choice(["nominal", "standard"]), "nominal", heading=Heading.DRIVE),
    Option("--seconds", "Start no more tests after this many seconds.", SECONDS),
    options.seed("The same seed gives the same table.", 0),
    options.out("Folder for the campaign. [default: a new one]"),
    options.AGAIN,
    *options.WORKERS,
    *(options.PLAN, *named(options.SETUP, "reader", "designer")),
    Option("--driver --drivers drivers", "Name of a driver, or FILE.py:CLASS; for more drivers, repeat the "
           "option or separate them by commas: a,b:key=value. If FILE.toml lists a driver file, RoadGPT runs "
           "it only if you name it here, too.", options.drivers, ("lane_centring",), multiple=True,
           heading=Heading.DRIVE, table="run", guard=options.driver_guard,
           callback=lambda _, __, given: tuple(chain.from_iterable(given))),
    Option("--paired", "Compare the drivers on the same roads at the end, in a report.", bool,
           heading=Heading.DRIVE),
    *named(options.SETUP, "simulator", "keep_driving"),
    *options.WORLD,
    *named(options.SETUP, "geometry", "rules"),
    *(options.NO_DRIVE, *options.CHAT, *options.AT_END, *options.GATE, options.JUNIT),
    *(options.json_option("Print one JSON object at the end.", heading=Heading.OUTPUT), options.QUIET),
)
# fmt: on


@click.command(cls=GroupedCommand, has_simulators=True, params=[*CAMPAIGN_OPTIONS])
@click.pass_context
def campaign(ctx: click.Context, /, words: tuple[str, ...], out: Path | None, **given: Any) -> None:
    """Search for roads that a driver fails on, or make thousands of roads.

    Give a description, or a FILE.toml that lists prompts, designers, drivers, simulators and seeds; each
    combination is then a cell with tests of its own. With --on, the roads of a folder are tested instead. A
    campaign can be resumed after Ctrl-C, a crash or a power cut. The table of results depends neither on
    interruptions nor on the number of workers.

    \b
    roadgpt campaign --on routes --drivers lane_centring,pure_pursuit --paired
    roadgpt campaign "an uphill road with 3 turns" --goal failures -n 200 -j 2 --seed 7
    roadgpt campaign --scenario "ncap:*" --grid standard --driver lane_centring -j 2
    roadgpt campaign study.toml -j 16 --out study
    roadgpt show study"""
    from roadgpt.campaign.lifecycle import begin
    from roadgpt.run.atomic import to_bytes
    from roadgpt.run.folder import new_folder

    if not (words or given["on"] or given["scenarios"]):
        raise click.MissingParameter(ctx=ctx, param=ctx.command.params[0])
    text = to_bytes(" ".join(words)).decode()  # what a broken terminal put into it becomes an escape
    refuse_file(text, "tests", "campaign", "--on")
    plan, told = _filed(ctx, Path(text), given) if text.endswith(".toml") else _described(ctx, text, given)
    plan, roads = _given(plan, told, given["quiet"]) if plan.on else (plan, ())
    plan.check()
    plugins.find("executors", given["executor"])
    if out is None:
        out = new_folder(
            Path(text).stem if text.endswith(".toml") else text or given["on"] or given["scenarios"],
            plan.seeds[0],
        )
    given["gate"] = options.gate_of(given, out)
    with redirect_stdout(sys.stderr):  # a user's driver is loaded, and may print
        was_there = begin(plan, out, given.pop("again"), roads)
    if not given["quiet"] and not given["as_json"]:
        _tell(out, plan, was_there)
    work_to_the_end(out, given)


def work_to_the_end(
    folder: Path, given: dict[str, Any], chat: "ChatSettings | None" = None, draw: "Draw | None" = None
) -> None:
    """Runs the remaining tests of a campaign or a folder of runs and prints the results.

    ``given`` holds the gate, which decides last, and the values of the options, which can request a JUnit
    file and analyses of the tests. ``chat`` has the settings of the language model if the user changed
    a limit. ``draw`` adds pictures and road files to a folder of runs."""
    from roadgpt.campaign.lifecycle import work
    from roadgpt.campaign.record import Record
    from roadgpt.cli.summary import watch

    again = given.get("again", False)
    steps = work(folder, given["workers"], given["executor"], given["address"], chat, draw, again)
    watch(folder, steps, given["as_json"], given["quiet"], given["gate"])
    if given["junit"] is not None:
        from roadgpt.cli.junit import suites_of, write_junit

        write_junit(given["junit"], [*suites_of(folder, given["gate"].worse)])
    with Record.opened(folder) as record:
        if record.plan().paired:
            from roadgpt.report.chapters.same_roads import compared

            page = write_report(folder)
            if not given["quiet"]:
                click.echo("\n".join([*compared(record), f"report: {page}"]), err=given["as_json"])
    for name in plugins.names("analyses"):
        plugins.find("analyses", name).at_end(folder, given)
    given["gate"].close()


def _filed(ctx: click.Context, path: Path, rest: dict[str, Any]) -> "tuple[Plan, Set[str]]":
    """Returns the plan in a file, and the fields of the World that it sets."""
    from roadgpt.campaign.plan import read_plan
    from roadgpt.chat import configured
    from roadgpt.drive.loading import check_named_drivers
    from roadgpt.settings import Layer

    typed = options.typed(ctx)
    wrong = typed - BESIDE_A_FILE - {flag.field for flag in options.CHAT}
    for parameter in ctx.command.params:
        if parameter.name in wrong:
            raise UsageError(f"{parameter.opts[0]} cannot be given with {path}; write it into the file")
    written = read_plan(path)
    check_named_drivers(rest["drivers"] if "drivers" in typed else (), {*written.plan.drivers}, path)
    if not written.plan.asks_a_model:
        return written.plan, written.world
    chat = configured(options.chat_values(rest), Layer(str(path), tables={"chat": written.chat}))
    return written.plan.model_copy(update={"chat": chat}), written.world


OF_DESIGN = {"words", "goal", "generator", "is_plan", "reader", "designer"}


def _described(ctx: click.Context, text: str, rest: dict[str, Any]) -> "tuple[Plan, Set[str]]":
    """Returns the plan of a description or of given roads, and the fields of the World that were typed."""
    from roadgpt.brief.scenarios import points_of
    from roadgpt.campaign.model import WITH_GOAL, WITHOUT_GOAL, CellBudget
    from roadgpt.campaign.plan import Plan

    told = options.typed(ctx)
    wrong = OF_DESIGN | {flag.field for flag in options.CHAT} if rest["on"] else set()
    for parameter in ctx.command.params:
        if parameter.name in wrong & told:
            what = parameter.opts[0] if isinstance(parameter, Option) else "a description"
            raise UsageError(
                f"--on tests roads that are there, and {what} is for roads that are designed; leave one of "
                "them out"
            )
    settings, tests = dict[str, Any](), rest["tests"]
    if rest["scenarios"]:
        if rest["goal"] or rest["on"] or rest["generator"] not in (None, WITHOUT_GOAL):
            raise UsageError(
                "--scenario is for roads of a description; leave --goal, --on and --generator out"
            )
        settings = {"scenario": rest["scenarios"], "grid": rest["grid"]}
        tests = tests or len(points_of(rest["scenarios"], rest["grid"], not text)[0])
    rest["reader"] = options.reader_of(rest)
    rest["generator"] = rest["generator"] or (WITH_GOAL if rest["goal"] else WITHOUT_GOAL)
    lists = {f"{name}s": (rest[name],) for name in ("designer", "simulator", "generator", "seed")}
    names = ("goal", "drivers", "reader", "rules", "geometry", "keep_driving", "paired")
    plan = Plan(
        prompts=(text,),
        on=rest["on"] or "",
        budget=CellBudget(tests=tests, seconds=rest["seconds"]),
        settings=settings,
        drives=not rest["no_drive"],
        world=options.world_of(rest),
        chat=options.chat_of(rest, rest["reader"], rest["designer"]),
        **lists,
        **{name: rest[name] for name in names},
    )
    return plan, told


def _given(plan: "Plan", told: Set[str], quiet: bool) -> "tuple[Plan, list[bytes]]":
    """Returns the plan with the roads that were found where it says, and the files that keep them; says which
    files there are left out, and why. ``told`` are the fields of the World that precede those of files."""
    from roadgpt.campaign.given import kept_road
    from roadgpt.campaign.model import GIVEN
    from roadgpt.network import made_from
    from roadgpt.network.maps import is_map_file
    from roadgpt.network.source import OF_FILE
    from roadgpt.reading import digest

    home = Path(plan.on) if Path(plan.on).is_dir() else Path(plan.on).parent
    named, contents, left_out = list[dict[str, Any]](), list[bytes](), dict[str, str]()
    worlds, remarks = list[dict[str, Any]](), dict[str, list[str]]()
    for said in roads_in([plan.on]):
        name = os.path.relpath(said, home)
        try:
            with named_in_errors(said):
                blueprint, world, more = source_of(said, plan.world, told)
                if not made_from(blueprint, world, plan.geometry).has_way:
                    how = command_line("import", said if is_map_file(Path(said)) else "MAP.xodr")
                    raise UsageError(
                        f"{said} is a map without a route, on which nothing can be driven; to make routes: "
                        f"{how} --random-routes 20 --out FOLDER"
                    )
        except PartError:
            raise
        except UsageError as error:
            if said == plan.on:
                raise
            left_out[name] = str(error)
            warn(f"left out: {error}")
            continue
        worlds.append({field: world.values()[field] for field in OF_FILE})
        data = blueprint.to_json() | {"world": worlds[-1]}
        road, content = kept_road(len(named) + 1, name, digest(Path(said)), data)
        named.append(road.model_dump())
        contents.append(content)
        for remark in more:
            remarks.setdefault(remark, []).append(name)
    if not named:
        raise UsageError(f"none of the {len(left_out):,} road files in {plan.on} can be tested")
    for remark, names in () if quiet else remarks.items():
        warn(f"{', '.join(names[:MOST_TOLD])}{', ...' * (len(names) > MOST_TOLD)}: {remark}")
    common = {name: worlds[0][name] for name in OF_FILE if len({each[name] for each in worlds}) == 1}
    settings = {"roads": named, "differ": [name for name in OF_FILE if name not in common]}
    budget = plan.budget.model_copy(update={"tests": plan.budget.tests or len(named)})
    changed = {"generators": (GIVEN,), "settings": settings, "budget": budget, "left_out": left_out}
    changed["on"] = str(home.absolute())
    return plan.model_copy(update=changed | {"world": plan.world.changed(**common)}), contents


def _tell(out: Path, plan: "Plan", was_there: bool) -> None:
    """Prints how the description is read, how many cells there are, and the folder."""
    from roadgpt.campaign.record import Record
    from roadgpt.design.room import world_remarks

    with Record.opened(out) as record:
        cells = record.cells()
    briefs = {cell.request.words: (cell.brief, cell.request.world) for cell in cells if cell.brief}
    for words, (brief, world) in briefs.items():
        if len(plan.prompts) == 1 and words:
            click.echo(understood(brief, world, plan.world))
            continue
        for said in world_remarks(brief, plan.world, world) if words else ():
            click.echo(f"note: {words}: {said}")
    if plan.on:
        count, tests = len(plan.settings["roads"]), plan.budget.tests or 0
        told = f"{plural(count, 'road')} of {plan.on}, kept in {out / 'roads'}"
        told += f"; {plural(len(plan.left_out), 'file')} left out" * bool(plan.left_out)
        told += f"; the first {tests:,} are tested" * (tests < count)
        told += f"; {tests:,} tests, so roads are driven again with other seeds" * (tests > count)
        click.echo(told)
    points, left_out = cells[0].points
    if points:
        where = "on the roads of the description" if cells[0].request.words else "each on its nominal road"
        where += f"; {left_out:,} that lead to speeds below 0 are left out" * bool(left_out)
        click.echo(f"{plural(len(points), 'point')} of {plan.settings['scenario']}, {where}")
    if len(cells) > 1:
        what = "the same roads for each driver" if plan.paired else "each with tests of its own"
        click.echo(f"{len(cells):,} cells, {what}")
    click.echo(f"{'resuming in' if was_there else 'into'} {out}")


RESUME_OPTIONS = (
    Argument("folder", "DIR", "Name the folder of a campaign or of runs, as 'roadgpt campaign' or "
             "'roadgpt run' printed it.", PATH),
    *(*options.WORKERS, *named(options.CHAT, "max_tokens", "max_cost"), options.DRIVER_AGAIN),
    Option("--base-url", "Address of the server. Repeat it here if the campaign used one: for safety, your "
           "API key is not sent to an address just because a folder refers to it.", heading=Heading.MODEL),
    *(*options.AT_END, *options.GATE),
    options.AGAIN,
    options.AXES,
    options.JUNIT,
    options.json_option("Print one JSON object at the end.", heading=Heading.OUTPUT),
    options.QUIET,
)  # fmt: skip


@click.command(cls=GroupedCommand, has_simulators=True, params=[*RESUME_OPTIONS])
def resume(folder: Path, driver: tuple[str, ...], base_url: str | None, axes: "Scale", **rest: Any) -> None:
    """Continue a campaign or a run that was interrupted.

    DIR is a folder that 'roadgpt campaign' or 'roadgpt run' wrote. Tests that had not finished are repeated.
    The tests and tables are the same as without the interruption, whatever the number of workers. If DIR
    was written by 'roadgpt run', the remaining roads get the same kinds of pictures and road files as the
    finished ones.

    \b
    roadgpt resume roadgpt-runs/an-uphill-road-with-3-turns-7 -j 2"""
    from roadgpt.campaign.folder_record import cannot_go_on, has_tests, is_store, open_record
    from roadgpt.campaign.given import changes, given_roads
    from roadgpt.chat.config import trust_server
    from roadgpt.drive.loading import check_named_drivers
    from roadgpt.reading import digest

    rest["gate"] = options.gate_of(rest, folder)
    if has_tests(folder) and not is_store(folder):
        raise cannot_go_on(folder)
    with open_record(folder) as record:
        cells, plan = record.cells(), record.plan()
    if plan.on and not has_tests(Path(plan.on)):
        roads = given_roads(plan.settings)
        for change in changes(roads, {road.name: digest(Path(plan.on, road.name)) for road in roads}):
            warn(f"{plan.on}: {change} since the campaign began, which goes on with what it kept of it")
    chat = next((cell.request.setup.chat for cell in cells if cell.request.setup.chat), None)
    check_named_drivers(driver, {cell.request.setup.driver for cell in cells}, folder)
    if base_url is not None:
        trust_server(base_url, chat.base_url if chat else None, folder)
    limits = {name: rest[name] for name in ("max_tokens", "max_cost") if rest[name] is not None}
    if limits and chat is None:
        raise UsageError(f"--max-tokens and --max-cost limit a language model, and {folder} asks none")
    changed = chat.model_copy(update=limits) if limits and chat else None
    work_to_the_end(folder, rest, changed, _as_before(folder, axes) if cells[0].keeps_runs else None)


def _as_before(folder: Path, axes: "Scale") -> "Draw | None":
    """Returns a function that gives a run the same kinds of pictures and road files as the finished runs of a
    folder have."""
    from roadgpt.report import FORMATS
    from roadgpt.run.exporting import NAME
    from roadgpt.run.folder import RUNS

    names = {path.name for path in folder.glob(f"{RUNS}/*/*")}
    if "road.json" not in names:
        return beside(("png",), axes, ())
    pictures = tuple(kind for kind in FORMATS if f"birds_eye.{kind}" in names)
    has_formats = any(name.startswith(NAME) and name != "road.json" for name in names)
    every = plugins.names("exporters") if has_formats else []
    formats = tuple(each for each in every if NAME + plugins.find("exporters", each).suffix in names)
    return beside(pictures, axes, formats)
