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
def test_two_chains_run_side_by_side_the_length_of_the_road(tmp_path: Path, name: str) -> None:
    road = ROADS[name]
    root = saved(name, tmp_path)
    lanelets = {int(each.attrib["id"]): each for each in root.findall("lanelet")}
    ends = [id_ for id_, each in lanelets.items() if each.find("successor") is None]
    assert len(ends) == 2
    for id_, lanelet in lanelets.items():
        left, right = bound(lanelet, "left"), bound(lanelet, "right")
        assert left.shape == right.shape
        after = lanelet.find("successor")
        if after is not None:
            follower = lanelets[int(after.attrib["ref"])]
            assert (bound(follower, "left")[0] == left[-1]).all()
            assert (bound(follower, "right")[0] == right[-1]).all()
            assert int(follower.find("predecessor").attrib["ref"]) == id_
        beside = lanelets[int(lanelet.find("adjacentLeft").attrib["ref"])]
        assert lanelet.find("adjacentLeft").attrib["drivingDir"] == "opposite"
        assert (bound(beside, "left")[::-1] == left).all()
        s, t = road.locate(right[:, 0], right[:, 1])
        forward = s[-1] > s[0]
        assert t == pytest.approx(-4.0 if forward else 4.0, abs=1e-3)
        assert id_ <= len(lanelets) / 2 if forward else id_ > len(lanelets) / 2


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


def test_the_sign_says_the_speed_limit(tmp_path: Path) -> None:
    root = saved("arcs", tmp_path)
    (sign,) = root.findall("trafficSign")
    assert sign.find("trafficSignElement/trafficSignID").text == "274"
    assert float(sign.find("trafficSignElement/additionalValue").text) == pytest.approx(50 / 3.6, abs=1e-5)
    assert {each.attrib["ref"] for each in root.iter("trafficSignRef")} == {sign.attrib["id"]}
    ids = [each.attrib["id"] for each in root if "id" in each.attrib]
    assert len(ids) == len(set(ids))
