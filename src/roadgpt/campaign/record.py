"""The file of a campaign, or of a folder of runs: its tables, in SQLite, and what is read from them and
written to them.

    meta      format, plan, versions (of each driver's tests), and whether the campaign is finished
    cells     the settings of each cell; how long it has taken; why it was closed early
    batches   which tests were requested together; a batch and its tests are written in one transaction,
              so that no test is requested twice
    tests     one row per test with its short columns, so that a million tests are counted in a second;
              a test without an outcome has not ended
    details   one row per test with its long columns: design, sentences, features
    traces    the names of the files with the drives
    sittings  the sessions: when each began and was last active, and the cost of language models outside tests

``results.csv`` and ``cells.csv`` are made from the deterministic columns of ``tests`` and ``details``. The
column ``ended`` and all columns after it depend on the clock.

A store from another person or from a bad disk may contain anything: text in place of a number, a number that
is not finite, or a cell whose name is a path. When a store is opened, all tables except ``details`` are
checked; this takes a second for a million tests. The table ``details`` holds long texts, such as designs, and
each of its rows is checked when it is read.

A folder of runs is a campaign of one cell without a name, which keeps runs: each test has a folder of files,
written before its row, and read as they are. They hold its drive, so ``traces`` is empty."""

import json
import math
import sqlite3
import time
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager, suppress
from dataclasses import dataclass, replace
from functools import cache, cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self, get_args

import numpy as np
from pydantic import TypeAdapter

from roadgpt.campaign.model import Cell, GivenRoad, NumberedTest, Proposal, Result
from roadgpt.campaign.single_test import (
    OF_VERDICT,
    FinishedTest,
    OutOfAllowance,
    Task,
    execute,
    seed_of_driver,
)
from roadgpt.chat import Spent
from roadgpt.check import inspect
from roadgpt.drive import Drive
from roadgpt.errors import RoadGPTError, UsageError, command_line
from roadgpt.network import made_from
from roadgpt.reading import LARGEST, json_of
from roadgpt.road import Design, Road
from roadgpt.run import Request, Run, read_run
from roadgpt.run.atomic import refuse_links, to_bytes
from roadgpt.run.folder import keep_ground, run_folder
from roadgpt.run.model import Outcome, permissions
from roadgpt.run.versions import Versions, joined, still
from roadgpt.verdict import Verdict, judge
from roadgpt.verdict.verdict import DEPARTURES

if TYPE_CHECKING:
    from roadgpt.campaign.plan import Plan

STORE = "campaign.sqlite"
FORMAT = 1
WHICH = {
    None: ("1", ""),
    "failures": ("outcome = 'FAIL'", ""),
    "worst": ("outcome IN ('FAIL', 'PASS')", "outcome != 'FAIL', margin IS NULL, margin, max_oob DESC,"),
}
"""For each choice of tests that users can make: the SQL condition on the tests, and the SQL order."""
MEASURED = (
    "outcome", "cause", "side", "length", "margin", "max_oob", "beyond", "at_s", "own_share", "handed_to",
)  # fmt: skip
"""The columns of the table ``tests`` that hold the fields of a Result with the same names."""
SPENT = ("ended", "design_s", "drive_s", "tokens", "cost", "trace")
"""The columns of the table ``tests`` that depend on the clock or on the session."""
RESULT = ", ".join(("tests.number, batch, seed, given", *MEASURED, "origin, design, description, features"))
"""The columns of a result in the joined tables ``tests`` and ``details``."""


def design_text(design: Design | GivenRoad | None) -> str | None:
    """Returns a design, or a reference to a given road, as JSON; ``design_of`` restores the same."""
    if design is None:
        return None
    if isinstance(design, GivenRoad):
        return design.model_dump_json()
    unused = {name for name, value in design if value == () or value is False}
    unused |= {"starting_point", "theta"} if design.is_map else set()
    return design.model_dump_json(exclude_none=True, exclude=unused)


def design_of(text: str | None) -> Design | GivenRoad | None:
    """Restores a design from JSON text as returned by ``design_text``."""
    kind = GivenRoad if text is not None and text.startswith('{"sha256"') else Design
    return None if text is None else kind.model_validate_json(text)


def plain(text: str) -> str:
    """Returns text that UTF-8 can encode; other characters, as from a broken terminal, become escapes."""
    return to_bytes(text).decode()


