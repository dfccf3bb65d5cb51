"""How long a report on a campaign of many tests takes, beside reading every row of its store.

python benchmarks/bench_report.py 100000
"""

import sqlite3
import sys
import tempfile
import time
from pathlib import Path

from roadgpt.brief import read
from roadgpt.campaign.model import Cell, CellBudget, Proposal, Result
from roadgpt.campaign.plan import Plan
from roadgpt.campaign.record import Record, Store
from roadgpt.campaign.single_test import FinishedTest
from roadgpt.design import draft
from roadgpt.report.report import write_report
from roadgpt.road import World
from roadgpt.run.model import Request

SEED_TESTS = 50  # that are written by the store itself; the others are copies with margins of their own
WORDS = "an uphill road with 3 turns"


def store_of(folder: Path, tests: int) -> None:
    """A campaign of so many tests in one cell."""
    plan = Plan(prompts=(WORDS,), budget=CellBudget(tests=tests))
    cell = Cell("c01", Request(words=WORDS), None, "words", None, budget=CellBudget(tests=tests))
    brief, world = read(WORDS), World()
    made = [
        Result(
            number=number,
            batch=0,
            proposal=Proposal(None, number, "draft"),
            outcome="PASS",
            description="came to the goal",
            design=draft(brief, world, seed=number),
            length=200.0,
            margin=1.0,
            features={"MAX_CURV": number / 1000, "DIR_COV": number / 100, "STD_SA": number, "MEAN_LP": 1.0},
        )
        for number in range(1, SEED_TESTS + 1)
    ]
    with Store.new(folder, plan.model_dump_json(), [cell], {"any": {"roadgpt": "bench"}}) as store:
        store.begin_session(1)
        store.add_batch("c01", 0, 1, [result.proposal for result in made])
        store.keep([("c01", FinishedTest(result)) for result in made], None, {"c01": 1.0})
        store.finish()
    db = sqlite3.connect(folder / "campaign.sqlite")
    db.execute(
        "CREATE TEMP TABLE k AS WITH RECURSIVE q(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM q WHERE i < ?) "
        "SELECT i FROM q",
        (tests // SEED_TESTS - 1,),
    )
    for table in ("tests", "details"):
        names = [row[1] for row in db.execute(f"PRAGMA table_info({table})")]
        columns = ", ".join(f"number + {SEED_TESTS} * i" if name == "number" else name for name in names)
        db.execute(f"INSERT INTO {table} SELECT {columns} FROM k CROSS JOIN {table}")
    db.execute("UPDATE tests SET margin = (number * 7919 % 1000) / 400.0 - 0.5")
    db.execute("UPDATE tests SET outcome = 'FAIL', cause = 'out of lane', side = 'left' WHERE margin < 0")
    db.execute("UPDATE batches SET n = ?", (tests,))
    db.commit()
    db.close()


def clocked(work: object) -> tuple[float, float]:
    """Seconds on the clock, and of the processor."""
    begun, cpu = time.perf_counter(), time.process_time()
    work()  # type: ignore[operator]
    return time.perf_counter() - begun, time.process_time() - cpu


def main(tests: int) -> None:
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        store_of(folder, tests)
        size = (folder / "campaign.sqlite").stat().st_size / 1e6

        def all_rows() -> None:
            with Record.opened(folder) as record:
                for _ in record.results():
                    pass

        report, cpu = clocked(lambda: write_report(folder))
        rows, rows_cpu = clocked(all_rows)
    print("| tests | store, MB | report, s (processor) | every row read, s (processor) |")
    print("|---|---|---|---|")
    print(f"| {tests:,} | {size:,.1f} | {report:.1f} ({cpu:.1f}) | {rows:.1f} ({rows_cpu:.1f}) |")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 100_000)
