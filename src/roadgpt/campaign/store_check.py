"""Checks the tables, columns and values of a store before they are used.

A store from another person or from a bad disk may contain anything: text in place of a number, a number that
is not finite, or a cell whose name is a path. When a store is opened, all tables except ``details`` are
checked; this takes a second for a million tests. The table ``details`` holds long texts, such as designs, and
each of its rows is checked when it is read.
"""

import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from roadgpt.campaign.rows import MEASURED, SPENT
from roadgpt.errors import UsageError

TEXT = "typeof({0}) = 'text'"
WHOLE = "(typeof({0}) = 'integer' AND {0} BETWEEN 0 AND 9223372036854775807)"
COUNT = "(typeof({0}) = 'integer' AND {0} BETWEEN 0 AND 10000000)"
NUMBER = "(typeof({0}) IN ('integer', 'real') AND {0} BETWEEN -1e15 AND 1e15)"
NAME = "(typeof({0}) = 'text' AND {0} GLOB 'c[0-9]*' AND {0} NOT GLOB '*[^c0-9]*')"
FILES = "{0} GLOB '[0-9]*.npz' AND {0} NOT GLOB '*[^0-9npz.]*'"
OLD_FILES = "{0} GLOB '[0-9]*.parquet' AND {0} NOT GLOB '*[^0-9parquet.]*'"
FILE = f"(typeof({{0}}) = 'text' AND ({FILES} OR {OLD_FILES}))"
OUTCOME = "{0} IN ('PASS', 'FAIL', 'INVALID', 'ERROR', 'VALID')"
SIDE = "{0} IN ('left', 'right')"

LATER = {"beyond": "REAL", "own_share": "REAL", "handed_to": "TEXT"}
"""Columns of ``tests`` that stores of earlier versions lack, with their types."""
TABLES: dict[str, dict[str, str]] = {
    "meta": {"name": TEXT, "value": TEXT},
    "cells": {"name": NAME, "cell": TEXT, "seconds": NUMBER, "closed": f"({{0}} IS NULL OR {TEXT})"},
    "batches": dict.fromkeys(("batch", "first", "n", "left"), COUNT) | {"cell": NAME},
    "tests": {
        "cell": NAME + " AND {0} IN (SELECT name FROM cells)",  # noqa: S608 - our own words
        **dict.fromkeys(("number", "batch"), COUNT),
        **dict.fromkeys(("seed", "given"), WHOLE),
        "outcome": f"({{0}} IS NULL OR {OUTCOME})",
        "cause": f"({{0}} IS NULL OR {TEXT})",
        "side": f"({{0}} IS NULL OR {SIDE})",
        **dict.fromkeys(MEASURED[3:-1] + SPENT, f"({{0}} IS NULL OR {NUMBER})"),
        "handed_to": f"({{0}} IS NULL OR {TEXT})",
    },
    "details": dict.fromkeys(("cell", "number", "origin", "design", "description", "features", "error"), ""),
    "traces": {"trace": WHOLE, "file": FILE},
    "leases": {"cell": NAME, "number": COUNT, "worker": TEXT, "until": NUMBER},
    "sittings": dict.fromkeys(("begun", "seen", "workers", "is_over", "tokens", "cost"), NUMBER),
    "features": {"name": TEXT},
}
"""The SQL condition that the values of each column must satisfy; empty for columns that are checked when
they are read.
"""
META = ("finished", "plan", "versions")
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


def check_store(path: Path, db: sqlite3.Connection) -> None:
    """Checks a store's tables, once per process.

    Raises:
        UsageError: a table is missing, or holds values that RoadGPT never writes.
    """
    key = (str(path.absolute()), path.stat().st_ino)
    if key in _checked:
        return
    with reading_store(path):
        for table, columns in TABLES.items():
            there = {row[1] for row in db.execute(f"PRAGMA table_info({table})")}
            columns = {name: rule for name, rule in columns.items() if name not in LATER or name in there}
            db.execute(f"SELECT {', '.join(columns)} FROM {table} LIMIT 1").fetchone()  # noqa: S608 - our words
            rules = {name: rule.format(name) for name, rule in columns.items() if rule}
            if not rules:
                continue
            unlike = f"NOT coalesce({' AND '.join(rules.values())}, 0)"
            if db.execute(f"SELECT 1 FROM {table} WHERE {unlike} LIMIT 1").fetchone():  # noqa: S608
                named = (
                    name
                    for name, rule in rules.items()
                    if db.execute(f"SELECT 1 FROM {table} WHERE NOT coalesce({rule}, 0) LIMIT 1").fetchone()  # noqa: S608
                )
                raise damaged(path, f"{table}.{next(named, '')} holds what it cannot")
        there = {name for (name,) in db.execute("SELECT name FROM meta")}
        if not there >= {*META} or not db.execute("SELECT 1 FROM cells").fetchone():
            raise damaged(path, "it has no plan or no cells")
    _checked.add(key)
