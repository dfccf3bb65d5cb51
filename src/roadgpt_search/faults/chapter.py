"""Makes the section on distinct faults. No simulations are run."""

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from roadgpt.campaign.folder_record import kept_run
from roadgpt.campaign.model import NumberedTest
from roadgpt.campaign.record import Record
from roadgpt.errors import UsageError, command_line
from roadgpt.plural import plural
from roadgpt.report.canvas import FORMATS
from roadgpt.report.chapters import Chapter
from roadgpt.report.chapters.wording import as_sentence, percent, row
from roadgpt.report.page.maps import close_up
from roadgpt.report.page.model import (
    Block,
    Cards,
    Details,
    FigureCard,
    Line,
    Section,
    ShellCommand,
    Table,
    TableCell,
    cell,
    linked,
)
from roadgpt.report.road_record import named
from roadgpt.run import Run
from roadgpt.run.model import permissions
from roadgpt_search.faults.failures import FailureReason, reason_of
from roadgpt_search.faults.fault import DEFINED, GROUPED, Fault, Faults, faults_in
from roadgpt_search.faults.fault_log import TABLE, FailureAnalysis, kept_analysis
from roadgpt_search.faults.remedy import FOLDER

COMPARED = 2000  # failures, evenly spread, that are grouped before they are tested; this takes seconds
SHOWN = 24  # faults with a picture
LISTED = 300  # faults of the table
DRAWN = (
    "Each picture is of a typical failure, with north up: the lighter the way of the car, the faster it was, "
    "and a cross is where it failed."
)


class FaultSummary(NamedTuple):
    """One fault with a typical failure."""

    fault: Fault
    run: Run  # the run of the typical failure
    name: NumberedTest
    looked: FailureAnalysis | None
    """The analysis that ``roadgpt faults`` stored for this fault; None if there is none."""
    why: FailureReason | None  # why the car failed; None if the drive cannot be read

    @property
    def reason(self) -> str:
        """Why the car failed, as a sentence without a full stop."""
        return self.why.sentence if self.why else self.run.description


def fault_summaries(folder: Path, found: Faults) -> list[FaultSummary]:
    """Returns a summary of each fault in a folder; only the first 300 faults are included."""
    summaries = []
    for fault in found.them[:LISTED]:
        looked = kept_analysis(folder, fault)
        name = looked.name if looked else fault.names[0]
        try:
            run = kept_run(folder, *name)
        except UsageError:  # its drive cannot be read
            run = kept_run(folder, *name, has_drive=False)
        reason = looked.reason if looked else reason_of(run) if run.drive is not None else None
        summaries.append(FaultSummary(fault, run, name, looked, reason))
    return summaries


def chapter(record: Record) -> Chapter | None:
    """Returns the chapter on distinct faults, whose sentences tell how many there are and, if ``roadgpt
    faults`` has repeated tests, how many failed again in at least half of the drives; None if no road
    failed."""
    found = faults_in(record.folder, COMPARED)
    if not found.failures:
        return None
    summaries = fault_summaries(record.folder, found)
    said = [as_sentence(found.headline)]
    if measured := [each.looked.stability.is_stable for each in summaries if each.looked]:
        sure = f"{sum(measured)} of {len(measured)} that were driven again"
        what = "faults" if found.distinct else "groups"
        said.append(f"Of the {what}, {sure} fail every second time or oftener.")
    return Chapter(section(record.folder, found, summaries), tuple(said), is_first=True)


def section(folder: Path, found: Faults, summaries: Sequence[FaultSummary]) -> Section:
    """Returns the section on distinct faults: pictures of the most frequent faults, and a table of all
    faults in ``summaries``."""
    if not summaries:
        return Section("Failures of which no road is known", [as_sentence(found.headline)])
    blocks: list[Block] = [f"{DEFINED if found.distinct else GROUPED} {DRAWN}"]
    setups = [each.run.request.setup for each in summaries]
    missing = [each for each in summaries if each.looked is None]
    if missing:
        what = "was not measured" if len(missing) == len(summaries) else f"was not measured of {len(missing)}"
        blocks.append(
            [
                f"How often they fail again {what}: ",
                ShellCommand(command_line("faults", folder, "--minimise", *permissions(setups))),
                " finds which groups are one fault, drives a typical failure of each fault again and again "
                "with friction, start and sensors off a little, and looks for the simplest road that fails "
                "in the same way.",
            ]
        )
    blocks.append(Cards([_card(folder, each, found) for each in summaries[:SHOWN]]))
    blocks.append(_all(folder, found, summaries))
    return Section("Distinct faults" if found.distinct else "Groups of similar failures", blocks)


def _card(folder: Path, summary: FaultSummary, found: Faults) -> FigureCard:
    fault, looked, count = summary.fault, summary.looked, len(summary.fault.members)
    share = f" ({percent(count / found.compared, 0)} of failures)" if found.compared else ""
    title: Line = [
        f"{fault.number} · ",
        TableCell(count, plural(count, "test"), _picture(folder, summary)),
        share,
    ]
    reason = as_sentence(summary.reason)
    lines: list[Line] = [reason]
    if found.is_tested:
        gone = f"Disappears with {fault.removed_by}." if fault.remedy else ""
        lines.append(gone or "A group that belongs to no fault.")
    lines.append(as_sentence(looked.stability.sentence) if looked else "Nobody has driven it again.")
    outside = max((each.outside or 0.0 for each in fault.members), default=0.0)
    metres = max((each.beyond or 0.0 for each in fault.members), default=0.0)
    if outside:
        beyond = f", {metres:.2f} m beyond the marking" if metres else ""
        lines.append(f"Outside its lane at most: {percent(outside, 0)} of the car{beyond}.")
    if looked and looked.simplest:
        lines.append(f"Simplest road that fails in the same way: {looked.simplest}.")
    lines.append([ShellCommand(command_line("view", named(folder, summary.name)))])
    station = summary.why.station if summary.why else fault.typical[0].station
    return FigureCard(title, close_up(summary.run, station, reason), lines)


def _picture(folder: Path, summary: FaultSummary) -> str:
    place = "/".join(part for part in (FOLDER, summary.name.cell, f"{summary.name.number:04d}") if part)
    return next((f"{place}.{kind}" for kind in FORMATS if (folder / f"{place}.{kind}").is_file()), "")


def _all(folder: Path, found: Faults, summaries: Sequence[FaultSummary]) -> Block:
    rows = []
    for each in summaries:
        its = each.looked.stability if each.looked else None
        name = cell(str(each.name), href=_picture(folder, each))
        failed = None if its is None else cell(its.share, f"{its.failed} of {len(its.drives)}")
        removed = each.fault.removed_by or None
        rows.append(row(each.fault.number, len(each.fault.members), name, failed, removed, each.reason))
    what = "fault" if found.distinct else "group"
    heads = [what, "tests", "typical test", "failed again", "disappears with", "why"]
    caption = f"All {len(found.them):,}"
    if len(summaries) < len(found.them):
        caption = f"The first {len(summaries)} of {len(found.them):,}"
    table = Table("faults", caption, heads, rows)
    beside: list[Block] = []
    if (folder / FOLDER / TABLE).is_file():
        beside.append(["As roadgpt faults last wrote them: ", linked(TABLE, f"{FOLDER}/{TABLE}"), "."])
    return Details("All as a table", [table, *beside])
