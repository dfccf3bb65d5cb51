"""``roadgpt faults``: groups failures into distinct faults, and finds why each occurs."""

import os
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import click

from roadgpt.cli import options
from roadgpt.cli.option import Argument, Heading, Option
from roadgpt.cli.option_groups import GroupedCommand
from roadgpt.cli.option_types import folder, whole
from roadgpt.cli.progress import progress, watched
from roadgpt.cli.streams import resumable
from roadgpt.errors import command_line

if TYPE_CHECKING:
    from roadgpt.campaign.faults.fault import Faults
    from roadgpt.campaign.faults.fault_log import FailureAnalysis, FailureDrawing
    from roadgpt.campaign.model import NumberedTest

REPEAT = 10  # disturbed drives of each fault, unless the user gives another number
DRIVES = whole(1, 1000, "drives")

MINIMISE = "For each fault, also find the simplest road on which it still occurs"
DISTURB = "Number of further drives for each fault, with small disturbances"
GROUPS = (
    "Analyse each group of similar failures on its own, without finding out which groups are one fault. This "
    "saves up to 16 drives for each failure that is tried."
)
_failures = partial(Option, heading=Heading.FAILURES)
FAULT_OPTIONS = (
    _failures("--faults", "At the end, analyse the failures as 'roadgpt faults' does.", bool),
    _failures("--minimise", f"{MINIMISE}; implies --faults.", bool),
    _failures("--repeat", f"{DISTURB}; implies --faults. [default: {REPEAT}]", DRIVES),
    _failures("--groups", f"{GROUPS} Implies --faults.", bool),
)


class AnalysisOptions(NamedTuple):
    """Values of the options with which ``roadgpt faults`` analyses failures."""

    repeat: int = REPEAT
    minimise: bool = False
    workers: int = 1
    formats: tuple[str, ...] = ("png",)
    """Formats of the pictures; empty: no pictures are drawn."""
    is_quiet: bool = False
    groups: bool = False
    """Whether to analyse each group of failures without first finding out which groups are one fault."""
    top: int | None = None
    """Number of failures that are written into a folder for a paper."""
    is_apart: bool = False
    """Whether text is printed on standard error, because standard output is reserved for JSON."""

    def say(self, text: str, is_news: bool = False) -> None:
        """Prints a text unless ``is_quiet``; progress messages (``is_news``) go to standard error."""
        if not self.is_quiet:
            click.echo(text, err=is_news or self.is_apart)


def analysis_options(given: dict[str, Any]) -> AnalysisOptions | None:
    """Returns the options for the analysis of a campaign's failures; None if the user requested no
    analysis.
    """
    if not any(given[name] for name in ("faults", "minimise", "repeat", "groups")):
        return None
    # the campaign's workers may be on other machines
    here = min(given["workers"], os.cpu_count() or 1)
    return AnalysisOptions(
        repeat=given["repeat"] or REPEAT,
        minimise=given["minimise"],
        workers=here,
        is_quiet=given["quiet"],
        groups=given["groups"],
        is_apart=given["as_json"],
    )


def analyse_failures(place: Path, look: AnalysisOptions) -> None:
    """Finds and prints the distinct faults of a folder of runs or a campaign, with an analysis of each.

    Raises:
        UsageError: There are no roads, a file cannot be read, or the driver or something else that decides
            drives has changed since the failures.
        RoadGPTError: A file cannot be written.
    """
    from roadgpt.campaign.faults.fault import faults_in
    from roadgpt.campaign.faults.fault_log import FAILURES, instructive, write_tables, write_top
    from roadgpt.campaign.faults.remedy import FOLDER
    from roadgpt.campaign.folder_record import open_record, setups_of
    from roadgpt.cli.repeat_commands import typed_words
    from roadgpt.run.model import permissions
    from roadgpt.run.versions import versions_now

    found = faults_in(place)
    if not found.failures:
        look.say("no road failed, so there is no fault to analyse")
        return
    with open_record(place) as record:
        asked = ((cell.request, cell.generator) for cell in record.cells())
        record.refuse_changed(versions_now(asked))  # the user is asked for permission here, not in workers
    go_on = command_line("faults", place, *permissions(setups_of(place)), *typed_words(OPTIONS))
    with resumable(f"finished work is kept; continue with: {go_on}"):
        found = _tested(place, found, look)
        look.say(f"{found.sentence}; analysing a typical failure of each", is_news=True)
        looked = _analysed(place, [(each.number, each.names) for each in found.them], look)
        top = instructive(found.them, looked, look.top or 0)
        tops = _analysed(place, [(at, (name,)) for at, (_, name) in enumerate(top)], look)
    table = write_tables(found, looked, place)
    look.say("\n".join(_summary(place, found, looked)))
    look.say(f"tables: {table} and {table.with_name(FAILURES)}")
    if look.formats:
        cells = sorted({fault.typical[0].name.cell for fault in found.them})
        drawn = (f"{place / FOLDER / cell}/*.{kind}" for cell in cells for kind in look.formats)
        look.say(f"pictures: {', '.join(drawn)}")
    if top:
        from roadgpt.report.birds_eye import draw_fault

        folder = write_top(place, [(fault, tops[at]) for at, (fault, _) in enumerate(top)], draw_fault)
        look.say(f"the {len(top)} most instructive failures, for a paper: {folder}")


