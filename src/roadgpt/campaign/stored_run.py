"""Builds the Run of a test again from what a campaign stores of it; no road is driven."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from roadgpt.campaign.model import Cell, NumberedTest, Result
from roadgpt.campaign.single_test import OF_VERDICT, seed_of_driver
from roadgpt.check import inspect
from roadgpt.drive import Drive
from roadgpt.errors import UsageError
from roadgpt.road import Road
from roadgpt.run import Run
from roadgpt.verdict import Verdict, judge


def stored_run(
    cell: Cell, result: Result, road: Road, drive: Drive | None, versions: Mapping[str, str]
) -> Run:
    """Returns the Run of a test from its stored result, the road of its design, and its stored drive. Without
    a drive, the Run has no verdict; ``versions`` are those of the software that made the campaign."""
    request, brief = cell.request, cell.brief
    is_invalid = result.outcome == "INVALID"
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
    kept = {name: getattr(result, name) for name in ("outcome", *OF_VERDICT)}
    return replace(judged, **{name: value for name, value in kept.items() if value is not None})


def no_road(folder: Path, cell: str, result: Result) -> UsageError:
    """Returns the error for a test of a folder that has no road."""
    name = NumberedTest(cell, result.number)
    return UsageError(f"test {name} in {folder} has no road: {result.description}")
