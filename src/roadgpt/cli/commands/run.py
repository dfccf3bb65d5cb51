"""``roadgpt run``: designs, checks, drives, judges and draws roads from a description."""

import secrets
import shlex
import sys
from contextlib import redirect_stdout
from dataclasses import dataclass
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from roadgpt.cli import options
from roadgpt.cli.crash import crashes_go_to
from roadgpt.cli.next_steps import lines, of_rows
from roadgpt.cli.option import Heading, Option
from roadgpt.cli.option_groups import GroupedCommand
from roadgpt.cli.option_types import ROADS
from roadgpt.cli.result_row import spending
from roadgpt.cli.screen import Screen
from roadgpt.cli.streams import warn

if TYPE_CHECKING:
    from roadgpt.brief.model import Brief
    from roadgpt.campaign import Campaign
    from roadgpt.report import Format, Scale
    from roadgpt.road import World
    from roadgpt.run import Setup
    from roadgpt.run.folder import Draw

SEEDS = 1_000_000  # random seeds are below this number, so that they are short enough to type again


@dataclass(frozen=True)
class RunJob:
    """One call of ``roadgpt run``: the description, and the values of all options."""

    words: str
    roads: int
    world: "World"
    setup: "Setup"
    seed: int | None = None
    """The seed; None: the seed stored in ``out`` or, if there is none, a random one."""
    out: Path | None = None
    """The folder for the runs; None: a new one."""
    axes: "Scale" = "equal"
    pictures: "tuple[Format, ...]" = ("png",)
    """Formats of the pictures of each run; empty: no pictures are drawn."""
    formats: tuple[str, ...] = ()
    """Formats of the road files that are written into each run."""
    junit: Path | None = None
    """The JUnit file to write; None: none is written."""
    route: str = ""
    """Where the car turns at the junctions of a map of roads, such as "left,straight"; empty: at random."""


OPTIONS = (
    Option("-n --roads", "Number of roads.", ROADS, 1),
    options.seed("The same seed gives the same roads. [default: random]"),
    options.out("Folder for the runs. [default: a new one]"),
    options.PLAN,
    Option(
        "--route",
        "For a map of roads: where the car turns at junctions, such as left,right. [default: random]",
        str,
        "",
        metavar="TURN,...",
        heading=Heading.DESIGN,
        is_rare=True,
    ),
    *options.MAKING,
    *(*options.CHAT, *options.BEAMNG, options.JUNIT, *options.SCREEN),
)


@click.command(cls=GroupedCommand, params=[options.WORDS, *OPTIONS])
def command(words: tuple[str, ...], as_json: bool, quiet: bool, verbose: bool, **rest: Any) -> None:
    """Make roads from a description: design, check, drive and judge them.

    \b
    roadgpt run "an uphill road with 3 turns" -n 5
    roadgpt run "two hairpins, then a straight" -n 20 --seed 7 --friction 0.6
    roadgpt run "a winding road" --designer chat --max-cost 0.50

    \b
    Exit status:
      0  every road has an outcome, even if it is FAIL, INVALID or ERROR
      2  the description or an option cannot be used
      3  nothing could be designed
      4  a language model could not be used, or its token or cost limit was hit
    Roads finished before an error are saved in full.
    """
    roads = rest["roads"]
    carry_out(_job_of(" ".join(words), rest), Screen(roads, as_json, quiet, verbose))


def _job_of(words: str, given: dict[str, Any]) -> RunJob:
    """Returns the job that the values of the options describe; removes some of them from ``given``."""
    from roadgpt.run import Setup

    own = {name: given.pop(name) for name in ("roads", "seed", "out", "axes", "formats", "junit", "route")}
    world, pictures = options.world_of(given), options.pictures_of(given)
    given["reader"] = options.reader_of(given)
    chat = options.chat_of(given, given["reader"], given["designer"])
    setup = Setup(drives=not given.pop("no_drive"), chat=chat, **given)
    return RunJob(words=words, world=world, setup=setup, pictures=pictures, **own)


def usual_job(words: str, roads: int, is_plan: bool = False) -> RunJob:
    """Returns the RunJob of ``roadgpt run`` without options: all settings have their configured or default
    values.

    Args:
        words: the description, or a plan.
        roads: the number of roads.
        is_plan: whether the words are a plan.

    Raises:
        UsageError: A setting cannot be used.
    """
    parent = click.get_current_context(silent=True)
    given = ["-n", str(roads), *(["--plan"] if is_plan else []), "--", words]
    values = command.make_context("run", given, parent).params
    for name in ("words", "as_json", "quiet", "verbose"):
        values.pop(name)
    return _job_of(words, values)


