"""What a campaign loses by kill -9: 2,000 tests, 30 kills, and the same table as without any.

    python benchmarks/bench_kills.py            # or: TESTS KILLS

Every third kill takes the whole campaign (then ``roadgpt resume``), the others one of its workers.
"""

import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from roadgpt.campaign.record import Record
from roadgpt.campaign.status import status_of
from roadgpt.errors import UsageError

WORDS = "an uphill road with 3 turns"
ROADGPT = [sys.executable, "-c", "from roadgpt.cli import main; main()"]
EVERY = 3


def roadgpt(*words: object) -> "subprocess.Popen[bytes]":
    """A command in a process of its own."""
    return subprocess.Popen([*ROADGPT, *map(str, words)], stdout=subprocess.DEVNULL)


def begin(folder: Path, tests: int, workers: int) -> "subprocess.Popen[bytes]":
    """A campaign of so many tests: drafted and checked by real workers."""
    return roadgpt(
        "campaign", WORDS, "-n", tests, "--no-drive", "--reader", "grammar", "--seed", 7, "-j", workers,
        "--out", folder,
    )  # fmt: skip


def done_in(folder: Path) -> int:
    """Tests that have ended so far."""
    try:
        with Record.opened(folder) as record:
            return int(record.query("SELECT count(*) FROM tests WHERE outcome IS NOT NULL")[0][0])
    except UsageError:
        return 0


def children(pid: int) -> list[int]:
    """The workers of a campaign."""
    told = subprocess.run(
        ["ps", "-o", "pid=", "--ppid", str(pid)], capture_output=True, text=True, check=False
    )
    return [int(word) for word in told.stdout.split()]


def killed(folder: Path, tests: int, kills: int) -> tuple[int, int]:
    """Work off a campaign under kills; how many hit the campaign, and how many a worker."""
    rng = random.Random(7)
    hits = [0, 0]
    process = begin(folder, tests, 2)
    for kill in range(kills):
        goal = tests * (kill + rng.random()) / kills * 0.97
        while done_in(folder) < goal and process.poll() is None:
            time.sleep(0.05)
        time.sleep(rng.random() * 0.5)
        workers = children(process.pid)
        if kill % EVERY == 0 or not workers:
            process.kill()
            process.wait()
            hits[0] += 1
            process = roadgpt("resume", folder, "-j", 2)
        else:
            os.kill(rng.choice(workers), signal.SIGKILL)
            hits[1] += 1
    assert process.wait() == 0
    return hits[0], hits[1]


def main() -> None:
    """Print both campaigns side by side."""
    tests, kills = (int(word) for word in [*sys.argv[1:], "2000", "30"][:2])
    with tempfile.TemporaryDirectory() as name:
        once, often = Path(name) / "once", Path(name) / "often"
        start = time.perf_counter()
        assert begin(once, tests, 1).wait() == 0
        between = time.perf_counter()
        of_campaign, of_workers = killed(often, tests, kills)
        end = time.perf_counter()
        files = ("results.csv", "cells.csv")
        other = [file for file in files if (once / file).read_bytes() != (often / file).read_bytes()]
        print("| | workers | kills of the campaign | kills of workers | tests | seconds |")
        print("|---|---|---|---|---|---|")
        print(f"| undisturbed | 1 | 0 | 0 | {status_of(once).done:,} | {between - start:.0f} |")
        print(
            f"| killed | 2 | {of_campaign} | {of_workers} | {status_of(often).done:,} | {end - between:.0f} |"
        )
        print(f"\nTables that differ: {', '.join(other) or 'none; they are the same, byte for byte'}.")
        if other:
            for folder in (once, often):
                print((folder / other[0]).read_text()[:2000])
            sys.exit(1)


if __name__ == "__main__":
    main()
