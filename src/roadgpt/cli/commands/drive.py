"""``roadgpt drive``: drives roads from files, or repeats tests of a campaign."""

import sys
from collections.abc import Sequence
from contextlib import redirect_stdout
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from roadgpt.cli import options
from roadgpt.cli.campaigns import one_line
from roadgpt.cli.option import Heading, Option, named
from roadgpt.cli.option_groups import GroupedCommand
from roadgpt.cli.result_row import Row, row_of
from roadgpt.cli.roads import UNREADABLE, each_road, made, roads_in, source_of
from roadgpt.cli.screen import Screen
from roadgpt.cli.streams import warn
from roadgpt.errors import UsageError

if TYPE_CHECKING:
    from roadgpt.campaign.gate import Gate
    from roadgpt.campaign.selection import Choice, Selection
    from roadgpt.report import Format, Scale
    from roadgpt.run.lost_drives import LostDrives
    from roadgpt.run.model import Request, Run

OF_AGAIN = (*options.CHOICES, options.NO_PLOT, options.AXES, options.FORMAT)
OPTIONS = (
    options.seed("Seed for the driver.", 1),
    options.out("Folder for the runs. [default: none is written, or with --again CAMPAIGN/again]"),
    *options.WORLD,
    *named(options.SETUP, "driver", "simulator", "keep_driving", "geometry", "rules"),
    *options.BEAMNG,
    Option("--again", "Drive tests of a campaign again.", bool, heading=Heading.AGAIN),
    *(each.but(heading=Heading.AGAIN) for each in OF_AGAIN),
    *(*options.GATE, options.JUNIT, *options.SCREEN),
)
ONLY_AGAIN = {each.field for each in OF_AGAIN}
BOTH = {"files", "again", "driver", "out", *(each.field for each in options.GATE)}


