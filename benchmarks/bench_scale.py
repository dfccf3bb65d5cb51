"""What a campaign costs beside its tests, and how it grows.

    python benchmarks/bench_scale.py [PART ...] [TESTS]

overhead   8,000 tests that do nothing: through the store and two workers, against the bare function
workers    96 tests that are drafted, driven and judged: two workers against one, and bytes on the disk
leaks      800 such tests: memory of the workers that drive
memory     20,000 tests that cost nothing, with drives to be kept: memory of the process that writes
million    a store of 1,000,000 synthetic tests: status, what a report asks for, the table of results

Without a PART all are measured; TESTS takes the place of each of these numbers.
"""

import json
import os
import sqlite3
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from resource import RUSAGE_SELF, getrusage
from typing import Any

import numpy as np

from roadgpt import plugins
from roadgpt.campaign import lifecycle, scheduler
from roadgpt.campaign.csv_tables import write_tables
from roadgpt.campaign.lifecycle import begin, work
from roadgpt.campaign.model import Cell, CellBudget, Pool, Proposal, Result
from roadgpt.campaign.plan import Plan
from roadgpt.campaign.record import STORE, Record, Store, design_text
from roadgpt.campaign.single_test import FinishedTest, Task
from roadgpt.campaign.status import status_of
from roadgpt.campaign.traces import Trace
from roadgpt.drive import COLUMNS
from roadgpt.road import Design, Segment

ROAD = "turn x3 | up"
SEGMENT = Segment(
    distance=51.25, direction="left", incline=3.5, turn_degrees=40.125, radius=35.5, transition=12.25
)
DESIGN = Design(starting_point=(31.5, 40.25, 3.0), theta=17.5, segments=(SEGMENT,) * 7)
FEATURES = {name: 1.234567 * number for number, name in enumerate("ABCDEFGHIJKLMNOPQR", 1)}
STEPS_OF_A_DRIVE = 1000
TESTS = next(filter(str.isdigit, sys.argv[1:]), "")
ENDS = {True: ("PASS", None), False: ("FAIL", "stuck")}


def instant(task: Task, cell: Cell) -> FinishedTest:
    """A test that does nothing, with a result of the usual size."""
    result = Result(
        task.number,
        task.batch,
        task.proposal,
        "PASS" if task.number % 3 else "FAIL",
        "kept its lane to the goal after 226 m, never less than 0.18 m sideways from failing",
        task.proposal.design,
        226.5,
        0.125 * (task.number % 17),
        0.5,
        features=FEATURES,
    )
    return FinishedTest(result)


def with_drive(task: Task, cell: Cell) -> FinishedTest:
    """The same with a drive of 20 s, whose columns change about as much as those of real ones."""
    rng = np.random.default_rng(task.number)
    rows = np.cumsum(rng.integers(-9, 10, (len(COLUMNS), STEPS_OF_A_DRIVE)), axis=1).astype(np.int32)
    header = {
        "driver": "me",
        "simulator": "mine",
        "seed": 1,
        "ended": "goal",
        "car": {"length": 4.7, "width": 1.9},
    }
    return FinishedTest(instant(task, cell).result, Trace(header, rows))


class Same:
    """Asks for the same design, again and again."""

    batch_size = 16

    def __init__(self, cell: Cell) -> None: ...

    def ask(self, batch: int, first: int, n: int, pool: Pool) -> list[Proposal]:
        """The same."""
        return [Proposal(DESIGN, first + at, "same") for at in range(n)]

    def tell(self, results: Sequence[Result]) -> None:
        """Nothing is learnt."""


def nothing() -> None:
    """Prepares nobody."""


def of_no_cost(tests: int, function: Callable[..., FinishedTest]) -> tuple[Plan, Callable[[], None]]:
    """A plan of tests that cost nothing, and what puts it on its way."""
    installed = plugins.find

    def find(shelf: str, name: str) -> Any:
        return Same if (shelf, name) == ("generators", "same") else installed(shelf, name)

    def ready() -> None:
        setattr(plugins, "find", find)  # noqa: B010 - it is a function of a module
        setattr(scheduler, "execute", function)  # noqa: B010
        setattr(lifecycle, "WorkerSetup", lambda setups: nothing)  # noqa: B010

    return Plan(generators=("same",), budget=CellBudget(tests=tests), drives=False), ready


