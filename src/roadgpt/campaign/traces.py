"""Stores the drives of a campaign compactly: every column at 50 Hz, as integer multiples of small steps.

The drives of a group of tests are stored in one file under ``traces/``, in the format of ``numpy.savez``. Its
entry ``header`` is a line of JSON: the ``columns`` in their order, the ``steps`` in which they are measured,
and the tests whose ``drives`` the file holds. The drive of test 17 of cell c02 is the entry ``c02/17``,
integers ``(columns, n)``: the second differences of each column, counted in steps. For a car's motion, these
differences are near 0 and compress well (12 kB for a drive of 28 s). Two cumulative sums of a row, times the
column's step, give the column of ``roadgpt.drive.COLUMNS`` in its unit. Others on the road, if there were
any, are the entry ``c02/17/others``, as in ``drive.npz``."""

import io
import json
import os
import zipfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from roadgpt.drive import COLUMNS, Columns, Drive
from roadgpt.drive.drive import OTHERS, add_array, packed, unpacked
from roadgpt.errors import UsageError
from roadgpt.reading import arrays_in, json_of
from roadgpt.run.atomic import write_whole

TRACES, SUFFIX = "traces", ".npz"
FORMAT = 2  # of a file
LARGEST, UNPACKED = 500_000_000, 200_000_000  # bytes of a file, and of one drive in it: as drive.npz
LEVEL = 4  # of zlib: 1 ms and 12 kB for a drive of 28 s; level 9 takes 40 ms for 10 kB
FINE, COARSE = 1e-4, 1e-2
STEPS = {
    **dict.fromkeys(COLUMNS, 1e-3),  # s, m, m/s, shares: no decision depends on a millimetre
    **dict.fromkeys(("heading", "pitch", "roll", "yaw_rate", "steer", "outside"), FINE),
    **dict.fromkeys(("ax", "ay"), COARSE),  # m/s^2
}
NOT_A_NUMBER = np.iinfo(np.int32).min

Whole = NDArray[np.int32]


class Trace(NamedTuple):
    """A Drive whose values are integer multiples of small steps, as stored in a file."""

    header: dict[str, Any]
    """What the drive has beside its columns, as ``drive.packed`` returns it."""
    rows: Whole  # the columns in their order, ``(columns, n)``
    others: NDArray[Any] | None = None
    """The states of others on the road, as ``drive.packed`` returns them."""


def trace_of(drive: Drive) -> Trace:
    """Returns a Drive as a Trace, in which every value is rounded to a multiple of its column's step."""
    header, states = packed(drive)
    limit, values = np.iinfo(np.int32).max, np.stack([drive[name] for name in COLUMNS])
    finite = np.nan_to_num(values, posinf=np.inf, neginf=-np.inf)
    steps = np.clip(np.round(finite / [[STEPS[name]] for name in COLUMNS]), -limit, limit)
    return Trace(header, np.where(np.isnan(values), NOT_A_NUMBER, steps).astype(np.int32), states)


def drive_of(trace: Trace) -> Drive:
    """Returns the Drive of a Trace; its values differ by at most half a step from those of the original."""
    # divided by the inverse, so that 0.02 s is 0.02 s and not its neighbour
    values = trace.rows / [[round(1 / STEPS[name])] for name in COLUMNS]
    values[trace.rows == NOT_A_NUMBER] = np.nan
    return unpacked(trace.header, Columns(dict(zip(COLUMNS, values, strict=True))), trace.others)


def write_traces(folder: Path, number: int, drives: Sequence[tuple[str, int, Trace]]) -> str:
    """Writes a group of drives (cell, number of the test, drive) as one file, and returns its name once it is
    on the disk and not only in a buffer. The same drives give the same bytes."""
    header = {
        "format": FORMAT,
        "columns": [*COLUMNS],
        "steps": [STEPS[name] for name in COLUMNS],
        "drives": [{"cell": cell, "number": test, **trace.header} for cell, test, trace in drives],
    }
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w") as archive:
        add_array(archive, "header", np.array(json.dumps(header)), LEVEL)
        for cell, test, trace in drives:
            start = np.zeros((len(COLUMNS), 2), np.int32)
            # these int32 may overflow; the sums then overflow back, so that even the largest values are exact
            add_array(archive, f"{cell}/{test}", np.diff(trace.rows, 2, prepend=start), LEVEL)
            if trace.others is not None:
                add_array(archive, f"{cell}/{test}/{OTHERS}", trace.others, LEVEL)
    name = f"{number:07d}{SUFFIX}"
    path = folder / TRACES / name
    path.parent.mkdir(exist_ok=True)
    write_whole(path, data.getvalue())
    _to_disk(path)
    _to_disk(path.parent)
    return name


def _to_disk(path: Path) -> None:
    """Waits until a file, or a folder's list of names, is on the disk, so that a power cut cannot undo it."""
    if path.is_dir() and os.name == "nt":  # Windows opens no folders
        return
    number = os.open(path, os.O_RDONLY if os.name != "nt" else os.O_RDWR)
    try:
        os.fsync(number)
    finally:
        os.close(number)


def read_traces(path: Path, cell: str, number: int) -> Drive:
    """Reads one drive out of a file of traces."""
    which = {"cell": cell, "number": number}
    try:
        names = "header", f"{cell}/{number}", f"{cell}/{number}/{OTHERS}"
        found = arrays_in(path, "drives of a campaign", UNPACKED, names, LARGEST)
        contents, rows, others = json_of(str(found["header"])), found[names[1]], found.get(names[2])
        if contents["format"] != FORMAT or contents["columns"] != [*COLUMNS]:
            raise ValueError("another version of roadgpt wrote it")
        if rows.dtype != np.int32 or rows.ndim != 2 or len(rows) != len(COLUMNS) or not rows.size:
            raise ValueError("a drive is a table of whole numbers")
        (header,) = [each for each in contents["drives"] if which.items() <= each.items()]
        header = {name: value for name, value in header.items() if name not in which}
        steps = rows.cumsum(axis=1, dtype=np.int32).cumsum(axis=1, dtype=np.int32)
        return drive_of(Trace(header, steps, others))
    except UsageError:
        raise
    except Exception as error:  # zipfile, its decoders, numpy and json raise anything
        raise UsageError(
            f"{path} holds no drive of test {number} of {cell} ({error}); drive it again"
        ) from error
