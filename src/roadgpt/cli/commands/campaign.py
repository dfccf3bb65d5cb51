"""``roadgpt campaign``: runs thousands of tests with many workers; can be resumed after any interruption."""

import sys
from contextlib import redirect_stdout
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from roadgpt.cli import options
from roadgpt.cli.campaigns import watch
from roadgpt.cli.commands.faults import FAULT_OPTIONS, analyse_failures, analysis_options
from roadgpt.cli.commands.report import write_report
from roadgpt.cli.configuration import driver_guard
from roadgpt.cli.junit import write_folder
from roadgpt.cli.option import Argument, Heading, Option, named
from roadgpt.cli.option_groups import GroupedCommand
from roadgpt.cli.option_types import drivers, measure, whole
from roadgpt.errors import UsageError

if TYPE_CHECKING:
    from roadgpt.campaign.plan import Plan
    from roadgpt.chat import ChatSettings
    from roadgpt.run import Draw

MOST_TESTS = 10_000_000
TESTS = whole(1, MOST_TESTS, "the number of tests")
SECONDS = measure(0, 1e8, "s", above=True)
BESIDE_A_FILE = {
    "words", "out", "again", "workers", "executor", "address", "drivers", "faults", "minimise", "repeat",
    "groups", "junit", "as_json", "quiet", *(each.field for each in options.GATE),
}  # fmt: skip


# fmt: off
PARAMETERS = (
    Argument("words...", "DESCRIPTION|FILE.toml",
             'Say what roads: roadgpt campaign "a winding road" --goal failures -n 200'),
    Option("-n --tests", "Number of tests.", TESTS),
    Option("--goal", "What to search for: failures, coverage (roads as diverse as possible), hardest (least "
           "margin), boundary (just between PASS and FAIL). [default: no search]",
           click.Choice(["failures", "coverage", "hardest", "boundary"])),
    Option("--generator", "Test generator. [default: 'quality_diversity' with --goal, else 'words', which "
           "does not search]"),
    Option("--seconds", "Start no more tests after this many seconds.", SECONDS),
    options.seed("The same seed gives the same table.", 0),
    options.out("Folder for the campaign. [default: a new one]"),
    options.AGAIN,
    *options.WORKERS,
    *(options.PLAN, *named(options.SETUP, "reader", "designer")),
    Option("--driver --drivers drivers", "Name of a driver, or FILE.py:CLASS; for more drivers, repeat the "
           "option or separate them by commas. If FILE.toml lists a driver file, RoadGPT runs it only if you "
           "name it here, too.", drivers, ("lane_centring",), multiple=True, heading=Heading.DRIVE,
           table="run", guard=driver_guard, callback=lambda _, __, given: tuple(chain.from_iterable(given))),
    Option("--paired", "Compare the drivers on the same roads at the end, in a report.", bool,
           heading=Heading.DRIVE),
    *named(options.SETUP, "simulator", "keep_driving"),
    *options.WORLD,
    *named(options.SETUP, "geometry", "rules"),
    *(options.NO_DRIVE, *options.CHAT, *options.BEAMNG, *FAULT_OPTIONS, *options.GATE, options.JUNIT),
    *(options.json_option("Print one JSON object at the end.", heading=Heading.OUTPUT), options.QUIET),
)
# fmt: on


@click.command(cls=GroupedCommand, params=[*PARAMETERS])
@click.pass_context
def command(ctx: click.Context, /, words: tuple[str, ...], out: Path | None, **given: Any) -> None:
    """Search for roads that a driver fails on, or make thousands of roads.

    Give a description, or a FILE.toml that lists prompts, designers, drivers, simulators and seeds; each
    combination is then a cell with tests of its own. A campaign can be resumed after Ctrl-C, a crash or a
    power cut. The table of results depends neither on interruptions nor on the number of workers.

    \b
    roadgpt campaign "an uphill road with 3 turns" --goal failures -n 200 -j 2 --seed 7
    roadgpt campaign study.toml -j 16 --out study
    roadgpt show study --watch
    """
    from roadgpt import plugins
    from roadgpt.campaign.gate import Gate
    from roadgpt.campaign.lifecycle import begin
    from roadgpt.run.atomic import to_bytes
    from roadgpt.run.folder_names import new_folder

    text = to_bytes(" ".join(words)).decode()  # what a broken terminal put into it becomes an escape
    plan = _filed(ctx, Path(text), given) if text.endswith(".toml") else _described(text, given)
    plan.check()
    plugins.find("executors", given["executor"])
    if out is None:
        out = new_folder(Path(text).stem if text.endswith(".toml") else text, plan.seeds[0])
    given["gate"] = Gate(out, *(given.pop(each.field) for each in options.GATE))
    with redirect_stdout(sys.stderr):  # a user's driver is loaded, and may print
        was_there = begin(plan, out, given.pop("again"))
    if not given["quiet"] and not given["as_json"]:
        _tell(out, plan, was_there)
    work_to_the_end(out, given)