def overhead() -> None:
    """A test that does nothing, with everything around it."""
    tests = int(TESTS or 8000)
    plan, ready = of_no_cost(tests, instant)
    ready()
    cell = plan.cells({})[0]
    start = time.perf_counter()
    for number in range(tests):
        instant(Task(number, 0, Proposal(DESIGN, number, "same")), cell)
    bare = (time.perf_counter() - start) / tests
    print("| workers | tests | bare function | in a campaign | overhead | of the main process (CPU) |")
    print("|---|---|---|---|---|---|")
    for workers in (1, 2):
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name) / "c"
            begin(plan, folder)
            cpu, began, at = time.process_time(), time.perf_counter(), 0
            for progress in work(folder, workers):
                if 0 < progress.total() < tests and not at:  # workers have started
                    cpu, began, at = time.process_time(), time.perf_counter(), progress.total()
            spent, busy = (time.perf_counter() - began), time.process_time() - cpu
        each = spent / (tests - at)
        print(
            f"| {workers} | {tests:,} | {1e6 * bare:.0f} µs | {1e6 * each:.0f} µs "
            f"| {1e6 * (each - bare):.0f} µs | {1e6 * busy / (tests - at):.0f} µs |"
        )


def workers() -> None:
    """Real tests with one worker and with two; what the process that writes has to do for each."""
    tests = int(TESTS or 96)
    rates = []
    print("\n| workers | tests | tests/s | times | main process, CPU per test | bytes per test on the disk |")
    print("|---|---|---|---|---|---|")
    for count in (1, 2):
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name) / "c"
            begin(Plan(prompts=(ROAD,), reader="plan", budget=CellBudget(tests=tests), seeds=(7,)), folder)
            before = time.process_time()
            for _ in work(folder, count):
                pass
            busy = (time.process_time() - before) / tests
            with Record.opened(folder) as record:
                # from when all workers were warm to the last test
                ended = sorted(when for (when,) in record.query("SELECT ended FROM tests"))
            files = [path for path in folder.rglob("*") if path.suffix in (".sqlite", ".npz")]
            size = sum(path.stat().st_size for path in files) / tests
            first = next((at for at, when in enumerate(ended) if when > ended[0] + 2.0), 1)
            rates.append((len(ended) - first) / (ended[-1] - ended[first - 1]))
            times = rates[-1] / rates[0]
            print(
                f"| {count} | {tests} | {rates[-1]:.2f} | {times:.2f} | {1e3 * busy:.1f} ms | {size:,.0f} |"
            )


def memory_of(pid: int) -> float:
    """MB of a process that are in memory."""
    told = Path(f"/proc/{pid}/status").read_text()
    return int(told.partition("VmRSS:")[2].split()[0]) / 1024


def children() -> list[int]:
    """Our workers."""
    command = ["ps", "-o", "pid=,comm=", "--ppid", str(os.getpid())]
    told = subprocess.run(command, capture_output=True, text=True, check=False)
    return [int(line.split()[0]) for line in told.stdout.splitlines() if "python" in line]


