"""Reads a campaign's store, even while another process is working on the campaign."""

import sqlite3
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from roadgpt.campaign.model import Cell, Proposal, Result
from roadgpt.campaign.numbered_test import NumberedTest
from roadgpt.campaign.rows import RESULT, cell_of_text, design_of, result_of_row
from roadgpt.campaign.single_test import seed_of_driver
from roadgpt.campaign.store_check import LATER, check_store, reading_store
from roadgpt.drive import Drive
from roadgpt.errors import UsageError
from roadgpt.network import made_from
from roadgpt.reading import json_of
from roadgpt.road import Road
from roadgpt.run import Run

if TYPE_CHECKING:
    from roadgpt.campaign.plan import Plan

STORE = "campaign.sqlite"
FORMAT = 1
PATIENCE = 30.0  # s to wait for another process that locks the store
WHICH = {
    None: ("1", ""),
    "failures": ("outcome = 'FAIL'", ""),
    "worst": ("outcome IN ('FAIL', 'PASS')", "outcome != 'FAIL', margin IS NULL, margin, max_oob DESC,"),
}
"""For each choice of tests that users can make: the SQL condition on the tests, and the SQL order."""


def _connected(path: Path, mode: str) -> tuple[sqlite3.Connection, int]:
    """Returns a connection to a store's file and the number of its format; raises sqlite3.Error."""
    try:
        return _opened(path, mode)
    except sqlite3.OperationalError as error:
        log = path.with_name(f"{path.name}-wal")
        is_whole = not log.exists() or not log.stat().st_size
        if mode == "ro" and is_whole and error.sqlite_errorcode & 0xFF == sqlite3.SQLITE_CANTOPEN:
            # an interrupted campaign on a read-only disk: no process can be writing the store
            return _opened(path, "ro&immutable=1")
        raise


def _opened(path: Path, mode: str) -> tuple[sqlite3.Connection, int]:
    db = sqlite3.connect(f"{path.resolve().as_uri()}?mode={mode}", PATIENCE, isolation_level=None, uri=True)
    try:
        version = db.execute("PRAGMA user_version").fetchone()[0]
        db.execute("SELECT count(*) FROM meta").fetchone()
    except sqlite3.Error:
        db.close()
        raise
    return db, version


def _missing(db: sqlite3.Connection) -> tuple[str, ...]:
    there = {row[1] for row in db.execute("PRAGMA table_info(tests)")}
    return tuple(name for name in LATER if name not in there)


def no_tests(folder: Path) -> UsageError:
    """Returns the error for a folder that holds neither a campaign nor runs."""
    return UsageError(
        f"there is no campaign in {folder}, and there are no runs; give a folder that roadgpt campaign or "
        "roadgpt run made"
    )


@dataclass
class Batch:
    """One batch of a cell, with the number of its tests that have not ended yet."""

    number: int
    first: int
    n: int
    left: int


