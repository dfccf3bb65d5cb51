"""Opens the tests of a folder, whatever wrote them; returns the drive or the Run of one of them, either as
stored or by driving its road again."""

import json
import sqlite3
import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

from roadgpt.campaign.model import GIVEN, Cell, CellBudget, NumberedTest, Result
from roadgpt.campaign.record import SCHEMA, STORE, Record, no_road, no_tests
from roadgpt.campaign.single_test import finished_run
from roadgpt.errors import UsageError
from roadgpt.run import Request, Run, Setup, prove, read_run
from roadgpt.run.folder import RUNS, finished, is_run, run_folder


def is_store(folder: Path) -> bool:
    """Returns whether a folder holds a campaign, or runs, with a store."""
    return (folder / STORE).is_file()


def has_tests(folder: Path) -> bool:
    """Returns whether a folder holds a campaign or runs; False for the folder of a single run."""
    return is_store(folder) or ((folder / RUNS).is_dir() and not is_run(folder))


def cannot_go_on(folder: Path) -> UsageError:
    """Returns the error for files of runs without a store."""
    return UsageError(
        f"{folder} has no {STORE}, the record of its tests, so they are shown but not continued; make them "
        "anew in another folder"
    )


def open_record(folder: Path) -> Record:
    """Opens the tests of a campaign, of a folder of runs, or of a single run."""
    if is_store(folder):
        return Record.opened(folder)
    if not has_tests(folder) and not is_run(folder):
        raise no_tests(folder)
    return FolderRecord(folder)


def setups_of(folder: Path) -> list[Setup]:
    """Returns the Setup of each cell of a campaign, a folder of runs or a run; see ``open_record``."""
    with open_record(folder) as record:
        return [cell.request.setup for cell in record.cells()]


class FolderRecord(Record):
    """The tests in a folder of runs without a store, or of one Run, open for reading: the Runs are entered
    into tables in memory when these are first queried."""

    def __init__(self, folder: Path) -> None:
        super().__init__(folder / STORE, sqlite3.connect(":memory:", isolation_level=None))
        self._is_entered, self.keeps_runs = False, True
        if is_run(folder):
            self._places = {read_run(folder).index: folder}
        else:
            self._places = {number: run_folder(folder, number) for number in finished(folder)}
        first = self._first_run()
        brief, request = (first.brief, first.request) if first else (None, Request())
        self._versions = first.versions if first else {}
        tests = CellBudget(tests=max(len(self._places), 1))
        self._cell_of_all = Cell("", request, brief, GIVEN, None, {}, tests, keeps_runs=True)

    def _first_run(self) -> Run | None:
        for number in self._places:
            with suppress(UsageError):  # who asks for this test is told
                return self.run("", number)
        return None

    def _execute(self, sql: str, values: Sequence[Any]) -> sqlite3.Cursor:
        if not self._is_entered:
            self._is_entered = True
            ended = [finished_run(self.run("", number)) for number in self._places]
            now, took = time.time(), sum(one.seconds.total for one in ended)
            self._db.executescript(SCHEMA)
            meta = {"finished": "yes", "versions": json.dumps({**self._versions})}
            self._db.executemany("INSERT INTO meta VALUES (?, ?)", meta.items())
            self._db.execute("INSERT INTO cells(name, cell) VALUES ('', '')")
            self._db.execute("INSERT INTO sittings VALUES (?, ?, 1, 1, 0, 0)", (now - took, now))
            for one in ended:
                its = one.result
                self.add_batch("", its.number - 1, its.number, [its.proposal])
            self.keep([("", one) for one in ended])
            self._db.execute("UPDATE tests SET ended = NULL")  # the files do not record when a test ended
        return super()._execute(sql, values)

    def total(self) -> int | None:
        """Returns the number of runs."""
        return len(self._places)

    def names(self) -> list[str]:
        """Returns the name of its only cell, which is empty."""
        return [""]

    def cells(self) -> list[Cell]:
        """Returns its only cell."""
        return [self._cell_of_all]

    def cell(self, name: str) -> Cell:
        """Returns its only cell; raises UsageError if there is none of that name."""
        return super().cell(name) if name else self._cell_of_all

    def tests(self, cell: str = "", which: str | None = None) -> list[NumberedTest]:
        """Returns the names of its tests; see ``Record.tests``."""
        if which is not None:
            return super().tests(cell, which)
        return [NumberedTest("", number) for number in self._places]

    def check_ended(self, cell: str, number: int) -> None:
        """Raises UsageError if the folder has no finished run of this number."""
        if number not in self._places:
            super().check_ended(cell, number)

    def run(self, cell: str, number: int, has_drive: bool = True) -> Run:
        """Returns the Run of a test, always with its drive; raises UsageError if it cannot be read."""
        self.check_ended(cell, number)
        return read_run(self._places[number])

    def result(self, cell: str, number: int) -> Result:
        """Returns the result of one test; raises UsageError if its Run cannot be read."""
        return finished_run(self.run(cell, number)).result

    def seed(self, result: Result) -> int:
        """Returns the driver's seed in a test."""
        return result.proposal.seed


def kept_run(folder: Path, cell: str, number: int, has_drive: bool = True) -> Run:
    """Returns the stored Run of a test; no road is driven, and no driver's file is loaded.

    The road is built from the stored design. The drive, unless it is left out, is the stored one, with
    positions exact to half a millimetre; outcome, margin and the place of a failure are those recorded.
    ``cell`` is empty in a folder of runs or of one run, whose Runs are as they were, and have their
    drives."""
    with open_record(folder) as record:
        return record.run(cell, number, has_drive)


def run_again(folder: Path, cell: str, number: int) -> tuple[Run, Result]:
    """Checks and drives the road of a test again; returns the new Run, the same bit for bit on one machine,
    and the stored Result."""
    with open_record(folder) as record:
        result, kept = record.result(cell, number), record.run(cell, number, has_drive=False)
    if kept.road is None:
        raise no_road(folder, cell, result)
    # then it was driven, whatever the rules find
    despite = result.margin is not None or result.outcome != "INVALID"
    run = prove(kept.road, kept.seed, kept.world, kept.request.setup, number, kept.brief, despite)
    return replace(run, request=kept.request, design=kept.design), result


def is_same(run: Run, result: Result) -> bool:
    """Returns whether a Run has the same outcome and exactly the same margin as a stored Result."""
    return run.outcome == result.outcome and (run.verdict and run.verdict.margin) == result.margin
