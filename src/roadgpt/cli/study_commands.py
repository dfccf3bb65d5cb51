"""``roadgpt study thesis`` and ``roadgpt study alignment``: evaluate many roads of many descriptions."""

import shlex
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import click

from roadgpt.cli.configuration import designer_guard
from roadgpt.cli.option import DESIGN, FILES, OUTPUT, Option, named, words_of
from roadgpt.cli.option_groups import GroupedCommand
from roadgpt.cli.option_types import ROADS, whole
from roadgpt.cli.options import (
    CHAT,
    FORMAT,
    NO_DRIVE,
    SETUP,
    WORLD,
    chat_of,
    out,
    pictures_of,
    seed,
    world_of,
)  # fmt: skip
from roadgpt.errors import ChatError

if TYPE_CHECKING:
    from roadgpt.report import Drawing
    from roadgpt.study.execution import Problem
    from roadgpt.study.plan import StudyPlan
    from roadgpt.study.prompts import Prompt

EVERY = 0.1  # share of the roads between two lines in a pipe
NOT_ASKED = ChatError.exit_status
SHOWN = ("reader", "driver", "simulator", "keep_driving", "geometry")


def roads_option(number: int) -> Option:
    """Returns the option --roads with this default."""
    return Option("--roads -n", "Roads per description.", ROADS, number)


# fmt: off
STUDY_OPTIONS = (
    Option("--designer designers", "What designs roads; repeat the option to compare designers.",
           default=("planner",), multiple=True, heading=DESIGN, table="run", guard=designer_guard),
    seed("The same seed gives the same files.", 1),
    out("Folder for the study. [default: in roadgpt-runs]"),
    Option("--workers", "Number of descriptions processed in parallel; it does not change the files.",
           whole(1, 64, "processes"), 2),
    *named(SETUP, *SHOWN),
    *WORLD,
    FORMAT,
    Option("--no-plot", "Draw no pictures of single runs.", bool, heading=FILES),
    Option("--quiet -q", "Print only errors and the path of the report.", bool, heading=OUTPUT),
    *CHAT,
)
PROMPTS = click.Argument(["prompts"], metavar="PROMPTS.jsonl", type=click.Path(path_type=Path))
DRIVES = Option("--drive drives", "Drive the roads as well.", bool)
# fmt: on


@click.command(cls=GroupedCommand, params=[roads_option(100), NO_DRIVE, *STUDY_OPTIONS])
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
    formats = pictures_of(rest)
    seed, out = rest.pop("seed"), rest.pop("out")
    place = out or Path("roadgpt-runs") / f"study-{kind}-{seed}"
    plan = _plan(kind, prompts, source, roads, seed, drives, rest)
    plan = plan.model_copy(update={"command": _command(plan, place)})
    for designer in plan.designers:
        check_parts(plan.setup_of(designer), plan.world)
    open_folder(plan, place)
    total = len(plan.parts()) * plan.roads
    tell = None if quiet else _teller(total)
    if not quiet:
        click.echo(
            f"{plural(len(prompts), 'description')}, {plural(roads, 'road')} each, "
            f"by {' and '.join(plan.designers)}, into {place}"
        )
    begun = time.perf_counter()
    try:
        problems = work(plan, place, workers, _drawing(formats), tell)
    except KeyboardInterrupt:
        click.echo(
            "\nroadgpt: stopped; finished roads are complete, and the same command continues", err=True
        )
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
    world = world_of(rest)
    chat = chat_of(rest, rest["reader"], (asking or designers)[0])
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
    words += [*words_of(named(SETUP, *SHOWN), plan.setup), *words_of(WORLD, plan.world)]
    if plan.setup.chat is not None:
        words += words_of(CHAT, plan.setup.chat, type(plan.setup.chat)())
    if plan.setup.drives != (plan.kind == "thesis"):
        words.append("--drive" if plan.setup.drives else "--no-drive")
    return shlex.join([*words, "--out", str(place)])


def _drawing(formats: tuple[Any, ...]) -> "Drawing | None":
    if not formats:
        return None
    from roadgpt.report import drawing

    return drawing(formats=formats)


def _teller(total: int) -> Callable[[str, int], None]:
    """Returns a function that prints the progress: in place on a terminal, some lines in a pipe."""
    begun, is_seen = time.perf_counter(), sys.stderr.isatty()
    first: list[int] = []
    said = [0]

    def tell(at: str, done: int) -> None:
        first.append(done) if not first else None
        seconds = time.perf_counter() - begun
        rate = (done - first[0]) / max(seconds, 1e-9)
        left = f", about {(total - done) / rate:.0f} s left" if rate > 0 else ""
        line = f"{done}/{total} roads, {rate:.1f} roads/s{left}"
        if is_seen:
            click.echo(f"\r{line:<60}", err=True, nl=done >= total)
        elif done - said[0] >= EVERY * total or (done >= total > said[0]):
            said[0] = done
            click.echo(line)

    return tell


def _complain(problems: "Sequence[Problem]") -> None:
    told: dict[str, list[str]] = {}
    for problem in problems:
        told.setdefault(problem.sentence, []).append(problem.part)
    for sentence, parts in told.items():
        click.echo(f"roadgpt: {', '.join(parts)}: {sentence}", err=True)