class Record:
    """A campaign's store, open for reading; ``campaign.store`` describes its tables."""

    has_run = "design IS NOT NULL"
    """The SQL condition that selects the tests whose Runs the method ``run`` can return."""

    def __init__(self, path: Path, db: sqlite3.Connection) -> None:
        self.path = path
        self._db = db
        self.missing: tuple[str, ...] = ()
        """Columns of ``tests`` that this store lacks; they read as empty."""

    @classmethod
    def opened(cls, folder: Path) -> Self:
        """Opens the record of the campaign in a folder.

        Raises:
            UsageError: there is no store, or it is damaged or of another version.
        """
        return cls._opened(folder, "ro")

    @classmethod
    def _opened(cls, folder: Path, mode: str) -> Self:
        path = folder / STORE
        if not path.is_file():
            raise no_tests(folder)
        try:
            db, version = _connected(path, mode)
        except sqlite3.Error as error:
            raise UsageError(
                f"{path} cannot be read ({error}); name another folder, or copy this to where you may write"
            ) from error
        if version != FORMAT:
            db.close()
            raise UsageError(
                f"{path} was written by another version of roadgpt (its format is {version}, this one reads "
                f"{FORMAT}); start the campaign again in another folder"
            )
        try:
            check_store(path, db)
            record = cls(path, db)
            record.missing = _missing(db)
        except BaseException:
            db.close()
            raise
        if record.missing and mode == "ro":
            empty = ", ".join(f"NULL AS {name}" for name in record.missing)
            db.execute(f"CREATE TEMP VIEW tests AS SELECT *, {empty} FROM main.tests")  # noqa: S608 - ours
        return record

    @property
    def folder(self) -> Path:
        """The campaign's folder."""
        return self.path.parent

    def close(self) -> None:
        """Closes the file."""
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

    def plan(self) -> "Plan":
        """Returns the campaign's plan."""
        from roadgpt.campaign.plan import Plan

        with reading_store(self.path):
            return Plan.model_validate_json(self.meta("plan")).came_with(self.path)

    def total(self) -> int | None:
        """Returns the number of tests that the plan requests in all cells; None if the plan has only a time
        limit.
        """
        tests = self.plan().budget.tests
        return tests and tests * len(self.names())

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
        """Returns one cell.

        Raises:
            UsageError: there is no cell of that name.
        """
        found = self.query("SELECT cell FROM cells WHERE name = ?", (name,))
        if not found:
            names = ", ".join(self.names()[:10])
            raise UsageError(f"there is no cell '{name}' in {self.path.parent}; cells are {names}")
        return self._cell(name, found[0][0])

    def results(
        self, cell: str | None = None, where: str = "1", values: Sequence[Any] = ()
    ) -> Iterator[Result]:
        """Yields one by one the results of tests that have ended, sorted by cell and number.

        Args:
            cell: name of the cell; None: all cells.
            where: a condition in SQL on the columns of ``tests`` and ``details``.
            values: the values of the condition's placeholders.
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

    def result(self, cell: str, number: int) -> Result:
        """Returns the result of one test.

        Raises:
            UsageError: there is no such test, or it has not ended.
        """
        for result in self.results(cell, "tests.number = ?", (number,)):
            return result
        raise UsageError(f"{self.path.parent} holds no result of test {number} of {cell}")

    def run(self, cell: str, number: int, has_drive: bool = True) -> Run:
        """Returns the stored Run of a test; see ``rerun.kept_run``."""
        from roadgpt.campaign.stored_run import no_road, stored_run

        own, result = self.cell(cell), self.result(cell, number)
        road = self.road(own, result)
        if road is None:
            raise no_road(self.folder, cell, result)
        drive = self.drive(cell, number) if has_drive else None
        with reading_store(self.path):
            versions = {str(name): str(value) for name, value in json_of(self.meta("versions")).items()}
        return stored_run(own, result, road, drive, versions)

    def drive(self, cell: str, number: int) -> Drive | None:
        """Returns the stored drive of a test; None if the test was not driven."""
        from roadgpt.campaign.traces import TRACES, read_traces

        name = self.trace_file(cell, number)
        return None if name is None else read_traces(self.folder / TRACES / name, cell, number)

    def road(self, cell: Cell, result: Result) -> Road | None:
        """Returns the road of a test that has ended; None if the test has no road."""
        if result.design is None:
            return None
        return made_from(result.design, cell.request.world, cell.request.setup.geometry)

    def seed(self, result: Result) -> int:
        """Returns the driver's seed in a test."""
        return seed_of_driver(result.number, result.proposal)

    def file(self, number: int) -> str:
        """Returns the empty text, because the tests in a store have no file ``test.NNNN.json``."""
        del number
        return ""

    def tests(self, cell: str = "", which: str | None = None) -> list[NumberedTest]:
        """Returns the names of tests that have ended and whose Runs can be read.

        Args:
            cell: name of the cell; empty: all cells.
            which: None: all tests, in order; "failures": those that failed; "worst": those that failed
                and then those that passed, each by increasing margin.
        """
        condition, order = WHICH[which]
        sql = (
            "SELECT tests.cell, tests.number FROM tests JOIN details USING (cell, number) "  # noqa: S608 - ours
            f"WHERE outcome IS NOT NULL AND {self.has_run} AND {condition} AND (? = '' OR tests.cell = ?) "
            f"ORDER BY {order} tests.cell, tests.number"
        )
        return [NumberedTest(*row) for row in self.query(sql, (cell, cell))]

    def check_ended(self, cell: str, number: int) -> None:
        """Raises UsageError if there is no such test, or if it has not ended."""
        found = self.query("SELECT outcome FROM tests WHERE cell = ? AND number = ?", (cell, number))
        if found and found[0][0] is not None:
            return
        if found:
            raise UsageError(f"test {number} of {cell} in {self.folder} has not ended yet")
        ((low, high),) = self.query("SELECT min(number), max(number) FROM tests WHERE cell = ?", (cell,))
        there = "it has no tests yet" if low is None else f"its tests are {low} to {high}"
        raise UsageError(f"{self.folder} holds no result of test {number} of {cell}; {there}")

    def batches(self, cell: str) -> list[Batch]:
        """Returns the batches of a cell that have been requested, in order."""
        rows = self.query("SELECT batch, first, n, left FROM batches WHERE cell = ? ORDER BY batch", (cell,))
        return [Batch(*row) for row in rows]

    def waiting(self, cell: str) -> list[tuple[int, int, Proposal]]:
        """Returns the proposed tests of a cell that have not ended: the number, batch and proposal of each,
        in order of the numbers.
        """
        rows = self.query(
            "SELECT tests.number, batch, seed, origin, design FROM tests JOIN details USING (cell, number) "
            "WHERE tests.cell = ? AND outcome IS NULL ORDER BY tests.number",
            (cell,),
        )
        with reading_store(self.path):
            return [
                (number, batch, Proposal(design_of(text), seed, origin))
                for number, batch, seed, origin, text in rows
            ]

    def spent(self) -> tuple[int, float]:
        """Returns the tokens and the USD spent on language models so far."""
        sql = "SELECT coalesce(sum(tokens), 0), coalesce(sum(cost), 0) FROM "
        tests, other = (self.query(sql + table)[0] for table in ("tests", "sittings"))
        return tests[0] + other[0], tests[1] + other[1]

    def trace_file(self, cell: str, number: int) -> str | None:
        """Returns the name of the file with the drive of a test; None if the test was not driven."""
        rows = self.query(
            "SELECT file FROM tests JOIN traces USING (trace) WHERE cell = ? AND number = ?", (cell, number)
        )
        return str(rows[0][0]) if rows else None

    def feature_names(self) -> list[str]:
        """Returns the names of all features that occur in the results, sorted."""
        return [name for (name,) in self.query("SELECT name FROM features ORDER BY name")]
