"""Builds the Run of a test again from what a campaign stores of it; no road is driven."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from roadgpt.campaign.model import Cell, Result
from roadgpt.campaign.numbered_test import NumberedTest
from roadgpt.campaign.single_test import seed_of_driver
from roadgpt.check import inspect
from roadgpt.drive import Drive
from roadgpt.errors import UsageError
from roadgpt.road import Road
from roadgpt.run import Run
from roadgpt.verdict import Verdict, judge


def stored_run(
    cell: Cell, result: Result, road: Road, drive: Drive | None, versions: Mapping[str, str]
) -> Run:
    """Returns the Run of a test.

    Args:
        cell: the test's cell.
        result: the stored result.
        road: the road of the stored design.
        drive: the stored drive; None: the Run has no drive and no verdict.
        versions: the versions of the software with which the campaign was made.
    """
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
    kept: dict[str, Any] = {
        "margin": result.margin,
        "at_s": result.at_s,
        "side": result.side,
        "max_oob": result.max_oob,
    }
    kept |= {"outcome": result.outcome, "beyond": result.beyond}
    return replace(judged, **{name: value for name, value in kept.items() if value is not None})


def no_road(folder: Path, cell: str, result: Result) -> UsageError:
    """Returns the error for a test of a folder that has no road."""
    name = NumberedTest(cell, result.number)
    return UsageError(f"test {name} in {folder} has no road: {result.description}")