def work_to_the_end(
    folder: Path, given: dict[str, Any], chat: "ChatSettings | None" = None, draw: "Draw | None" = None
) -> None:
    """Runs the remaining tests of a campaign or a folder of runs and prints the results.

    ``given`` holds the gate, which decides last, and the values of the options, which can request a JUnit
    file and an analysis of the failures. ``chat`` has the settings of the language model if the user changed
    a limit. ``draw`` adds pictures and road files to a folder of runs.
    """
    from roadgpt.campaign.folder_record import is_store
    from roadgpt.campaign.lifecycle import work
    from roadgpt.campaign.record import Record

    again = given.get("again", False)
    steps = work(folder, given["workers"], given["executor"], given["address"], chat, draw, again)
    watch(folder, steps, given["as_json"], given["quiet"], given["gate"])
    if given["junit"] is not None:
        write_folder(given["junit"], folder, given["gate"].worse)
    if is_store(folder):
        with Record.opened(folder) as record:
            if record.plan().paired:
                from roadgpt.study.chapters.same_roads import compared

                page = write_report(folder)
                if not given["quiet"]:
                    click.echo("\n".join([*compared(record), f"report: {page}"]), err=given["as_json"])
    if look := analysis_options(given):
        analyse_failures(folder, look)
    given["gate"].close()


def _filed(ctx: click.Context, path: Path, rest: dict[str, Any]) -> "Plan":
    """Returns the plan in a file.

    Raises:
        UsageError: An option was given that must be set in the file, or the plan cannot be used.
    """
    from roadgpt.campaign.plan_file import read_plan
    from roadgpt.chat.config import Layer, configured
    from roadgpt.drive.permission import check_named_drivers

    typed = options.typed(ctx)
    wrong = typed - BESIDE_A_FILE - {flag.field for flag in options.CHAT}
    for parameter in ctx.command.params:
        if parameter.name in wrong:
            raise UsageError(f"{parameter.opts[0]} cannot be given with {path}; write it into the file")
    written = read_plan(path)
    check_named_drivers(rest["drivers"] if "drivers" in typed else (), {*written.plan.drivers}, path)
    if not written.plan.asks_a_model:
        return written.plan
    chat = configured(options.chat_values(rest), Layer(str(path), written.chat))
    return written.plan.model_copy(update={"chat": chat})


def _described(text: str, rest: dict[str, Any]) -> "Plan":
    from roadgpt.campaign.model import WITH_GOAL, WITHOUT_GOAL, CellBudget
    from roadgpt.campaign.plan import Plan

    goal, seconds, tests = rest["goal"], rest["seconds"], rest["tests"]
    rest["reader"] = options.reader_of(rest)
    world = options.world_of(rest)
    chat = options.chat_of(rest, rest["reader"], rest["designer"])
    return Plan(
        prompts=(text,),
        designers=(rest["designer"],),
        drivers=tuple(rest["drivers"]),
        simulators=(rest["simulator"],),
        generators=(rest["generator"] or (WITH_GOAL if goal else WITHOUT_GOAL),),
        seeds=(rest["seed"],),
        goal=goal,
        budget=CellBudget(tests=tests, seconds=seconds),
        reader=rest["reader"],
        rules=rest["rules"],
        geometry=rest["geometry"],
        keep_driving=rest["keep_driving"],
        drives=not rest["no_drive"],
        paired=rest["paired"],
        world=world,
        chat=chat,
    )


def _tell(out: Path, plan: "Plan", was_there: bool) -> None:
    """Prints how the description is read, how many cells there are, and the folder."""
    from roadgpt.campaign.record import Record
    from roadgpt.cli.commands.run import understood
    from roadgpt.design.room import world_remarks

    with Record.opened(out) as record:
        cells = record.cells()
    briefs = {cell.request.words: (cell.brief, cell.request.world) for cell in cells if cell.brief}
    for words, (brief, world) in briefs.items():
        if len(plan.prompts) == 1:
            click.echo(understood(brief, world, plan.world))
            continue
        for said in world_remarks(brief, plan.world, world):
            click.echo(f"note: {words}: {said}")
    if len(cells) > 1:
        what = "the same roads for each driver" if plan.paired else "each with tests of its own"
        click.echo(f"{len(cells):,} cells, {what}")
    click.echo(f"{'resuming in' if was_there else 'into'} {out}")
