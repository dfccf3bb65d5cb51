"""Reads drives that earlier versions of RoadGPT stored as Apache Parquet files; this needs pyarrow.

A row is one time step of a drive; its values are integer multiples of the steps in ``traces``. The columns
``cell`` and ``number`` identify the test, and the metadata under ``roadgpt`` holds the headers of the drives.
"""

import json
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roadgpt.drive import COLUMNS
from roadgpt.errors import UsageError


def read_parquet(path: Path, cell: str, number: int) -> tuple[dict[str, Any], dict[str, NDArray[np.int32]]]:
    """Returns the header of one drive, and its columns as integers.

    Raises:
        UsageError: pyarrow is not installed.
        Exception: the file is broken or lacks the drive; the type of error is that of pyarrow, json or numpy.
    """
    try:
        import pyarrow.parquet as pq
    except ImportError as error:
        raise UsageError(
            f"{path} was written by an earlier version of roadgpt, and reading its drives needs pyarrow; "
            "say: pip install pyarrow"
        ) from error
    contents = json.loads(pq.read_metadata(path).metadata[b"roadgpt"])
    (header,) = [
        dict(each) for each in contents["drives"] if (each["cell"], each["number"]) == (cell, number)
    ]
    table = pq.read_table(path, filters=[("cell", "=", cell), ("number", "=", number)])
    del header["cell"], header["number"]
    return header, {name: table[name].to_numpy().astype(np.int32) for name in COLUMNS}
