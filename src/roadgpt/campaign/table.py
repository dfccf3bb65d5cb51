"""The tables of a campaign: what is the same whoever worked on it, however often it was interrupted.

results.csv    one row per test: what was asked for, what came of it, its features
cells.csv      one row per cell: what its tests share, and how many of them ended how
"""

import csv
import json
import os
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from roadgpt.campaign.model import Cell
from roadgpt.campaign.record import Record
from roadgpt.run import seed_of
from roadgpt.run.atomic import PART

RESULTS, CELLS = "results.csv", "cells.csv"
COLUMNS = (
    "cell",
    "test",
    "batch",
    "origin",
    "seed",
    "outcome",
    "cause",
    "side",
    "length_m",
    "margin_m",
    "max_oob",
    "at_s_m",
    "description",
)
EVERY = (
    "SELECT tests.cell, tests.number, batch, origin, seed, given, outcome, cause, side, length, margin, "
    "max_oob, at_s, description, features FROM tests JOIN details USING (cell, number) "
    "WHERE outcome IS NOT NULL ORDER BY tests.cell, tests.number"
)
OUTCOMES = {
    "PASS": "passed",
    "FAIL": "failed",
    "INVALID": "invalid",
    "ERROR": "in_error",
    "VALID": "not_driven",
}


def write_tables(record: Record, folder: Path) -> None:
    """Write both, row by row; raises OSError."""
    features = record.feature_names()
    rows = (_row(row, features) for row in record.stream(EVERY))  # a million pass through here one by one
    _write(folder / RESULTS, (*COLUMNS, *features), rows)
    cells = [_cell_row(record, cell) for cell in record.cells()]
    _write(folder / CELLS, tuple(cells[0]), (tuple(row.values()) for row in cells))


def _row(row: tuple[Any, ...], features: list[str]) -> tuple[Any, ...]:
    cell, number, batch, origin, seed, given, *rest, found = row
    values = json.loads(found)
    driver = seed if given else seed_of(seed, number)
    return (cell, number, batch, origin, driver, *rest, *(values.get(name) for name in features))


def _cell_row(record: Record, cell: Cell) -> dict[str, Any]:
    counts = Counter(
        dict(
            record.query(
                "SELECT outcome, count(*) FROM tests WHERE cell = ? AND outcome IS NOT NULL GROUP BY outcome",
                (cell.name,),
            )
        )
    )
    ((least, sides),) = record.query(
        "SELECT min(margin), sum(side = 'left') FROM tests WHERE cell = ? AND outcome IN ('PASS', 'FAIL')",
        (cell.name,),
    )
    setup = cell.request.setup
    return {
        "cell": cell.name,
        "description": cell.request.words,
        "designer": setup.designer,
        "driver": setup.driver,
        "simulator": setup.simulator,
        "generator": cell.generator,
        "goal": cell.goal,
        "seed": cell.request.seed,
        "tests": counts.total(),
        "valid": counts.total() - counts["INVALID"] - counts["ERROR"],
        **{name: counts[outcome] for outcome, name in OUTCOMES.items()},
        "least_margin_m": least,
        "failed_left": sides or 0,
    }


def _write(path: Path, head: tuple[str, ...], rows: Iterator[tuple[Any, ...]]) -> None:
    draft = path.with_name(f"{path.name}.{os.getpid()}{PART}")
    try:
        with draft.open("w", encoding="utf-8", errors="backslashreplace", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(head)
            writer.writerows(rows)
        draft.replace(path)
    except BaseException:
        draft.unlink(missing_ok=True)
        raise
