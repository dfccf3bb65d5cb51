"""Builds the commands that repeat a Run, that continue or change the present command, and that make tests
harder where the driver failed on no road."""

import os
from collections.abc import Iterator, Sequence, Set
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import click
from click.core import ParameterSource

from roadgpt.brief.model import Brief
from roadgpt.brief.words import SURFACES
from roadgpt.campaign.folder_record import open_record
from roadgpt.campaign.status import Status
from roadgpt.cli import options
from roadgpt.cli.options import Option, named, words_of
from roadgpt.errors import command_line
from roadgpt.road import World
from roadgpt.road.world import oracle_limits
from roadgpt.run.model import Request, Run, Setup
from roadgpt.verdict.verdict import PARTLY

# The options of ``roadgpt drive`` that set fields of the Setup; the road's file determines the geometry.
OF_DRIVES = named(options.SETUP, "driver", "simulator", "keep_driving", "tracks", "rules")


def replay_lines(run: Run, folder: Path | None = None) -> list[str]:
    """Returns lines with the commands that repeat a Run: from its description, and from its road file."""
    lines, request = list[str](), run.request
    if run.words:
        lines.append(command_line("run", *request_words(request, run.index, run.brief)))
    if folder is not None and run.road is not None and request.setup.drives:
        words = option_words(request.setup, request.world, OF_DRIVES, asks=False)
        lines.append(command_line("drive", folder / "road.json", "--seed", run.seed, *words))
    return lines


def request_words(request: Request, roads: int, brief: Brief | None) -> list[str]:
    """Returns the arguments with which ``roadgpt run`` makes the first ``roads`` roads of a request."""
    # where the words name a surface, the friction is always told
    told = {"friction"} if brief is not None and brief.friction is not None else set[str]()
    rest = ["-n", str(roads), "--seed", str(request.seed)]
    rest += option_words(request.setup, request.world, also=told)
    if not request.setup.drives:
        rest.append("--no-drive")
    # words that begin with a dash would pass for an option
    return [*rest, "--", request.words] if request.words.startswith("-") else [request.words, *rest]


def option_words(
    setup: Setup, world: World, of_setup: Sequence[Option] | None = None, asks: bool = True,
    also: Set[str] = frozenset(),
) -> list[str]:  # fmt: skip
    """Returns the arguments for options that differ from their defaults, that configuration files or the
    environment set, or whose keys are in ``also``. ``of_setup`` are those of the command that set fields of
    the Setup, of all if it is None; ``asks`` says whether it has options for language models."""
    layers = options.layers()
    told = {each.key for each in options.settable() if each.found(layers) is not None} | also
    words = words_of(of_setup or options.SETUP, dict(setup), told=told)
    told |= {"oracle"} if told & {*oracle_limits()} else set()
    values = world.values() | dict.fromkeys(oracle_limits()) | {"oracle": world.limits.oracle}
    words += words_of(options.WORLD, values, World().values(), told)
    if asks and setup.chat:
        words += words_of(options.CHAT, dict(setup.chat), dict(type(setup.chat)()))
    return words


def to_resume(folder: Path) -> str:
    """Returns the command that continues the tests in a folder, with what the user typed in this command."""
    root = click.get_current_context().find_root()
    resume = root.command.get_command(root, "resume") if isinstance(root.command, click.Group) else None
    with open_record(folder) as record:
        return record.to_resume(*typed_words(resume) if resume else ())


def typed_words(command: click.Command) -> list[str]:
    """Returns the arguments with which the user gave options of ``command`` in the present command, without
    permissions."""
    ctx, words = click.get_current_context(), list[str]()
    for each in command.get_params(ctx):
        is_typed = ctx.get_parameter_source(str(each.name)) is ParameterSource.COMMANDLINE
        if isinstance(each, Option) and is_typed and each.field not in ("driver", "base_url"):
            value = ctx.params.get(each.field, os.environ.get(each.variable))
            words += each.written(bool(value) if each.is_flag else value, is_set=True)
    return words


FEWEST = 5  # passed drives; if there are fewer, it is no surprise that none failed
FRICTIONS = {"wet": "a wet road", "snow": "snow"}
SPEEDS = (100.0, 130.0)  # km/h
SEARCHED = 200  # tests of a search
HEAD = "No road failed. What may find one that does:"


