"""Commands that make or drive roads: ``roadgpt run``, ``read`` and ``drive``."""

import json
import shlex
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import redirect_stdout
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from roadgpt.cli import options
from roadgpt.cli.options import (
    HOW_MANY,
    Argument,
    GroupedCommand,
    Heading,
    Option,
    folder,
    named,
    refuse_file,
    whole,
)
from roadgpt.cli.screen import Row, Screen, row_of
from roadgpt.cli.streams import aligned, crashes_go_to, warn
from roadgpt.errors import GivenUpError, UsageError

if TYPE_CHECKING:
    from roadgpt.brief import Brief
    from roadgpt.campaign import Campaign
    from roadgpt.campaign.gate import Gate
    from roadgpt.campaign.selection import Selection
    from roadgpt.report import Format, Scale
    from roadgpt.road import Design, Road, World
    from roadgpt.run.folder import Draw
    from roadgpt.run.model import Run, Setup

SEEDS = 1_000_000  # random seeds are below this number, so that they are short enough to type again

RUN_OPTIONS = (
    Option("-n --roads", "Number of roads.", HOW_MANY, 1),
    Option("-j --workers", "Roads driven at a time.", whole(1, 4096, "the number of workers"), 1),
    options.seed("The same seed gives the same roads. [default: random]"),
    options.out("Folder for the runs. [default: a new one]"),
    options.AGAIN,
    options.PLAN,
    Option("--route", "For a map of roads: where the car turns at junctions, such as left,right. [default: "
           "random]", str, "", metavar="TURN,...", heading=Heading.DESIGN, is_rare=True),
    *options.MAKING,
    *(*options.CHAT, *options.GATE, options.JUNIT, *options.SCREEN),
)  # fmt: skip

OF_RUN = Argument("words...", "DESCRIPTION", options.WORDS.advice, required=False)


@click.command(cls=GroupedCommand, has_simulators=True, params=[OF_RUN, *RUN_OPTIONS])
@click.pass_context
def run(
    ctx: click.Context, /, words: tuple[str, ...], as_json: bool, quiet: bool, verbose: bool, **rest: Any
) -> None:
    """Make roads from a description: design, check, drive and judge them.

    \b
    roadgpt run "an uphill road with 3 turns" -n 20 -j 2 --seed 7 --friction 0.6
    roadgpt run "a winding road" --scenario "r157:cut_in slower=30"

    \b
    Exit status (roads finished before an error are saved in full):
      0  every road has an outcome, even if it is FAIL, INVALID or ERROR
      2  the description or an option cannot be used
      3  nothing could be designed
      4  a language model could not be used, or its token or cost limit was hit
      6  the results do not meet --fail-on or --baseline; see --help-all"""
    if not words:
        if not rest["scenario"]:
            raise click.MissingParameter(ctx=ctx, param=OF_RUN)
        from roadgpt.brief.scenarios import LANE_WIDTH, scenario

        words = (scenario(rest["scenario"]).plan,)
        rest |= {"is_plan": True} | ({} if "lane_width" in options.typed(ctx) else {"lane_width": LANE_WIDTH})
    refuse_file(text := " ".join(words), "drives", "drive")
    carry_out(Screen(rest["roads"], as_json, quiet, verbose), text, **rest)


def usual_values(words: str, roads: int, is_plan: bool = False) -> dict[str, Any]:
    """Returns the option values of ``roadgpt run`` for a user who gives only the number of roads and a
    description or plan (``words``). All other options have their configured or default values."""
    parent = click.get_current_context(silent=True)
    given = ["-n", str(roads), *["--plan"] * is_plan, "--", words]
    values = run.make_context("run", given, parent).params
    return {name: values[name] for name in values.keys() - {"words", "as_json", "quiet", "verbose"}}


