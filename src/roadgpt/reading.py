"""Reads files from untrusted sources: only regular files, and only up to a size limit.

Reading from pipes and devices could block for ever or yield endless data, and files that are too large fill
the memory. What is no such file raises UsageError, and what the system refuses OSError."""

import json
import os
import stat
import tomllib
import zipfile
from collections.abc import Collection, Hashable, Iterable
from errno import EISDIR
from functools import cache
from hashlib import file_digest, sha256
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, TypeVar, cast

from roadgpt.errors import UsageError

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from pydantic import BaseModel

T = TypeVar("T")
M = TypeVar("M", bound="BaseModel")

LARGEST = 50_000_000  # bytes, where a caller gives no other limit
MOST_OPENED, MOST_COMMAS = 2_000_000, 6_000_000  # brackets and commas of a JSON text, which cost memory
DIGITS = 300  # of a whole number; a floating-point number has at most 308
ABSENT = "absent"
ANY = "a file of this kind"
HOW = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0) | getattr(os, "O_CLOEXEC", 0)


def opened(path: Path, most: int = LARGEST, what: str = ANY, called: str = "") -> BinaryIO:
    """Returns a regular file of at most ``most`` bytes, opened for reading. In errors, the file is named as
    it is ``called``, or by its path, and ``what`` says what it should be, such as "a recording"."""
    number = os.open(path, HOW)
    try:
        found = os.fstat(number)
        if stat.S_ISDIR(found.st_mode):
            raise IsADirectoryError(EISDIR, os.strerror(EISDIR), str(path))
        if not stat.S_ISREG(found.st_mode):
            raise UsageError(
                f"{called or path} is a pipe or a device, not a file; write its output to a file first"
            )
        if found.st_size > most:
            raise _too_large(called or str(path), most, what)
        return os.fdopen(number, "rb")
    except BaseException:
        os.close(number)
        raise


def digest(path: Path, pattern: str = "*") -> str:
    """Returns the first 16 digits of the SHA-256 of a file, or of the names and contents of the files in a
    folder that match a pattern, without bytecode; ``ABSENT`` if it is not there, or cannot be read."""
    if path.is_dir():
        files = sorted(
            file for file in path.rglob(pattern) if file.is_file() and "__pycache__" not in file.parts
        )
        names = [(file.relative_to(path).as_posix(), digest(file)) for file in files]
        return sha256(repr(names).encode()).hexdigest()[:16]
    try:
        its = path.stat()
        return _digest(path, its.st_size, its.st_mtime_ns, its.st_ctime_ns) if path.is_file() else ABSENT
    except OSError:
        return ABSENT


@cache
def _digest(path: Path, *_state: int) -> str:
    with path.open("rb") as file:
        return file_digest(file, "sha256").hexdigest()[:16]


def read_bytes(path: Path, most: int = LARGEST, what: str = ANY) -> bytes:
    """Returns the content of a regular file of at most ``most`` bytes."""
    with opened(path, most, what) as file:
        content = file.read(most + 1)
    if len(content) > most:  # it is growing, or its file system reports no size
        raise _too_large(str(path), most, what)
    return content


def read_text(path: Path, most: int = LARGEST, what: str = ANY, encoding: str = "utf-8") -> str:
    """Returns the content of a regular file as text, with all line ends as "\\n"; or raises
    UnicodeDecodeError."""
    return read_bytes(path, most, what).decode(encoding).replace("\r\n", "\n").replace("\r", "\n")


def read_json(path: Path, most: int = LARGEST, what: str = ANY) -> Any:
    """Returns the data in a JSON file; raises ValueError as ``json_of`` does."""
    return json_of(read_text(path, most, what))


def read_model(kind: type[M], path: Path, what: str, absent: str, advice: str = "name another folder") -> M:
    """Reads a JSON file that RoadGPT wrote, and returns the pydantic model in it. The error says ``absent``
    if there is no file, and otherwise ends with ``advice``."""
    try:
        data = read_json(path, LARGEST, what)
    except FileNotFoundError as error:
        raise UsageError(absent) from error
    except (OSError, ValueError) as error:
        raise UsageError(f"{path} cannot be read ({error}); {advice}") from error
    try:
        return kind.model_validate(data)
    except ValueError as error:  # pydantic's ValidationError is one
        raise UsageError(
            f"{path} is damaged or was written by another version of roadgpt; {advice}"
        ) from error


def json_of(text: str) -> Any:
    """Returns the data in JSON text. Raises ValueError if it is not JSON, has too many elements, is nested
    too deeply, or holds a whole number of more than 300 digits."""
    if text.count("[") + text.count("{") > MOST_OPENED or text.count(",") > MOST_COMMAS:
        raise ValueError("it has more parts than would fit into memory")
    try:
        return json.loads(text, parse_int=_integer)
    except RecursionError:
        raise ValueError("it is nested too deeply") from None


def toml_of(text: str) -> dict[str, Any]:
    """Returns the data in TOML text. Raises ValueError as ``json_of`` does."""
    try:
        return tomllib.loads(text)
    except RecursionError:
        raise ValueError("it is nested too deeply") from None


def arrays_in(
    path: Path, what: str, unpacked: int, names: Collection[str] = (), most: int = LARGEST
) -> "dict[str, NDArray[Any]]":
    """Returns the arrays in a .npz file by name, all or those of ``names`` that it has; never pickled ones.
    Raises ValueError if they have more than ``unpacked`` bytes, and other errors if the file is broken."""
    import numpy as np

    with opened(path, most, what) as file, np.load(file, allow_pickle=False) as archive:
        found = [name for name in archive.files if not names or name in names]
        check_unpacked([archive.zip.getinfo(f"{name}.npy") for name in found], unpacked)
        return {name: archive[name] for name in found}


def check_unpacked(entries: Iterable[zipfile.ZipInfo], most: int) -> None:
    """Raises ValueError if a zip archive would unpack to more than ``most`` bytes."""
    if sum(entry.file_size for entry in entries) > most:
        raise ValueError(f"it unpacks to more than {most / 1e6:g} MB")


def strictly(kind: type[T], data: Any) -> T:
    """Makes an instance of a dataclass from the data in a file. Raises ValueError if a field is missing, has
    another type, or is a number that is not finite."""
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
