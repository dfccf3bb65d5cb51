"""Returns the drive or the Run of one test: either as stored or by driving its road again."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from roadgpt.campaign.folder_record import open_record
from roadgpt.campaign.model import Cell, Result
from roadgpt.campaign.numbered_test import NumberedTest
from roadgpt.campaign.record import Record
from roadgpt.campaign.single_test import seed_of_driver
from roadgpt.campaign.store_check import reading_store
from roadgpt.campaign.traces import TRACES, read_traces
from roadgpt.check import inspect
from roadgpt.drive import Drive
from roadgpt.errors import UsageError
from roadgpt.reading import json_of
from roadgpt.road import Road
from roadgpt.run import Run, prove
from roadgpt.verdict import Verdict, judge


def read_trace(folder: Path, cell: str, number: int) -> Drive:
    """Returns the stored drive of a test: every column at 50 Hz, positions exact to half a millimetre.

    Raises:
        UsageError: there is no campaign or no such test, or it was not driven.
    """
    with Record.opened(folder) as record:
        record.result(cell, number)
        found = _kept_drive(record, cell, number)
    if found is None:
        raise UsageError(f"test {number} of {cell} in {folder} was not driven")
    return found


def kept_run(folder: Path, cell: str, number: int, has_drive: bool = True) -> Run:
    """Returns the stored Run of a test; no road is driven, and no driver's file is loaded.

    The road is built from the stored design. The drive is the stored one, with positions exact to half a
    millimetre; outcome, margin and the place of a failure are those recorded in the campaign.

    Args:
        folder: the campaign's folder.
        cell: name of the test's cell; empty for a run in a folder of runs, or if the folder itself is a run.
        number: number of the test.
        has_drive: whether to include drive and verdict; a run from a folder of runs always includes them.

    Raises:
        UsageError: there is no campaign or no such test, it has no road, or its drive cannot be read.
    """
    with open_record(folder) as record:
        return record.run(cell, number, has_drive)


def kept_in(record: Record, cell: Cell, result: Result, has_drive: bool = True) -> Run:
    """Returns the Run of a test whose result was read from an open Record; see ``kept_run``."""
    request, brief = cell.request, cell.brief
    road = record.road(cell, result)
    if road is None:
        raise _no_road(record.folder, cell.name, result)
    drive = _kept_drive(record, cell.name, result.number) if has_drive else None
    is_invalid = result.outcome == "INVALID"
    with reading_store(record.path):
        versions = {str(name): str(number) for name, number in json_of(record.meta("versions")).items()}
    return Run(
        request,
        result.number,
        seed_of_driver(result.number, result.proposal),
        outcome=result.outcome,
        description=result.description,
        brief=brief,
        design=result.design,
        road=road,
        findings=inspect(road, brief, request.world, request.setup.rules) if is_invalid else (),
        drive=drive,
        verdict=None if drive is None else _verdict_of(road, drive, cell, result),
        versions=versions,
    )


def _verdict_of(road: Road, drive: Drive, cell: Cell, result: Result) -> Verdict | None:
    """Judges the stored drive, and then replaces values of the verdict by those that the campaign stored,
    because the drive's rounded positions may give others. Returns None if the test was not judged."""
    if result.outcome not in ("PASS", "FAIL") or result.margin is None:
        return None
    step = len(drive) - 1
    if result.at_s is not None and result.cause in ("out of lane", "fell"):
        step = int(np.argmin(np.abs(drive["s"] - result.at_s)))
    judged = judge(road, drive, cell.request.world, (step, result.cause))
    kept: dict[str, Any] = {
        "margin": result.margin,
        "at_s": result.at_s,
        "side": result.side,
        "max_oob": result.max_oob,
    }
    kept |= {"outcome": result.outcome, "beyond": result.beyond}
    return replace(judged, **{name: value for name, value in kept.items() if value is not None})


def _no_road(folder: Path, cell: str, result: Result) -> UsageError:
    name = NumberedTest(cell, result.number)
    return UsageError(f"test {name} in {folder} has no road: {result.description}")


def _kept_drive(record: Record, cell: str, number: int) -> Drive | None:
    name = record.trace_file(cell, number)
    return None if name is None else read_traces(record.folder / TRACES / name, cell, number)


def run_again(folder: Path, cell: str, number: int) -> tuple[Run, Result]:
    """Checks and drives the road of a test again; returns the new Run and the stored Result.

    The same design, seed and setup give the same Run, bit for bit, on one machine.

    Args:
        folder: the folder of a campaign or of runs.
        cell: name of the test's cell; empty for a run in a folder of runs.
        number: number of the test.

    Raises:
        UsageError: there is no such test, or it has no road.
    """
    with open_record(folder) as record:
        result, kept = record.result(cell, number), record.run(cell, number, has_drive=False)
    if kept.road is None:
        raise _no_road(folder, cell, result)
    run = prove(kept.road, kept.seed, kept.world, kept.request.setup, number, kept.brief)
    return replace(run, request=kept.request, design=kept.design), result


def is_same(run: Run, result: Result) -> bool:
    """Returns whether a Run has the same outcome and exactly the same margin as a stored Result."""
    return run.outcome == result.outcome and (run.verdict and run.verdict.margin) == result.margin
