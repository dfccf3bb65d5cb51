"""Reads files that may be somebody else's: regular ones alone, whole, and no larger than their kind is.

A pipe that nobody writes into is waited for without end, and a device has no end: both are refused, and so is
what is too large, before it fills the memory. Files that a campaign or a run wrote are read like this, too.
"""

import json
import os
import stat
import zipfile
from collections.abc import Hashable, Iterable
from errno import EISDIR
from functools import cache
from pathlib import Path
from typing import Any, BinaryIO, TypeVar, cast

from roadgpt.errors import UsageError

T = TypeVar("T")

LARGEST = 50_000_000  # bytes, of files of which nothing else is said
MOST_OPENED, MOST_COMMAS = 2_000_000, 6_000_000  # of a JSON text: each of them costs many bytes of memory
DIGITS = 300  # of a whole number; a floating-point number has 308 at most
ANY = "a file of this kind"
HOW = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0) | getattr(os, "O_CLOEXEC", 0)


def opened(path: Path, most: int = LARGEST, what: str = ANY, called: str = "") -> BinaryIO:
    """A regular file of at most so many bytes, open for reading from its beginning.

    Args:
        path: where it is; a link to such a file will do.
        most: bytes that it may have.
        what: what it should be, for the sentence that says that it is too large.
        called: what the sentence calls it, where that is not its path.

    Raises:
        OSError: it is not there, or may not be read.
        UsageError: it is something else than a file, or larger.
    """
    number = os.open(path, HOW)
    try:
        found = os.fstat(number)
        if stat.S_ISDIR(found.st_mode):
            raise IsADirectoryError(EISDIR, os.strerror(EISDIR), str(path))
        if not stat.S_ISREG(found.st_mode):
            raise UsageError(
                f"{called or path} is a pipe or a device and no file; write what it gives into a file first"
            )
        if found.st_size > most:
            raise _too_large(called or str(path), most, what)
        return os.fdopen(number, "rb")
    except BaseException:
        os.close(number)
        raise


def read_bytes(path: Path, most: int = LARGEST, what: str = ANY) -> bytes:
    """All of a regular file of at most so many bytes; raises as ``opened``."""
    with opened(path, most, what) as file:
        content = file.read(most + 1)
    if len(content) > most:  # it grows, or its system tells no size
        raise _too_large(str(path), most, what)
    return content


def read_text(path: Path, most: int = LARGEST, what: str = ANY, encoding: str = "utf-8") -> str:
    """The same as text, with any ends of lines; UnicodeDecodeError where it is none."""
    return read_bytes(path, most, what).decode(encoding).replace("\r\n", "\n").replace("\r", "\n")


def read_json(path: Path, most: int = LARGEST, what: str = ANY) -> Any:
    """What is in a JSON file.

    Raises:
        OSError, UsageError: as ``opened``.
        ValueError: it is not JSON, is nested too deeply, or holds a number that no machine number can hold.
    """
    return json_of(read_text(path, most, what))


def json_of(text: str) -> Any:
    """What is in JSON text; whole numbers are no larger than a floating-point number can be.

    Raises:
        ValueError: as ``read_json``.
    """
    if text.count("[") + text.count("{") > MOST_OPENED or text.count(",") > MOST_COMMAS:
        raise ValueError("it has more parts than would fit into memory")
    try:
        return json.loads(text, parse_int=_integer)
    except RecursionError:
        raise ValueError("it is nested too deeply") from None


def check_unpacked(entries: Iterable[zipfile.ZipInfo], most: int) -> None:
    """ValueError where a zip archive unpacks to more than so many bytes."""
    if sum(entry.file_size for entry in entries) > most:
        raise ValueError(f"it unpacks to more than {most / 1e6:g} MB")


def strictly(kind: type[T], data: Any) -> T:
    """Data out of a file as a value of a dataclass, every field of which has the type that it says.

    Raises:
        ValueError: a field is missing, is of another type, or is not finite where it is a number.
    """
    value: T = _reader(cast(Hashable, kind)).validate_json(json.dumps(data, allow_nan=False), strict=True)
    return value


@cache
def _reader(kind: Any) -> Any:
    from pydantic import TypeAdapter

    return TypeAdapter(kind)


def _too_large(called: str, most: int, what: str) -> UsageError:
    size = f"{most / 1e6:g} MB" if most >= 100_000 else f"{most:,} bytes"
    return UsageError(f"{called} is larger than {size}; that is not {what}")


def _integer(digits: str) -> int:
    if len(digits) > DIGITS:
        raise ValueError(f"the number {digits[:12]}... has {len(digits):,} digits")
    return int(digits)
