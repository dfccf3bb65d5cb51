"""Converts a Run to the SBFT competition's file ``test.NNNN.json``, which the competition's tools read.

There are three differences from the competition's own files. A field that the competition omits, such as the
execution data of an invalid road, is present and empty. Interpolated points are [x, y, z] instead of the
competition's [x, y]. Where the map is not the usual one, ``world`` states its size. The description of a
drive uses the competition's wording; ``verdict.json`` has RoadGPT's.
"""

from typing import Any

import numpy as np

from roadgpt.brief.words import USUAL_MAP
from roadgpt.run.atomic import json_text
from roadgpt.run.execution import ExecutionRecord, records_of
from roadgpt.run.features import features_of
from roadgpt.run.model import Run

DECIMALS = 5
PER_POINT = 1.0  # m


def test_of(run: Run) -> dict[str, Any]:
    """Returns the content of a Run's test file as a dictionary with the competition's order of fields."""
    points = np.empty((0, 3))
    control = np.empty((0, 2))
    if run.road is not None:
        points = np.round(run.road.centreline(PER_POINT), DECIMALS) + 0.0
        control = np.round(run.road.control_points(), DECIMALS) + 0.0
    records: list[ExecutionRecord] = []
    if run.road is not None and run.drive is not None:
        records = records_of(run.road, run.drive, run.world)
    size = run.world.site.map_size
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
    } | ({} if size == USUAL_MAP else {"world": {"map_size": size}})


def test_name(index: int) -> str:
    """Returns the name of the test file of road ``index``."""
    return f"test.{index:04d}.json"


def test_text(run: Run) -> str:
    """Returns the content of the Run's test file."""
    return json_text(test_of(run), indent=None)