def result_of_row(row: tuple[Any, ...]) -> Result:
    """Converts a row with the columns ``RESULT`` to a result."""
    number, batch, seed, given, *measured, origin, text, description, features = row
    values = _features_of(features)
    if not (isinstance(description, str) and isinstance(origin, str)):
        raise TypeError("a description is a text")
    design = design_of(text)
    proposal = Proposal(design if given else None, seed, origin)
    named = dict(zip(MEASURED, measured, strict=True))
    return Result(number, batch, proposal, description=description, design=design, features=values, **named)


def _features_of(text: str) -> dict[str, float]:
    """Reads features as ``Record.keep`` wrote them; raises TypeError if there is anything else."""
    values = json_of(text)
    if not isinstance(values, dict) or not all(
        isinstance(value, (int, float)) and math.isfinite(value) for value in values.values()
    ):
        raise TypeError("features are finite numbers by name")
    return values


@cache
def _cells() -> TypeAdapter[Cell]:
    return TypeAdapter(Cell)


def _text_of(cell: Cell) -> str:
    return _cells().dump_json(cell).decode()


META = ("finished", "plan", "versions")
BUSY_SECONDS = 30.0  # to wait for another process that locks the file
_checked: set[tuple[str, int]] = set()
BUSY = {
    sqlite3.SQLITE_BUSY, sqlite3.SQLITE_LOCKED, sqlite3.SQLITE_FULL, sqlite3.SQLITE_NOMEM,
    sqlite3.SQLITE_READONLY, sqlite3.SQLITE_IOERR, sqlite3.SQLITE_PERM, sqlite3.SQLITE_INTERRUPT,
}  # fmt: skip
"""SQLite's errors that do not mean that the store is damaged, such as a lock or a full disk."""


def damaged(path: Path, why: object) -> UsageError:
    """Returns the error to raise for a store with content that RoadGPT never writes."""
    reason = " ".join(str(why).split())[:160]
    return UsageError(
        f"{path} is damaged, or not as roadgpt wrote it ({reason}); "
        "start the campaign again in another folder"
    )


@contextmanager
def reading_store(path: Path) -> Iterator[None]:
    """Raises one clear error if code in a ``with`` block fails because a store's content is damaged."""
    try:
        yield
    except sqlite3.Error as error:
        if getattr(error, "sqlite_errorcode", 0) & 0xFF in BUSY:
            raise
        raise damaged(path, error) from error
    except (ValueError, TypeError, LookupError, AttributeError, OverflowError) as error:
        raise damaged(path, f"{type(error).__name__}: {error}") from error


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
CREATE TABLE sittings(begun REAL NOT NULL, seen REAL NOT NULL, workers INTEGER NOT NULL,
  is_over INTEGER NOT NULL DEFAULT 0, tokens INTEGER NOT NULL DEFAULT 0, cost REAL NOT NULL DEFAULT 0);
CREATE INDEX waiting ON tests(cell, number) WHERE outcome IS NULL;
"""


NAME = "({0} = '' OR {0} GLOB 'c[0-9]*' AND {0} NOT GLOB '*[^c0-9]*')"
OF_TYPE = {
    "TEXT": "typeof({0}) = 'text'",
    "INTEGER": "typeof({0}) = 'integer' AND {0} >= 0",
    "REAL": "typeof({0}) IN ('integer', 'real') AND abs({0}) <= 1e15",
}
"""The SQL condition that the values of the columns of each type must satisfy."""
OF_COLUMN = {
    **dict.fromkeys(("cells.name", "batches.cell"), NAME),
    "tests.cell": NAME + " AND {0} IN (SELECT name FROM cells)",  # noqa: S608 - our own words
    "tests.number": "{0} <= 10000000",
    **{f"batches.{name}": "{0} <= 10000000" for name in ("batch", "first", "n", "left")},
    "tests.batch": "{0} <= 10000000",
    "tests.outcome": "{0} IN " + str(get_args(Outcome)),
    "tests.side": "{0} IN ('left', 'right')",
    "traces.file": "{0} GLOB '[0-9]*.npz' AND {0} NOT GLOB '*[^0-9npz.]*'",
}
"""The SQL condition that the values of some columns must satisfy as well."""
CHECKED_LATER = "details"  # the table whose rows are checked when they are read


def check_store(path: Path, db: sqlite3.Connection) -> None:
    """Checks a store's tables, once per process."""
    key = (str(path.absolute()), path.stat().st_ino)
    if key in _checked:
        return
    with closing(sqlite3.connect(":memory:")) as ours:
        ours.executescript(SCHEMA)
        columns = ours.execute(
            'SELECT tables.name, columns.name, columns.type, NOT ("notnull" OR pk) '
            "FROM sqlite_master AS tables, pragma_table_info(tables.name) AS columns "
            "WHERE tables.type = 'table'"
        ).fetchall()
    rules: dict[str, dict[str, str]] = {}
    for table, name, kind, may_be_null in columns:
        rule = f"{OF_TYPE[kind]} AND {OF_COLUMN.get(f'{table}.{name}', '1')}".format(name)
        rules.setdefault(table, {})[name] = f"({f'{name} IS NULL OR ' * may_be_null}{rule})"
    with reading_store(path):
        for table, its in rules.items():
            unlike = f"SELECT {', '.join(its)} FROM {table} WHERE NOT coalesce({{}}, 0) LIMIT 1"  # noqa: S608
            every = "1" if table == CHECKED_LATER else " AND ".join(its.values())
            if db.execute(unlike.format(every)).fetchone():
                named = (name for name, rule in its.items() if db.execute(unlike.format(rule)).fetchone())
                raise damaged(path, f"{table}.{next(named, '')} holds what it cannot")
        there = {name for (name,) in db.execute("SELECT name FROM meta")}
        if not there >= {*META} or not db.execute("SELECT 1 FROM cells").fetchone():
            raise damaged(path, "it has no plan or no cells")
    _checked.add(key)


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
    left: int  # number of its tests that have not ended yet


