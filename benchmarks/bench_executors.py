"""What it costs to have a job done by a worker: the executors beside each other; prints a table.

python benchmarks/bench_executors.py [JOBS]

Jobs do nothing, or sleep for 50 ms as a short test takes; two workers each. Where Ray is not installed its
row says so.
"""

import importlib.util
import os
import sys
import tempfile
import time
from functools import partial
from pathlib import Path

from roadgpt import plugins
from roadgpt.campaign.executors import Executor, Job, WorkerConfig

WORKERS = 2
TEST = 0.05  # s


def all_done(workers: Executor, jobs: list[Job]) -> float:
    """Seconds until every job has ended."""
    begun = time.perf_counter()
    workers.submit(jobs)
    left = len(jobs)
    while left:
        left -= len(workers.done(1.0))
    return time.perf_counter() - begun


def row(name: str, count: int, log: Path) -> str:
    begun = time.perf_counter()
    workers = plugins.find("executors", name)(WorkerConfig(WORKERS, partial(abs, 0), 600.0, log))
    try:
        workers.map(abs, range(WORKERS * 4))
        ready = time.perf_counter() - begun
        nothing = all_done(workers, [Job(key, abs, key) for key in range(count)]) / count
        short = all_done(workers, [Job(key, time.sleep, TEST) for key in range(count // 5)]) / (count // 5)
    finally:
        workers.stop()
    lost = short * WORKERS - TEST
    return (
        f"| `{name}` | {ready:.1f} s | {1000 * nothing:.2f} ms | {1000 * lost:.1f} ms ({lost / TEST:.0%}) |"
    )


def main(count: int = 1000) -> None:
    print("| executor | until the first answer | a job of nothing | lost per worker and job of 50 ms |")
    print("|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for name in ("processes", "ray"):
            if name == "ray" and importlib.util.find_spec("ray") is None:
                print("| `ray` | not installed | | |")
                continue
            print(row(name, count, Path(folder) / "log"), flush=True)
    print(f"\nload of the machine: {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
