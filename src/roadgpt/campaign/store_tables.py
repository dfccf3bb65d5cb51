"""The tables of a campaign, in SQLite: what a session reads and writes while it runs tests.

    meta      format, plan, versions (of each driver's tests), and whether the campaign is finished
    cells     the settings of each cell; how long it has taken; why it was closed early
    batches   which tests were requested together; a batch and its tests are written in one transaction,
              so that no test is requested twice
    tests     one row per test with its short columns, so that a million tests are counted in a second;
              a test without an outcome has not ended
    details   one row per test with its long columns: design, sentences, features
    traces    the names of the files with the drives
    leases    which worker runs which test now; deleted at the start of the next session
    sittings  the sessions: when each began and was last active, and the cost of language models outside tests
    features  names of all features that occur

``results.csv`` and ``cells.csv`` are made from the deterministic columns of ``tests`` and ``details``. The
column ``ended`` and all columns after it depend on the clock.
"""

import sqlite3
import time
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

from roadgpt.campaign.model import Cell, Proposal, Result
from roadgpt.campaign.rows import (
    MEASURED,
    RESULT,
    SPENT,
    cell_of_text,
    design_of,
    design_text,
    detail_values,
    plain,
    result_of_row,
    values_of_test,
)
from roadgpt.campaign.single_test import FinishedTest, Task
from roadgpt.campaign.store_check import reading_store
from roadgpt.chat import Spent
from roadgpt.errors import RoadGPTError, UsageError, command_line
from roadgpt.run.model import permissions

SCHEMA = """
CREATE TABLE meta(name TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;
CREATE TABLE cells(name TEXT PRIMARY KEY, cell TEXT NOT NULL, seconds REAL NOT NULL DEFAULT 0, closed TEXT)
  WITHOUT ROWID;
CREATE TABLE batches(cell TEXT, batch INTEGER, first INTEGER NOT NULL, n INTEGER NOT NULL,
  left INTEGER NOT NULL, PRIMARY KEY(cell, batch)) WITHOUT ROWID;
CREATE TABLE tests(cell TEXT, number INTEGER, batch INTEGER NOT NULL, seed INTEGER NOT NULL,
  given INTEGER NOT NULL, outcome TEXT, cause TEXT, side TEXT, length REAL, margin REAL, max_oob REAL,
  beyond REAL, at_s REAL, own_share REAL, handed_to TEXT, ended REAL, design_s REAL, drive_s REAL,
  tokens INTEGER, cost REAL, trace INTEGER,
  PRIMARY KEY(cell, number)) WITHOUT ROWID;
CREATE TABLE details(cell TEXT, number INTEGER, origin TEXT NOT NULL, design TEXT, description TEXT,
  features TEXT, error TEXT, PRIMARY KEY(cell, number));
CREATE TABLE traces(trace INTEGER PRIMARY KEY, file TEXT NOT NULL);
CREATE TABLE leases(cell TEXT, number INTEGER, worker TEXT NOT NULL, until REAL NOT NULL,
  PRIMARY KEY(cell, number)) WITHOUT ROWID;
CREATE TABLE sittings(begun REAL NOT NULL, seen REAL NOT NULL, workers INTEGER NOT NULL,
  is_over INTEGER NOT NULL DEFAULT 0, tokens INTEGER NOT NULL DEFAULT 0, cost REAL NOT NULL DEFAULT 0);
CREATE TABLE features(name TEXT PRIMARY KEY) WITHOUT ROWID;
CREATE INDEX waiting ON tests(cell, number) WHERE outcome IS NULL;
"""


OF_A_DRIVE = (*MEASURED, *(name for name in SPENT if name not in ("tokens", "cost")))
"""The columns of ``tests`` that a test loses when it is opened again."""


def _set(names: Sequence[str], value: str) -> str:
    return ", ".join(f"{name} = {value}" for name in names)


@dataclass
class Batch:
    """One batch of a cell."""

    number: int
    first: int
    n: int
    left: int
    """Number of its tests that have not ended yet."""


