"""Traces: whole drives in little room. Every column at 50 Hz, as whole numbers of small steps, in Parquet.

A group of drives is one file under ``traces/``; its rows are steps of drives, one drive after another, told
apart by ``cell`` and ``number``. A value times its step (``STEPS``, and in the file's own metadata) is the
column of ``roadgpt.drive.COLUMNS``. Whole numbers that change little from row to row are stored by their
differences, in as few bits as these need: 11 kB for a drive of 20 s, a twelfth of its ``drive.npz``.
"""

import io
import json
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from roadgpt.drive import COLUMNS, Box, Columns, Drive
from roadgpt.errors import UsageError
from roadgpt.run.atomic import write_whole

TRACES, SUFFIX = "traces", ".parquet"
FORMAT = 1
FINE, COARSE = 1e-4, 1e-2
STEPS = {
    **dict.fromkeys(COLUMNS, 1e-3),  # s, m, m/s, shares: a millimetre is less than anything here decides on
    **dict.fromkeys(("heading", "pitch", "roll", "yaw_rate", "steer", "outside"), FINE),
    **dict.fromkeys(("ax", "ay"), COARSE),  # m/s^2
}
NOT_A_NUMBER = np.iinfo(np.int32).min

Whole = NDArray[np.int32]


class Trace(NamedTuple):
    """A Drive on its way to a file."""

    header: dict[str, Any]
    columns: dict[str, Whole]


def trace_of(drive: Drive) -> Trace:
    """A Drive in whole steps."""
    header = {
        "driver": drive.driver,
        "simulator": drive.simulator,
        "seed": drive.seed,
        "ended": drive.ended,
        "car": drive.car._asdict(),
    }
    return Trace(header, {name: _whole(drive[name], STEPS[name]) for name in COLUMNS})


def drive_of(trace: Trace) -> Drive:
    """The Drive again, to half a step."""
    header = dict(trace.header)
    columns = Columns({name: _number(trace.columns[name], STEPS[name]) for name in COLUMNS})
    return Drive(columns=columns, **{**header, "car": Box(**header["car"])})


def _whole(values: NDArray[np.float64], step: float) -> Whole:
    limit = np.iinfo(np.int32).max
    steps = np.clip(np.round(np.nan_to_num(values, posinf=np.inf, neginf=-np.inf) / step), -limit, limit)
    return np.where(np.isnan(values), NOT_A_NUMBER, steps).astype(np.int32)


def _number(steps: Whole, step: float) -> NDArray[np.float64]:
    # divided by the inverse, so that 0.02 s is 0.02 s and not its neighbour
    return np.where(steps == NOT_A_NUMBER, np.nan, steps / round(1 / step))


def write_traces(folder: Path, number: int, drives: Sequence[tuple[str, int, Trace]]) -> str:
    """Write a group of drives (cell, number of the test, drive) as one file; gives back its name.

    The file is whole and on the disk, not in some buffer, when this returns.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    lengths = [len(trace.columns["time"]) for _, _, trace in drives]
    table = pa.table(
        {
            "cell": np.repeat([cell for cell, _, _ in drives], lengths),
            "number": np.repeat(np.array([number for _, number, _ in drives], np.int32), lengths),
            **{name: np.concatenate([trace.columns[name] for *_, trace in drives]) for name in COLUMNS},
        }
    )
    told = {
        "format": FORMAT,
        "steps": STEPS,
        "drives": [{"cell": cell, "number": number, **trace.header} for cell, number, trace in drives],
    }
    data = io.BytesIO()
    with pq.ParquetWriter(
        data,
        table.schema,
        compression="zstd",
        use_dictionary=["cell"],
        column_encoding=dict.fromkeys(("number", *COLUMNS), "DELTA_BINARY_PACKED"),
        write_statistics=["number"],
        store_schema=False,
    ) as writer:
        writer.write_table(table)
        writer.add_key_value_metadata({"roadgpt": json.dumps(told)})
    name = f"{number:07d}{SUFFIX}"
    path = folder / TRACES / name
    path.parent.mkdir(exist_ok=True)
    write_whole(path, data.getvalue())
    _to_disk(path)
    _to_disk(path.parent)
    return name


def _to_disk(path: Path) -> None:
    """Wait until a file or the names in a folder are where a power cut does not reach them."""
    if path.is_dir() and os.name == "nt":  # Windows opens no folders
        return
    number = os.open(path, os.O_RDONLY if os.name != "nt" else os.O_RDWR)
    try:
        os.fsync(number)
    finally:
        os.close(number)


def read_traces(path: Path, cell: str, number: int) -> Drive:
    """One drive out of a file.

    Raises:
        UsageError: the file is damaged or gone, or does not hold it.
    """
    import pyarrow.parquet as pq

    try:
        told = json.loads(pq.read_metadata(path).metadata[b"roadgpt"])
        (header,) = [dict(d) for d in told["drives"] if (d["cell"], d["number"]) == (cell, number)]
        table = pq.read_table(path, filters=[("cell", "=", cell), ("number", "=", number)])
        del header["cell"], header["number"]
        columns = {name: table[name].to_numpy().astype(np.int32) for name in COLUMNS}
        return drive_of(Trace(header, columns))
    except Exception as error:  # of a broken file, pyarrow, json and numpy raise anything
        raise UsageError(
            f"{path} holds no drive of test {number} of {cell} ({error}); drive it again"
        ) from error
