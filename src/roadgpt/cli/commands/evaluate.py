"""Commands that judge roads: ``roadgpt check`` and ``report``."""

import time
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from roadgpt import plugins
from roadgpt.cli import options
from roadgpt.cli.options import PATH, Argument, GroupedCommand, Option, named
from roadgpt.cli.roads import LANES, UNREADABLE, each_road, open_page, roads_in
from roadgpt.cli.screen import Row, Screen, row_of
from roadgpt.errors import UsageError, command_line

if TYPE_CHECKING:
    from roadgpt.road import Design, Road, World

INVALID = 1  # exit status, so that a script can ask
CHECK_OPTIONS = (
    *named(options.SETUP, "rules"),
    *named(options.WORLD, "map_size", "ground", *LANES),
    *named(options.SETUP, "geometry"),
    *options.SCREEN,
)


@click.command(cls=GroupedCommand, params=[options.ROADS, *CHECK_OPTIONS])
def check(files: tuple[str, ...], rules: Any, geometry: Any, verbose: bool, **rest: Any) -> int:
    """Check roads against the rules.

    ROAD is a RoadGPT design, a test of SBFT or SDC-Scissor, a list of points [x, y] or [x, y, z], a table of
    points (.csv) or OpenDRIVE (.xodr). A folder of such files, a folder of runs and a campaign stand for all
    their roads. The exit status is 0 if all roads are valid, 1 if one is not, 2 if one cannot be read."""
    from roadgpt.run import Setup, prove

    world = options.world_of(rest)
    roads = roads_in(files)
    screen = Screen(len(roads), rest["as_json"], rest["quiet"], verbose)
    setup = Setup(rules=rules, geometry=geometry, drives=False)

    def checked(file: str, blueprint: "Design | Road", world: "World") -> tuple[Row, None]:
        begun = time.perf_counter()
        run = prove(blueprint, world=world, setup=setup)
        row = row_of(run, file)
        if is_only_map := run.road is not None and not run.road.has_way:
            screen.say(f"{file}: the map has no route, so only its roads and junctions are checked")
        for sentence in row.findings[1:]:
            screen.detail(f"{file}: also, {sentence}")
        said = row.description if row.findings else f"valid by the rules '{rules}'"
        length, seconds = None if is_only_map else row.length_m, time.perf_counter() - begun
        return replace(row, description=said, length_m=length, seconds=seconds), None

    each_road(roads, screen, world, checked)
    outcomes = {row.test_outcome for row in screen.rows}
    return UNREADABLE if "ERROR" in outcomes else INVALID if "INVALID" in outcomes else 0


REPORT_OPTIONS = (
    Argument("folder", "DIR", kind=PATH),
    Option("--brief", "Write one page to print, brief.html, with the outcomes and the worst test.", bool),
    options.OPEN,
    options.JUNIT,
)


@click.command(cls=GroupedCommand, params=[*REPORT_OPTIONS])
def report(folder: Path, brief: bool, opens: bool, junit: Path | None) -> None:
    """Write a report on a run, a folder of runs, a campaign or a study.

    DIR is the folder that roadgpt run, roadgpt campaign or roadgpt study wrote. The command writes
    report.html and the tables as CSV and LaTeX into DIR. The page needs no network and no server, and links
    to the runs in DIR.

    \b
    roadgpt report roadgpt-runs/an-uphill-road-with-3-turns-7 --open
    roadgpt report CAMPAIGN --brief"""
    page = write_report(folder, brief)
    if junit is not None:
        from roadgpt.cli.junit import suites_of, write_junit

        write_junit(junit, [*suites_of(folder, {})])
    click.echo(str(page))
    if opens:
        open_page(page)


def write_report(folder: Path, is_brief: bool = False) -> Path:
    """Writes the report on a folder of tests or a study, or its brief page; returns the path of the page.

    A plug-in called ``reports`` is named after the file of the folders for which it writes the report."""
    from roadgpt.report import brief_page, report

    for card in plugins.names("reports"):
        if (folder / card).is_file():
            if is_brief:
                raise UsageError(f"{folder} has no brief page; name one of the folders of runs in it")
            made: Path = plugins.find("reports", card)(folder)
            return made
    write = brief_page.write_brief if is_brief else report.write_report
    return write(folder, command_of(folder))


def command_of(folder: Path) -> str:
    """Returns the command that repeats a run, runs or a campaign; empty for runs without a description.
    Options cannot express some campaigns, such as a campaign with several cells; for these, returns the
    command that resumes the campaign."""
    from roadgpt.campaign.folder_record import open_record
    from roadgpt.campaign.model import WITH_GOAL, WITHOUT_GOAL
    from roadgpt.cli.repeat_commands import replay_lines, request_words
    from roadgpt.run.folder import is_run, read_run

    if is_run(folder):
        return next(iter(replay_lines(read_run(folder), folder)), "")
    with open_record(folder) as record:
        cells, resume = record.cells(), record.to_resume()
    only, n = cells[0], cells[0].budget.tests
    if len(cells) > 1 or not only.request.words or n is None or only.settings:
        return "" if only.keeps_runs and not only.request.words else resume
    words = request_words(only.request, n, only.brief)
    words += ["--goal", only.goal] if only.goal else []
    if only.generator != (WITH_GOAL if only.goal else WITHOUT_GOAL):
        words += ["--generator", only.generator]
    words += ["--seconds", f"{only.budget.seconds:g}"] if only.budget.seconds else []
    return command_line("run" if only.keeps_runs else "campaign", *words, "--out", folder)
