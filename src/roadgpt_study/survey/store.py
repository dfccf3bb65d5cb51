"""Stores the answers to a survey in one SQLite file. An answer is confirmed after it is on the disk.

The tables are:
raters   the SHA-256 digest of each rater's token (the token itself is not stored), the rater's state, the
         day on which the rater agreed to take part, and whether the rater joined by the shared link
doors    the token of the shared link, if the survey has one
answers  rater, question and value of each answer
"""

import hashlib
import hmac
import os
import secrets
import sqlite3
import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Literal

from roadgpt.errors import RoadGPTError

ANSWERS = "answers.sqlite"
TOKEN_BYTES = 24
MOST_RATERS = 10_000
State = Literal["invited", "agreed", "withdrawn"]
TABLES = """
CREATE TABLE IF NOT EXISTS raters (
    digest TEXT PRIMARY KEY, state TEXT NOT NULL DEFAULT 'invited', agreed_on TEXT, joined INTEGER NOT NULL
) WITHOUT ROWID;
CREATE TABLE IF NOT EXISTS doors (token TEXT NOT NULL);
CREATE TABLE IF NOT EXISTS answers (
    rater TEXT NOT NULL REFERENCES raters (digest), question TEXT NOT NULL, value TEXT NOT NULL,
    PRIMARY KEY (rater, question)
) WITHOUT ROWID;
"""


@dataclass(frozen=True)
class Rater:
    """An invited person, who is identified only by the digest of a random token."""

    digest: str
    state: State
    agreed_on: str | None = None
    """The day on which the rater agreed, such as 2026-01-31; None if the rater has not agreed."""


NOBODY = Rater("0" * 64, "invited")


def _private(path: Path) -> None:
    """Lets only the owner read and write the file and its logs; new logs inherit the file's permissions."""
    os.close(os.open(path, os.O_RDWR | os.O_CREAT | getattr(os, "O_NONBLOCK", 0), 0o600))
    for each in (path, *(path.with_name(path.name + end) for end in ("-wal", "-shm"))):
        if each.exists():
            each.chmod(0o600)


class AnswerStore:
    """The file of answers. Several threads and several processes may use it at the same time."""

    def __init__(self, path: Path | str) -> None:
        self._lock = threading.Lock()
        try:
            _private(Path(path))
            self._file = sqlite3.connect(path, timeout=30, isolation_level=None, check_same_thread=False)
            # FULL: every commit waits for the disk; secure_delete: deleted answers are overwritten
            for pragma in ("journal_mode=WAL", "synchronous=FULL", "secure_delete=ON", "foreign_keys=ON"):
                self._file.execute(f"PRAGMA {pragma}")
            self._file.executescript(TABLES)
        except (sqlite3.Error, OSError) as error:
            raise RoadGPTError(
                f"the answers in {path} cannot be opened ({error}); look at the file"
            ) from error

    def close(self) -> None:
        """Closes the file."""
        with self._lock:
            self._file.close()

    def add_rater(self, joined: bool = False, token: str = "") -> str:
        """Adds a rater and returns the rater's token, which is not stored; some ``joined`` by the shared
        link."""
        token = token or new_token()
        with self._writing() as file:
            file.execute("INSERT INTO raters (digest, joined) VALUES (?, ?)", (digest_of(token), joined))
        return token

    def rater_of(self, token: str) -> Rater | None:
        """Returns the rater of a token, or None; this takes equally long for every token."""
        digest = digest_of(token)
        found = self._read("SELECT digest, state, agreed_on FROM raters WHERE digest = ?", digest)
        rater = Rater(*found[0]) if found else NOBODY
        return rater if hmac.compare_digest(rater.digest, digest) else None

    def shared(self) -> str:
        """Returns the token of the shared link, which the first call makes."""
        with self._writing() as file:
            row = file.execute("SELECT token FROM doors").fetchone()
            token = str(row[0]) if row else new_token()
            if not row:
                file.execute("INSERT INTO doors VALUES (?)", (token,))
        return token

    def links(self) -> int:
        """Returns the number of raters who have a personal link."""
        return int(self._read("SELECT count(*) FROM raters WHERE NOT joined")[0][0])

    def raters(self) -> list[Rater]:
        """Returns all raters, including those who joined by the shared link and those who withdrew."""
        rows = self._read("SELECT digest, state, agreed_on FROM raters ORDER BY digest")
        return [Rater(*row) for row in rows]

    def agree(self, rater: Rater) -> None:
        """Records that a rater agrees to take part; does nothing if the rater agreed before or withdrew."""
        with self._writing() as file:
            file.execute(
                "UPDATE raters SET state = 'agreed', agreed_on = ? WHERE digest = ? AND state = 'invited'",
                (datetime.now(UTC).date().isoformat(), rater.digest),
            )

    def save(self, rater: Rater, answers: Mapping[str, str]) -> bool:
        """Saves a rater's answers by question, all or none; an empty one deletes an earlier one. Returns
        False if the rater has not agreed or has withdrawn."""
        with self._writing() as file:
            state = file.execute("SELECT state FROM raters WHERE digest = ?", (rater.digest,)).fetchone()
            if state != ("agreed",):
                return False
            rows = [(rater.digest, question, value) for question, value in answers.items()]
            file.executemany("INSERT OR REPLACE INTO answers VALUES (?, ?, ?)", rows)
            file.execute("DELETE FROM answers WHERE rater = ? AND value = ''", (rater.digest,))
        return True

    def answers_of(self, rater: Rater) -> dict[str, str]:
        """Returns a rater's answers by question."""
        return dict(self._read("SELECT question, value FROM answers WHERE rater = ?", rater.digest))

    def withdraw(self, rater: Rater) -> None:
        """Deletes all answers of a rater: their bytes in the file and in its journal are overwritten."""
        with self._writing() as file:
            file.execute("DELETE FROM answers WHERE rater = ?", (rater.digest,))
            file.execute(
                "UPDATE raters SET state = 'withdrawn', agreed_on = NULL WHERE digest = ?", (rater.digest,)
            )
        self._read("PRAGMA wal_checkpoint(TRUNCATE)")

    def _read(self, query: str, *values: str) -> list[Any]:
        with self._lock:
            return self._file.execute(query, values).fetchall()

    @contextmanager
    def _writing(self) -> Iterator[sqlite3.Connection]:
        with self._lock, self._file:  # which commits, or rolls back after an error
            self._file.execute("BEGIN IMMEDIATE")
            yield self._file


def new_token() -> str:
    """Returns a random token of characters that are allowed in URLs."""
    return secrets.token_urlsafe(TOKEN_BYTES)


def code_of(digest: str) -> str:
    """Returns a short name; two of 10,000 raters share one with a probability below one in five million."""
    return digest[:12]


def digest_of(token: str) -> str:
    """Returns the SHA-256 digest of a token as hexadecimal text."""
    return hashlib.sha256(token.encode("utf-8", "surrogatepass")).hexdigest()
