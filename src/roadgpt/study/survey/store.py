"""Stores the answers of a survey in one SQLite file. A confirmed answer is on the disk, even after a crash.

raters   digest (SHA-256 of the token: the token itself is not kept here), state, day on which they agreed,
         whether they joined by the shared link
doors    the token of the shared link, where the survey is open
answers  rater, question, value
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
    """An invited person, known only by the digest of their token."""

    digest: str
    state: State
    agreed_on: str | None = None
    """The day on which they agreed, as 2026-01-31."""

    @property
    def code(self) -> str:
        """Their name in tables."""
        return code_of(self.digest)


NOBODY = Rater("0" * 64, "invited")


def _private(path: Path) -> None:
    """Lets only the owner read and write the file and its logs; new logs inherit the file's permissions."""
    os.close(os.open(path, os.O_RDWR | os.O_CREAT | getattr(os, "O_NONBLOCK", 0), 0o600))
    for each in (path, *(path.with_name(path.name + end) for end in ("-wal", "-shm"))):
        if each.exists():
            each.chmod(0o600)


class AnswerStore:
    """The file of answers. Several threads and several processes may use it at once."""

    def __init__(self, path: Path | str) -> None:
        self._lock = threading.Lock()
        try:
            _private(Path(path))
            self._file = sqlite3.connect(path, timeout=30, isolation_level=None, check_same_thread=False)
            # FULL waits for the disk at every commit; deleted answers are overwritten and not only let go
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
        """Adds a rater and returns their token, which is not stored."""
        token = token or new_token()
        with self._writing() as file:
            file.execute("INSERT INTO raters (digest, joined) VALUES (?, ?)", (digest_of(token), joined))
        return token

    def rater_of(self, token: str) -> Rater | None:
        """Returns the rater of a token; None if there is none. Unknown tokens all take the same time."""
        digest = digest_of(token)
        found = self._read("SELECT digest, state, agreed_on FROM raters WHERE digest = ?", digest)
        rater = Rater(*found[0]) if found else NOBODY
        return rater if hmac.compare_digest(rater.digest, digest) else None

    def shared(self) -> str:
        """Returns the token of the shared link, which stays the same."""
        with self._writing() as file:
            row = file.execute("SELECT token FROM doors").fetchone()
            token = str(row[0]) if row else new_token()
            if not row:
                file.execute("INSERT INTO doors VALUES (?)", (token,))
        return token

    def links(self) -> int:
        """Returns the number of raters with a link of their own."""
        return int(self._read("SELECT count(*) FROM raters WHERE NOT joined")[0][0])

    def raters(self) -> list[Rater]:
        """Returns all invited raters."""
        rows = self._read("SELECT digest, state, agreed_on FROM raters ORDER BY digest")
        return [Rater(*row) for row in rows]

    def agree(self, rater: Rater) -> None:
        """Records that a rater agrees today; no effect for one who withdrew."""
        with self._writing() as file:
            file.execute(
                "UPDATE raters SET state = 'agreed', agreed_on = ? WHERE digest = ? AND state = 'invited'",
                (datetime.now(UTC).date().isoformat(), rater.digest),
            )

    def save(self, rater: Rater, answers: Mapping[str, str]) -> bool:
        """Saves all answers or none; an empty one deletes an earlier one. They are on disk when this returns.

        Returns:
            Whether they were saved. Answers of a rater who has not agreed, or who withdrew, are not.
        """
        with self._writing() as file:
            state = file.execute("SELECT state FROM raters WHERE digest = ?", (rater.digest,)).fetchone()
            if state != ("agreed",):
                return False
            rows = [(rater.digest, question, value) for question, value in answers.items()]
            file.executemany("INSERT OR REPLACE INTO answers VALUES (?, ?, ?)", rows)
            file.execute("DELETE FROM answers WHERE rater = ? AND value = ''", (rater.digest,))
        return True

    def answers_of(self, rater: Rater) -> dict[str, str]:
        """Returns a rater's answers, by question."""
        return dict(self._read("SELECT question, value FROM answers WHERE rater = ?", rater.digest))

    def withdraw(self, rater: Rater) -> None:
        """Deletes all answers of a rater for good: their bytes are overwritten in file and journal."""
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
        with self._lock:
            self._file.execute("BEGIN IMMEDIATE")
            try:
                yield self._file
                self._file.execute("COMMIT")
            except BaseException:
                if self._file.in_transaction:
                    self._file.execute("ROLLBACK")
                raise


def new_token() -> str:
    """Returns a random token of characters that are allowed in addresses."""
    return secrets.token_urlsafe(TOKEN_BYTES)


def code_of(digest: str) -> str:
    """Returns a short name; two of 10,000 raters share one in one of five million surveys."""
    return digest[:12]


def digest_of(token: str) -> str:
    """Returns the SHA-256 of a token, hexadecimal."""
    return hashlib.sha256(token.encode("utf-8", "surrogatepass")).hexdigest()