def _tested(place: Path, found: "Faults", look: AnalysisOptions) -> "Faults":
    """Tries small changes on failures of all groups until it is known which groups are one fault; returns
    the faults.
    """
    from roadgpt.campaign.faults.fault import faults_in
    from roadgpt.campaign.faults.remedy import try_remedies
    from roadgpt.campaign.unordered_map import unordered_map
    from roadgpt.campaign.workers.worker_log import LOG

    done, rounds = 0, 0
    with progress("failures", None, look.is_quiet) as tell:
        while found.to_test and not look.groups:
            rounds, total, later = rounds + 1, done + found.to_come, found.to_come - len(found.to_test)
            more = f", about {later:,} more in later rounds" * (later > 0)
            what = f"trying small changes on {len(found.to_test):,} of them{more}"
            look.say(f"{found.sentence}; round {rounds}: {what}", is_news=True)
            for _ in unordered_map(partial(try_remedies, place), found.to_test, look.workers, place / LOG):
                done += 1
                tell(done, total=total)
            found = faults_in(place)
    return found


def _analysed(
    place: Path, what: "Sequence[tuple[int, Sequence[NumberedTest]]]", look: AnalysisOptions
) -> "dict[int, FailureAnalysis]":
    """Analyses one of the named failures under each number; returns the analyses by number."""
    from roadgpt.campaign.faults.fault_log import AnalysisTask, analyse
    from roadgpt.campaign.unordered_map import unordered_map
    from roadgpt.campaign.workers.worker_log import LOG

    draw: FailureDrawing | None = None
    if look.formats:
        from roadgpt.report.birds_eye import draw_fault as draw
    tasks = [
        AnalysisTask(place, number, tuple(names), look.repeat, look.minimise, draw, look.formats)
        for number, names in what
    ]
    steps = unordered_map(analyse, tasks, look.workers, place / LOG)
    return dict(watched(steps, len(tasks), "faults", look.is_quiet))


def _summary(place: Path, found: "Faults", looked: "Mapping[int, FailureAnalysis]") -> Iterator[str]:
    """Yields two rows for each fault: its failures, how often it fails again, why a typical test failed, and
    the small change with which the failures disappear.
    """
    from roadgpt.plural import plural
    from roadgpt.run.folder import is_run

    wide = max([len("test"), *(len(str(its.name)) for its in looked.values())])
    yield f"{'fault':>5} {'failures':>8} {'again':>7}  {'test':<{wide}}  why"
    for fault in found.them:
        its = looked[fault.number]
        again = f"{its.stability.failed}/{len(its.stability.drives)}"
        name = f"{its.name!s:<{wide}}"
        yield f"{fault.number:>5} {len(fault.members):>8,} {again:>7}  {name}  {its.reason.sentence}"
        alone = "it belongs to no fault" if found.is_tested else "no small changes were tried"
        removed = f"disappears with {fault.removed_by}" if fault.remedy else f"a group; {alone}"
        yield f"{'':>{wide + 26}}{removed}"
        if its.simplest:
            yield f"{'':>{wide + 26}}simplest: {its.simplest}"
    stable = sum(its.stability.is_stable for its in looked.values())
    yield found.headline
    what = plural(len(found.them), "fault" if found.distinct else "group")
    yield f"{stable:,} of {what} fail again in at least half of the drives"
    if looked:
        one = place if is_run(place) else f"{place}/{looked[1].name}"
        yield f"look at one: {command_line('view', one)}"


# fmt: off
OPTIONS = (
    Option("--repeat", f"{DISTURB}.", DRIVES, REPEAT),
    Option("--minimise", f"{MINIMISE}.", bool),
    Option("--groups", GROUPS, bool),
    Option("--top", "Also write the N most instructive failures into a folder for a paper: different faults "
           "first, then different places.", whole(1, 100, "failures")),
    Option("-j workers", "Number of failures analysed in parallel.", whole(1, 256, "processes"), 1),
    *(options.DRIVER_AGAIN, *options.BEAMNG, options.FORMAT, options.NO_PLOT, options.QUIET),
)
# fmt: on


@click.command(cls=GroupedCommand, params=[Argument("place", "DIR", kind=folder), *OPTIONS])
def command(
    place: Path,
    repeat: int,
    minimise: bool,
    groups: bool,
    top: int | None,
    workers: int,
    driver: tuple[str, ...],
    quiet: bool,
    **rest: Any,
) -> None:
    """Group the failures of a folder of runs or a campaign into distinct faults, and find why each occurs.

    Failures form a group if the 60 m of road around the lane departures are alike. Some failures of each
    group are driven with small changes, such as a 15 % larger radius of the bend. If the failures of several
    groups disappear with the same change, these groups are one fault. Further failures of the fault are then
    driven with this change; a failure that still occurs with it no longer counts as part of the fault. The
    most typical failure of each fault is driven again several times with slightly varied friction, start
    position and perception delay; the share of drives that fail again is reported. DIR/faults gets a
    picture and a sentence for each fault, faults.csv with a line per fault, and failures.csv with a line per
    failure.
    Finished work is not repeated, so Ctrl-C loses nothing.

    \b
    roadgpt faults roadgpt-runs/hairpins-7
    roadgpt faults roadgpt-runs/hairpins-7 --repeat 30 --minimise -j 2
    """
    from roadgpt.campaign.folder_record import setups_of
    from roadgpt.drive.permission import check_named_drivers

    check_named_drivers(driver, {setup.driver for setup in setups_of(place)}, place)
    formats = options.pictures_of(rest)
    analyse_failures(place, AnalysisOptions(repeat, minimise, workers, formats, quiet, groups, top))
