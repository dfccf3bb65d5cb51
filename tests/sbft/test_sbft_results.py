"""A folder of results is what the competition's own tools read: by another reader, and by counting again."""

import math
from pathlib import Path

import pytest

from authorities.sbft_official_slow import interpolated, verdict
from authorities.sbft_results import read_results
from roadgpt_sbft import Experiment, compete

EXAMPLES = Path(__file__).resolve().parents[2] / "examples" / "sbft"
TESTS = 14


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("results")
    experiment = Experiment(
        module_name="curvature_walk", class_name="CurvatureWalk", module_path=str(EXAMPLES), test_budget=TESTS
    )
    assert len(list(compete(experiment, out=out))) == TESTS
    return out


def test_names_order_and_types_are_theirs(folder: Path) -> None:
    tests, generation, oob, experiment = read_results(folder)
    assert [test["id"] for test in tests] == [*range(1, TESTS + 1)]
    valid = [test for test in tests if test["is_valid"]]
    outcomes = [test["test_outcome"] for test in valid]
    assert {"PASS", "FAIL"} <= {*outcomes}
    assert int(generation["test_generated"]) == TESTS
    assert int(generation["test_valid"]) == len(valid) < TESTS
    assert int(generation["test_invalid"]) == TESTS - len(valid)
    assert int(generation["test_passed"]) == outcomes.count("PASS")
    assert int(generation["test_failed"]) == outcomes.count("FAIL")
    assert int(generation["test_in_error"]) == 0
    simulated = sum(test["execution_data"][-1].timer for test in valid)
    assert float(generation["simulated_time_execution"]) == pytest.approx(simulated, abs=0.1 * len(valid))
    assert experiment["module_name"] == "curvature_walk"
    assert float(experiment["map_size"]) == 200
    assert int(oob["total_oob"]) == int(oob["left_oob"]) + int(oob["right_oob"])


def test_verdicts_and_points_are_those_of_the_slow_validator(folder: Path) -> None:
    for test in read_results(folder)[0]:
        assert (test["is_valid"], test["validation_message"]) == verdict(test["road_points"], 200)
        nodes = interpolated([tuple(point) for point in test["road_points"]])
        assert len(nodes) == len(test["interpolated_points"])
        for (x, y), (u, v) in zip(nodes, test["interpolated_points"], strict=True):
            assert math.hypot(x - u, y - v) < 1.5e-3


def test_outcomes_follow_from_the_records(folder: Path) -> None:
    tests, _, oob, _ = read_results(folder)
    left = total = 0
    for test in tests:
        if not test["is_valid"]:
            continue
        records = test["execution_data"]
        is_out = any(row.oob_percentage > 0.95 for row in records)
        assert is_out == any(row.is_oob for row in records)
        assert all(-29 < row.pos[2] < -26 for row in records)
        end = test["interpolated_points"][-1]
        assert math.dist(records[0].pos[:2], test["interpolated_points"][0]) < 5
        if test["test_outcome"] == "PASS":
            assert test["description"] == "Successful test"
            assert not is_out
            assert math.dist(records[-1].pos[:2], end) < 9
        elif test["description"].startswith("Car drove out of the lane "):
            assert is_out
            place = next(row.pos[:2] for row in records if row.is_oob)
            total += 1
            left += min(math.dist(place, point) for point in test["interpolated_points"]) < 2
        else:
            assert test["description"].startswith("Car is not moving fast enough ")
    assert (total, left) == (int(oob["total_oob"]), int(oob["left_oob"]))