@dataclass(frozen=True)
class WithoutFailure:
    """The results of a set of tests in which no test failed."""

    request: Request
    tests: int
    passed: int
    outside: int = 0  # number of passed tests in which more than 10 % of the car was outside its lane
    goal: str | None = None  # what the campaign searched for, such as 'failures'; None if it did not search
    is_search: bool = False  # whether the tests are those of a campaign
    brief: Brief | None = None  # what was read from the description
    compares: tuple[str, ...] = ()
    """The arguments that name several drivers; empty for one driver, which the request names."""


def next_steps(quiet: WithoutFailure | None) -> list[tuple[str, str]]:
    """Returns pairs of a suggestion and a command for results without a failure (``quiet``). The list is
    empty if too few tests passed, or if command-line options cannot express the whole request."""
    if quiet is None or quiet.passed < FEWEST or not quiet.request.words:
        return []
    values, usual = quiet.request.world.values(), World().values()
    others = values.keys() - {flag.field for flag in options.WORLD}
    return [*_steps(quiet)] if all(values[name] == usual[name] for name in others) else []


def lines(quiet: WithoutFailure | None) -> Iterator[str]:
    """Yields the suggestions as lines of text, below a heading."""
    found = next_steps(quiet)
    if found:
        yield HEAD
    for why, command in found:
        yield f"  {why}:"
        yield f"    {command}"


def _steps(quiet: WithoutFailure) -> Iterator[tuple[str, str]]:
    world = quiet.request.world
    if not world.limits.lane_departure:
        why = "fail where a front tyre passes the lane marking (UN R157)"
        if quiet.outside:
            why += f"; {quiet.outside:,} of {quiet.passed:,} passed with the car partly or mostly outside"
        yield why, _command(quiet, **oracle_limits("departure"))
    slippery = [(SURFACES[surface].friction, name) for surface, name in FRICTIONS.items()]
    for friction, name in [each for each in slippery if each[0] < world.site.friction][:1]:
        yield name, _command(quiet, friction=friction)
    for speed in [speed for speed in SPEEDS if speed / 3.6 > world.limits.speed_limit * 1.001][:1]:
        yield f"a speed limit of {speed:.0f} km/h", _command(quiet, speed_limit=speed / 3.6)
    if not quiet.compares:
        goal, what = ("hardest", "the hardest road") if quiet.goal == "failures" else ("failures", "failures")
        search = replace(quiet, goal=goal, is_search=True, tests=max(quiet.tests, SEARCHED))
        yield f"search for {what} among such roads", _command(search)


def _command(quiet: WithoutFailure, **world: Any) -> str:
    request = quiet.request.model_copy(update={"world": quiet.request.world.changed(**world)})
    verb = ["campaign", *(["--goal", quiet.goal] if quiet.goal else [])] if quiet.is_search else ["run"]
    return command_line(*verb, *quiet.compares, *request_words(request, quiet.tests, quiet.brief))


def of_status(status: Status) -> WithoutFailure | None:
    """Summarises a campaign or a folder of runs. Returns None if its tests are still running, if any test
    failed, if none passed, or if more than the driver differs between cells."""
    if status.is_running or status.outcomes.get("FAIL") or not status.outcomes.get("PASS"):
        return None
    with open_record(Path(status.folder)) as record:
        first, *others = record.cells()
        compares: tuple[str, ...] = ()
        if others:
            named = ",".join(cell.request.setup.driver for cell in (first, *others))
            asked = []
            for cell in (first, *others):
                setup = cell.request.setup.model_copy(update={"driver": Setup().driver})
                asked.append(cell.request.model_copy(update={"setup": setup}))
            if any(request != asked[0] for request in asked):
                return None
            compares = ("--drivers", named, *["--paired"] * record.plan().paired)
            first = replace(first, request=asked[0])
    outside = sum(cell.partly_outside + cell.mostly_outside for cell in status.cells)
    tests, is_search = first.budget.tests or SEARCHED, not first.in_sequence
    passed = status.outcomes["PASS"]
    return WithoutFailure(first.request, tests, passed, outside, first.goal, is_search, first.brief, compares)


def of_rows(request: Request, brief: Brief | None, roads: int, rows: Any) -> WithoutFailure | None:
    """Summarises result rows; returns None if any road failed."""
    if any(row.test_outcome == "FAIL" for row in rows):
        return None
    shares = [row.max_oob or 0.0 for row in rows if row.test_outcome == "PASS"]
    outside = sum(share > PARTLY for share in shares)
    return WithoutFailure(request, roads, len(shares), outside, brief=brief)
