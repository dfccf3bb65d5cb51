"""The failed Runs of a folder, whoever made it."""

from collections.abc import Container, Iterator
from pathlib import Path

from roadgpt.campaign.again import run_again
from roadgpt.campaign.record import STORE, Record
from roadgpt.errors import UsageError
from roadgpt.run import Run, read_run
from roadgpt.run.campaign import finished
from roadgpt.run.card import read_card
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


def drivers_of(folder: Path) -> set[str]:
    """Who drives in a run, a folder of runs or a campaign.

    Raises:
        UsageError: nothing of the kind is there, or a file cannot be read.
    """
    if is_run(folder):
        return {read_run(folder).request.setup.driver}
    if (folder / STORE).is_file() or not finished(folder):
        with Record.opened(folder) as record:
            return {cell.request.setup.driver for cell in record.cells()}
    return {read_card(folder).request.setup.driver}


def failed_runs(folder: Path, cell: str = "", only: Container[int] | None = None) -> Iterator[Run]:
    """Those of one run, of a folder of runs, or of a cell of a campaign, one after another.

    A campaign keeps no whole Runs, so its failures are driven again, which gives the same.

    Args:
        folder: of any of these.
        cell: of a campaign.
        only: numbers of the roads that are wanted; None: all.

    Raises:
        UsageError: a file cannot be read.
    """
    if cell:
        with Record.opened(folder) as record:
            numbers = [result.number for result in record.results(cell, "outcome = 'FAIL'")]
        for number in numbers:
            if only is None or number in only:
                yield run_again(folder, cell, number)[0]
        return
    for each in [folder] if is_run(folder) else [run_folder(folder, index) for index in finished(folder)]:
        run = read_run(each)
        if run.outcome == "FAIL" and (only is None or run.index in only):
            yield run