class Tables:
    """The tables in a database: in the file of a campaign, or in memory (``FolderStore``)."""

    group_seconds = 1.0
    """Longest time in seconds that a result waits to be stored; if the process is killed, the results of
    this time are lost.
    """

    def __init__(self, path: Path, db: sqlite3.Connection) -> None:
        self.path = path
        self._db = db
        self._features: set[str] = set()
        self._session = 0

    @property
    def folder(self) -> Path:
        """The campaign's folder."""
        return self.path.parent

    def close(self) -> None:
        """Closes the database."""
        self._db.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _execute(self, sql: str, values: Sequence[Any]) -> sqlite3.Cursor:
        return self._db.execute(sql, values)

    def query(self, sql: str, values: Sequence[Any] = ()) -> list[tuple[Any, ...]]:
        """Returns all rows of a SELECT as a list; use ``stream`` for large results."""
        with reading_store(self.path):
            return self._execute(sql, values).fetchall()

    def stream(self, sql: str, values: Sequence[Any] = ()) -> Iterator[tuple[Any, ...]]:
        """Yields the rows of a SELECT one by one."""
        with reading_store(self.path):
            cursor = self._execute(sql, values)
        while True:
            with reading_store(self.path):
                row = cursor.fetchone()
            if row is None:
                return
            yield row

    def meta(self, name: str) -> str:
        """Returns one value of the table ``meta``, by its key: ``plan``, ``versions`` or ``finished``."""
        return str(self.query("SELECT value FROM meta WHERE name = ?", (name,))[0][0])

    def names(self) -> list[str]:
        """Returns the names of all cells, in the order of the plan."""
        return [name for (name,) in self.query("SELECT name FROM cells ORDER BY name")]

    def cells(self) -> list[Cell]:
        """Returns all cells, in the order of the plan."""
        rows = self.query("SELECT name, cell FROM cells ORDER BY name")
        return [self._cell(name, text) for name, text in rows]

    def _cell(self, name: str, text: str) -> Cell:
        with reading_store(self.path):
            found = cell_of_text(text, self.path)
            if found.name != name:
                raise ValueError(f"cell {name} calls itself {found.name[:20]}")
            return found

    def cell(self, name: str) -> Cell:
        """Returns one cell; raises UsageError if there is none of that name."""
        found = self.query("SELECT cell FROM cells WHERE name = ?", (name,))
        if not found:
            names = ", ".join(self.names()[:10])
            raise UsageError(f"there is no cell '{name}' in {self.path.parent}; cells are {names}")
        return self._cell(name, found[0][0])

    def results(
        self, cell: str | None = None, where: str = "1", values: Sequence[Any] = ()
    ) -> Iterator[Result]:
        """Yields the results of the ended tests of a cell (None: of all cells), sorted by cell and number.
        ``where`` is a condition in SQL on the columns of ``tests`` and ``details``, with placeholders for
        ``values``.
        """
        chosen, names = ("tests.cell = ? AND", [cell]) if cell is not None else ("", [])
        sql = (
            f"SELECT {RESULT} FROM tests JOIN details USING (cell, number) "  # noqa: S608 - our own words
            f"WHERE {chosen} outcome IS NOT NULL AND ({where}) ORDER BY tests.cell, tests.number"
        )
        for row in self.stream(sql, (*names, *values)):
            with reading_store(self.path):
                found = result_of_row(row)
            yield found

    def batches(self, cell: str) -> list[Batch]:
        """Returns the batches of a cell that have been requested, in order."""
        rows = self.query("SELECT batch, first, n, left FROM batches WHERE cell = ? ORDER BY batch", (cell,))
        return [Batch(*row) for row in rows]

    def waiting(self, cell: str) -> list[Task]:
        """Returns the tests of a cell that have not ended, sorted by number."""
        rows = self.query(
            "SELECT tests.number, batch, seed, origin, design FROM tests JOIN details USING (cell, number) "
            "WHERE tests.cell = ? AND outcome IS NULL ORDER BY tests.number",
            (cell,),
        )
        with reading_store(self.path):
            return [
                Task(number, batch, Proposal(design_of(text), seed, origin))
                for number, batch, seed, origin, text in rows
            ]

    def spent(self) -> tuple[int, float]:
        """Returns the tokens and the USD spent on language models so far."""
        sql = "SELECT coalesce(sum(tokens), 0), coalesce(sum(cost), 0) FROM "
        tests, other = (self.query(sql + table)[0] for table in ("tests", "sittings"))
        return tests[0] + other[0], tests[1] + other[1]

    def to_resume(self, *more: object) -> str:
        """Returns the command that continues the campaign, with further options."""
        permitted = permissions([cell.request.setup for cell in self.cells()], asks=True)
        return command_line("resume", self.folder, *permitted, *more)

    @contextmanager
    def _whole(self) -> Iterator[sqlite3.Connection]:
        """Makes a ``with`` block one transaction."""
        with refusals(self.folder, self):
            self._db.execute("BEGIN IMMEDIATE")
            try:
                yield self._db
                self._db.execute("COMMIT")
            except BaseException:
                if self._db.in_transaction:
                    self._db.execute("ROLLBACK")
                raise

    def begin_session(self, workers: int) -> None:
        """Begins a session, and deletes the leases of earlier sessions."""
        now = time.time()
        with self._whole() as db:
            db.execute("DELETE FROM leases")
            done = db.execute(
                "INSERT INTO sittings(begun, seen, workers) VALUES (?, ?, ?)", (now, now, workers)
            )
            self._session = done.lastrowid or 0

    def end_session(self) -> None:
        """Ends the session."""
        with self._whole() as db:
            db.execute("UPDATE sittings SET is_over = 1 WHERE rowid = ?", (self._session,))

    def add_batch(self, cell: str, batch: int, first: int, proposals: Sequence[Proposal]) -> None:
        """Adds a batch with all its tests."""
        n, numbered = len(proposals), [*enumerate(proposals, first)]
        with self._whole() as db:
            db.execute("INSERT INTO batches VALUES (?, ?, ?, ?, ?)", (cell, batch, first, n, n))
            db.executemany(
                "INSERT INTO tests(cell, number, batch, seed, given) VALUES (?, ?, ?, ?, ?)",
                [(cell, number, batch, made.seed, made.design is not None) for number, made in numbered],
            )
            db.executemany(
                "INSERT INTO details(cell, number, origin, design) VALUES (?, ?, ?, ?)",
                [(cell, number, plain(made.origin), design_text(made.design)) for number, made in numbered],
            )

    def reopen(self, cell: str, number: int, batch: int) -> None:
        """Marks a test that ended without a drive as not ended, so that it is run again."""
        with self._whole() as db:
            db.execute(
                f"UPDATE tests SET {_set(OF_A_DRIVE, 'NULL')} WHERE cell = ? AND number = ?",  # noqa: S608
                (cell, number),
            )
            db.execute(
                "UPDATE details SET description = NULL, features = NULL, error = NULL, design = CASE "
                "(SELECT given FROM tests WHERE cell = ? AND number = ?) WHEN 1 THEN design END "
                "WHERE cell = ? AND number = ?",
                (cell, number) * 2,
            )
            db.execute("UPDATE batches SET left = left + 1 WHERE cell = ? AND batch = ?", (cell, batch))

    def close_cell(self, cell: str, why: str) -> None:
        """Records that no further batch of a cell will be requested, and the reason."""
        with self._whole() as db:
            db.execute("UPDATE cells SET closed = ? WHERE name = ?", (why, cell))

    def finish(self) -> None:
        """Records that the campaign is finished."""
        with self._whole() as db:
            db.execute("UPDATE meta SET value = 'yes' WHERE name = 'finished'")

    def spend(self, spent: Spent) -> None:
        """Adds what a language model used outside of finished tests, as in a test beyond its allowance."""
        with self._whole() as db:
            db.execute(
                "UPDATE sittings SET tokens = tokens + ?, cost = cost + ? WHERE rowid = ?",
                (spent.usage.total, spent.cost or 0.0, self._session),
            )

    def next_trace(self) -> int:
        """Returns the number of the next file of drives to write."""
        return int(self.query("SELECT coalesce(max(trace), 0) + 1 FROM traces")[0][0])

    def keep(
        self,
        ended: Sequence[tuple[str, FinishedTest]],
        trace: tuple[int, str] | None,
        leases: Sequence[tuple[str, int, str, float]],
        seconds: Mapping[str, float],
    ) -> None:
        """Stores a group of results in one transaction.

        Args:
            ended: finished tests, each with the name of its cell.
            trace: number and name of the file with the drives of these tests.
            leases: running tests: cell, number, worker, and the time by which each must have ended.
            seconds: working time of each cell since the last group was stored, in seconds.
        """
        now = time.time()
        left = Counter((cell, one.result.batch) for cell, one in ended)
        names = {name for _, one in ended for name in one.result.features} - self._features
        with self._whole() as db:
            if trace is not None:
                db.execute("INSERT INTO traces VALUES (?, ?)", trace)
            db.executemany(
                f"UPDATE tests SET {_set(MEASURED + SPENT, '?')} WHERE cell = ? AND number = ?",  # noqa: S608
                [
                    (*values_of_test(one, now, trace and trace[0]), cell, one.result.number)
                    for cell, one in ended
                ],
            )
            db.executemany(
                "UPDATE details SET design = ?, description = ?, features = ?, error = ? "
                "WHERE cell = ? AND number = ?",
                [(*detail_values(one), cell, one.result.number) for cell, one in ended],
            )
            db.executemany(
                "UPDATE batches SET left = left - ? WHERE cell = ? AND batch = ?",
                [(count, cell, batch) for (cell, batch), count in left.items()],
            )
            db.executemany("INSERT OR IGNORE INTO features VALUES (?)", [(name,) for name in sorted(names)])
            db.execute("DELETE FROM leases")
            db.executemany("INSERT OR REPLACE INTO leases VALUES (?, ?, ?, ?)", leases)
            db.executemany(
                "UPDATE cells SET seconds = seconds + ? WHERE name = ?",
                [(taken, cell) for cell, taken in seconds.items()],
            )
            db.execute("UPDATE sittings SET seen = ? WHERE rowid = ?", (now, self._session))
        self._features |= names


@contextmanager
def refusals(folder: Path, store: Tables | None = None) -> Iterator[None]:
    """Turns errors of SQLite or the operating system in a ``with`` block into one clear error message, which
    says how to continue the campaign in ``store``."""
    try:
        yield
    except (sqlite3.Error, OSError) as error:
        reason = (error.strerror if isinstance(error, OSError) else None) or error
        again = f"then say: {store.to_resume()}" if store else "and repeat the command"
        raise RoadGPTError(f"cannot write into {folder}: {reason}; make room there, {again}") from error
