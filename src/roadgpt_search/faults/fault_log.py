"""Analyses the faults of a folder, and stores the results. For each fault, a typical failure is driven again
and, on request, its road is simplified.

DIR/faults/
  c01/0017.json    why a failure happened, the result of every disturbed drive, and the simplest road;
                   if this file exists, the fault is not analysed again
  c01/0017.png     the failure, seen from above
  simplest/c01/    a folder of runs: the simplified road of each failure, under the failure's test number
  faults.csv       one line per fault; the fault with the most failures comes first. If no fault is known
                   (``removed_by`` is empty), one line per group of similar failures
  remedies/        which small changes remove a failure (see ``remedy``)
  failures.csv     one line per failure, with the fault that it belongs to, if any

For a folder of runs, the level c01/ is left out."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from roadgpt.campaign.folder_record import kept_run
from roadgpt.campaign.model import NumberedTest
from roadgpt.reading import strictly
from roadgpt.run import Run, write_run
from roadgpt.run.atomic import csv_text, json_text, write_whole
from roadgpt.run.folder import is_run, run_folder
from roadgpt_search.faults.failures import FailureReason, reason_of
from roadgpt_search.faults.fault import Fault, Faults
from roadgpt_search.faults.minimise import simplest
from roadgpt_search.faults.remedy import FOLDER, made_folder, page_of, stored
from roadgpt_search.faults.stability import Repeated, Stability, repeated

SIMPLEST = "simplest"
TABLE, FAILURES = "faults.csv", "failures.csv"
HEAD = (
    "fault", "failures", "test", "failed_again", "drives", "share", "way", "side", "radius_m",
    "entered_kmh", "needed_g", "grade", "station_m", "reason", "simplest", "removed_by",
)  # fmt: skip
HEAD_OF_FAILURES = ("test", "fault", "way", "side", "radius_m", "station_m", "max_oob", "beyond_m")


@dataclass(frozen=True)
class FailureAnalysis:
    """The analysis of one failure."""

    name: NumberedTest
    reason: FailureReason
    stability: Stability
    simplest: str = ""
    """A sentence about the simplest road that reproduces the failure; empty if none was requested."""


def analyse(
    folder: Path, times: int, minimise: bool, formats: Sequence[str],
    fault: tuple[int, Sequence[NumberedTest]],
) -> tuple[int, FailureAnalysis]:  # fmt: skip
    """Returns the number of a fault, of which typical failures are given, and the analysis of the first that
    recurs in at least half of ``times`` disturbed drives, or else of the one that recurs most often; with
    ``minimise`` also the simplest road for it. A stored analysis with as many drives is read instead. Its
    pictures are drawn in the ``formats``."""
    best: FailureAnalysis | None = None
    for name in fault[1]:
        found = _repeated(folder, name, times, formats)
        if best is None or found.stability.share > best.stability.share:
            best = found
        if best.stability.is_stable:
            break
    assert best is not None, "every fault has a failure"
    return fault[0], _least(folder, best) if minimise else best


def _repeated(folder: Path, name: NumberedTest, times: int, formats: Sequence[str]) -> FailureAnalysis:
    """Returns the analysis of one failure; drives and draws the failure unless that was done before."""
    run, path = kept_run(folder, *name), page_of(folder / FOLDER, name)
    there = _read(path, run, name, times)
    found = there or FailureAnalysis(name, reason_of(run), repeated(run, times))
    made_folder(path.parent)
    for picture in (path.with_suffix(f".{kind}") for kind in formats):
        if there is None or not picture.is_file():
            from roadgpt.report.birds_eye import draw_place

            said = f"{found.reason.sentence}; {found.stability.sentence}"
            draw_place(run, found.reason.station, said, picture)
    if there is None:
        _write(path, run, found)
    return found


def _least(folder: Path, found: FailureAnalysis) -> FailureAnalysis:
    """Returns the analysis with its simplest road; searches for this road unless it is stored already."""
    place = run_folder(folder / FOLDER / SIMPLEST / found.name.cell, found.name.number)
    if found.simplest and is_run(place):
        return found
    run = kept_run(folder, *found.name)
    if run.plain_design is None:
        return found
    least = simplest(run)
    write_run(least.run, made_folder(place.parent.parent))
    found = replace(found, simplest=least.sentence)
    _write(page_of(folder / FOLDER, found.name), run, found)
    return found


def kept_analysis(folder: Path, fault: Fault) -> FailureAnalysis | None:
    """Returns the stored analysis of a fault; None if nothing is stored. If several failures were analysed,
    returns the analysis that ``analyse`` would choose. Raises UsageError if a file cannot be read."""
    pages = [name for name in fault.names if page_of(folder / FOLDER, name).is_file()]
    runs = [(name, kept_run(folder, *name, has_drive=False)) for name in pages]
    found = [its for name, run in runs if (its := _read(page_of(folder / FOLDER, name), run, name))]
    # of equal ones max returns the first, which is the most typical
    return max(found, key=lambda its: its.stability.is_stable or its.stability.share, default=None)


def write_tables(found: Faults, looked: Mapping[int, FailureAnalysis], folder: Path) -> Path:
    """Writes ``faults.csv``, whose path is returned, and ``failures.csv``; ``looked`` has the analysis of
    each fault by its number."""
    place = made_folder(folder / FOLDER)
    every = (*found.them, *found.alone)
    members = [(each, fault.number or "") for fault in every for each in fault.members]
    of_failures = [
        [
            str(each.name), number, each.manner.way, each.manner.side or "", _decimal(each.manner.radius, 1),
            f"{each.station:.1f}", _decimal(each.outside, 3), _decimal(each.beyond, 3),
        ]
        for each, number in sorted(members, key=lambda pair: pair[0].name)
    ]  # fmt: skip
    write_whole(place / FAILURES, csv_text(HEAD_OF_FAILURES, of_failures))
    write_whole(place / TABLE, csv_text(HEAD, [_line(each, looked[each.number]) for each in found.them]))
    return place / TABLE


def _line(fault: Fault, looked: FailureAnalysis) -> list[Any]:
    its, reason = looked.stability, looked.reason
    return [
        fault.number, len(fault.members), str(looked.name), its.failed, len(its.drives), f"{its.share:.3f}",
        reason.way, reason.side or "", _decimal(reason.radius, 1), f"{reason.entered * 3.6:.1f}",
        f"{reason.needed:.3f}", f"{reason.grade:.3f}", f"{reason.station:.1f}", reason.sentence,
        looked.simplest, fault.remedy or "",
    ]  # fmt: skip


def _decimal(value: float | None, digits: int) -> str:
    return "" if value is None else f"{value:.{digits}f}"


def _write(path: Path, run: Run, found: FailureAnalysis) -> None:
    page = {
        "test": str(found.name),
        "seed": run.seed,
        "description": run.description,
        "why": asdict(found.reason),
        "stability": found.stability.sentence,
        "drives": [asdict(drive) for drive in found.stability.drives],
        "simplest": found.simplest,
    }
    write_whole(path, json_text(page))


def _read(path: Path, run: Run, name: NumberedTest, times: int | None = None) -> FailureAnalysis | None:
    """Returns the stored analysis if it belongs to this Run and, where ``times`` is given, has that many
    drives; otherwise None."""

    def analysis_in(data: Any) -> FailureAnalysis | None:
        if (data["seed"], data["description"]) != (run.seed, run.description):
            return None
        drives = strictly(tuple[Repeated, ...], data["drives"])
        if not drives or len(drives) != (times or len(drives)):
            return None
        reason = strictly(FailureReason, data["why"])
        return FailureAnalysis(name, reason, Stability(drives), str(data.get("simplest", "")))

    return stored(path, analysis_in)
