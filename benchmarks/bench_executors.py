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
from collections.abc import Callable
from concurrent.futures import Executor, wait
from functools import partial
from pathlib import Path
from typing import Any

from roadgpt import plugins
from roadgpt.campaign.executors import WorkerConfig

WORKERS = 2
TEST = 0.05  # s


def seconds_of(workers: Executor, count: int, function: Callable[..., Any], item: Any) -> float:
    """Seconds for each of so many jobs, until every one has ended."""
    begun = time.perf_counter()
    wait([workers.submit(function, item) for _ in range(count)])
    return (time.perf_counter() - begun) / count


def row(name: str, count: int, log: Path) -> str:
    begun = time.perf_counter()
    workers = plugins.find("executors", name)(WorkerConfig(WORKERS, partial(abs, 0), 600.0, log))
    try:
        list(workers.map(abs, range(WORKERS * 4)))
        ready = time.perf_counter() - begun
        nothing = seconds_of(workers, count, abs, 1)
        short = seconds_of(workers, count // 5, time.sleep, TEST)
    finally:
        workers.shutdown(cancel_futures=True)
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
