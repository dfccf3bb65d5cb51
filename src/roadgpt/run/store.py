"""The record of a folder of runs, ``runs.sqlite``: one row for each test that has ended.

A row has the files of the test's Run but its pictures, and its ``test.NNNN.json``. A test has ended when its
row is there. Its folder, its file and the tables are made from the row, and can be made again."""

import io
import os
import sqlite3
import zipfile
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

from roadgpt.errors import RoadGPTError, UsageError
from roadgpt.reading import LARGEST, check_unpacked, read_bytes
from roadgpt.run.atomic import PART, refuse_links

STORE = "runs.sqlite"
PATIENCE = 30.0  # s to wait for another process that locks the file
TEST = "test.json"  # the name of test.NNNN.json in a row
KEPT = (
    *("brief.json", "design.json", "road.json", "verdict.json", "run.json", "seconds.json"),
    *("error.txt", "drive.npz"),
)
"""The files of a Run's folder that a row holds."""
MOST = 10_000_000  # the largest number of a test


def is_kept(campaign: Path) -> bool:
    """Returns whether a folder has a record of its tests; if not, its files are all that is known of them."""
    return (campaign / STORE).is_file()


def numbers(campaign: Path) -> list[int]:
    """Returns the numbers of the tests that have ended, in ascending order."""
    with _opened(campaign) as db:
        found = db.execute("SELECT number FROM runs WHERE number BETWEEN 0 AND ? ORDER BY number", (MOST,))
        return [number for (number,) in found]


def keep(campaign: Path, number: int, folder: Path, test: str) -> None:
    """Stores a test that has ended: the files in the ``folder`` of its Run, and the text of its
    ``test.NNNN.json``. Raises RoadGPTError if nothing can be written."""
    packed = io.BytesIO()
    there = [name for name in KEPT if (folder / name).is_file()]
    files = {name: read_bytes(folder / name, LARGEST) for name in there} | {TEST: test.encode()}
    with zipfile.ZipFile(packed, "w") as archive:
        for name, content in files.items():
            archive.writestr(zipfile.ZipInfo(name), content, zipfile.ZIP_DEFLATED)
    with _opened(campaign, is_written=True) as db:
        db.execute("INSERT OR REPLACE INTO runs VALUES (?, ?)", (number, packed.getvalue()))


def remove(campaign: Path, number: int) -> None:
    """Removes a test, which then counts as not ended."""
    with _opened(campaign, is_written=True) as db:
        db.execute("DELETE FROM runs WHERE number = ?", (number,))


def files_of(campaign: Path, number: int) -> dict[str, bytes]:
    """Returns the files of a test by name; raises UsageError if there is no such test, or it is damaged."""
    with _opened(campaign) as db:
        row = db.execute("SELECT files FROM runs WHERE number = ?", (number,)).fetchone()
    if row is None:
        raise UsageError(f"there is no run {number} in {campaign}")
    try:
        with zipfile.ZipFile(io.BytesIO(row[0])) as archive:
            check_unpacked(archive.infolist(), LARGEST)
            return {name: archive.read(name) for name in archive.namelist() if name in (*KEPT, TEST)}
    except Exception as error:  # zipfile and its decoders raise anything
        raise UsageError(f"{campaign / STORE} is damaged at run {number} ({error})") from error


def _make(campaign: Path) -> None:
    """Makes a record without tests; it is complete or absent, even if the process is killed."""
    draft = campaign / f"{STORE}{PART}"
    draft.unlink(missing_ok=True)
    with closing(sqlite3.connect(draft, isolation_level=None)) as db:
        db.execute("CREATE TABLE runs(number INTEGER PRIMARY KEY, files BLOB NOT NULL)")
    draft.replace(campaign / STORE)


@contextmanager
def _opened(campaign: Path, is_written: bool = False) -> Iterator[sqlite3.Connection]:
    path = campaign / STORE
    refuse_links(path)
    try:
        if is_written and not path.exists():
            _make(campaign)
        is_free = os.access(path, os.W_OK) and os.access(path.parent, os.W_OK)
        with closing(connected(path, "rw" if is_free else "ro", "runs")) as db:
            yield db
    except sqlite3.Error as error:
        if not is_written:
            raise UsageError(
                f"{path} cannot be read ({error}); remove it, and the files of the runs beside it are read"
            ) from error
        raise RoadGPTError(
            f"cannot write into {campaign}: {error}; make room there and continue with the same command and "
            "--out"
        ) from error


def connected(path: Path, mode: str, table: str) -> sqlite3.Connection:
    """Returns a connection to a database that has a table, to read ("ro") or also to write it ("rw"), so that
    what a killed process left is undone; raises sqlite3.Error, also if reading it would run its own words."""
    address, db = f"{path.resolve().as_uri()}?mode={mode}", None
    try:
        db = sqlite3.connect(address, PATIENCE, isolation_level=None, uri=True)
        db.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, LARGEST)
        if db.execute("SELECT 1 FROM sqlite_master WHERE type IN ('view', 'trigger')").fetchone():
            raise sqlite3.DatabaseError("it has views or triggers, which roadgpt does not make")
        db.execute(f"SELECT 1 FROM {table} LIMIT 1").fetchone()  # noqa: S608 - our own words
        return db
    except sqlite3.Error as error:
        if db is not None:
            db.close()
        log = path.with_name(f"{path.name}-wal")
        is_whole = not log.exists() or not log.stat().st_size
        is_shut = getattr(error, "sqlite_errorcode", 0) & 0xFF == sqlite3.SQLITE_CANTOPEN
        if mode == "ro" and is_whole and is_shut:
            # an interrupted campaign on a read-only disk: no process can be writing the file
            return connected(path, "ro&immutable=1", table)
        raise