def no_tests(folder: Path) -> UsageError:
    """Returns the error for a folder that holds neither a campaign nor runs."""
    return UsageError(
        f"there is no campaign in {folder}, and there are no runs; give a folder that roadgpt campaign or "
        "roadgpt run made"
    )


class Record:
    """The tables in a database: in the file of a campaign, or in memory (``FolderRecord``)."""

    mode = "ro"  # in which ``opened`` opens the file

    def __init__(self, path: Path, db: sqlite3.Connection) -> None:
        self.path = path
        self._db = db
        self._session = 0

    @property
    def folder(self) -> Path:
        """The campaign's folder."""
        return self.path.parent

    @classmethod
    def opened(cls, folder: Path) -> Self:
        """Opens the campaign in a folder; raises UsageError if there is no store, or it is damaged or of
        another version."""
        path = folder / STORE
        if not path.is_file():
            raise no_tests(folder)
        try:
            db = _connected(path, cls.mode)
            ((version,),) = db.execute("PRAGMA user_version")
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
            return cls(path, db)
        except BaseException:
            db.close()
            raise

    def plan(self) -> "Plan":
        """Returns the campaign's plan."""
        from roadgpt.campaign.plan import Plan

        with reading_store(self.path):
            return Plan.model_validate_json(self.meta("plan")).came_with(self.path)

    @cached_property
    def keeps_runs(self) -> bool:
        """Whether this is a folder of runs."""
        return self.names() == [""]

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
        """Returns the stored Run of a test; see ``folder_record.kept_run``. Without its drive, it has no
        verdict. Of a folder of runs, it is read from its files; raises UsageError if that cannot be done."""
        if self.keeps_runs:
            self.check_ended(cell, number)
            return read_run(run_folder(self.folder, number))
        result = self.result(cell, number)
        own = self.cell(cell).of_test(result.proposal)
        made, request = self._blueprint(own, result)
        if made is None:
            raise no_road(self.folder, cell, result)
        road = made_from(made, request.world, request.setup.geometry)
        drive = self.drive(cell, number) if has_drive else None
        is_given = isinstance(result.design, GivenRoad)
        has_findings = result.outcome == "INVALID" or is_given
        return Run(
            request,
            number,
            self.seed(result),
            outcome=result.outcome,
            description=result.description,
            brief=own.brief,
            design=made if isinstance(made, Design) else None,
            road=road,
            findings=inspect(road, own.brief, request.world, request.setup.rules) if has_findings else (),
            drive=drive,
            verdict=None if drive is None else _verdict_of(road, drive, own, result),
            source=result.proposal.origin if is_given else "",
            versions=self.versions(request.setup.driver),
        )

    def versions(self, driver: str) -> Versions:
        """Returns what decided the results of a driver's tests besides the plan, see ``run.versions``."""
        with reading_store(self.path):
            found = json_of(self.meta("versions"))  # a folder of runs has one record for all its tests
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

    def road(self, cell: Cell, result: Result) -> tuple[Road, Request] | None:
        """Returns the road of a test that has ended, and the request with its World; None without a road."""
        if self.keeps_runs:
            run = self.run(cell.name, result.number)
            return None if run.road is None else (run.road, run.request)
        made, request = self._blueprint(cell.of_test(result.proposal), result)
        return None if made is None else (made_from(made, request.world, request.setup.geometry), request)

    def _blueprint(self, cell: Cell, result: Result) -> tuple[Design | Road | None, Request]:
        if not isinstance(result.design, GivenRoad):
            return result.design, cell.request
        from roadgpt.campaign.given import content_of, source_of

        source = source_of(result.design, content_of(result.design, self.folder))
        world = cell.request.world.changed(**source.world)
        return source.blueprint, cell.request.model_copy(update={"world": world})

    def seed(self, result: Result) -> int:
        """Returns the driver's seed in a test."""
        return seed_of_driver(result.number, result.proposal)

    def tests(self, cell: str = "", which: str | None = None) -> list[NumberedTest]:
        """Returns the names of the ended tests whose Runs can be read, of one cell or (empty) of all cells:
        all of them in order, the "failures", or the "worst", which are those that failed and then those that
        passed, each by margin."""
        condition, order = WHICH[which]
        has_run = "1" if self.keeps_runs else "design IS NOT NULL"
        sql = (
            "SELECT tests.cell, tests.number FROM tests JOIN details USING (cell, number) "  # noqa: S608 - ours
            f"WHERE outcome IS NOT NULL AND {has_run} AND {condition} AND (? = '' OR tests.cell = ?) "
            f"ORDER BY {order} tests.cell, tests.number"
        )
        return [NumberedTest(*row) for row in self.query(sql, (cell, cell))]

    def check_ended(self, cell: str, number: int) -> None:
        """Raises UsageError if there is no such test, or if it has not ended."""
        found = self.query("SELECT outcome FROM tests WHERE cell = ? AND number = ?", (cell, number))
        if found and found[0][0] is not None:
            return
        test = f"test {number} of {cell}" if cell else f"run {number}"
        if found:
            raise UsageError(f"{test} in {self.folder} has not ended yet")
        ((low, high),) = self.query("SELECT min(number), max(number) FROM tests WHERE cell = ?", (cell,))
        tests = "tests" if cell else "runs"
        there = f"it has no {tests} yet" if low is None else f"its {tests} are {low} to {high}"
        raise UsageError(f"there is no {test} in {self.folder}; {there}")

    def feature_names(self) -> list[str]:
        """Returns the names of all features that occur in the results, sorted."""
        sql = "SELECT DISTINCT key FROM details, json_each(features) WHERE features IS NOT NULL ORDER BY key"
        return [name for (name,) in self.query(sql)]

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

    def _set_meta(self, name: str, value: str) -> None:
        self._change("UPDATE meta SET value = ? WHERE name = ?", value, name)

    def names(self) -> list[str]:
        """Returns the names of all cells, in the order of the plan."""
        return [name for (name,) in self.query("SELECT name FROM cells ORDER BY name")]

    def cells(self) -> list[Cell]:
        """Returns all cells, in the order of the plan."""
        rows = self.query("SELECT name, cell FROM cells ORDER BY name")
        return [self._cell(name, text) for name, text in rows]

    def _cell(self, name: str, text: str) -> Cell:
        with reading_store(self.path):
            found = _cells().validate_python(json_of(text))
            if found.name != name:
                raise ValueError(f"cell {name} calls itself {found.name[:20]}")
            return replace(found, request=found.request.came_with(self.path))

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
        ``where`` is a condition in SQL on ``tests`` and ``details``, with placeholders for ``values``."""
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
        with refusals(self.folder, self):
            self._db.execute("BEGIN IMMEDIATE")
            try:
                yield self._db
                self._db.execute("COMMIT")
            except BaseException:
                if self._db.in_transaction:
                    self._db.execute("ROLLBACK")
                raise

    def _change(self, sql: str, *values: Any) -> int:
        """Runs a statement; returns the number of the row that it adds, if it adds one."""
        with self._whole() as db:
            return db.execute(sql, values).lastrowid or 0

    def begin_session(self, workers: int) -> None:
        """Begins a session."""
        now = time.time()
        sql = "INSERT INTO sittings(begun, seen, workers) VALUES (?, ?, ?)"
        self._session = self._change(sql, now, now, workers)

    def end_session(self) -> None:
        """Ends the session."""
        self._change("UPDATE sittings SET is_over = 1 WHERE rowid = ?", self._session)

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
        self._change("UPDATE cells SET closed = ? WHERE name = ?", why, cell)

    def finish(self, is_finished: bool = True) -> None:
        """Records that the campaign is finished, or that more tests were asked for."""
        self._set_meta("finished", "yes" if is_finished else "")

    def spend(self, spent: Spent) -> None:
        """Adds what a language model used outside of finished tests, as in a test beyond its allowance."""
        sql = "UPDATE sittings SET tokens = tokens + ?, cost = cost + ? WHERE rowid = ?"
        self._change(sql, spent.usage.total, spent.cost or 0.0, self._session)

    def next_trace(self) -> int:
        """Returns the number of the next file of drives to write."""
        return int(self.query("SELECT coalesce(max(trace), 0) + 1 FROM traces")[0][0])

    def keep(
        self,
        ended: Sequence[tuple[str, FinishedTest]],
        trace: tuple[int, str] | None = None,
        seconds: Mapping[str, float] = {},
    ) -> None:
        """Stores a group of results, each with the name of its cell, in one transaction; with them the number
        and name of the file with their drives, and the seconds that each cell has worked since."""
        now = time.time()
        left = Counter((cell, one.result.batch) for cell, one in ended)
        tests, details = list[tuple[Any, ...]](), list[tuple[Any, ...]]()
        for cell, one in ended:
            its, took, spent, where = one.result, one.seconds, one.spent, (cell, one.result.number)
            measured = [getattr(its, name) for name in MEASURED]  # SQLite stores NaN as NULL
            times = now, round(took.design, 4), round(took.drive, 4)
            paid = (spent.usage.total, spent.cost) if spent else (None, None)
            tests.append((*measured, *times, *paid, trace[0] if trace and one.trace else None, *where))
            known = {
                name: float(value) for name, value in sorted(its.features.items()) if math.isfinite(value)
            }
            texts = plain(its.description), json.dumps(known), plain(one.error) or None
            details.append((design_text(its.design), *texts, *where))
        with self._whole() as db:
            if trace is not None:
                db.execute("INSERT INTO traces VALUES (?, ?)", trace)
            db.executemany(
                f"UPDATE tests SET {_set(MEASURED + SPENT, '?')} WHERE cell = ? AND number = ?",  # noqa: S608
                tests,
            )
            db.executemany(
                "UPDATE details SET design = ?, description = ?, features = ?, error = ? "
                "WHERE cell = ? AND number = ?",
                details,
            )
            db.executemany(
                "UPDATE batches SET left = left - ? WHERE cell = ? AND batch = ?",
                [(count, cell, batch) for (cell, batch), count in left.items()],
            )
            db.executemany(
                "UPDATE cells SET seconds = seconds + ? WHERE name = ?",
                [(taken, cell) for cell, taken in seconds.items()],
            )
            db.execute("UPDATE sittings SET seen = ? WHERE rowid = ?", (now, self._session))


@contextmanager
def refusals(folder: Path, store: Record | None = None) -> Iterator[None]:
    """Turns errors of SQLite or the operating system in a ``with`` block into one clear error message, which
    says how to continue the campaign in ``store``."""
    try:
        yield
    except (sqlite3.Error, OSError) as error:
        reason = (error.strerror if isinstance(error, OSError) else None) or error
        again = f"then say: {store.to_resume()}" if store else "and repeat the command"
        raise RoadGPTError(f"cannot write into {folder}: {reason}; make room there, {again}") from error


def _verdict_of(road: Road, drive: Drive, cell: Cell, result: Result) -> Verdict | None:
    """Judges the stored drive, and then replaces values of the verdict by those that the campaign stored,
    because the drive's rounded positions may give others. Returns None if the test was not judged."""
    if result.margin is None:
        return None
    step = len(drive) - 1
    if result.at_s is not None and result.cause in DEPARTURES:
        step = int(np.argmin(np.abs(drive["s"] - result.at_s)))
    world = cell.request.world.in_weather_of(drive.seed)
    judged = judge(road, drive, world, (step, result.cause))
    kept = {name: getattr(result, name) for name in ("outcome", *OF_VERDICT)}
    return replace(judged, **{name: value for name, value in kept.items() if value is not None})


