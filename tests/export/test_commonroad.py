"""CommonRoad files: lanelets in chains, and a task along them. Its own reader is asked in authorities/."""

import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest

from exported import ROADS, WORLD
from roadgpt.export import save


def saved(name: str, folder: Path) -> ET.Element:
    (file,) = save(ROADS[name], folder, ["commonroad"], WORLD)
    return ET.parse(file).getroot()


def bound(lanelet: ET.Element, side: str) -> np.ndarray:
    points = lanelet.findall(f"{side}Bound/point")
    return np.array([[float(point.find(axis).text) for axis in "xy"] for point in points])


@pytest.mark.parametrize("name", ROADS)
def test_the_task_leads_from_rest_to_the_last_lanelet_of_the_right_lane(tmp_path: Path, name: str) -> None:
    road = ROADS[name]
    root = saved(name, tmp_path)
    (problem,) = root.findall("planningProblem")
    state = problem.find("initialState")
    x, y = (float(state.find(f"position/point/{axis}").text) for axis in "xy")
    s, t = road.locate(x, y)
    assert float(s) == pytest.approx(min(2.5, road.length / 2), abs=1e-3)
    assert float(t) == pytest.approx(-2.0, abs=1e-3)
    heading = float(state.find("orientation/exact").text)
    assert np.exp(1j * heading) == pytest.approx(np.exp(1j * road.heading(s)), abs=1e-3)
    assert abs(heading) <= np.pi
    goal = problem.find("goalState/position/lanelet").attrib["ref"]
    last = next(each for each in root.findall("lanelet") if each.attrib["id"] == goal)
    assert last.find("successor") is None
    assert bound(last, "right")[-1] == pytest.approx(road.at(road.length, -4.0)[:2], abs=1e-3)
    steps = int(problem.find("goalState/time/intervalEnd").text)
    assert steps * 0.1 > road.length / WORLD.limits.speed_limit