@click.command(cls=GroupedCommand, params=[options.ROADS, *OPTIONS])
@click.pass_context
def command(
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
    roadgpt drive --again roadgpt-runs/an-uphill-road-with-3-turns-7 17
    """
    _refuse_mixture(ctx, again)
    from roadgpt.campaign.gate import Gate

    choice, pictures = options.choice_of(rest), options.pictures_of(rest)
    gate = Gate(out, *(rest.pop(each.field) for each in options.GATE))
    if again:
        drivers = [rest["driver"]] if "driver" in options.typed(ctx) else []
        drive_again(files, choice, out, drivers, axes, pictures, gate)
        return 0
    from roadgpt.run import Request, Setup, check_parts
    from roadgpt.run.editing import reject_used
    from roadgpt.run.lost_drives import LostDrives

    if out is not None:
        reject_used(out)
    world = options.world_of(rest)
    setup = Setup(**rest)
    with redirect_stdout(sys.stderr):
        check_parts(setup, world)  # reports a missing driver before any road is read
    asked = Request(seed=seed, world=world, setup=setup)
    roads = roads_in(files)
    screen = Screen(len(roads), as_json, quiet, verbose)
    screen.request, screen.junit, screen.gate = asked, junit, gate
    losses: LostDrives[str] = LostDrives()
    each_road(roads, screen, lambda file: _driven(screen, file, asked, losses, out))
    gate.close()
    return UNREADABLE if any(row.cause == "unreadable" for row in screen.rows) else 0


def _refuse_mixture(ctx: click.Context, again: bool) -> None:
    for parameter in ctx.command.params:
        if parameter.name in options.typed(ctx) - BOTH and again != (parameter.name in ONLY_AGAIN):
            flag = parameter.opts[0]
            raise UsageError(
                f"a test keeps its world and its seed; leave out {flag} with --again"
                if again
                else f"{flag} is for tests of a campaign, which are driven with --again; leave it out for a "
                "road from a file"
            )


def _driven(
    screen: Screen, file: str, asked: "Request", losses: "LostDrives[str]", out: Path | None
) -> "tuple[Row, Run]":
    from roadgpt.run import prove, write_run

    blueprint, world, remarks = source_of(file, asked.world)
    for remark in remarks:
        screen.say(f"{file}: {remark}")
    with redirect_stdout(sys.stderr):  # what a user's driver prints is no row
        is_strict = asked.setup.rules == "strict"
        at = len(screen.rows) + 1
        run = prove(blueprint, asked.seed, world, asked.setup, at, despite_findings=is_strict)
    screen.detail(f"{file}: {run.description}")
    for finding in run.findings:
        screen.detail(f"{file}: finding: {finding.sentence}")
    if losses.count(file, run.is_lost):
        raise losses.given_up(
            run.description, f"see to it and drive the roads from {losses.lost[0]} on again"
        )
    if out is not None:
        write_run(run, made(out))
    return row_of(run, file), run


AGAIN = "again"  # folder in that of the tests


def drive_again(
    names: Sequence[str], choice: "Choice | None", out: Path | None, drivers: Sequence[str], axes: "Scale",
    formats: "tuple[Format, ...]", gate: "Gate",
) -> None:  # fmt: skip
    """Repeats tests, writes a run folder for each, and warns if a result differs from the recorded one.

    The names are a folder and numbers of tests in this folder, or single tests like CAMPAIGN/c02/17.
    Without ``out``, the run folders are written into ``again`` in the folder of the tests. ``drivers`` are
    those that the user gave with ``--driver``. No pictures are drawn without ``formats``.

    Raises:
        UsageError: A name is wrong, or ``drivers`` are not those of the campaign.
    """
    from roadgpt.campaign.folder_record import setups_of
    from roadgpt.campaign.model import NumberedTest
    from roadgpt.campaign.rerun import is_same, run_again
    from roadgpt.drive.permission import check_named_drivers
    from roadgpt.run import write_run
    from roadgpt.run.atomic import refuse_links

    tests = _named(names, choice)
    for folder_ in {place.folder for place in tests}:
        check_named_drivers(drivers, {setup.driver for setup in setups_of(folder_)}, folder_)
    draw = options.drawing_of(formats, axes)
    for place in tests:
        cell, number = place.cell, place.number or 0
        run, result = run_again(place.folder, cell, number)
        home = (out or place.folder / AGAIN) / cell
        refuse_links(*([home.parent] if home.parent.name == AGAIN else []), home)
        written = write_run(run, made(home), draw)
        name = NumberedTest(cell, number)
        worse = gate.add(place.said, run)
        told = f"{one_line(run.description)}  worse: {worse}" if worse else one_line(run.description)
        click.echo(f"{run.outcome:<8} {name}  {written}  {told}")
        if not is_same(run, result):
            said = f"{result.outcome} before ({one_line(result.description)})"
            changed = "its driver, RoadGPT or the machine has changed: compare the versions that show prints"
            warn(f"test {name} was {said}; {changed}")
    if gate.remark:
        click.echo(gate.remark)
    gate.close()


def _named(names: Sequence[str], choice: "Choice | None") -> "list[Selection]":
    """Returns the tests that the names refer to; a number refers to a test in the folder that is named
    first."""
    from roadgpt.campaign.record import no_tests
    from roadgpt.campaign.selection import chosen, selection_of

    first = selection_of(names[0])
    if first is None:
        raise no_tests(Path(names[0]))
    if first.number is None and choice is None and len(names) == 1:
        raise UsageError(
            f"say which tests of {first.said}: their numbers, such as 17 or c02/17, or --worst, --faults or "
            "--failures"
        )
    out = [] if first.number is None and choice is None else chosen(first, choice)
    for name in names[1:]:
        place = selection_of(f"{first.folder}/{name}") or selection_of(name)
        if place is None or (place.number is None and choice is None):
            raise UsageError(f"'{one_line(name, 40)}' is not a test; give its number, such as 17 or c02/17")
        out += chosen(place, choice)
    if not out:
        raise UsageError(f"{first.said} has no test for --{choice}")
    return out
