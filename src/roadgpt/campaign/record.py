"""Opens the file of a campaign: for reading, even while a process works on the campaign, or for writing."""

import json
import sqlite3
import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from roadgpt.campaign.model import Cell, NumberedTest, Result
from roadgpt.campaign.rows import cell_text
from roadgpt.campaign.single_test import FinishedTest, seed_of_driver
from roadgpt.campaign.store_check import LATER, check_store, reading_store
from roadgpt.campaign.store_tables import SCHEMA, Tables, refusals
from roadgpt.chat import Spent
from roadgpt.drive import Drive
from roadgpt.errors import UsageError
from roadgpt.network import made_from
from roadgpt.reading import json_of
from roadgpt.road import Road
from roadgpt.run import Run
from roadgpt.run.atomic import refuse_links
from roadgpt.run.versions import Versions, joined, still

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
    address = f"{path.resolve().as_uri()}?mode={mode}"
    db = sqlite3.connect(address, timeout=PATIENCE, isolation_level=None, uri=True)
    try:
        version = db.execute("PRAGMA user_version").fetchone()[0]
        db.execute("SELECT count(*) FROM meta").fetchone()
    except sqlite3.Error:
        db.close()
        raise
    return db, version


def no_tests(folder: Path) -> UsageError:
    """Returns the error for a folder that holds neither a campaign nor runs."""
    return UsageError(
        f"there is no campaign in {folder}, and there are no runs; give a folder that roadgpt campaign or "
        "roadgpt run made"
    )


class Record(Tables):
    """The tables in the file of a campaign, open for reading."""

    has_run = "design IS NOT NULL"
    """The SQL condition that selects the tests whose Runs the method ``run`` can return."""
    missing: tuple[str, ...] = ()
    """Columns of ``tests`` that this store lacks; they read as empty."""

    @classmethod
    def opened(cls, folder: Path) -> Self:
        """Opens the campaign in a folder; raises UsageError if there is no store, or it is damaged or of
        another version."""
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
            there = {row[1] for row in db.execute("PRAGMA table_info(tests)")}
            record.missing = tuple(name for name in LATER if name not in there)
        except BaseException:
            db.close()
            raise
        if record.missing and mode == "ro":
            empty = ", ".join(f"NULL AS {name}" for name in record.missing)
            db.execute(f"CREATE TEMP VIEW tests AS SELECT *, {empty} FROM main.tests")  # noqa: S608 - ours
        return record

    def plan(self) -> "Plan":
        """Returns the campaign's plan."""
        from roadgpt.campaign.plan import Plan

        with reading_store(self.path):
            return Plan.model_validate_json(self.meta("plan")).came_with(self.path)

    def total(self) -> int | None:
        """Returns the number of tests that the plan requests; None if it has only a time limit."""
        tests = self.plan().budget.tests
        return tests and tests * len(self.names())

    def result(self, cell: str, number: int) -> Result:
        """Returns the result of one test; raises UsageError if there is none."""
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
        return stored_run(own, result, road, drive, self.versions(own.request.setup.driver))

    def versions(self, driver: str) -> Versions:
        """Returns what decided the results of a driver's tests besides the plan, see ``run.versions``."""
        with reading_store(self.path):
            found = json_of(self.meta("versions"))  # earlier versions stored one record, for all drivers
            its = found if isinstance(found, dict) else found[self._drivers.index(driver)]
            return {str(name): str(value) for name, value in its.items()}

    @cached_property
    def _drivers(self) -> tuple[str, ...]:
        return self.plan().drivers

    def refuse_changed(self, now: Mapping[str, Versions]) -> None:
        """Raises UsageError if what decides the results of a driver's tests is not what it was."""
        for driver, versions in now.items():
            still(self.versions(driver), versions, driver, self.folder)

    def drive(self, cell: str, number: int) -> Drive | None:
        """Returns the stored drive of a test; None if the test was not driven."""
        from roadgpt.campaign.traces import TRACES, read_traces

        rows = self.query(
            "SELECT file FROM tests JOIN traces USING (trace) WHERE cell = ? AND number = ?", (cell, number)
        )
        return read_traces(self.folder / TRACES / str(rows[0][0]), cell, number) if rows else None

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
        """Returns the names of the ended tests whose Runs can be read, of one cell or (empty) of all cells.

        ``which`` is None for all tests, in order; "failures" for those that failed; "worst" for those that
        failed and then those that passed, each by increasing margin.
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

    def feature_names(self) -> list[str]:
        """Returns the names of all features that occur in the results, sorted."""
        return [name for (name,) in self.query("SELECT name FROM features ORDER BY name")]


class Store(Record):
    """The tables in the file of a campaign, open for writing. One process writes it; any process may read it.

    The file uses WAL and synchronous=NORMAL: committed transactions survive if the process is killed. A power
    cut may undo the last transactions, each as a whole. Their tests then count as not done and are run again
    with the same results, since a batch depends only on the results of earlier batches.
    """

    @classmethod
    def new(
        cls,
        folder: Path,
        plan: str,
        cells: Sequence[Cell],
        versions: Mapping[str, Versions],
        spent: Spent | None = None,
    ) -> Self:
        """Makes a store without tests.

        Args:
            folder: the campaign's folder.
            plan: the campaign's plan as JSON.
            cells: the cells of the plan.
            versions: what decides the results of each driver's tests besides the plan.
            spent: what a language model used to read the descriptions.

        Raises:
            RoadGPTError: the file cannot be written.
        """
        path = folder / STORE
        draft = path.with_name(f"{path.name}.part")
        with refusals(folder):
            draft.unlink(missing_ok=True)
            db = sqlite3.connect(draft, isolation_level=None)
            meta = {"plan": plan, "versions": json.dumps([*versions.values()]), "finished": ""}
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
        """Opens the store in a folder for writing; raises UsageError, see ``Record.opened``."""
        refuse_links(folder / STORE)
        store = cls._opened(folder, "rw")
        try:
            for name in store.missing:  # an older version made this store
                store._db.execute(f"ALTER TABLE tests ADD COLUMN {name} {LATER[name]}")
            store._db.execute("PRAGMA journal_mode = WAL")
            store._db.execute("PRAGMA synchronous = NORMAL")
        except sqlite3.Error as error:
            store.close()
            raise UsageError(f"{store.path} cannot be written ({error}); name another folder") from error
        store._features = {*store.feature_names()}
        return store

    def close(self) -> None:
        """Closes the file; once the campaign is finished, the file may be copied and made read-only."""
        with suppress(sqlite3.Error):  # somebody reads it at this moment
            if self.meta("finished"):
                self._db.execute("PRAGMA journal_mode = DELETE")
        super().close()

    def keep(self, ended: Sequence[tuple[str, FinishedTest]], *rest: Any) -> None:
        """Stores results; raises UsageError if a file of a driver has changed since an earlier test."""
        for name, one in ended:
            driver = self.cell(name).request.setup.driver
            before = self.versions(driver)
            if before != (now := joined(before, one.driver_files, self.folder)):
                every = [now if each == driver else self.versions(each) for each in self._drivers]
                with self._whole() as db:
                    db.execute("UPDATE meta SET value = ? WHERE name = 'versions'", (json.dumps(every),))
        super().keep(ended, *rest)

    def set_plan(self, plan: str) -> None:
        """Replaces the stored plan, as JSON, by one that differs only in limits and the like."""
        with self._whole() as db:
            db.execute("UPDATE meta SET value = ? WHERE name = 'plan'", (plan,))
