"""What a campaign and a folder of runs lose by kill -9: 30 kills, and the same files as without any.

    python benchmarks/bench_kills.py            # or: TESTS KILLS [ROADS]

Every third kill takes the whole campaign (then ``roadgpt resume``), the others one of its workers. A folder
of ROADS runs (300) is killed as often, and continued by the same ``roadgpt run`` and ``roadgpt resume`` in
turn.
"""

import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from roadgpt.campaign.record import STORE, Record
from roadgpt.campaign.status import status_of
from roadgpt.errors import UsageError
from roadgpt.run.folder import finished

ROAD = "turn x3 | up"
ROADGPT = [sys.executable, "-c", "from roadgpt.cli import main; main()"]
EVERY = 3


def roadgpt(*words: object) -> "subprocess.Popen[bytes]":
    """A command in a process of its own."""
    return subprocess.Popen([*ROADGPT, *map(str, words)], stdout=subprocess.DEVNULL)


def begin(folder: Path, tests: int, workers: int) -> "subprocess.Popen[bytes]":
    """A campaign of so many tests: drafted and checked by real workers."""
    return roadgpt(
        "campaign", ROAD, "-n", tests, "--no-drive", "--reader", "plan", "--seed", 7, "-j", workers,
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


def killed_run(folder: Path, roads: int, kills: int) -> int:
    """Make a folder of runs under kills; how many hit."""
    rng, hits = random.Random(7), 0
    command = ("run", ROAD, "-n", roads, "--no-drive", "--no-plot", "--quiet", "--reader", "plan")
    for kill in range(kills + 1):
        is_resumed = kill % 2 == 1 and finished(folder)
        begun = (*command, "--seed", 7, "--out", folder)
        process = roadgpt(*(("resume", folder, "--quiet") if is_resumed else begun))
        goal = roads * (kill + rng.random()) / max(kills, 1) * 0.97
        while kill < kills and len(finished(folder)) < goal and process.poll() is None:
            time.sleep(0.02)
        if kill < kills:
            time.sleep(rng.random() * 0.1)
            process.kill()
        hits += process.wait() == -signal.SIGKILL
    assert process.returncode == 0
    return hits


def folders(home: Path, roads: int, kills: int) -> None:
    """Print what kills did to a folder of runs."""
    once, often = home / "run-once", home / "run-often"
    assert killed_run(once, roads, 0) == 0
    hits = killed_run(often, roads, kills)
    one, other = (
        {
            path.relative_to(folder): path.read_bytes()
            for path in folder.rglob("*")
            if path.is_file() and path.name not in ("seconds.json", "generation_stats.csv", STORE)
        }
        for folder in (once, often)
    )
    there = finished(often)
    assert there == [*range(1, roads + 1)], f"lost or doubled: {there}"
    assert one == other, "files differ"
    print(
        f"A folder of {roads} runs, killed {hits} times: none lost or doubled, the same {len(one):,} files."
    )


def main() -> None:
    """Print both campaigns side by side, and then the folder of runs."""
    tests, kills, roads = (int(word) for word in [*sys.argv[1:], *("2000", "30", "300")[len(sys.argv) - 1 :]])
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
        folders(Path(name), roads, kills)


if __name__ == "__main__":
    main()
