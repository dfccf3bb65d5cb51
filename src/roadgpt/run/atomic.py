"""Writes files and folders so that they are either complete or absent, even if the process is killed."""

import csv
import io
import json
import math
import os
import re
import shutil
from collections.abc import Iterable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from itertools import count
from pathlib import Path
from typing import Any

from roadgpt.errors import RoadGPTError, UsageError, explained

try:
    import fcntl
except ImportError:  # Windows has no such locks; folders are then not locked
    fcntl = None  # type: ignore[assignment]

LOCK = "campaign.lock"
PART = ".part"  # end of the names of unfinished files and folders
BEFORE = "before-"  # beginning of the names of folders with what was set aside
FORMULA = re.compile(r"[=@]|[+-].*[(|!]")
LETTERS = "backslashreplace"  # characters that UTF-8 cannot encode are written as escapes


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """Yields the path of a temporary file in the same folder; renames that file to ``path`` when the block
    succeeds, and removes it otherwise."""
    draft = path.with_name(f"{path.name}.{os.getpid()}{PART}")
    try:
        draft.unlink(missing_ok=True)  # if it were a link, writing would change the file it points to
        yield draft
        draft.replace(path)
    except BaseException:
        draft.unlink(missing_ok=True)
        raise


def write_whole(path: Path, content: str | bytes, is_private: bool = False) -> None:
    """Writes a file completely or not at all. If ``is_private``, only the owner can read the file."""
    with whole_file(path) as draft:
        if is_private:
            draft.touch(0o600, exist_ok=False)
        draft.write_bytes(to_bytes(content) if isinstance(content, str) else content)


def write_lines(path: Path, lines: Iterable[str]) -> None:
    """Writes a long text file line by line, completely or not at all, as UTF-8."""
    with whole_file(path) as draft, draft.open("w", encoding="utf-8", errors=LETTERS, newline="") as file:
        file.writelines(lines)


def refuse_links(*paths: Path) -> None:
    """Raises UsageError for links: in a folder from somebody else, one may point to any file, which writing
    would change."""
    for path in paths:
        if path.is_symlink() or (path.exists() and not (path.is_file() or path.is_dir())):
            what = "a link to somewhere else" if path.is_symlink() else "a pipe or a device"
            raise UsageError(
                f"{path} is {what}, and nothing is written there; remove it, or use another folder"
            )


def remove_numbered(folder: Path) -> None:
    """Removes an earlier call's files of a folder that are named by a number, such as ``3.png``."""
    refuse_links(folder)
    with explained(RoadGPTError, f"cannot write into {folder}", "make room there"):
        for path in folder.glob("[0-9]*.*"):
            if path.name.partition(".")[0].isdigit() and not path.is_dir():
                path.unlink()


@contextmanager
def alone_in(folder: Path) -> Iterator[None]:
    """Locks a folder for this process inside a ``with`` block, and creates the folder if it does not exist.

    The system releases the lock if the process is killed. Its file stays: another process that had just
    opened it would hold a lock on a deleted file, and Windows cannot delete open files."""
    with ExitStack() as stack:
        try:
            folder.mkdir(parents=True, exist_ok=True)
            refuse_links(folder / LOCK)
            file = stack.enter_context((folder / LOCK).open("a"))
            if fcntl is not None:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise UsageError(
                f"another process is at work in {folder}; wait for it or name another folder"
            ) from error
        except OSError as error:
            raise UsageError(f"cannot use {folder}: {error.strerror}; name another folder") from error
        yield


@contextmanager
def whole_folder(path: Path) -> Iterator[Path]:
    """Yields a temporary folder; renames it to ``path`` when the block succeeds, and removes it otherwise."""
    draft = path.with_name(f"{path.name}.{os.getpid()}{PART}")
    draft.mkdir(parents=True)
    try:
        yield draft
        if path.exists():
            shutil.rmtree(path)
        draft.replace(path)
    except BaseException:
        shutil.rmtree(draft, ignore_errors=True)
        raise


def missing(folder: Path) -> tuple[Path, ...]:
    """Returns the folders that must be created so that ``folder`` exists, the innermost first."""
    return tuple(path for path in (folder, *folder.parents) if not path.exists())


def is_new(folder: Path, card: str) -> bool:
    """Returns whether a folder holds nothing but results that were set aside, and drafts of its ``card``."""
    names = (path.name for path in folder.iterdir())
    return all(name == LOCK or name.startswith((BEFORE, f"{card}.")) for name in names)


def set_aside(folder: Path, card: str) -> None:
    """Moves everything in a folder with the file ``card`` into its new subfolder ``before-1`` (or 2, ...),
    the card last; leaves any other folder alone, since RoadGPT did not make it. Raises UsageError."""
    if (folder / card).is_file():
        with alone_in(folder), explained(UsageError, f"cannot empty {folder}", "name another folder"):
            place = next(at for n in count(1) if not (at := folder / f"{BEFORE}{n}").exists())
            place.mkdir()
            for path in sorted(folder.iterdir(), key=lambda path: path.name == card):
                if path.name != LOCK and not path.name.startswith(BEFORE):
                    path.replace(place / path.name)


def take_away(files: Iterable[Path], folders: Iterable[Path]) -> None:
    """Removes the files, and then the given folders that are empty; skips files that are in use."""
    for path in files:
        with suppress(OSError):  # Windows removes no file that is open
            path.unlink()
    for folder in folders:
        with suppress(OSError):  # something else lies in it
            folder.rmdir()


def sweep(folder: Path) -> None:
    """Removes unfinished files and folders that a killed process left in a folder."""
    for path in folder.glob(f"*{PART}"):
        if path.is_dir():
            shutil.rmtree(path)
        else:
            path.unlink()


def to_bytes(text: str) -> bytes:
    """Returns text as UTF-8; characters that UTF-8 cannot encode become backslash escapes."""
    return text.encode("utf-8", LETTERS)


def csv_text(head: Iterable[Any], rows: Iterable[Iterable[Any]]) -> str:
    """Returns a table as CSV with a line of column names; None gives an empty field. Texts of others that a
    spreadsheet would compute begin with an apostrophe."""
    text, table = io.StringIO(), [head, *rows]
    safe = ([f"'{v}" if isinstance(v, str) and FORMULA.match(v) else v for v in row] for row in table)
    csv.writer(text, lineterminator="\n").writerows(safe)
    return text.getvalue()


def json_text(value: Any, indent: int | None = 1) -> str:
    """Returns strictly valid JSON: numbers that are not finite become null."""
    try:
        return json.dumps(value, indent=indent, allow_nan=False, ensure_ascii=False) + "\n"
    except ValueError:
        return json.dumps(_finite(value), indent=indent, allow_nan=False, ensure_ascii=False) + "\n"


def _finite(value: Any) -> Any:
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_finite(item) for item in value]
    return value
