"""commonroad-io reads our CommonRoad files: lanelets, a network in order, a task with a goal.

The newest that goes with our pins is of 2022. A newer one, with CommonRoad's planners, is asked where an
environment of its own is at hand.
"""

import json
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from exported import ROADS, WORLD, python_with
from roadgpt.export import save

ASK = """
import json, sys, warnings
warnings.simplefilter("ignore")
from commonroad.common.file_reader import CommonRoadFileReader

def ask(file):
    scenario, problems = CommonRoadFileReader(file).open()
    (problem,) = problems.planning_problem_dict.values()
    network = scenario.lanelet_network
    place = problem.initial_state.position
    where = [each.lanelet_id for each in network.lanelets if each.polygon.contains_point(place)]
    way = where[:1]
    while network.find_lanelet_by_id(way[-1]).successor:
        way += network.find_lanelet_by_id(way[-1]).successor
    signs = [element for sign in network.traffic_signs for element in sign.traffic_sign_elements]
    return {
        "lanelets": [[each.left_vertices.tolist(), each.right_vertices.tolist(),
                      bool(each.polygon.shapely_object.is_valid)] for each in network.lanelets],
        "way": way,
        "goals": [id for ids in problem.goal.lanelets_of_goal_position.values() for id in ids],
        "velocity": problem.initial_state.velocity,
        "limits": [element.additional_values[0] for element in signs],
        "distance": sum(float(network.find_lanelet_by_id(id).distance[-1]) for id in way),
    }

print(json.dumps([ask(file) for file in sys.argv[1:]]))
"""


@pytest.fixture(scope="module")
def answers(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """What it read, by the name of the road; it is slow to start, and so is asked once."""
    python = python_with("commonroad", "venv-cr")
    folder = tmp_path_factory.mktemp("commonroad")
    files = [save(road, folder, ["commonroad"], WORLD, name)[0] for name, road in ROADS.items()]
    done = subprocess.run([python, "-c", ASK, *map(str, files)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return dict(zip(ROADS, json.loads(done.stdout), strict=True))


@pytest.mark.parametrize("name", ROADS)
def test_commonroad_io_finds_the_lanes_and_the_way_to_the_goal(answers: dict[str, Any], name: str) -> None:
    road, found = ROADS[name], answers[name]
    assert found["goals"] == found["way"][-1:]
    assert len(found["way"]) == len(found["lanelets"]) / 2
    turn = float(road.heading(road.length) - road.heading(0.0))
    assert found["distance"] == pytest.approx(road.length + 2 * turn, rel=0.01)
    assert [float(limit) for limit in found["limits"]] == [pytest.approx(50 / 3.6, abs=1e-5)]
    assert found["velocity"] == 0
    for left, right, is_valid in found["lanelets"]:
        assert is_valid
        points = np.array([*left, *right])
        s, t = road.locate(points[:, 0], points[:, 1])
        assert np.abs(road.at(s, t)[:, :2] - points).max() < 2e-3


PLAN = """
import sys, warnings
warnings.simplefilter("ignore")
import matplotlib
matplotlib.use("Agg")
from commonroad.common.file_reader import CommonRoadFileReader
from commonroad.scenario.lanelet import Lanelet
from commonroad.visualization.mp_renderer import MPRenderer
from commonroad_clcs.pycrccosy import CurvilinearCoordinateSystem
from commonroad_dc.boundary.boundary import create_road_boundary_obstacle
scenario, problems = CommonRoadFileReader(sys.argv[1]).open()
network = scenario.lanelet_network
(problem,) = problems.planning_problem_dict.values()
(start,) = network.find_lanelet_by_position([problem.initial_state.position])
first = network.find_lanelet_by_id(start[0])
lanes, _ = Lanelet.all_lanelets_by_merging_successors_from_lanelet(first, network)
frame = CurvilinearCoordinateSystem(lanes[0].center_vertices)
create_road_boundary_obstacle(scenario)
renderer = MPRenderer()
scenario.draw(renderer)
problems.draw(renderer)
renderer.render()
print(frame.length())
"""


def test_commonroads_planners_take_the_lanes(tmp_path: Path) -> None:
    python = python_with("commonroad_clcs", "venv-cr")
    road = ROADS["arcs"]
    (file,) = save(road, tmp_path, ["commonroad"], WORLD)
    done = subprocess.run([python, "-c", PLAN, str(file)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    turn = float(road.heading(road.length) - road.heading(0.0))
    # their frame is longer than the lane by what it adds at both ends
    assert float(done.stdout) == pytest.approx(road.length + 2 * turn, abs=5)
