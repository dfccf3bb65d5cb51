"""CommonRoad files: lanelets in chains, and a task along them. Its own reader is asked in authorities/."""

import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest

from exported import ROADS, WORLD
from roadgpt.brief.plan import read_plan
from roadgpt.design import draft
from roadgpt.export import save
from roadgpt.network import made_from


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


@pytest.mark.parametrize(
    "plan",
    [
        "| len=60 // crossroads left lights // | len=60",
        "| len=60 // crossroads straight stop // | len=60",
        "| len=60 // t_junction left lights // | len=50 // roundabout exit=2 // | len=60",
    ],
)
def test_no_two_things_have_the_same_id_and_each_reference_leads_to_one(plan: str, tmp_path: Path) -> None:
    """CommonRoad asks for ids that are unique in a file."""
    route = made_from(draft(read_plan(plan), WORLD, seed=1), WORLD)
    (path,) = save(route, tmp_path, ["commonroad"], WORLD)
    root = ET.parse(path).getroot()
    ids = [each.attrib["id"] for each in root.iter() if "id" in each.attrib]
    assert len(ids) == len(set(ids))
    assert ("lights" in plan) == (root.find("trafficLight") is not None)
    assert root.find("planningProblem") is not None
    assert {each.attrib["ref"] for each in root.iter() if "ref" in each.attrib} <= set(ids)
