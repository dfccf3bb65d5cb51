"""Reads files that may be somebody else's: regular ones alone, whole, and no larger than their kind is.

A pipe that nobody writes into is waited for without end, and a device has no end: both are refused, and so is
what is too large, before it fills the memory. Files that a campaign or a run wrote are read like this, too.
"""

import json
import os
import stat
from pathlib import Path
from typing import Any, BinaryIO

from roadgpt.errors import UsageError

LARGEST = 50_000_000  # bytes, of files of which nothing else is said
NO_WAITING = getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0) | getattr(os, "O_CLOEXEC", 0)


def opened(path: Path, most: int = LARGEST, what: str = "a file of this kind") -> BinaryIO:
    """A regular file of at most so many bytes, open for reading from its beginning.

    Args:
        path: where it is; a link to such a file will do.
        most: bytes that it may have.
        what: what it should be, for the sentence that says that it is too large.

    Raises:
        OSError: it is not there, or may not be read.
        UsageError: it is something else than a file, or larger.
    """
    number = os.open(path, os.O_RDONLY | NO_WAITING)
    try:
        found = os.fstat(number)
        if stat.S_ISDIR(found.st_mode):
            raise IsADirectoryError(21, os.strerror(21), str(path))
        if not stat.S_ISREG(found.st_mode):
            raise UsageError(
                f"{path} is a pipe or a device and no file; write what it gives into a file first"
            )
        if found.st_size > most:
            raise too_large(path, most, what)
        return os.fdopen(number, "rb")
    except BaseException:
        os.close(number)
        raise


def too_large(path: Path, most: int, what: str) -> UsageError:
    """What to say of a file that has more bytes than it may have."""
    size = f"{most / 1e6:g} MB" if most >= 100_000 else f"{most:,} bytes"
    return UsageError(f"{path} is larger than {size}; that is not {what}")


def read_bytes(path: Path, most: int = LARGEST, what: str = "a file of this kind") -> bytes:
    """All of a regular file of at most so many bytes; raises as ``opened``."""
    with opened(path, most, what) as file:
        content = file.read(most + 1)
    if len(content) > most:  # it grows, or its system tells no size
        raise too_large(path, most, what)
    return content


def read_text(
    path: Path, most: int = LARGEST, what: str = "a file of this kind", encoding: str = "utf-8"
) -> str:
    """The same as text, with any ends of lines; UnicodeDecodeError where it is none."""
    return read_bytes(path, most, what).decode(encoding).replace("\r\n", "\n").replace("\r", "\n")


def read_json(path: Path, most: int = LARGEST, what: str = "a file of this kind") -> Any:
    """What is in a JSON file.

    Raises:
        OSError, UsageError: as ``opened``.
        ValueError: it is not JSON, is nested without end, or holds a number that no machine number can hold.
    """
    return json_of(read_text(path, most, what))


def json_of(text: str | bytes) -> Any:
    """What is in JSON text; whole numbers are as large as a floating-point number can be.

    Raises:
        ValueError: as ``read_json``.
    """
    try:
        return json.loads(text, parse_int=_integer)
    except RecursionError:
        raise ValueError("it is nested too deeply") from None


def _integer(digits: str) -> int:
    if len(digits) > 300:
        raise ValueError(f"{digits[:12]}... is too large a number")
    return int(digits)
