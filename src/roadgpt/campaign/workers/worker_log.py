"""Limits the size of the log file with the output of workers."""

import os
from contextlib import suppress
from pathlib import Path

LOG = "workers.log"
MOST = 4_000_000  # bytes; then only the end is kept
KEPT = 1_000_000  # bytes of it
NOTE = b"[what was printed before is left out]\n"


def shorten(log: Path) -> None:
    """Keeps only the end of a log that has become too long; workers can continue to append to it.

    If the file cannot be read or written, no error is raised, since a full log must not stop a campaign.
    """
    with suppress(OSError):
        if log.stat().st_size <= MOST:
            return
        with log.open("rb") as file:
            file.seek(-KEPT, os.SEEK_END)
            _, _, end = file.read(KEPT).partition(b"\n")
        os.truncate(log, 0)
        with log.open("ab") as file:
            file.write(NOTE + end)
