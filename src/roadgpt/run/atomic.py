"""Files and folders that are there whole or not at all, whenever the process is killed."""

import json
import math
import os
import shutil
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from roadgpt.errors import UsageError

try:
    import fcntl
except ImportError:  # Windows has no such locks, and does without
    fcntl = None  # type: ignore[assignment]

PART = ".part"  # end of the name of what is not yet whole


def write_whole(path: Path, content: str | bytes, is_private: bool = False) -> None:
    """Write a file beside its place and then move it there; a private one is for its owner alone."""
    data = to_bytes(content) if isinstance(content, str) else content
    draft = path.with_name(f"{path.name}.{os.getpid()}{PART}")
    try:
        draft.unlink(missing_ok=True)  # were it a link, it would be written through
        if is_private:
            draft.touch(0o600, exist_ok=False)
        draft.write_bytes(data)
        draft.replace(path)
    except BaseException:
        draft.unlink(missing_ok=True)
        raise


def refuse_links(*paths: Path) -> None:
    """Within a folder that may be somebody else's nothing is written through a link to elsewhere.

    Raises:
        UsageError: one of these is a link, or neither a file nor a folder.
    """
    for path in paths:
        if path.is_symlink() or (path.exists() and not (path.is_file() or path.is_dir())):
            what = "a link to somewhere else" if path.is_symlink() else "a pipe or a device"
            raise UsageError(
                f"{path} is {what}, and nothing is written there; remove it, or use another folder"
            )


@contextmanager
def held(path: Path) -> Iterator[None]:
    """Hold a lock file while the block runs; a process that is killed lets go of it.

    The file stays: were it removed, a process that had just opened it would hold a lock that nobody sees, and
    Windows removes no file that is open.

    Raises:
        BlockingIOError: another process holds it.
        UsageError: it is no file.
    """
    refuse_links(path)
    with path.open("a") as file:
        if fcntl is not None:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        yield


@contextmanager
def whole_folder(path: Path) -> Iterator[Path]:
    """A folder to fill; it takes its name when the block ends well, and vanishes when it does not."""
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
    """The folder and those around it that do not exist, the innermost first."""
    return tuple(path for path in (folder, *folder.parents) if not path.exists())


def take_away(files: Iterable[Path], folders: Iterable[Path]) -> None:
    """Remove files, then folders in which nothing else lies."""
    for path in files:
        with suppress(OSError):  # Windows removes no file that is open
            path.unlink()
    for folder in folders:
        with suppress(OSError):  # something else lies in it
            folder.rmdir()


def sweep(folder: Path) -> None:
    """Remove what a killed process left unfinished in a folder."""
    for path in folder.glob(f"*{PART}"):
        if path.is_dir():
            shutil.rmtree(path)
        else:
            path.unlink()


def to_bytes(text: str) -> bytes:
    """As UTF-8; what a broken terminal put into words is written as an escape, which JSON reads back."""
    return text.encode("utf-8", "backslashreplace")


def json_text(value: Any, indent: int | None = 1) -> str:
    """JSON that every reader takes: numbers that are not finite become null."""
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
