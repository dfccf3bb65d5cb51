"""The store: one SQLite file with everything about a campaign. One process writes it; any process may read
it.

    meta      format, plan, versions, and whether the campaign is finished
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

The file uses WAL and synchronous=NORMAL: committed transactions survive if the process is killed. A power cut
may undo the last transactions, each as a whole. Their tests then count as not done and are run again with the
same results, since a batch depends only on the results of earlier batches.
"""

import json
import sqlite3
import time
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, Self

from roadgpt.campaign.jobs import RunningJob
from roadgpt.campaign.model import Cell, Proposal
from roadgpt.campaign.record import FORMAT, STORE, Record
from roadgpt.campaign.rows import MEASURED, SPENT, cell_text, detail_values, proposal_rows, result_values
from roadgpt.campaign.single_test import FinishedTest
from roadgpt.chat import Spent
from roadgpt.errors import RoadGPTError, UsageError
from roadgpt.run.atomic import refuse_links

SCHEMA = """
CREATE TABLE meta(name TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;
CREATE TABLE cells(name TEXT PRIMARY KEY, cell TEXT NOT NULL, seconds REAL NOT NULL DEFAULT 0, closed TEXT)
  WITHOUT ROWID;
CREATE TABLE batches(cell TEXT, batch INTEGER, first INTEGER NOT NULL, n INTEGER NOT NULL,
  left INTEGER NOT NULL, PRIMARY KEY(cell, batch)) WITHOUT ROWID;
CREATE TABLE tests(cell TEXT, number INTEGER, batch INTEGER NOT NULL, seed INTEGER NOT NULL,
  given INTEGER NOT NULL, outcome TEXT, cause TEXT, side TEXT, length REAL, margin REAL, max_oob REAL,
  beyond REAL, at_s REAL, ended REAL, design_s REAL, drive_s REAL, tokens INTEGER, cost REAL, trace INTEGER,
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


class Store(Record):
    """A campaign's store, open for writing; the docstring of this module describes its tables."""

    group_seconds = 1.0
    """Longest time in seconds that a result waits to be stored. If the process is killed, the results of this
    time are lost.
    """

    def __init__(self, path: Path, db: sqlite3.Connection) -> None:
        super().__init__(path, db)
        self._features: set[str] = set()
        self._session = 0

    @classmethod
    def new(
        cls,
        folder: Path,
        plan: str,
        cells: Sequence[Cell],
        versions: Mapping[str, str],
        spent: Spent | None = None,
    ) -> Self:
        """Makes a store with a plan and its cells, without tests.

        Args:
            folder: the campaign's folder.
            plan: the campaign's plan as JSON.
            cells: the cells of the plan.
            versions: versions of RoadGPT and of the libraries that it uses.
            spent: tokens and money spent on reading the descriptions with a language model.

        Raises:
            RoadGPTError: the file cannot be written.
        """
        path = folder / STORE
        draft = path.with_name(f"{path.name}.part")
        with _refusals(folder):
            draft.unlink(missing_ok=True)
            db = sqlite3.connect(draft, isolation_level=None)
            meta = {"plan": plan, "versions": json.dumps(dict(versions)), "finished": ""}
            db.executescript(SCHEMA)
            db.execute("BEGIN")
            db.executemany("INSERT INTO meta VALUES (?, ?)", meta.items())
            db.executemany(
                "INSERT INTO cells(name, cell) VALUES (?, ?)", [(c.name, cell_text(c)) for c in cells]
            )
            if spent is not None and spent.calls:
                db.execute(
                    "INSERT INTO sittings VALUES (?, ?, 0, 1, ?, ?)",
                    (now := time.time(), now, spent.usage.total, spent.cost or 0.0),
                )
            db.execute(f"PRAGMA user_version = {FORMAT}")
            db.execute("COMMIT")
            db.close()
            draft.replace(path)  # so that the store is complete or absent
        return cls.opened(folder)

    @classmethod
    def opened(cls, folder: Path) -> Self:
        """Opens the store in a folder for writing.

        Raises:
            UsageError: there is no store, or it is damaged or of another version.
        """
        refuse_links(folder / STORE)
        store = cls._opened(folder, "rw")
        try:
            for name in store.missing:  # an older version made this store
                store._db.execute(f"ALTER TABLE tests ADD COLUMN {name} REAL")
            store._db.execute("PRAGMA journal_mode = WAL")
            store._db.execute("PRAGMA synchronous = NORMAL")
        except sqlite3.Error as error:
            store.close()
            raise UsageError(f"{store.path} cannot be written ({error}); name another folder") from error
        store._features = {*store.feature_names()}
        return store

    @property
    def how_to_continue(self) -> str:
        """Text at the end of an error message that explains how to continue the campaign."""
        return f"continue with: roadgpt resume {self.folder}"

    @contextmanager
    def _whole(self) -> Iterator[sqlite3.Connection]:
        """Makes a ``with`` block one transaction."""
        with _refusals(self.folder):
            self._db.execute("BEGIN IMMEDIATE")
            try:
                yield self._db
                self._db.execute("COMMIT")
            except BaseException:
                if self._db.in_transaction:
                    self._db.execute("ROLLBACK")
                raise

    def close(self) -> None:
        """Closes the file; once the campaign is finished, the file may be copied and made read-only."""
        with suppress(sqlite3.Error):  # somebody reads it at this moment
            if self.meta("finished"):
                self._db.execute("PRAGMA journal_mode = DELETE")
        super().close()

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
        rows = [proposal_rows(cell, batch, first + at, made) for at, made in enumerate(proposals)]
        n = len(proposals)
        with self._whole() as db:
            db.execute("INSERT INTO batches VALUES (?, ?, ?, ?, ?)", (cell, batch, first, n, n))
            db.executemany(
                "INSERT INTO tests(cell, number, batch, seed, given) VALUES (?, ?, ?, ?, ?)",
                [test for test, _ in rows],
            )
            db.executemany(
                "INSERT INTO details(cell, number, origin, design) VALUES (?, ?, ?, ?)",
                [detail for _, detail in rows],
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

    def set_plan(self, plan: str) -> None:
        """Replaces the stored plan, as JSON. The new plan may differ from the stored plan only in settings
        that may change when a campaign is resumed, such as limits.
        """
        with self._whole() as db:
            db.execute("UPDATE meta SET value = ? WHERE name = 'plan'", (plan,))

    def spend(self, spent: Spent) -> None:
        """Adds tokens and money that a language model used outside of finished tests, such as for a test that
        ran out of its allowance.
        """
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
        leases: Sequence[tuple[str, int, RunningJob, float]],
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
                [_test_values(cell, one, now, trace) for cell, one in ended],
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
            db.executemany(
                "INSERT OR REPLACE INTO leases VALUES (?, ?, ?, ?)",
                [(cell, number, one.worker, until) for cell, number, one, until in leases],
            )
            db.executemany(
                "UPDATE cells SET seconds = seconds + ? WHERE name = ?",
                [(taken, cell) for cell, taken in seconds.items()],
            )
            db.execute("UPDATE sittings SET seen = ? WHERE rowid = ?", (now, self._session))
        self._features |= names


@contextmanager
def _refusals(folder: Path) -> Iterator[None]:
    """Turns errors of SQLite or the operating system in a ``with`` block into one clear error message."""
    try:
        yield
    except (sqlite3.Error, OSError) as error:
        raise refused(folder, error) from error


def refused(folder: Path, error: sqlite3.Error | OSError) -> RoadGPTError:
    """Returns the error to raise if SQLite or the operating system cannot write a file."""
    reason = (error.strerror if isinstance(error, OSError) else None) or error
    return RoadGPTError(
        f"cannot write into {folder}: {reason}; make room there, then say: roadgpt resume {folder}"
    )


def _test_values(cell: str, one: FinishedTest, now: float, trace: tuple[int, str] | None) -> tuple[Any, ...]:
    spent = one.spent
    return (
        *result_values(one.result),
        now,
        round(one.seconds.design, 4),
        round(one.seconds.drive, 4),
        spent.usage.total if spent else None,
        spent.cost if spent else None,
        trace[0] if trace is not None and one.trace is not None else None,
        cell,
        one.result.number,
    )
