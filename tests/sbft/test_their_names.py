"""The competition's names, used as its generators use them: in a process in which they can be imported."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from roadgpt.run.execution import FIELDS
from roadgpt_sbft.generator_process import NAMES

# The folder of names stands first on the path, and RoadGPT answers here, as in a generator's process.
HEAD = (
    f"import sys; sys.path.insert(0, {str(NAMES)!r})\n"
    "import roadgpt_inside, roadgpt_sbft.answers\n"
    "roadgpt_inside.Answering.here = roadgpt_sbft.answers.answer\n"
)


def told(code: str, folder: Path | None = None) -> str:
    done = subprocess.run(
        [sys.executable, "-c", HEAD + code], cwd=folder, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


def test_records_have_all_17_fields_in_order() -> None:
    code = (
        "from self_driving.simulation_data import SimulationDataRecord, SimulationDataRecords\n"
        "import json; print(json.dumps(SimulationDataRecord._fields))"
    )
    assert json.loads(told(code)) == list(FIELDS)
    assert len(FIELDS) == 17


def test_a_test_is_made_measured_and_told_as_theirs_is() -> None:
    code = """
import json, math
from code_pipeline.tests_generation import RoadTestFactory, TestGenerationStatistic
from code_pipeline.validation import TestValidator
from code_pipeline.executors import AbstractTestExecutor, MockExecutor, Budget
from code_pipeline.beamng_executor import BeamngExecutor
from code_pipeline.visualization import RoadTestVisualizer
from code_pipeline.test_analysis import (
    compute_all_features, direction_coverage, direction_coverage_klk, max_curvature, max_lateral_position)
from types import SimpleNamespace
points = [(40.0 + 60 * math.sin(a / 10), 120 - 60 * math.cos(a / 10)) for a in range(12)]
one, two = (RoadTestFactory.create_road_test(points) for _ in range(2))
assert (one.id, two.id) == (1, 2)
assert one.is_valid is None
assert type(one) is RoadTestFactory.RoadTest
assert all(len(node) == 4 and node[2:] == (-28.0, 8.0) for node in one.interpolated_points)
assert abs(one.get_road_length() - 66) < 1
assert abs(one.get_road_length(interpolate_road_points=True) - one.get_road_length()) < 0.5
assert list(json.loads(one.to_json())) == [
    "is_valid", "validation_message", "road_points", "interpolated_points", "id"]
assert TestValidator(200).validate_test(one) == (True, "")
class Own(RoadTestFactory.RoadTest):
    pass
assert TestValidator(200).validate_test(Own(points)) == (False, "Wrong type")
assert TestValidator(75).validate_test(one)[0] is False
assert TestValidator(map_size=200, min_road_length=5).validate_test([]) == (False, "Wrong type")
name, bend = max_curvature(one)
assert name == "MAX_CURV" and abs(1 / bend - 60) < 2
(name, share), (other, wider) = direction_coverage(one), direction_coverage_klk(one)
assert name == other == "DIR_COV" and 0 < share < 0.5 and 0 < wider < 0.5
ring = [(math.cos(a / 30), math.sin(a / 30)) for a in range(189)]
assert direction_coverage(ring)[1] == 13 / 26 and direction_coverage_klk(ring)[1] == 35 / 36
assert direction_coverage(ring, n_bins=36)[1] == 18 / 37
assert max_lateral_position([SimpleNamespace(oob_distance=d) for d in (0.5, 1.5)]) == ("MAX_LP", 1.5)
assert set(compute_all_features(one, [])) == {"MAX_CURV", "DIR_COV"}
RoadTestVisualizer(map_size=200).visualize_road_test(one)
stats = TestGenerationStatistic()
stats.add("FAIL", "Car drove out of the lane 7")
assert stats.as_csv().splitlines()[0] == (
    "test_generated,test_valid,test_invalid,test_passed,test_failed,test_in_error,"
    "real_time_generation,real_time_execution,simulated_time_execution")
assert (stats.test_failed, stats.obes) == (1, 1)
print("well")
"""
    assert told(code) == "well"


def test_polygons_and_boxes_answer_as_a_generator_of_seeds_asks_them() -> None:
    code = """
from shapely.geometry import Point
from self_driving.bbox import RoadBoundingBox
from self_driving.road_polygon import RoadPolygon
box = RoadBoundingBox((0, 0, 250, 250))
assert not box.intersects_vertices(Point(125, 0))
assert box.intersects_sides(Point(125, 0))
assert not box.bbox.contains(Point(125, -25))
nodes = [(125.0, -25.0, -28.0, 8.0), (125.0, 0.0, -28.0, 8.0), (125.0, 25.0, -28.0, 8.0)]
road = RoadPolygon.from_nodes(nodes)
assert len(road.polygons) == 2
assert road.is_valid()
assert box.intersects_boundary(road.polygons[0])
assert not box.contains(road)
on = [*nodes, (125.0, 50.0, -28.0, 8.0), (117.0, 74.0, -28.0, 8.0)]
assert not box.intersects_boundary(RoadPolygon.from_nodes(on).polygons[-1])
assert box.contains(RoadPolygon.from_nodes(on[3:]))
assert abs(road.polygon.area - 400) < 1e-9
assert abs(road.right_polygon.area - 200) < 1e-9
assert road.right_polygon.contains(Point(127, 10))
assert road.left_polygon.contains(Point(123, 10))
knot = [(0, 0, -28, 8), (50, 0, -28, 8), (50, 30, -28, 8), (20, 30, -28, 8), (20, -30, -28, 8)]
assert not RoadPolygon.from_nodes(knot).is_valid()
print("well")
"""
    assert told(code) == "well"


@pytest.mark.parametrize("values", [{"test_budget": 4}, {"time_budget": 100.0}])
def test_a_budget_is_a_number_whatever_is_counted(values: dict[str, float]) -> None:
    code = f"""
import copy, json
from code_pipeline.executors import Budget
budget = Budget(**{values})
assert budget.can_run_a_test()
assert not budget.is_over()
assert budget.get_remaining_real_time() > 0.5 * budget.time_budget
left = budget.get_remaining_time()
assert abs(left["time-budget"] - float(left)) < 1e-9
assert left > 0
assert left >= 1
assert not left < 1
assert not left <= 0
assert left - 1 < float(left) < 1 + left["time-budget"]
assert 1000 - left > 0
assert json.loads(json.dumps(left)) == dict(left)
copied = copy.deepcopy(budget)
budget.tests = 4
assert budget.is_over() == copied.is_over() == {"test_budget" in values}
print("well")
"""
    assert told(code) == "well"