def curve(steps: Iterator[Any], tests: int, points: int = 8) -> None:
    """Memory of the main process and of the largest worker, as tests are done."""
    print("| tests done | main process, MB | largest worker, MB |")
    print("|---|---|---|")
    nexts = [tests * (at + 1) // points for at in range(points)]
    for progress in steps:
        if nexts and progress.total() >= nexts[0]:
            largest = max((memory_of(pid) for pid in children()), default=0.0)
            print(f"| {progress.total():,} | {memory_of(os.getpid()):.0f} | {largest:.0f} |", flush=True)
            nexts = [at for at in nexts if at > progress.total()]


def leaks() -> None:
    """Many real tests, one after another: do workers grow?"""
    real = int(TESTS or 800)
    print("\nReal tests: drafted, driven, judged.\n")
    with tempfile.TemporaryDirectory() as name:
        begin(
            Plan(prompts=(ROAD,), reader="plan", budget=CellBudget(tests=real), seeds=(7,)), Path(name) / "c"
        )
        curve(work(Path(name) / "c", 2), real)


def memory() -> None:
    """Very many tests with drives: does the process that writes grow?"""
    tests = int(TESTS or 20_000)
    plan, ready = of_no_cost(tests, with_drive)
    ready()
    print("\nTests that cost nothing, with drives of 20 s.\n")
    with tempfile.TemporaryDirectory() as name:
        begin(plan, Path(name) / "c")
        curve(work(Path(name) / "c", 2), tests)


def million() -> None:
    """A store of a million tests, written as fast as SQLite takes them, and asked."""
    tests = int(TESTS or 1_000_000)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        plan = Plan(prompts=(ROAD,), reader="plan", budget=CellBudget(tests=tests // 4), seeds=(0, 1, 2, 3))
        Store.new(folder, plan.model_dump_json(), plan.cells({}), {"any": {}}).close()
        _fill(folder, tests)
        size = (folder / STORE).stat().st_size
        print(f"\n{tests:,} tests in {size / 1e6:,.0f} MB ({size / tests:,.0f} bytes each).\n")
        print("| asked | seconds | memory, MB |")
        print("|---|---|---|")
        _asked("roadgpt status", lambda: status_of(folder))
        with Record.opened(folder) as record:
            for what, sql in QUESTIONS.items():
                _asked(what, lambda sql=sql: record.query(sql))
            _asked("table of results", lambda: write_tables(record, folder))


QUESTIONS = {
    "outcomes, causes and sides by cell": "SELECT cell, outcome, cause, side, count(*) FROM tests "
    "GROUP BY 1, 2, 3, 4",
    "margins in 50 bins": "SELECT round(margin * 25), count(*) FROM tests GROUP BY 1",
    "failures over time": "SELECT cell, number / 1000, sum(outcome = 'FAIL') FROM tests GROUP BY 1, 2",
    "map of two features, with failures": "SELECT round(json_extract(features, '$.A'), 1), "
    "round(json_extract(features, '$.B'), 1), count(*), sum(outcome = 'FAIL') "
    "FROM tests JOIN details USING (cell, number) GROUP BY 1, 2",
    "the 50 hardest": "SELECT cell, number, margin FROM tests ORDER BY margin LIMIT 50",
}


def _asked(what: str, question: Callable[[], object]) -> None:
    start = time.perf_counter()
    question()
    print(
        f"| {what} | {time.perf_counter() - start:.1f} | {getrusage(RUSAGE_SELF).ru_maxrss / 1024:.0f} |",
        flush=True,
    )


def _fill(folder: Path, tests: int) -> None:
    """Synthetic rows; features differ, so that nothing is asked of the same value a million times."""
    db = sqlite3.connect(folder / STORE, isolation_level=None)
    db.execute("PRAGMA synchronous = OFF")
    db.execute("BEGIN")
    rng = np.random.default_rng(0)
    margins, text = rng.normal(0.4, 0.5, tests), design_text(DESIGN)
    per_cell = tests // 4
    for cell in range(4):
        name, first = f"c{cell + 1:02d}", cell * per_cell
        rows = range(per_cell)
        db.executemany(
            "INSERT INTO tests(cell, number, batch, seed, given, outcome, cause, side, length, margin, "
            "max_oob, ended) VALUES (?, ?, ?, ?, 1, ?, ?, 'left', 226.5, ?, 0.5, 0)",
            (
                (name, at + 1, at // 16, at, *ENDS[bool(margins[first + at] > 0)], float(margins[first + at]))
                for at in rows
            ),
        )  # fmt: skip
        db.executemany(
            "INSERT INTO details(cell, number, origin, design, description, features) "
            "VALUES (?, ?, 'vary 17', ?, 'kept its lane to the goal after 226 m, never closer than 0 m', ?)",
            (
                (name, at + 1, text, json.dumps(FEATURES | {"A": at % 997 / 100, "B": at % 89 / 10}))
                for at in rows
            ),
        )
        db.executemany(
            "INSERT INTO batches VALUES (?, ?, ?, 16, 0)",
            ((name, at, 16 * at + 1) for at in range(per_cell // 16)),
        )
    db.execute("COMMIT")
    db.close()


PARTS = {"overhead": overhead, "workers": workers, "leaks": leaks, "memory": memory, "million": million}


def main() -> None:
    """Measure the part that is named, or each of several in its own process, since some replace functions of
    RoadGPT.
    """
    names = [word for word in sys.argv[1:] if word in PARTS] or list(PARTS)
    if len(names) == 1:
        PARTS[names[0]]()
        return
    for name in names:
        subprocess.run([sys.executable, __file__, name, *filter(None, [TESTS])], check=True)


if __name__ == "__main__":
    import bench_scale  # under its own name, so that workers find its functions

    bench_scale.main()
