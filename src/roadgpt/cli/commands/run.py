"""``roadgpt run``: designs, checks, drives, judges and draws roads from a description."""

import secrets
import sys
from contextlib import redirect_stdout
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from roadgpt.cli import options
from roadgpt.cli.crash import crashes_go_to
from roadgpt.cli.option import Heading, Option
from roadgpt.cli.option_groups import GroupedCommand
from roadgpt.cli.option_types import ROADS
from roadgpt.cli.result_row import spending
from roadgpt.cli.screen import Screen
from roadgpt.cli.streams import warn
from roadgpt.errors import GivenUpError

if TYPE_CHECKING:
    from roadgpt.brief.model import Brief
    from roadgpt.campaign import Campaign
    from roadgpt.report import Format, Scale
    from roadgpt.road import World
    from roadgpt.run.folder import Draw

SEEDS = 1_000_000  # random seeds are below this number, so that they are short enough to type again

OPTIONS = (
    Option("-n --roads", "Number of roads.", ROADS, 1),
    options.seed("The same seed gives the same roads. [default: random]"),
    options.out("Folder for the runs. [default: a new one]"),
    options.AGAIN,
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
    *(*options.CHAT, *options.BEAMNG, *options.GATE, options.JUNIT, *options.SCREEN),
)


@click.command(cls=GroupedCommand, params=[options.WORDS, *OPTIONS])
def command(words: tuple[str, ...], as_json: bool, quiet: bool, verbose: bool, **rest: Any) -> None:
    """Make roads from a description: design, check, drive and judge them.

    \b
    roadgpt run "an uphill road with 3 turns" -n 5
    roadgpt run "two hairpins, then a straight" -n 20 --seed 7 --friction 0.6
    roadgpt run "a winding road" --reader chat --max-cost 0.50

    \b
    Exit status (roads finished before an error are saved in full):
      0  every road has an outcome, even if it is FAIL, INVALID or ERROR
      2  the description or an option cannot be used
      3  nothing could be designed
      4  a language model could not be used, or its token or cost limit was hit
      6  the results do not meet --fail-on or --baseline; see --help-all
    """
    carry_out(Screen(rest["roads"], as_json, quiet, verbose), " ".join(words), **rest)


def usual_values(words: str, roads: int, is_plan: bool = False) -> dict[str, Any]:
    """Returns the option values of ``roadgpt run`` for a user who gives only the number of roads and a
    description or plan (``words``). All other options have their configured or default values.

    Raises:
        UsageError: A setting cannot be used.
    """
    parent = click.get_current_context(silent=True)
    given = ["-n", str(roads), *(["--plan"] if is_plan else []), "--", words]
    values = command.make_context("run", given, parent).params
    for name in ("words", "as_json", "quiet", "verbose"):
        values.pop(name)
    return values


def carry_out(
    screen: Screen,
    words: str,
    *,
    roads: int,
    seed: int | None,
    out: Path | None,
    again: bool,
    junit: Path | None,
    route: str,
    axes: "Scale",
    formats: "tuple[Format, ...]",
    **given: Any,
) -> None:
    """Interprets the description, makes its roads, and prints each road when it is finished.

    The keyword arguments are the values of the options. If ``seed`` is None, the runs in ``out``
    determine the seed; without such runs, the seed is random. An empty ``route`` means a random route.

    Raises:
        RoadGPTError: The description, a plug-in or the folder cannot be used, or nothing could be designed.
        KeyboardInterrupt: The user pressed Ctrl-C; finished roads are saved in full.
    """
    from roadgpt.campaign import campaign
    from roadgpt.campaign.gate import Gate
    from roadgpt.chat import Meter
    from roadgpt.run import Setup, brief_of, seed_in

    gate = screen.gate = Gate(out, *(given.pop(each.field) for each in options.GATE))
    world, pictures = options.world_of(given), options.pictures_of(given)
    given["reader"] = options.reader_of(given)
    chat = options.chat_of(given, given["reader"], given["designer"])
    setup = Setup(drives=not given.pop("no_drive"), chat=chat, **given)
    draw = beside(pictures, axes, formats)
    meter = Meter.of(chat)
    brief = brief_of(words, world, setup, meter)
    if route:
        from roadgpt.brief.map_plan import with_route  # only for maps

        brief = brief.model_copy(update={"map": with_route(brief.map, route)})
    if seed is None and out is not None:
        seed = seed_in(out)
    if seed is None:
        seed = secrets.randbelow(SEEDS)
    with redirect_stdout(sys.stderr):  # a user's driver is loaded, and may print
        work = campaign(brief, roads, seed, world, setup, out, draw, meter, again)
    screen.request, screen.junit = work.request, junit
    screen.say(understood(brief, work.request.world, world))
    screen.detail(brief.model_dump_json(exclude_defaults=True, indent=2))
    crashes_go_to(work.folder)
    screen.say(f"seed {seed}, into {work.folder}")
    if work.is_complete:
        screen.say(f"all {work.roads} roads are there")
    elif work.kept:
        screen.say(f"{len(work.kept)} roads were finished before; continuing")
    _watch(work, pictures, screen)
    gate.close()


