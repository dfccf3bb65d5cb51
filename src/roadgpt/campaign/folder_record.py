"""Opens the tests of a folder, whatever wrote them; returns the drive or the Run of one of them, either as
stored or by driving its road again."""

import json
import sqlite3
import time
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from roadgpt.campaign.model import Cell, NumberedTest, Result
from roadgpt.campaign.record import STORE, Record, no_road, no_tests
from roadgpt.campaign.run_folder import Campaign, FolderStore, counted, finished_run, writing
from roadgpt.errors import UsageError
from roadgpt.road import Road
from roadgpt.run import Request, Run, Setup, prove, read_run, store, write_run
from roadgpt.run.atomic import alone_in, is_locked
from roadgpt.run.folder import (
    CARD,
    RUNS,
    finished,
    finished_run_in,
    is_run,
    read_card,
    run_folder,
    write_again,
)


def is_store(folder: Path) -> bool:
    """Returns whether a folder holds a campaign with a store; False for a folder of runs."""
    return (folder / STORE).is_file()


def has_tests(folder: Path) -> bool:
    """Returns whether a folder holds a campaign or runs; False for the folder of a single run."""
    return is_store(folder) or ((folder / RUNS).is_dir() and not is_run(folder))


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


class FolderRecord(FolderStore):
    """The tests in a folder of runs, open for reading; all Runs are read when the tables are first
    queried."""

    has_run = "1"

    def __init__(self, folder: Path) -> None:
        """Opens a folder of runs, or the folder of one Run."""
        self._is_entered, self._home = False, folder
        if is_run(folder):
            self._places = {read_run(folder).index: folder}
        else:
            self._places = {number: run_folder(folder, number) for number in finished(folder)}
        card = read_card(folder) if (folder / CARD).is_file() else None
        first = next(iter(self._places), None)
        brief, request, versions = None, card and card.request, card and card.versions
        if first is not None:
            try:
                run = self.run("", first)
                brief, request, versions = run.brief, request or run.request, versions or run.versions
            except UsageError:
                if request is None:
                    raise
        roads = card.roads if card else max(len(self._places), 1)
        runs = Campaign(folder, request or Request(), brief, roads)
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
        place = self._places[number]
        return read_run(place) if place == self._home else finished_run_in(self._home, number)

    def result(self, cell: str, number: int) -> Result:
        """Returns the result of one test; raises UsageError if its Run cannot be read."""
        return finished_run(self.run(cell, number)).result

    def road(self, cell: Cell, result: Result) -> tuple[Road, Request] | None:
        """Returns the road of a test that has ended, and its request; None if the test has no road."""
        run = self.run(cell.name, result.number)
        return None if run.road is None else (run.road, run.request)

    def seed(self, result: Result) -> int:
        """Returns the driver's seed in a test."""
        return result.proposal.seed


def kept_run(folder: Path, cell: str, number: int, has_drive: bool = True) -> Run:
    """Returns the stored Run of a test; no road is driven, and no driver's file is loaded.

    The road is built from the stored design. The drive, unless it is left out, is the stored one, with
    positions exact to half a millimetre; outcome, margin and the place of a failure are those recorded.
    ``cell`` is empty in a folder of runs or of one run, whose Runs always have their drives."""
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


def write_runs(folder: Path, out: Path) -> Iterator[Path]:
    """Writes the tests of a campaign, or of a folder of runs, as a folder of runs ``out`` with its tables; of
    a campaign, a folder in ``out`` for each cell. If ``out`` is the folder of runs itself, what is missing or
    damaged there becomes what it was, but for the pictures. Yields the folder of each Run when it is written.
    Raises UsageError if other runs are in ``out``, or it is a folder that has no record."""
    with open_record(folder) as record:
        for cell in record.cells():
            place = out / cell.name
            names, versions = record.tests(cell.name), record.versions(cell.request.setup.driver)
            roads = cell.budget.tests or len(names)
            runs = Campaign(place, cell.request, cell.brief, roads, versions=versions)
            is_again = place.exists() and place.samefile(folder)
            if is_again and not store.is_kept(folder):
                raise UsageError(
                    f"{folder} has no {store.STORE}, from which its files could be written again; "
                    "name another folder with --out"
                )
            if (place / CARD).is_file() and not is_again:
                raise UsageError(f"{place} holds runs already; name another folder")
            with alone_in(place), writing(place):
                for _, number in names:
                    run = record.run(cell.name, number)
                    if isinstance(record, FolderRecord) and store.is_kept(folder):
                        write_again(folder, number, place)
                    else:
                        write_run(run, place)
                    runs.count(counted(run))
                    yield run_folder(place, number)
                runs.write_settings()
                runs.write_tables()
                if not is_again:
                    runs.write_card(is_finished=True)


def is_same(run: Run, result: Result) -> bool:
    """Returns whether a Run has the same outcome and exactly the same margin as a stored Result."""
    return run.outcome == result.outcome and (run.verdict and run.verdict.margin) == result.margin