def carry_out(
    screen: Screen, words: str, *, roads: int, seed: int | None, out: Path | None, again: bool,
    junit: Path | None, route: str, axes: "Scale", formats: "tuple[Format, ...]", workers: int, **given: Any,
) -> None:  # fmt: skip
    """Interprets the description, makes its roads, and prints each road when it is finished.

    The keyword arguments are the values of the options. If ``seed`` is None, the runs in ``out``
    determine the seed; without such runs, the seed is random. An empty ``route`` means a random route."""
    from roadgpt.brief.plan import with_route
    from roadgpt.campaign.run_folder import campaign, seed_in
    from roadgpt.chat import Meter
    from roadgpt.run import Setup, brief_of

    gate = screen.gate = options.gate_of(given, out)
    world, pictures = options.world_of(given), options.pictures_of(given)
    given["reader"] = options.reader_of(given)
    chat = options.chat_of(given, given["reader"], given["designer"])
    setup = Setup(drives=not given.pop("no_drive"), chat=chat, **given)
    draw = beside(pictures, axes, formats)
    meter = Meter.of(chat)
    brief = brief_of(words, world, setup, meter)
    if route:
        brief = brief.model_copy(update={"map": with_route(brief.map, route)})
    world = setup.staged(world, brief.left_hand)
    if seed is None and out is not None:
        seed = seed_in(out)
    if seed is None:
        import secrets

        seed = secrets.randbelow(SEEDS)
    with redirect_stdout(sys.stderr):  # a user's driver is loaded, and may print
        work = campaign(brief, roads, seed, world, setup, out, draw, meter, again, workers)
    screen.request = work.request
    screen.say(understood(brief, work.request.world, world))
    tell_recording(screen, setup)
    screen.detail(brief.model_dump_json(exclude_defaults=True, indent=2))
    crashes_go_to(work.folder)
    screen.say(f"seed {seed}, into {work.folder}")
    if work.is_complete:
        screen.say(f"all {work.roads} roads are there")
    elif work.kept:
        screen.say(f"{len(work.kept)} roads were finished before; continuing")
    _watch(work, pictures, screen, junit)
    gate.close()


def tell_recording(screen: Screen, setup: "Setup") -> None:
    """Tells what of recorded tracks is not replayed."""
    from roadgpt.run import recording_of

    recording = recording_of(setup)
    for remark in () if recording is None else recording.remarks:
        screen.say(f"note: {remark}")


UNSURE = "perhaps not understood as meant ({:.0f} % sure{}), so check it or say it in other words"


def understood(brief: "Brief", world: "World", given: "World") -> str:
    """Returns lines: how a description was read, a warning if that is uncertain, and ``all_remarks``."""
    from roadgpt.brief import SURE
    from roadgpt.brief.plan import read_plan

    told = f"I read this as: {reading(brief)}"
    if brief.confidence < SURE:
        from roadgpt.brief.readers.model.mentions import unnamed_in

        unnamed = "".join(f"; no word names the {kind}" for kind in unnamed_in(brief))
        told += f"; {UNSURE.format(100 * brief.confidence, unnamed)}"
    if brief.other:
        other = reading(read_plan(brief.other))
        told += f"\nit could also mean: {other}\n  (for that: --plan '{brief.other}')"
    return "\n".join([told, *(f"note: {remark}" for remark in all_remarks(brief, world, given))])


def all_remarks(brief: "Brief", world: "World", given: "World") -> tuple[str, ...]:
    """Returns sentences on what is not built, or not as described; ``given`` is the World of the user."""
    from roadgpt.brief import remarks
    from roadgpt.design.room import world_remarks

    is_set = {name for part in (given.site, given.section, given.limits) for name in part.model_fields_set}
    is_set |= {"speed"} & {name.removesuffix("_limit") for name in is_set}
    open_ = brief.model_copy(update={"beside": tuple(each for each in brief.beside if each not in is_set)})
    site, of_friction = world.site, (world.site.friction, world.scene.surfaces, "friction" in is_set)
    of_words = remarks(open_, site.map_size, *of_friction)
    of_words += tuple(f"the language model was asked again: {said}" for said in brief.rounds)
    return tuple(dict.fromkeys((*of_words, *world_remarks(brief, given, world))))  # both tell the surface


def reading(brief: "Brief") -> str:
    """Returns a text that says how a description was read, and which words the reading does not use."""
    from roadgpt.brief import sentence

    said = sentence(brief).removesuffix(".")
    told = f"{said[:1].lower()}{said[1:]}"
    if brief.unused:
        told += "; not used: " + ", ".join(f"'{word}'" for word in brief.unused)
    return told


def _watch(work: "Campaign", pictures: "tuple[Format, ...]", screen: Screen, junit: Path | None) -> None:
    from roadgpt.campaign.model import no_failure

    try:
        screen.runs(work.all_runs(), work.folder)
    except (KeyboardInterrupt, GivenUpError):
        from roadgpt.cli.repeat_commands import to_resume

        warn(f"continue with: {to_resume(work.folder)}")
        raise
    finally:
        if junit is not None:
            from roadgpt.cli.junit import suite_of, write_junit

            write_junit(junit, [suite_of(work.request, sorted(screen.rows, key=lambda row: row.name))])
        screen.close()
        screen.spent(work.meter.spent)
        if screen.rows:
            screen.say(f"tests and tables: {work.folder}")
            if len(screen.rows) == work.roads:
                for line in no_failure(Counter(row.outcome for row in screen.rows)):
                    screen.say(line)
            for kind in pictures[:1]:
                overview = work.folder / f"overview.{kind}"
                screen.say(f"pictures: {overview} and {work.folder / 'runs'}/*/*.{kind}")


