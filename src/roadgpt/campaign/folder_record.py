"""Opens tests for reading: those of a campaign, of a folder of runs, or of a single run."""

import json
import sqlite3
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from roadgpt.campaign.folder_store import FolderStore
from roadgpt.campaign.model import Cell, NumberedTest, Result
from roadgpt.campaign.record import STORE, Record, no_tests
from roadgpt.campaign.run_folder import RunFolder, finished_run
from roadgpt.errors import UsageError
from roadgpt.road import Road
from roadgpt.run import Request, Run, Setup, read_run
from roadgpt.run.atomic import is_locked
from roadgpt.run.card import CARD, read_card
from roadgpt.run.folder import RUNS, finished, is_run, run_folder
from roadgpt.run.sbft_json import test_name


def is_store(folder: Path) -> bool:
    """Returns whether a folder holds a campaign with a store; False for a folder of runs."""
    return (folder / STORE).is_file()


def has_tests(folder: Path) -> bool:
    """Returns whether a folder holds a campaign or runs; False for the folder of a single run."""
    return is_store(folder) or ((folder / RUNS).is_dir() and not is_run(folder))


def open_record(folder: Path) -> Record:
    """Opens the tests of a campaign, of a folder of runs, or of a single run.

    Raises:
        UsageError: the folder holds none of these, or it cannot be read.
    """
    if is_store(folder):
        return Record.opened(folder)
    if not has_tests(folder) and not is_run(folder):
        raise no_tests(folder)
    return FolderRecord(folder)


def setups_of(folder: Path) -> list[Setup]:
    """Returns the Setup of each cell of a campaign, a folder of runs or a run; see ``open_record``."""
    with open_record(folder) as record:
        return [cell.request.setup for cell in record.cells()]


class FolderRecord(FolderStore, Record):
    """The tests in a folder of runs, open for reading.

    All Runs are read when the tables are first queried; if one of them cannot be read, that query fails.
    """

    has_run = "1"

    def __init__(self, folder: Path) -> None:
        """Opens a folder of runs, or the folder of one Run.

        Raises:
            UsageError: ``campaign.json`` is damaged, or it is missing and the first Run cannot be read.
        """
        self._is_entered = False
        if is_run(folder):
            self._places = {read_run(folder).index: folder}
        else:
            self._places = {number: run_folder(folder, number) for number in finished(folder)}
        card = read_card(folder) if (folder / CARD).is_file() else None
        first = next(iter(self._places.values()), None)
        brief, request, versions = None, card and card.request, card and card.versions
        if first is not None:
            try:
                run = read_run(first)
                brief, request, versions = run.brief, request or run.request, versions or run.versions
            except UsageError:
                if request is None:
                    raise
        roads = card.roads if card else max(len(self._places), 1)
        runs = RunFolder(folder, request or Request(), brief, roads)
        super().__init__(folder, {}, [runs.cell("")])
        self._db.execute("INSERT INTO meta VALUES ('versions', ?)", (json.dumps({**(versions or {})}),))
        if card is None or card.is_finished:
            self.finish()

    def _execute(self, sql: str, values: Sequence[Any]) -> sqlite3.Cursor:
        if not self._is_entered:
            self._is_entered = True
            ended = {number: finished_run(self.run("", number)) for number in self._places}
            self._enter("", ended)
            self._db.execute("UPDATE tests SET ended = NULL")  # the files do not record when a test ended
            now, took = time.time(), sum(one.seconds.total for one in ended.values())
            is_over = not is_locked(self.folder)
            self._db.execute("INSERT INTO sittings VALUES (?, ?, 1, ?, 0, 0)", (now - took, now, is_over))
        return super()._execute(sql, values)

    def total(self) -> int | None:
        """Returns the number of roads requested; without ``campaign.json``, the number of runs."""
        return self.cell("").budget.tests

    def tests(self, cell: str = "", which: str | None = None) -> list[NumberedTest]:
        """Returns the names of tests that have ended; see ``Record.tests``."""
        if which is not None:
            return super().tests(cell, which)
        return [NumberedTest("", number) for number in self._places]

    def check_ended(self, cell: str, number: int) -> None:
        """Raises UsageError if the folder has no finished run of this number."""
        del cell
        if number not in self._places:
            there = [*self._places]
            its = f"its runs are {there[0]} to {there[-1]}" if there else "it has no runs yet"
            raise UsageError(f"there is no run {number} in {self.folder}; {its}")

    def run(self, cell: str, number: int, has_drive: bool = True) -> Run:
        """Returns the Run of a test, always with its drive; raises UsageError if it cannot be read."""
        self.check_ended(cell, number)
        return read_run(self._places[number])

    def result(self, cell: str, number: int) -> Result:
        """Returns the result of one test; raises UsageError if its Run cannot be read."""
        return finished_run(self.run(cell, number)).result

    def road(self, cell: Cell, result: Result) -> Road | None:
        """Returns the road of a test that has ended; None if the test has no road."""
        return self.run(cell.name, result.number).road

    def seed(self, result: Result) -> int:
        """Returns the driver's seed in a test."""
        return result.proposal.seed

    def file(self, number: int) -> str:
        """Returns the path of a test's ``test.NNNN.json``."""
        return str(self.folder / test_name(number))