def understood(brief: "Brief", world: "World", given: "World") -> str:
    """Returns lines of text: how a description was read, a warning if that is uncertain, and the remarks of
    ``all_remarks``.
    """
    from roadgpt.brief import SURE

    told = f"I read this as: {reading(brief)}"
    if brief.confidence < SURE:
        sure = f"{100 * brief.confidence:.0f} % sure"
        told += f"; perhaps not understood as meant ({sure}), so check it or say it in other words"
    if brief.other:
        from roadgpt.brief.plan import read_plan

        other = reading(read_plan(brief.other))
        told += f"\nit could also mean: {other}\n  (for that: --plan '{brief.other}')"
    return "\n".join([told, *(f"note: {remark}" for remark in all_remarks(brief, world, given))])


def all_remarks(brief: "Brief", world: "World", given: "World") -> tuple[str, ...]:
    """Returns sentences that say, for example, which parts of a description are not built, and how ``world``
    differs from ``given``, the World that the user gave.

    The sentences also say if the friction of ``world`` does not match the surface in the description, or if a
    motorway does not fit on its map.
    """
    from roadgpt.brief import remarks
    from roadgpt.design.room import lane_remarks, map_remark

    found = remarks(brief, world.site.map_size, world.site.friction)
    return tuple(filter(None, (*found, *lane_remarks(brief, world), map_remark(brief, given, world))))


def reading(brief: "Brief") -> str:
    """Returns a text that says how a description was read, and which words the reading does not use."""
    from roadgpt.brief import sentence

    said = sentence(brief).removesuffix(".")
    told = f"{said[:1].lower()}{said[1:]}"
    if brief.unused:
        told += "; not used: " + ", ".join(f"'{word}'" for word in brief.unused)
    return told


def _watch(work: "Campaign", pictures: "tuple[Format, ...]", screen: Screen) -> None:
    """Shows the roads of a folder, starting with those that had been finished before, and then a table."""
    try:
        screen.runs(work.all_runs(), work.folder)
    except (KeyboardInterrupt, GivenUpError):
        from roadgpt.cli.repeat_commands import to_resume

        warn(f"continue with: {to_resume(work.folder)}")
        raise
    finally:
        screen.close()
        if work.meter.spent.calls:
            screen.say(f"language model: {spending(work.meter.spent)}")
        if screen.rows:
            screen.say(f"tests and tables: {work.folder}")
            if len(screen.rows) == work.roads:
                from roadgpt.cli.next_steps import lines, of_rows

                for line in lines(of_rows(work.request, work.brief, work.roads, screen.rows)):
                    screen.say(line)
            if pictures:
                kind = pictures[0]
                screen.say(
                    f"pictures: {work.folder / f'overview.{kind}'} and {work.folder / 'runs'}/*/*.{kind}"
                )


def beside(pictures: "tuple[Format, ...]", axes: "Scale", formats: tuple[str, ...]) -> "Draw | None":
    """Returns a function that adds pictures, and road files in these formats, to the folder of a run; None if
    neither is wanted.

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
