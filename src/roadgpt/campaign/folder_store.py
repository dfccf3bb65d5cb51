"""The store of campaigns whose tests are written into folders of runs: one folder for each cell.

The folders are the only record of the tests, and each can be copied on its own. The tables of
``campaign.store`` are built from the folders in memory, so that the same code schedules, resumes and counts
both kinds of campaigns.
"""

import sqlite3
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from roadgpt.campaign.model import Cell, Proposal
from roadgpt.campaign.record import STORE
from roadgpt.campaign.run_folder import FinishedRun, RunFolder, RunWriter
from roadgpt.campaign.single_test import FinishedTest, Task, error_run
from roadgpt.campaign.store import SCHEMA, Store


class FolderStore(Store):
    """The store of the tests in folders of runs."""

    group_seconds = 0.0

    def __init__(self, home: Path, folders: Mapping[str, RunFolder], cells: Sequence[Cell]) -> None:
        """Makes the tables of the tests that are in the folders.

        Args:
            home: the folder that messages name.
            folders: the folder of each cell, by the cell's name.
            cells: the cells.
        """
        super().__init__(home / STORE, sqlite3.connect(":memory:", isolation_level=None))
        self._folders = folders
        self._cells = {cell.name: cell for cell in cells}
        self.written: list[tuple[str, FinishedRun]] = []
        """Tests whose files were written, with the names of their cells; whoever reads them empties it."""
        self._db.executescript(SCHEMA)
        self._db.execute("INSERT INTO meta VALUES ('finished', '')")
        self._db.executemany(
            "INSERT INTO cells(name, cell) VALUES (?, '')", [(name,) for name in self._cells]
        )
        for cell in cells:
            there = folders[cell.name].tests
            for number in range(1, max(there, default=0) + 1):
                self.add_batch(cell.name, number - 1, number, [Proposal(None, cell.request.seed, "draft")])
            super().keep([(cell.name, one) for one in there.values()], None, (), {})

    @property
    def how_to_continue(self) -> str:
        """Text at the end of an error message that explains how to continue the campaign."""
        return f"continue with the same command and --out {self.folder}"

    def cell(self, name: str) -> Cell:
        """Returns one cell."""
        return self._cells[name]

    def keep(self, ended: Sequence[tuple[str, FinishedTest]], *rest: Any) -> None:
        """Writes the files of tests that have ended.

        A test for which no road could be designed is written only once another test of its cell has a road.
        """
        super().keep(ended, *rest)
        for name, one in ended:
            if not isinstance(one, FinishedRun):  # its workers died, perhaps over its pictures
                task = Task(one.result.number, one.result.batch, one.result.proposal)
                run = error_run(task, self._cells[name], one.result.description)
                one = RunWriter({name: self._folders[name].folder}).written(run, task, name)
            self.written += [(name, each) for each in self._folders[name].add(one)]

    def reopen(self, cell: str, number: int, batch: int) -> None:
        """Removes a test that ended without a drive, so that it runs again."""
        super().reopen(cell, number, batch)
        self._folders[cell].remove(number)
