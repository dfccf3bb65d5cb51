"""Stores tests in folders of runs, as ``roadgpt run`` and studies do."""

import sqlite3
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from roadgpt.campaign.model import Cell, Proposal
from roadgpt.campaign.run_folder import FinishedRun, RunFolder, RunWriter
from roadgpt.campaign.single_test import FinishedTest, Task, error_run
from roadgpt.campaign.store_tables import SCHEMA, Tables
from roadgpt.run.card import CARD


class FolderStore(Tables):
    """A store whose tests lie in folders of runs: one folder for each cell, which is one combination of
    description, driver and other settings.

    The folders are the only record of the tests, and each can be copied on its own. The tables are built in
    memory from the folders, so that the same code schedules, resumes and counts both kinds of campaigns.
    """

    group_seconds = 0.0

    def __init__(self, home: Path, folders: Mapping[str, RunFolder], cells: Sequence[Cell]) -> None:
        """Builds the tables from the tests in the folder of each cell; messages name the folder ``home``."""
        super().__init__(home / CARD, sqlite3.connect(":memory:", isolation_level=None))
        self._folders = folders
        self._cells = {cell.name: cell for cell in cells}
        self.written: list[tuple[str, FinishedRun]] = []
        """Tests whose files were written, with their cells' names; code that reads this list empties it."""
        self._db.executescript(SCHEMA)
        self._db.execute("INSERT INTO meta VALUES ('finished', '')")
        self._db.executemany(
            "INSERT INTO cells(name, cell) VALUES (?, '')", [(name,) for name in self._cells]
        )
        for name, folder in folders.items():
            self._enter(name, folder.tests, range(1, max(folder.tests, default=0) + 1))

    def _enter(
        self, cell: str, ended: Mapping[int, FinishedTest], numbers: Iterable[int] | None = None
    ) -> None:
        """Enters tests into the tables; tests of ``numbers`` that have not ended are still to be run."""
        seed = self._cells[cell].request.seed
        for number in ended if numbers is None else numbers:
            made = ended[number].result.proposal if number in ended else Proposal(None, seed, "draft")
            self.add_batch(cell, number - 1, number, [made])
        super().keep([(cell, one) for one in ended.values()], None, (), {})

    def to_resume(self, *more: object) -> str:
        """Returns the command that continues the tests, with further options."""
        if all(each.folder == self.folder for each in self._folders.values()):
            return super().to_resume(*more)
        return " ".join(map(str, ("the same command with --out", self.folder, *more)))

    def names(self) -> list[str]:
        """Returns the names of all cells."""
        return [*self._cells]

    def cells(self) -> list[Cell]:
        """Returns all cells."""
        return [*self._cells.values()]

    def cell(self, name: str) -> Cell:
        """Returns one cell; raises UsageError if there is none of that name."""
        return self._cells[name] if name in self._cells else super().cell(name)

    def keep(self, ended: Sequence[tuple[str, FinishedTest]], *rest: Any) -> None:
        """Enters tests that have ended into the tables, and writes their files; see ``RunFolder.add``."""
        super().keep(ended, *rest)
        for name, one in ended:
            if not isinstance(one, FinishedRun):  # its workers died, perhaps while they drew pictures
                task = Task(one.result.number, one.result.batch, one.result.proposal)
                run = error_run(task, self._cells[name], one.result.description)
                one = RunWriter({name: self._folders[name].folder}).written(run, task, name)
            self.written += [(name, each) for each in self._folders[name].add(one)]

    def reopen(self, cell: str, number: int, batch: int) -> None:
        """Removes a test that ended without a drive, so that it runs again."""
        super().reopen(cell, number, batch)
        self._folders[cell].remove(number)