def beside(pictures: "tuple[Format, ...]", axes: "Scale", formats: tuple[str, ...]) -> "Draw | None":
    """Returns a function that adds pictures, and road files in these formats, to the folder of a run; None if
    neither is wanted."""
    draw = options.drawing_of(pictures, axes)
    if not formats:
        return draw
    from roadgpt.export import exporter_of
    from roadgpt.run.exporting import Exporting

    for name in formats:
        exporter_of(name)
    return Exporting(formats, warn, draw)


FEW = whole(1, 10, "the number of readings")
LEAST = 0.01  # smallest chance of a reading that is listed
TEMPERATURE = 1.3  # sampling temperature for the readings after the likeliest one
READ_OPTIONS = (
    options.PLAN,
    *named(options.SETUP, "reader"),
    Option("--weights", "Read with the networks of another training, from this folder.", folder),
    *named(options.WORLD, "map_size", "friction"),
    Option("--table as_table", "Print a row for each turn and straight.", bool),
    options.json_option("Print the interpretation as JSON."),
    Option("--ask asks", "Ask what is doubtful or open, and print the plan that the answers make.", bool),
    Option("--alternatives number", "Show up to this many different interpretations.", FEW, 1),
    *options.CHAT,
)


@click.command(cls=GroupedCommand, params=[options.WORDS, *READ_OPTIONS])
def read(
    words: tuple[str, ...], weights: Path | None, as_table: bool, as_json: bool, asks: bool, number: int,
    **rest: Any,
) -> None:  # fmt: skip
    """Show how RoadGPT interprets a description, how confident it is, and whether the road fits on the map.

    \b
    roadgpt read "uphill, 3 turns, the last one a hairpin"
    roadgpt read "drei Kurven, dann 80 m geradeaus bergab" --table
    roadgpt read "a road" --alternatives 3"""
    from roadgpt.brief import alternatives, sentence
    from roadgpt.brief.plan import plan
    from roadgpt.cli.asking import made_clear
    from roadgpt.design.room import world_for
    from roadgpt.run import Setup, brief_of

    if asks and (as_json or number > 1 or not sys.stdin.isatty()):
        raise UsageError("--ask is for one reading at a terminal; leave it out, or --json and --alternatives")
    world, reader, text = options.world_of(rest), options.reader_of(rest), " ".join(words)
    if weights is not None:
        if reader != "model":
            raise UsageError(f"--weights are of the reader model, not of {reader}; leave one of them out")
        reader = f"model:{weights}"
    chat = options.chat_of(rest, reader)
    briefs: Sequence[Brief] = (brief_of(text, world, Setup(reader=reader, chat=chat)),)
    if number > 1 and chat is None:  # a language model says what it takes for likeliest
        briefs = alternatives(text, number, reader, world.site.map_size, TEMPERATURE)
    if as_json:
        found = [_as_data(brief, world_for(brief, world), world) for brief in briefs]
        click.echo(json.dumps(found if number > 1 else found[0], indent=2, ensure_ascii=False))
    elif number > 1:
        click.echo("\n".join(_list(briefs, as_table)))
    else:
        click.echo(understood(briefs[0], world_for(briefs[0], world), world))
        if as_table:
            click.echo(_table(briefs[0]))
        if asks:
            meant = made_clear(briefs[0])
            click.echo(f"{sentence(meant)}\n  (for that: --plan {shlex.quote(plan(meant))})")


def _as_data(brief: "Brief", world: "World", usual: "World") -> dict[str, object]:
    from roadgpt.brief import SURE, sentence
    from roadgpt.brief.plan import plan

    told = {"sentence": sentence(brief), "plan": plan(brief), "confidence": brief.confidence}
    told |= {"is_sure": brief.confidence >= SURE, "other": brief.other}
    map_size, friction = world.site.map_size, world.site.friction
    told |= {"map_size": map_size, "friction": friction, "remarks": all_remarks(brief, world, usual)}
    return {**told, "unused": brief.unused, "brief": brief.model_dump(exclude_defaults=True)}


