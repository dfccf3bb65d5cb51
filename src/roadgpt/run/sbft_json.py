"""A Run in the shape of the SBFT competition's ``test.NNNN.json``, which its tools read.

Where the competition leaves a field out (an invalid road has no execution data), it is here and empty. The
description of a drive has the competition's words; ``verdict.json`` has ours. The competition's interpolated
points are [x, y]; these have the height as well: [x, y, z].
"""

from typing import Any

import numpy as np

from roadgpt.run.atomic import json_text
from roadgpt.run.execution import ExecutionRecord, records_of
from roadgpt.run.features import features_of
from roadgpt.run.model import Run

DECIMALS = 5
PER_POINT = 1.0  # m


def test_of(run: Run) -> dict[str, Any]:
    """Returns the test as data, in the competition's order of fields."""
    points = np.empty((0, 3))
    control = np.empty((0, 2))
    if run.road is not None:
        points = np.round(run.road.centreline(PER_POINT), DECIMALS) + 0.0
        control = np.round(run.road.control_points(), DECIMALS) + 0.0
    records: list[ExecutionRecord] = []
    if run.road is not None and run.drive is not None:
        records = records_of(run.road, run.drive, run.world)
    return {
        "is_valid": run.is_valid,
        "validation_message": run.validation_message,
        "road_points": control.tolist(),
        "interpolated_points": points.tolist(),
        "id": run.index,
        "execution_data": records,
        "test_outcome": None if run.outcome == "VALID" else run.outcome,
        "description": run.verdict.sbft_description if run.verdict else run.description,
        "features": features_of(points, records) if run.is_valid else {},
    }


def test_name(index: int) -> str:
    """Returns the name of the file of road ``index``."""
    return f"test.{index:04d}.json"


def test_text(run: Run) -> str:
    """Returns the content of the file."""
    return json_text(test_of(run), indent=None)
