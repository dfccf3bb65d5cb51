"""Returns the drive or the Run of one test: either as stored or by driving its road again."""

from dataclasses import replace
from pathlib import Path

from roadgpt.campaign.folder_record import open_record
from roadgpt.campaign.model import Result
from roadgpt.campaign.record import Record
from roadgpt.campaign.stored_run import no_road
from roadgpt.drive import Drive
from roadgpt.errors import UsageError
from roadgpt.run import Run, prove


def read_trace(folder: Path, cell: str, number: int) -> Drive:
    """Returns the stored drive of a test: every column at 50 Hz, positions exact to half a millimetre.

    Raises:
        UsageError: there is no campaign or no such test, or it was not driven.
    """
    with Record.opened(folder) as record:
        record.result(cell, number)
        found = record.drive(cell, number)
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
        raise no_road(folder, cell, result)
    run = prove(kept.road, kept.seed, kept.world, kept.request.setup, number, kept.brief)
    return replace(run, request=kept.request, design=kept.design), result


def is_same(run: Run, result: Result) -> bool:
    """Returns whether a Run has the same outcome and exactly the same margin as a stored Result."""
    return run.outcome == result.outcome and (run.verdict and run.verdict.margin) == result.margin