def _list(briefs: Sequence["Brief"], as_table: bool) -> Iterator[str]:
    from roadgpt.brief import SURE

    likely = [brief for place, brief in enumerate(briefs) if not place or brief.confidence >= LEAST]
    whole = max(1.0, sum(brief.confidence for brief in likely))  # each is judged on its own; one is meant
    for number, brief in enumerate(likely, 1):
        yield f"{number}. {100 * brief.confidence / whole:3.0f} %  {reading(brief)}"
        if as_table:
            yield _table(brief)
    if len(likely) == 1:
        yield f"no other reading has a chance of {100 * LEAST:.0f} %"
    if likely[0].confidence < SURE:
        yield "not sure of any: if none is what you mean, say it in other words"


def _table(brief: "Brief") -> str:
    """Returns a table of the features in driving order, then the requirements on the whole road."""
    from roadgpt.brief import normal
    from roadgpt.brief.scene import scene_text
    from roadgpt.brief.sentence import clause_columns, road_words

    said = normal(brief)
    rows = [("", "what", "how")]
    rows += [(str(number), *clause_columns(clause)) for number, clause in enumerate(said.clauses, 1)]
    wishes = road_words(said)
    if wishes or not said.clauses:
        rows.append(("", "whole road", wishes or "nothing is asked of it"))
    if scene := scene_text(brief.scene):
        rows.append(("", "others", scene))
    return "\n".join(aligned(rows, "><<"))


OF_AGAIN = (*options.CHOICES, options.NO_PLOT, options.AXES, options.FORMAT)
DRIVE_OPTIONS = (
    options.seed("Seed for the driver.", 1),
    options.out("Folder for the runs. [default: none is written, or with --again CAMPAIGN/again]"),
    *options.WORLD,
    *named(options.SETUP, "driver", "simulator", "keep_driving", "tracks", "scenario", "geometry", "rules"),
    Option("--again", "Drive tests of a campaign again.", bool, heading=Heading.AGAIN),
    *(each.but(heading=Heading.AGAIN) for each in OF_AGAIN),
    *(*options.GATE, options.JUNIT, *options.SCREEN),
)
ONLY_AGAIN = {each.field for each in OF_AGAIN}
BOTH = {"files", "again", "driver", "tracks", "out", *(each.field for each in options.GATE)}


@click.command(cls=GroupedCommand, has_simulators=True, params=[options.ROADS, *DRIVE_OPTIONS])
@click.pass_context
def drive(
    ctx: click.Context, /, files: tuple[str, ...], seed: int, again: bool, out: Path | None, axes: Any,
    junit: Path | None, as_json: bool, quiet: bool, verbose: bool, **rest: Any,
) -> int:  # fmt: skip
    """Drive roads from files, or run tests of a campaign again.

    ROAD is a RoadGPT design, a test of SBFT or SDC-Scissor, a list of points [x, y] or [x, y, z], a table of
    points (.csv) or OpenDRIVE (.xodr). A folder of such files, a folder of runs and a campaign stand for all
    their roads. A road that breaks a rule is driven anyway, and the broken rule is shown with the verdict. A
    road is INVALID if it cannot be driven: it has numbers that are not finite, two points at the same place,
    or no room for a car. With --rules sbft (see --help-all), every broken rule makes a road INVALID, as in
    the SBFT competition. The exit status is 0 if every road could be read, and 6 if the results do not meet
    --fail-on or --baseline.

    With --again, give a campaign or a folder of runs, followed by the numbers of its tests, such as DIR 17.
    If a campaign has several cells (combinations of settings), name the cell, too: CAMPAIGN/c02/17. Road,
    world, driver and seed are taken from the test, so the drive should be identical byte for byte; the
    command says so if it is not. Each test is written into a run folder of its own. To look at a test
    without driving it again, use roadgpt show, view, film or export with CAMPAIGN/c02/17.

    \b
    roadgpt drive my_road.json --friction 0.6
    roadgpt drive --again roadgpt-runs/an-uphill-road-with-3-turns-7 17"""
    for parameter in ctx.command.params:
        if parameter.name in options.typed(ctx) - BOTH and again != (parameter.name in ONLY_AGAIN):
            flag = parameter.opts[0]
            raise UsageError(
                f"a test keeps its world and its seed; leave out {flag} with --again"
                if again
                else f"{flag} is for tests of a campaign, which are driven with --again; leave it out for a "
                "road from a file"
            )
    choice, pictures = options.choice_of(rest), options.pictures_of(rest)
    gate = options.gate_of(rest, out)
    if again:
        drivers = [rest["driver"]] if "driver" in options.typed(ctx) else []
        drive_again(files, choice, out, drivers, axes, pictures, gate)
        return 0
    from roadgpt.cli.junit import suite_of, write_junit
    from roadgpt.cli.roads import UNREADABLE, each_road, made, roads_in
    from roadgpt.run import Request, Setup, check_parts, prove, write_run
    from roadgpt.run.folder import reject_used
    from roadgpt.run.model import MOST, given_up

    reject_used(out)
    world = options.world_of(rest)
    setup = Setup(**rest)
    with redirect_stdout(sys.stderr):
        check_parts(setup, world)  # reports a missing driver before any road is read
    roads = roads_in(files)
    screen = Screen(len(roads), as_json, quiet, verbose)
    request = Request(seed=seed, world=world, setup=setup)
    screen.request, screen.gate = request, gate
    tell_recording(screen, setup)
    lost = list[str]()  # drives in a row

    def driven(file: str, blueprint: "Design | Road", world: "World") -> "tuple[Row, Run]":
        with redirect_stdout(sys.stderr):  # what a user's driver prints is no row
            at, is_strict = len(screen.rows) + 1, setup.rules == "strict"
            run = prove(blueprint, seed, world, setup, at, despite_findings=is_strict)
        screen.detail(f"{file}: {run.description}")
        for finding in run.findings:
            screen.detail(f"{file}: finding: {finding.sentence}")
        lost[:] = [*lost, file] if run.is_lost else []
        if len(lost) >= MOST:
            raise given_up(run.description, f"see to it and drive the roads from {lost[0]} on again")
        if out is not None:
            write_run(run, made(out))
        return row_of(run, file), run

    each_road(roads, screen, world, driven)
    if junit is not None:
        write_junit(junit, [suite_of(request, screen.rows)])
    gate.close()
    return UNREADABLE if any(row.cause == "unreadable" for row in screen.rows) else 0