def _connected(path: Path, mode: str) -> sqlite3.Connection:
    """Returns a connection to a store, to read ("ro") or also to write it ("rw"), so that what a killed
    process left is undone; raises sqlite3.Error, also if reading it would run its own words."""
    address, db = f"{path.resolve().as_uri()}?mode={mode}", None
    try:
        db = sqlite3.connect(address, BUSY_SECONDS, isolation_level=None, uri=True)
        db.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, LARGEST)
        if db.execute("SELECT 1 FROM sqlite_master WHERE type IN ('view', 'trigger')").fetchone():
            raise sqlite3.DatabaseError("it has views or triggers, which roadgpt does not make")
        db.execute("SELECT 1 FROM meta LIMIT 1").fetchone()
        return db
    except sqlite3.Error as error:
        if db is not None:
            db.close()
        log = path.with_name(f"{path.name}-wal")
        is_whole = not log.exists() or not log.stat().st_size
        is_shut = getattr(error, "sqlite_errorcode", 0) & 0xFF == sqlite3.SQLITE_CANTOPEN
        if mode == "ro" and is_whole and is_shut:
            # an interrupted campaign on a read-only disk: no process can be writing the file
            return _connected(path, "ro&immutable=1")
        raise


def no_road(folder: Path, cell: str, result: Result) -> UsageError:
    """Returns the error for a test of a folder that has no road."""
    name = NumberedTest(cell, result.number)
    return UsageError(f"test {name} in {folder} has no road: {result.description}")


