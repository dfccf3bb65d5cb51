"""Makes the tables of a campaign; their bytes depend neither on the number of workers nor on interruptions.

results.csv    one row per test: its proposal, its outcome, and its features
cells.csv      one row per cell: its settings, the number of tests with each outcome, the number of bins of
               the feature map that contain failures, and the largest share and distance of the car
               outside its lane in passed tests"""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any

from roadgpt.campaign.columns import bounds_of_columns, cell_of
from roadgpt.campaign.folder_record import open_record
from roadgpt.campaign.model import Cell
from roadgpt.campaign.record import MEASURED, Record, reading_store
from roadgpt.campaign.status import CellStatus, cell_statuses
from roadgpt.errors import needed
from roadgpt.reading import json_of
from roadgpt.run import seed_of
from roadgpt.run.atomic import csv_text, write_lines, write_whole

if TYPE_CHECKING:
    from pandas import DataFrame

RESULTS, CELLS = "results.csv", "cells.csv"
COLUMNS = (
    "cell", "test", "batch", "origin", "scenario", "parameters", "seed", "outcome", "cause", "side",
    "length_m", "margin_m", "max_oob", "beyond_m", "at_s_m", "own_share", "handed_to", "description",
)  # fmt: skip
AXES, PER_AXIS = ("MAX_CURV", "STD_SA"), 25
"""The feature map of a cell whose settings define no map: the axes, and the number of bins per axis."""
EVERY = (
    f"SELECT tests.cell, tests.number, batch, origin, seed, given, {', '.join(MEASURED)}, description, "  # noqa: S608
    "features FROM tests JOIN details USING (cell, number) "
    "WHERE outcome IS NOT NULL ORDER BY tests.cell, tests.number"
)
OUTCOMES = {
    "PASS": "passed",
    "FAIL": "failed",
    "UNAVOIDABLE": "unavoidable",
    "NOT TESTED": "not_tested",
    "INVALID": "invalid",
    "ERROR": "in_error",
    "VALID": "not_driven",
}


def write_tables(record: Record, folder: Path) -> None:
    """Writes both tables, row by row; raises OSError."""
    with reading_store(record.path):
        heads, rows = _results(record)
        write_lines(folder / RESULTS, (csv_text(each, ()) for each in chain([heads], rows)))
    both = zip(record.cells(), cell_statuses(record), strict=True)
    cells = [_cell_row(record, cell, status) for cell, status in both]
    write_whole(folder / CELLS, csv_text(cells[0], [row.values() for row in cells]))


def to_frame(folder: Path | str) -> "DataFrame":
    """Returns the tests of a campaign, of a folder of runs or of one run as a pandas DataFrame: a row for
    each test that has ended, and the columns of ``results.csv``. Those that end in ``_m`` are in metres,
    shares are from 0 to 1, and those in capitals are the numbers of plug-ins ``columns`` in their units. What
    a test lacks is NaN or None. Raises UsageError if pandas is not installed, or the folder has no tests."""
    pandas = needed("pandas", "a table")
    with open_record(Path(folder)) as record, reading_store(record.path):
        heads, rows = _results(record)
        frame: DataFrame = pandas.DataFrame.from_records([*rows], columns=heads)
    return frame


def _results(record: Record) -> tuple[tuple[str, ...], Iterator[tuple[Any, ...]]]:
    """Returns the heads and the rows of ``results.csv``."""
    features = record.feature_names()
    cells = {cell.name: cell for cell in record.cells()}
    return (*COLUMNS, *features), _rows(record.stream(EVERY), features, cells)


def _rows(
    rows: Iterator[tuple[Any, ...]], features: Sequence[str], cells: Mapping[str, Cell]
) -> Iterator[tuple[Any, ...]]:
    for cell, number, batch, origin, seed, given, *rest, found in rows:
        test, _, parameters = cells[cell].scenario_of(origin).partition(" ")
        if rest[MEASURED.index("cause")] == "collision":
            rest[MEASURED.index("margin")] = None
        values = {name: float(value) for name, value in json_of(found).items()}
        named = (values.get(name) for name in features)
        own = seed if given else seed_of(seed, number)
        yield cell, number, batch, origin, test, parameters, own, *rest, *named


def _cell_row(record: Record, cell: Cell, status: CellStatus) -> dict[str, Any]:
    counts = Counter(status.outcomes)
    left = "SELECT count(*) FROM tests WHERE outcome = 'FAIL' AND side = 'left' AND cell = ?"
    ((failed_left,),) = record.query(left, (cell.name,))
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
        "failed_left": failed_left,
        "failing_cells": _failing_cells(record, cell),
        "least_margin_m": status.least_margin,
        "passed_partly_outside": status.partly_outside,
        "passed_mostly_outside": status.mostly_outside,
        "passed_max_oob": status.max_oob,
        "passed_beyond_m": status.beyond,
        "friction": status.friction,
        "oracle": status.oracle,
        "failed_handed_over": status.handed_over,
    }


def _failing_cells(record: Record, cell: Cell) -> int:
    """Counts the bins of the feature map that contain failures: a measure of how much these differ."""
    axes, cells, bounds = (
        cell.settings.get("axes", AXES),
        cell.settings.get("cells", PER_AXIS),
        bounds_of_columns(),
    )
    if not isinstance(axes, (list, tuple)) or not isinstance(cells, int) or not {*axes} <= {*bounds}:
        axes, cells = AXES, PER_AXIS  # another generator's settings mean something else
    failures = record.stream(
        "SELECT features FROM tests JOIN details USING (cell, number) "
        "WHERE tests.cell = ? AND outcome = 'FAIL'",
        (cell.name,),
    )
    with reading_store(record.path):
        places = {cell_of(json_of(features), axes, cells, bounds) for (features,) in failures}
    return len(places - {None})