AGAIN = "again"  # folder in that of the tests


def drive_again(
    names: Sequence[str], choice: str | None, out: Path | None, drivers: Sequence[str], axes: "Scale",
    formats: "tuple[Format, ...]", gate: "Gate",
) -> None:  # fmt: skip
    """Repeats tests, writes a run folder for each, and warns if a result differs from the recorded one.

    The names are a folder and numbers of tests in this folder, or single tests like CAMPAIGN/c02/17.
    Without ``out``, the run folders are written into ``again`` in the folder of the tests. ``drivers`` are
    those that the user gave with ``--driver``. No pictures are drawn without ``formats``."""
    from roadgpt.campaign.folder_record import is_same, run_again, setups_of
    from roadgpt.campaign.model import NumberedTest
    from roadgpt.chat.answer import plain
    from roadgpt.cli.roads import made
    from roadgpt.drive.loading import check_named_drivers
    from roadgpt.run import write_run
    from roadgpt.run.atomic import refuse_links

    tests = _named(names, choice)
    for folder_ in {place.folder for place in tests}:
        check_named_drivers(drivers, {setup.driver for setup in setups_of(folder_)}, folder_)
    draw = options.drawing_of(formats, axes)
    for place in tests:
        name = NumberedTest(place.cell, place.number or 0)
        run, result = run_again(place.folder, *name)
        home = (out or place.folder / AGAIN) / place.cell
        refuse_links(*[home.parent] * (home.parent.name == AGAIN), home)
        written, told = write_run(run, made(home), draw), plain(run.description, 300)
        if worse := gate.add(place.said, run):
            told += f"  worse: {worse}"
        click.echo(f"{run.outcome:<8} {name}  {written}  {told}")
        if not is_same(run, result):
            said = f"{result.outcome} before ({plain(result.description, 300)})"
            changed = "its driver, RoadGPT or the machine has changed: compare the versions that show prints"
            warn(f"test {name} was {said}; {changed}")
    if gate.remark:
        click.echo(gate.remark)
    gate.close()


def _named(names: Sequence[str], choice: str | None) -> "list[Selection]":
    """Returns the tests that the names refer to; a number refers to a test in the folder that is named
    first."""
    from roadgpt.campaign.record import no_tests
    from roadgpt.campaign.selection import chosen, selection_of
    from roadgpt.chat.answer import plain

    first = selection_of(names[0])
    if first is None:
        raise no_tests(Path(names[0]))
    if first.number is None and choice is None and len(names) == 1:
        raise UsageError(
            f"say which tests of {first.said}: their numbers, such as 17 or c02/17, or "
            f"{options.choices_said()}"
        )
    out = [] if first.number is None and choice is None else chosen(first, choice)
    for name in names[1:]:
        place = selection_of(f"{first.folder}/{name}") or selection_of(name)
        if place is None or (place.number is None and choice is None):
            raise UsageError(f"'{plain(name, 40)}' is not a test; give its number, such as 17 or c02/17")
        out += chosen(place, choice)
    if not out:
        raise UsageError(f"{first.said} has no test for --{choice}")
    return out
