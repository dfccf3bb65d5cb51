"""``roadgpt study``: evaluates roads as RoadGPT's thesis did, by measurements and by asking people."""

import time
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from roadgpt.cli import options
from roadgpt.cli.options import PATH, Argument, CommandGroup, GroupedCommand, Heading, Option, named, whole
from roadgpt.cli.streams import progress, resumable, warn
from roadgpt.errors import ChatError, command_line
from roadgpt_study.survey import command as survey

if TYPE_CHECKING:
    from roadgpt_study.plan import Kind, Prompt, StudyPlan

NOT_ASKED = ChatError.exit_status
SHOWN = ("reader", "driver", "simulator", "keep_driving", "geometry")

DESIGNERS = Option(
    "--designer designers", "What designs roads; repeat the option to compare designers.", str, ("planner",),
    multiple=True, heading=Heading.DESIGN, table="run", guard=options.designer_guard,
)  # fmt: skip
ROADS_EACH = partial(Option, "--roads -n", "Roads per description.", options.HOW_MANY)
THESIS = {"driver": "beamng_like", "oracle": "thesis"}  # studies drive and judge as the thesis did
PROMPTS = Argument("prompts", "PROMPTS.jsonl", kind=PATH)
DRIVES = Option("--drive drives", "Drive the roads as well.", bool)


_DRIVEN = tuple(
    each.but(default=THESIS[each.field]) if each.field in THESIS else each
    for each in (*named(options.SETUP, *SHOWN), *options.WORLD)
)

STUDY_OPTIONS: list[Option] = [
    DESIGNERS,
    options.seed("The same seed gives the same files.", 1),
    options.out("Folder for the study. [default: in roadgpt-runs]"),
    options.AGAIN,
    Option("--workers", "Number of descriptions processed in parallel; the files do not depend on it.",
           whole(1, 64, "processes"), 2),
    *_DRIVEN,
    options.FORMAT,
    Option("--no-plot", "Draw no pictures of single runs.", bool, heading=Heading.FILES),
    Option("--quiet -q", "Print only errors and the path of the report.", bool, heading=Heading.OUTPUT),
    *options.CHAT,
]  # fmt: skip


@click.command(cls=GroupedCommand, params=[ROADS_EACH(100), options.NO_DRIVE, *STUDY_OPTIONS])
def thesis(no_drive: bool, **rest: Any) -> int:
    """Repeat the evaluation of RoadGPT's thesis: validity, drives, match with descriptions, and diversity.

    Takes the three descriptions that the thesis evaluated and those of its survey, makes and drives the
    roads, and writes one page with tables, statistical tests, confidence intervals and figures. The report
    shows the thesis' own counts next to the new ones. After Ctrl-C, the same command continues where it
    stopped. If a language model cannot be used, the report says so and the exit status is 4.

    \b
    roadgpt study thesis
    roadgpt study thesis --roads 20 --designer planner --designer thesis --model gpt-5-mini
    """
    from roadgpt_study.plan import thesis_prompts

    return _study("thesis", thesis_prompts(), "", not no_drive, rest)


@click.command(cls=GroupedCommand, params=[PROMPTS, ROADS_EACH(10), DRIVES, *STUDY_OPTIONS])
def alignment(prompts: Path, drives: bool, **rest: Any) -> int:
    """Measure how well roads match their descriptions, criterion by criterion.

    PROMPTS.jsonl has a line {"id": "1", "prompt": "a U-turn", "truth": {"turns": 1}} for each description.
    The guide "Evaluate roads" lists all keys of "truth". Without "truth", roads are compared with the
    requirements that the reader found in the description.

    \b
    roadgpt study alignment prompts.jsonl
    roadgpt study alignment prompts.jsonl -n 3 --reader chat --model gpt-5-mini
    """
    from roadgpt_study.plan import read_prompts

    return _study("alignment", read_prompts(prompts), str(prompts), drives, rest)


