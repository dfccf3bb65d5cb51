"""Analyses the failures of a folder for commands: finds the faults, prints what is found, and sums it up."""

import os
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import click

from roadgpt import plugins
from roadgpt.campaign.executors.processes import unordered_map
from roadgpt.campaign.folder_record import open_record, setups_of
from roadgpt.campaign.model import NumberedTest
from roadgpt.campaign.status import Status
from roadgpt.campaign.workers import LOG
from roadgpt.cli.options import Remarks
from roadgpt.cli.repeat_commands import typed_words
from roadgpt.cli.streams import progress, resumable, watched
from roadgpt.errors import command_line
from roadgpt.plural import plural
from roadgpt.run.folder import is_run
from roadgpt.run.model import permissions
from roadgpt.run.versions import versions_now
from roadgpt_search.faults.fault import Faults, faults_in
from roadgpt_search.faults.fault_log import FAILURES, FailureAnalysis, analyse, kept_analysis, write_tables
from roadgpt_search.faults.remedy import FOLDER, stored_remedies, try_remedies

COMPARED = 500  # largest number of failures, evenly spread, that are grouped (if untested): under a second


def chosen(folder: Path, cell: str) -> list[NumberedTest]:
    """Returns a typical test of each fault in a folder or in one of its cells."""
    found = faults_in(folder, cell=cell)
    looked = [(fault, kept_analysis(folder, fault)) for fault in found.them]
    return [its.name if its else fault.names[0] for fault, its in looked]


def told(status: Status) -> Remarks:
    """Returns what a summary tells of the faults of a campaign. Before ``roadgpt faults`` has tried small
    changes, it tells of groups of similar failures among at most ``COMPARED`` failures."""
    if not {"PASS", "FAIL"} & status.outcomes.keys():
        return Remarks(fields={"distinct": None})
    found = faults_in(Path(status.folder), COMPARED)
    counts = {
        "faults": found.distinct if found.is_tested else None,
        "groups": len(found.alone) or len(found.them) - found.distinct,
        "failures": found.failures,
        "compared": found.compared,
    }
    first = "" if found.is_tested else "how many faults these are, "
    look = command_line("faults", status.folder, *permissions(setups_of(Path(status.folder))))
    advice = f"{first}why, how often again, and pictures: {look}" if found.them else ""
    return Remarks(found.headline if found.failures else "", advice, {"distinct": counts})


def at_end(folder: Path, given: Mapping[str, Any]) -> None:
    """Analyses the failures of a folder whose tests have ended, if an option asks for it."""
    command = plugins.find("commands", "faults")
    if any(given[option.field] for option in command.at_end):
        usual = next(option.default for option in command.params if option.name == "repeat")
        here = min(given["workers"], os.cpu_count() or 1)  # the campaign's workers may be on other machines
        asked = given["repeat"] or usual, given["minimise"], here, given["quiet"], given["groups"]
        analyse_failures(folder, *asked, is_apart=given["as_json"])


def analyse_failures(
    place: Path, repeat: int, minimise: bool, workers: int, quiet: bool, groups: bool,
    formats: tuple[str, ...] = ("png",), is_apart: bool = False,
) -> None:  # fmt: skip
    """Finds and prints the distinct faults of a folder of runs or a campaign, with an analysis of each, and
    draws pictures in the ``formats``. ``is_apart``: standard output is reserved for JSON."""

    def say(text: str, is_news: bool = False) -> None:
        if not quiet:
            click.echo(text, err=is_news or is_apart)

    found = faults_in(place)
    if not found.failures:
        say("no road failed, so there is no fault to analyse")
        return
    with open_record(place) as record:
        asked = ((cell.request, cell.generator) for cell in record.cells())
        record.refuse_changed(versions_now(asked))  # the user is asked for permission here, not in workers
    typed = typed_words(plugins.find("commands", "faults"))
    go_on = command_line("faults", place, *permissions(setups_of(place)), *typed)
    with resumable(f"finished work is kept; continue with: {go_on}"):
        found = found if groups else _tested(place, found, workers, quiet, say)
        say(f"{found.sentence}; analysing a typical failure of each", is_news=True)
        look = partial(analyse, place, repeat, minimise, formats)
        steps = unordered_map(look, [(each.number, each.names) for each in found.them], workers, place / LOG)
        looked = dict(watched(steps, len(found.them), "faults", quiet))
    table = write_tables(found, looked, place)
    say("\n".join(_summary(place, found, looked)))
    every = [each for fault in (*found.them, *found.alone) for each in fault.members]
    tried = [removed for each in every if (removed := stored_remedies(place, each)) is not None]
    if fixed := sum({*removed.values()} == {None} for removed in tried):
        say(
            f"no small change could be tried on {fixed:,} of {len(tried):,} failures: their roads have lanes "
            "of their own and no design, as routes through a map do"
        )
    if minimise and (left := sum(not its.simplest for its in looked.values())):
        what = plural(left, "failure")
        say(f"no simplest road of {what}: only a design without junctions can be simplified")
    say(f"tables: {table} and {table.with_name(FAILURES)}")
    if formats:
        cells = sorted({fault.typical[0].name.cell for fault in found.them})
        drawn = (f"{place / FOLDER / cell}/*.{kind}" for cell in cells for kind in formats)
        say(f"pictures: {', '.join(drawn)}")


def _tested(
    place: Path, found: Faults, workers: int, quiet: bool, say: Callable[[str, bool], None]
) -> Faults:
    """Tries small changes on failures of all groups until it is known which groups are one fault; returns
    the faults."""
    done, rounds = 0, 0
    with progress("failures", None, quiet) as tell:
        while found.to_test:
            rounds, total, later = rounds + 1, done + found.to_come, found.to_come - len(found.to_test)
            more = f", about {later:,} more in later rounds" * (later > 0)
            what = f"trying small changes on {len(found.to_test):,} of them{more}"
            say(f"{found.sentence}; round {rounds}: {what}", True)
            for _ in unordered_map(partial(try_remedies, place), found.to_test, workers, place / LOG):
                done += 1
                tell(done, total=total)
            found = faults_in(place)
    return found


def _summary(place: Path, found: Faults, looked: Mapping[int, FailureAnalysis]) -> Iterator[str]:
    """Yields two rows for each fault: its failures, how often it fails again, why a typical test failed, and
    the small change with which the failures disappear."""
    wide = max([len("test"), *(len(str(its.name)) for its in looked.values())])
    line = f"{{:>5}} {{:>8}} {{:>7}}  {{:<{wide}}}  {{}}".format
    yield line("fault", "failures", "again", "test", "why")
    for fault in found.them:
        its = looked[fault.number]
        again = f"{its.stability.failed}/{len(its.stability.drives)}"
        yield line(fault.number, f"{len(fault.members):,}", again, str(its.name), its.reason.sentence)
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