class Store(Record):
    """The tables in the file of a campaign, open for writing. One process writes it; any process may read it.

    The file uses WAL and synchronous=NORMAL: committed transactions survive if the process is killed. A power
    cut may undo the last transactions, each as a whole. Their tests then count as not done and are run again
    with the same results, since a batch depends only on the results of earlier batches."""

    mode = "rw"
    group_seconds = 1.0
    """Longest time in seconds that a result waits to be stored; if the process is killed, the results of
    this time are lost."""

    run_test: Callable[..., FinishedTest | OutOfAllowance] = staticmethod(execute)
    """Runs a test on a worker."""

    @classmethod
    def new(
        cls,
        folder: Path,
        plan: str,
        cells: Sequence[Cell],
        versions: Mapping[str, Versions],
        spent: Spent | None = None,
    ) -> Self:
        """Makes a store without tests, for a plan (as JSON) and its cells. ``versions`` has what decides the
        results of each driver's tests besides, and ``spent`` what was used to read the descriptions."""
        path = folder / STORE
        draft = path.with_name(f"{path.name}.part")
        with refusals(folder):
            if cells:
                keep_ground(cells[0].request.world, folder)
            draft.unlink(missing_ok=True)
            db = sqlite3.connect(draft, isolation_level=None)
            meta = {"plan": plan, "versions": json.dumps([*versions.values()]), "finished": ""}
            db.executescript(SCHEMA)
            db.execute("BEGIN")
            db.executemany("INSERT INTO meta VALUES (?, ?)", meta.items())
            texts = [(each.name, _text_of(each)) for each in cells]
            db.executemany("INSERT INTO cells(name, cell) VALUES (?, ?)", texts)
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
        store = super().opened(folder)
        try:
            store._db.execute("PRAGMA journal_mode = WAL")
            store._db.execute("PRAGMA synchronous = NORMAL")
        except sqlite3.Error as error:
            store.close()
            raise UsageError(f"{store.path} cannot be written ({error}); name another folder") from error
        return store

    def close(self) -> None:
        """Closes the file; once the campaign is finished, the file may be copied and made read-only."""
        with suppress(sqlite3.Error, UsageError):  # somebody reads it at this moment, or it is closed
            if self.meta("finished"):
                self._db.execute("PRAGMA journal_mode = DELETE")
        super().close()

    def keep(self, ended: Sequence[tuple[str, FinishedTest]], *rest: Any) -> None:
        """Stores results; raises UsageError if a file of a driver has changed since an earlier test."""
        self.join_versions(ended)
        super().keep(ended, *rest)

    def join_versions(self, ended: Sequence[tuple[str, FinishedTest]]) -> None:
        """Adds the files that drivers have used; raises UsageError if one has changed since an earlier
        test."""
        for name, one in ended:
            driver = self.cell(name).request.setup.driver
            before = self.versions(driver)
            if before != (now := joined(before, one.driver_files, self.folder)):
                every = [now if each == driver else self.versions(each) for each in self._drivers]
                self._set_meta("versions", json.dumps(every))

    def set_plan(self, plan: str) -> None:
        """Replaces the stored plan, as JSON, by one that differs only in limits and the like."""
        self._set_meta("plan", plan)

    def set_cell(self, cell: Cell) -> None:
        """Replaces a stored cell by one that differs only in limits."""
        self._change("UPDATE cells SET cell = ? WHERE name = ?", _text_of(cell), cell.name)
