"""The failed Runs of a folder, whoever made it."""

from collections.abc import Iterator
from pathlib import Path

from roadgpt.campaign.again import run_again
from roadgpt.campaign.record import STORE, Record
from roadgpt.errors import UsageError
from roadgpt.run import Run, read_run
from roadgpt.run.campaign import finished
from roadgpt.run.folder import is_run, run_folder


def cells_of(folder: Path) -> list[str]:
    """Names of the cells of a campaign; one without a name for what ``roadgpt run`` made.

    Raises:
        UsageError: nothing of the kind is there, or a file cannot be read.
    """
    if (folder / STORE).is_file():
        with Record.opened(folder) as record:
            return [cell.name for cell in record.cells()]
    if is_run(folder) or finished(folder):
        return [""]
    raise UsageError(f"there are no roads in {folder}; give the folder of a run or of a campaign")


def failed_runs(folder: Path, cell: str = "") -> Iterator[Run]:
    """Those of one run, of a folder of runs, or of a cell of a campaign, one after another.

    A campaign keeps no whole Runs, so its failures are driven again, which gives the same.

    Raises:
        UsageError: a file cannot be read.
    """
    if cell:
        with Record.opened(folder) as record:
            numbers = [result.number for result in record.results(cell, "outcome = 'FAIL'")]
        for number in numbers:
            yield run_again(folder, cell, number)[0]
        return
    for each in [folder] if is_run(folder) else [run_folder(folder, index) for index in finished(folder)]:
        run = read_run(each)
        if run.outcome == "FAIL":
            yield run
