"""Reads a folder of results as the competition's documents describe it: names, order and types of all fields.

Nothing of roadgpt is used here. Source: what is known of the SBFT tool competition's pipeline (2024): one
test.NNNN.json for each test, three tables, and what its own evaluation reads out of them.
"""

import csv
import json
import math
import re
from collections import namedtuple
from pathlib import Path

RECORD = namedtuple(
    "RECORD",
    [
        "timer", "pos", "dir", "vel", "steering", "steering_input", "brake", "brake_input", "throttle",
        "throttle_input", "wheelspeed", "vel_kmh", "is_oob", "oob_counter", "max_oob_percentage",
        "oob_distance", "oob_percentage",
    ],
)  # fmt: skip
TRIPLES = ("pos", "dir", "vel")
INVALID = ["is_valid", "validation_message", "road_points", "interpolated_points", "id"]
VALID = [*INVALID, "execution_data", "test_outcome", "description", "features"]
FEATURES = ["MAX_CURV", "DIR_COV", "STD_SA", "MEAN_LP", "MAX_LP"]
GENERATION = [
    "test_generated", "test_valid", "test_invalid", "test_passed", "test_failed", "test_in_error",
    "real_time_generation", "real_time_execution", "simulated_time_execution",
]  # fmt: skip
OOB = ["total_oob", "left_oob", "right_oob", "avg_sparseness", "stdev_sparseness"]
EXPERIMENT = [
    "executor", "dave2_model", "beamng_home", "beamng_user", "time_budget", "map_size", "oob_tolerance",
    "speed_limit", "module_name", "module_path", "class_name", "visualize_tests", "log_to", "debug",
]  # fmt: skip
OUTCOMES = {"PASS", "FAIL", "ERROR"}


def read_results(folder: Path) -> tuple[list[dict], dict, dict, dict]:
    """Tests by their numbers, and the three tables; AssertionError where something is not as it is there."""
    files = sorted(folder.glob("test.*.json"))
    assert all(re.fullmatch(r"test\.\d{4,}\.json", path.name) for path in files)
    tests = [read_test(path) for path in files]
    generation = table(folder / "generation_stats.csv", GENERATION)
    oob = table(folder / "oob_stats.csv", OOB)
    experiment = table(folder / "experiment_description.csv", EXPERIMENT)
    return tests, generation, oob, experiment


def read_test(path: Path) -> dict:
    """One test, its records named."""
    test = json.loads(path.read_text(), parse_constant=refuse)
    assert isinstance(test["is_valid"], bool)
    assert list(test) == (VALID if test["is_valid"] else INVALID)
    assert isinstance(test["validation_message"], str)
    assert (test["validation_message"] == "") == test["is_valid"]
    assert f"test.{test['id']:04d}.json" == path.name
    for name in ("road_points", "interpolated_points"):
        assert all(len(point) == 2 and all(map(is_number, point)) for point in test[name])
    if test["is_valid"]:
        assert test["test_outcome"] in OUTCOMES
        assert isinstance(test["description"], str)
        test["execution_data"] = [record(row) for row in test["execution_data"]]
        times = [row.timer for row in test["execution_data"]]
        assert times == sorted(times)
        if len(times) > 2:
            assert list(test["features"]) == FEATURES
            assert all(map(is_number, test["features"].values()))
    return test


def record(row: list) -> RECORD:
    """A positional list of 17, checked."""
    assert isinstance(row, list)
    made = RECORD(*row)
    for name, value in zip(made._fields, made, strict=True):
        if name in TRIPLES:
            assert len(value) == 3
            assert all(map(is_number, value))
        elif name == "is_oob":
            assert isinstance(value, bool)
        elif name == "oob_counter":
            assert isinstance(value, int)
        else:
            assert is_number(value)
    assert abs(math.hypot(*made.dir) - 1) < 1e-3
    assert 0 <= made.oob_percentage <= 1
    assert made.oob_distance <= 2
    return made


def table(path: Path, columns: list[str]) -> dict[str, str]:
    """A table of one row, whose first columns are these."""
    with path.open(newline="") as file:
        header, row = csv.reader(file)
    assert header[: len(columns)] == columns
    assert len(header) == len(row)
    return dict(zip(header, row, strict=True))


def is_number(value: object) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


def refuse(constant: str) -> None:
    raise AssertionError(f"{constant} is no JSON")
