"""The tables of a campaign: what is the same whoever worked on it, however often it was interrupted.

results.csv    one row per test: what was asked for, what came of it, its features
cells.csv      one row per cell: what its tests share, how many of them ended how, and in how many cells of
               the map of behaviour (over the features of its search, or the usual ones) there are failures
"""

import csv
import json
import os
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from roadgpt.campaign.behaviour import BOUNDS, cell_of
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
AXES, PER_AXIS = ("MAX_CURV", "STD_SA"), 25
"""The map of behaviour, where a search names no other: its features, and cells along each."""
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
    ((least, left),) = record.query(
        "SELECT min(margin), sum(outcome = 'FAIL' AND side = 'left') FROM tests WHERE cell = ?",
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
        "failed_left": left or 0,
        "failing_cells": _failing_cells(record, cell),
        "least_margin_m": least,
    }


def _failing_cells(record: Record, cell: Cell) -> int:
    """In how many cells of the map of behaviour a car failed: how widely the failures differ."""
    axes, cells = cell.settings.get("axes", AXES), cell.settings.get("cells", PER_AXIS)
    if not isinstance(axes, (list, tuple)) or not isinstance(cells, int) or not {*axes} <= {*BOUNDS}:
        axes, cells = AXES, PER_AXIS  # another generator's settings mean something else
    failures = record.stream(
        "SELECT features FROM tests JOIN details USING (cell, number) "
        "WHERE tests.cell = ? AND outcome = 'FAIL'",
        (cell.name,),
    )
    places = {cell_of(json.loads(features), axes, cells) for (features,) in failures}
    return len(places - {None})


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
