"""``roadgpt study``: evaluates roads as the thesis did, by measurements and by a survey of people."""

import shlex
import time
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import click

from roadgpt.cli import options
from roadgpt.cli.commands import survey_
from roadgpt.cli.configuration import designer_guard
from roadgpt.cli.option import Argument, Heading, Option, named, words_of
from roadgpt.cli.option_groups import CommandGroup, GroupedCommand
from roadgpt.cli.option_types import PATH, ROADS, whole
from roadgpt.cli.progress import progress
from roadgpt.errors import ChatError

if TYPE_CHECKING:
    from roadgpt.report import Drawing
    from roadgpt.study.execution import Problem
    from roadgpt.study.plan import StudyPlan
    from roadgpt.study.prompts import Prompt

NOT_ASKED = ChatError.exit_status
SHOWN = ("reader", "driver", "simulator", "keep_driving", "geometry")


def roads_option(number: int) -> Option:
    """Returns the option --roads with this default."""
    return Option("--roads -n", "Roads per description.", ROADS, number)


# fmt: off
STUDY_OPTIONS = (
    Option("--designer designers", "What designs roads; repeat the option to compare designers.",
           default=("planner",), multiple=True, heading=Heading.DESIGN, table="run", guard=designer_guard),
    options.seed("The same seed gives the same files.", 1),
    options.out("Folder for the study. [default: in roadgpt-runs]"),
    Option("--workers", "Number of descriptions processed in parallel; it does not change the files.",
           whole(1, 64, "processes"), 2),
    *named(options.SETUP, *SHOWN),
    *options.WORLD,
    options.FORMAT,
    Option("--no-plot", "Draw no pictures of single runs.", bool, heading=Heading.FILES),
    Option("--quiet -q", "Print only errors and the path of the report.", bool, heading=Heading.OUTPUT),
    *options.CHAT,
)
PROMPTS = Argument("prompts", "PROMPTS.jsonl", kind=PATH)
DRIVES = Option("--drive drives", "Drive the roads as well.", bool)
# fmt: on


@click.command(cls=GroupedCommand, params=[roads_option(100), options.NO_DRIVE, *STUDY_OPTIONS])
def thesis(roads: int, no_drive: bool, **rest: Any) -> int:
    """Repeat the evaluation of RoadGPT's thesis: validity, drives, alignment and diversity.

    Takes the three descriptions of the thesis' table and those of its survey, makes and drives the roads, and
    writes one page with tables, tests, intervals and figures. The report shows the thesis' own counts next
    to the new ones. After Ctrl-C, the same command continues where it stopped. If a language model cannot be
    used, the report says so and the exit status is 4.

    \b
    roadgpt study thesis
    roadgpt study thesis --roads 20 --designer planner --designer thesis --model gpt-5-mini
    """
    from roadgpt.study.prompts import thesis_prompts

    return _study("thesis", thesis_prompts(), "", roads, not no_drive, rest)


@click.command(cls=GroupedCommand, params=[PROMPTS, roads_option(10), DRIVES, *STUDY_OPTIONS])
def alignment(prompts: Path, roads: int, drives: bool, **rest: Any) -> int:
    """Measure how well roads match their descriptions, criterion by criterion.

    PROMPTS.jsonl has a line {"id": "1", "prompt": "a U-turn", "truth": {"turns": 1}} for each description.
    The guide "Evaluate roads" lists all keys of "truth". Without "truth", roads are compared with the
    requirements that the reader found in the description.

    \b
    roadgpt study alignment prompts.jsonl
    roadgpt study alignment prompts.jsonl -n 3 --designer chat --model gpt-5-mini
    """
    from roadgpt.study.prompts import read_prompts

    return _study("alignment", read_prompts(prompts), str(prompts), roads, drives, rest)