def _study(kind: "Kind", prompts: "Sequence[Prompt]", source: str, drives: bool, rest: dict[str, Any]) -> int:
    from roadgpt.plural import plural
    from roadgpt.run import check_parts
    from roadgpt.run.atomic import set_aside
    from roadgpt.run.folder import finished
    from roadgpt_study.execution import work
    from roadgpt_study.plan import CARD, open_folder
    from roadgpt_study.study_report import keep_problems, write_study

    workers, quiet, out, again = (rest.pop(name) for name in ("workers", "quiet", "out", "again"))
    draw = options.drawing_of(options.pictures_of(rest))
    place = out or Path("roadgpt-runs") / f"study-{kind}-{rest['seed']}"
    plan = _plan(kind, prompts, source, drives, rest)
    plan = plan.model_copy(update={"command": _command(plan, place)})
    for designer in plan.designers:
        check_parts(plan.setup_of(designer), plan.world)
    if again:
        set_aside(place, CARD)
    open_folder(plan, place)
    total = len(plan.parts()) * plan.roads
    if not quiet:
        click.echo(
            f"{plural(len(prompts), 'description')}, {plural(plan.roads, 'road')} each, "
            f"by {' and '.join(plan.designers)}, into {place}"
        )
    begun, notes = time.perf_counter(), list[str]()
    advice = "finished roads are complete, and the same command continues"
    with resumable(advice), progress("roads", total, quiet) as tell:
        problems = work(plan, place, workers, draw, tell, notes.append)
    keep_problems(place, problems)
    if not quiet:
        click.echo("".join(f"note: {note}\n" for note in notes), nl=False)
        made = sum(len(finished(place / part.name)) for part in plan.parts())
        click.echo(f"{plural(made, 'road')} in {time.perf_counter() - begun:.0f} s; writing the report")
    page = write_study(place)
    told: dict[str, list[str]] = {}
    for problem in problems:
        told.setdefault(problem.sentence, []).append(problem.part)
    for sentence, parts in told.items():
        warn(f"{', '.join(parts)}: {sentence}")
    click.echo(str(page))
    return NOT_ASKED if any(problem.is_of_chat for problem in problems) else 0


def _plan(
    kind: "Kind", prompts: "Sequence[Prompt]", source: str, drives: bool, rest: dict[str, Any]
) -> "StudyPlan":
    from roadgpt import plugins
    from roadgpt.chat import asks_a_model
    from roadgpt.run import Setup
    from roadgpt_study.plan import StudyPlan

    designers = tuple(dict.fromkeys(rest.pop("designers")))
    asking = [name for name in designers if asks_a_model(plugins.find("designers", name))]
    own = {"roads": rest.pop("roads"), "seed": rest.pop("seed"), "world": options.world_of(rest)}
    chat = options.chat_of(rest, rest["reader"], (asking or designers)[0])
    setup = Setup(drives=drives, chat=chat, designer=designers[0], **rest)
    own |= {"kind": kind, "prompts": tuple(prompts), "designers": designers, "source": source}
    return StudyPlan(setup=setup, **own)


def _command(plan: "StudyPlan", place: Path) -> str:
    from roadgpt.cli.repeat_commands import option_words

    words = ["study", plan.kind, *([plan.source] if plan.source else [])]
    words += ["--roads", str(plan.roads), "--seed", str(plan.seed), *DESIGNERS.written(plan.designers)]
    told = {*THESIS} | ({"friction"} & plan.world.site.model_fields_set)
    words += option_words(plan.setup, plan.world, _DRIVEN[: len(SHOWN)], also=told)
    if plan.setup.drives != (plan.kind == "thesis"):
        words.append("--drive" if plan.setup.drives else "--no-drive")
    return command_line(*words, "--out", place)


@click.group(
    cls=CommandGroup,
    heading="Evaluate",
    short_help="Repeat the evaluation of RoadGPT's thesis, or survey people.",
)
def command() -> None:
    """Evaluate many roads, by measurements or by people who rate them."""


for each in (thesis, alignment, survey.command):
    command.add_command(each)