def carry_out(job: RunJob, screen: Screen) -> None:
    """Interprets the description, makes its roads, and prints each road when it is finished.

    Raises:
        RoadGPTError: The description, a plug-in or the folder cannot be used, or nothing could be designed.
        KeyboardInterrupt: The user pressed Ctrl-C; finished roads are saved in full.
    """
    from roadgpt.campaign import campaign
    from roadgpt.chat import Meter
    from roadgpt.run import brief_of

    draw = beside(job.pictures, job.axes, job.formats)
    meter = Meter.of(job.setup.chat)
    brief = brief_of(job.words, job.world, job.setup, meter)
    if job.route:
        from roadgpt.brief.map_plan import with_route  # only for maps

        brief = brief.model_copy(update={"map": with_route(brief.map, job.route)})
    seed = _seed(job)
    with redirect_stdout(sys.stderr):  # a user's driver is loaded, and may print
        work = campaign(brief, job.roads, seed, job.world, job.setup, job.out, draw, meter)
    if job.junit is not None:
        from roadgpt.cli.junit import junit_writer

        screen.junit = junit_writer(job.junit, work.request)
    screen.say(understood(brief, work.request.world, job.world))
    screen.detail(brief.model_dump_json(exclude_defaults=True, indent=2))
    crashes_go_to(work.folder)
    screen.say(f"seed {seed}, into {work.folder}")
    if work.is_complete:
        screen.say(f"all {work.roads} roads are there")
    elif work.kept:
        screen.say(f"{len(work.kept)} roads were finished before; continuing")
    _watch(work, job, screen)


def _seed(job: RunJob) -> int:
    """Returns the seed that was given, or that of the folder, or a new one."""
    from roadgpt.run import seed_in

    if job.seed is not None:
        return job.seed
    there = seed_in(job.out) if job.out is not None else None
    return secrets.randbelow(SEEDS) if there is None else there


def understood(brief: "Brief", world: "World | None" = None, given: "World | None" = None) -> str:
    """Returns lines of text: how a description was read, a warning if that is uncertain, and remarks.

    Args:
        brief: What was read.
        world: The World for the roads; see ``all_remarks``.
        given: The World that the user gave.
    """
    from roadgpt.brief import SURE

    told = f"I read this as: {reading(brief)}"
    if brief.confidence < SURE:
        sure = f"{100 * brief.confidence:.0f} % sure"
        told += f"; perhaps not understood as meant ({sure}), so check it or say it in other words"
    if brief.other:
        told += f"\nit could also mean: {other_reading(brief)}\n  (for that: --plan '{brief.other}')"
    return "\n".join([told, *(f"note: {remark}" for remark in all_remarks(brief, world, given))])


def all_remarks(brief: "Brief", world: "World | None", given: "World | None") -> tuple[str, ...]:
    """Returns sentences that say, for example, which parts of a description are not built, and how ``world``
    differs from ``given``, the World that the user gave.

    The sentences also say if the friction of ``world`` does not match the surface in the description, or if a
    motorway does not fit on its map. If ``world`` is None, neither these nor the differences are checked.
    """
    from roadgpt.brief import remarks
    from roadgpt.design.room import lane_remarks, map_remark

    if world is None:
        return remarks(brief, inf)
    found = remarks(brief, world.site.map_size, world.site.friction)
    return tuple(
        filter(None, (*found, *lane_remarks(brief, world), map_remark(brief, given or world, world)))
    )


def other_reading(brief: "Brief") -> str:
    """Returns the second likeliest reading of a description as text; ``brief.other`` must not be empty."""
    from roadgpt.brief import sentence
    from roadgpt.brief.plan import read_plan

    said = sentence(read_plan(brief.other)).removesuffix(".")
    return f"{said[:1].lower()}{said[1:]}"


def reading(brief: "Brief") -> str:
    """Returns a text that says how a description was read, and which words the reading does not use."""
    from roadgpt.brief import sentence

    said = sentence(brief).removesuffix(".")
    told = f"{said[:1].lower()}{said[1:]}"
    if brief.unused:
        told += "; not used: " + ", ".join(f"'{word}'" for word in brief.unused)
    return told


def _watch(work: "Campaign", job: RunJob, screen: Screen) -> None:
    """Shows the roads of a folder, starting with those that had been finished before, and then a table."""
    try:
        screen.runs(work.all_runs(), work.folder)
    except KeyboardInterrupt:
        axes = [] if job.axes == "equal" else ["--axes", job.axes]
        warn(f"continue with: {shlex.join(['roadgpt', 'resume', str(work.folder), *axes])}")
        raise
    finally:
        screen.close()
        if work.meter.spent.calls:
            screen.say(f"language model: {spending(work.meter.spent)}")
        if screen.rows:
            screen.say(f"tests and tables: {work.folder}")
            is_whole = len(screen.rows) == work.roads
            for line in lines(
                of_rows(work.request, work.brief, work.roads, screen.rows) if is_whole else None
            ):
                screen.say(line)
            if job.pictures:
                kind = job.pictures[0]
                screen.say(
                    f"pictures: {work.folder / f'overview.{kind}'} and {work.folder / 'runs'}/*/*.{kind}"
                )


def beside(pictures: "tuple[Format, ...]", axes: "Scale", formats: tuple[str, ...]) -> "Draw | None":
    """Returns a function that adds pictures and road files to the folder of a run; None if neither is wanted.

    Args:
        pictures: Formats of the pictures; empty: no pictures.
        axes: Axes of the pictures.
        formats: Formats of the road files; empty: no road files.

    Raises:
        PartError: A format of road files is unknown.
    """
    draw = options.drawing_of(pictures, axes)
    if not formats:
        return draw
    from roadgpt.export import exporter_of
    from roadgpt.run.exporting import Exporting

    for name in formats:
        exporter_of(name)
    return Exporting(formats, warn, draw)