def _study(
    kind: Literal["thesis", "alignment"],
    prompts: "Sequence[Prompt]",
    source: str,
    roads: int,
    drives: bool,
    rest: dict[str, Any],
) -> int:
    """Works, writes the report, prints its path, and returns the exit status."""
    from roadgpt.run import check_parts
    from roadgpt.study.chapters.wording import plural
    from roadgpt.study.execution import work
    from roadgpt.study.plan import open_folder
    from roadgpt.study.study_report import keep_problems, write_study

    workers, quiet = rest.pop("workers"), rest.pop("quiet")
    formats = options.pictures_of(rest)
    seed, out = rest.pop("seed"), rest.pop("out")
    place = out or Path("roadgpt-runs") / f"study-{kind}-{seed}"
    plan = _plan(kind, prompts, source, roads, seed, drives, rest)
    plan = plan.model_copy(update={"command": _command(plan, place)})
    for designer in plan.designers:
        check_parts(plan.setup_of(designer), plan.world)
    open_folder(plan, place)
    total = len(plan.parts()) * plan.roads
    if not quiet:
        click.echo(
            f"{plural(len(prompts), 'description')}, {plural(roads, 'road')} each, "
            f"by {' and '.join(plan.designers)}, into {place}"
        )
    begun = time.perf_counter()
    try:
        with progress("roads", total, quiet) as tell:
            problems = work(plan, place, workers, _drawing(formats), tell)
    except KeyboardInterrupt:
        click.echo("roadgpt: stopped; finished roads are complete, and the same command continues", err=True)
        raise
    keep_problems(place, problems)
    if not quiet:
        click.echo(f"{total} roads in {time.perf_counter() - begun:.0f} s; writing the report")
    page = write_study(place)
    _complain(problems)
    click.echo(str(page))
    return NOT_ASKED if any(problem.is_of_chat for problem in problems) else 0


def _plan(
    kind: Literal["thesis", "alignment"],
    prompts: "Sequence[Prompt]",
    source: str,
    roads: int,
    seed: int,
    drives: bool,
    rest: dict[str, Any],
) -> "StudyPlan":
    from roadgpt import plugins
    from roadgpt.chat import asks_a_model
    from roadgpt.run import Setup
    from roadgpt.study.plan import StudyPlan

    designers = tuple(dict.fromkeys(rest.pop("designers")))
    asking = [name for name in designers if asks_a_model(plugins.find("designers", name))]
    world = options.world_of(rest)
    chat = options.chat_of(rest, rest["reader"], (asking or designers)[0])
    setup = Setup(drives=drives, chat=chat, designer=designers[0], **rest)
    return StudyPlan(
        kind=kind,
        prompts=tuple(prompts),
        designers=designers,
        roads=roads,
        seed=seed,
        world=world,
        setup=setup,
        source=source,
    )


def _command(plan: "StudyPlan", place: Path) -> str:
    """Returns the command that makes the study again."""
    words = ["roadgpt", "study", plan.kind, *([plan.source] if plan.source else [])]
    words += ["--roads", str(plan.roads), "--seed", str(plan.seed)]
    if plan.designers != ("planner",):
        words += [word for name in plan.designers for word in ("--designer", name)]
    words += [*words_of(named(options.SETUP, *SHOWN), plan.setup), *words_of(options.WORLD, plan.world)]
    if plan.setup.chat is not None:
        words += words_of(options.CHAT, plan.setup.chat, type(plan.setup.chat)())
    if plan.setup.drives != (plan.kind == "thesis"):
        words.append("--drive" if plan.setup.drives else "--no-drive")
    return shlex.join([*words, "--out", str(place)])


def _drawing(formats: tuple[Any, ...]) -> "Drawing | None":
    if not formats:
        return None
    from roadgpt.report import drawing

    return drawing(formats=formats)


def _complain(problems: "Sequence[Problem]") -> None:
    told: dict[str, list[str]] = {}
    for problem in problems:
        told.setdefault(problem.sentence, []).append(problem.part)
    for sentence, parts in told.items():
        click.echo(f"roadgpt: {', '.join(parts)}: {sentence}", err=True)


@click.group(cls=CommandGroup)
def command() -> None:
    """Evaluate many roads, by measurements or by people who rate them."""


command.add_command(thesis)
command.add_command(alignment)
command.add_command(survey_.command)
