"""Works off a campaign in a process of its own, so that a test may kill it: FOLDER ROADS [--slow] [--all]."""

import os
import sys
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from roadgpt.road import Design
from roadgpt.run import Request, Run, Setup, prove, seed_of
from run.doubles import a_design, folder_of

PICTURE = bytes(range(256)) * 4000  # a megabyte, so that many kills fall into the writing of files
REQUEST = Request(words="a road to be interrupted", seed=7, setup=Setup(drives=False))


class LargeDrawing:
    """Writes something large in place of pictures."""

    def of_run(self, run: Run, folder: Path) -> None:
        (folder / "birds_eye.png").write_bytes(PICTURE)

    def of_campaign(self, folder: Path) -> None:
        (folder / "overview.png").write_bytes(PICTURE)


class Deadly(LargeDrawing):
    """Ends the process that draws the second road."""

    def of_run(self, run: Run, folder: Path) -> None:
        if run.index == 2:
            os._exit(9)


def perform(index: int, earlier: Sequence[Design]) -> Run:
    """A road that depends on its seed and on how many there were before."""
    seed = seed_of(REQUEST.seed, index)
    run = prove(a_design(seed + len(earlier)), seed, setup=REQUEST.setup, index=index)
    return replace(run, request=REQUEST)


def main() -> None:
    """Say each road as it is done."""
    campaign = folder_of(REQUEST, int(sys.argv[2]), Path(sys.argv[1]), perform, LargeDrawing())
    for run in campaign.all_runs() if "--all" in sys.argv else campaign:
        print(run.index, flush=True)
        time.sleep(0.02 * ("--slow" in sys.argv))


if __name__ == "__main__":
    main()
