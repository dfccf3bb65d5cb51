"""OpenSCENARIO of routes: ASAM's checker finds nothing, and the waypoints lead along the route in the map."""

import json
import xml.etree.ElementTree as ET
from collections.abc import Callable
from functools import cache
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from exported import asam_says
from roadgpt.brief.plan import read_plan
from roadgpt.design import draft
from roadgpt.export import save
from roadgpt.network import Route, made_from
from roadgpt.road import Site, World
from tables import rows as table_rows

WORLD = World(site=Site(map_size=700))
Saved = Callable[[str], tuple[Route, Path]]
PLANS = table_rows(__file__, "plans")


@pytest.fixture(scope="module")
def saved(tmp_path_factory: pytest.TempPathFactory) -> Saved:
    """Gives the route of a plan, and the folder with its files, which is made once."""

    @cache
    def made(line: str) -> tuple[Route, Path]:
        route = made_from(draft(read_plan(line), WORLD, seed=1), WORLD)
        assert isinstance(route, Route)
        folder = tmp_path_factory.mktemp("scenario")
        save(route, folder, ["openscenario"], WORLD, "x")
        return route, folder

    return made


@pytest.mark.parametrize("line", PLANS)
def test_asams_checker_finds_nothing(line: str, saved: Saved) -> None:
    _, folder = saved(line)
    issues, ends = asam_says(folder / "x.xosc")
    assert issues == []
    assert ends == {"completed": 17}


@pytest.mark.parametrize("line", PLANS)
def test_the_waypoints_lead_along_the_route(line: str, saved: Saved) -> None:
    _, folder = saved(line)
    scenario = ET.parse(folder / "x.xosc").getroot()
    map_ = ET.parse(folder / scenario.find("RoadNetwork/LogicFile").attrib["filepath"]).getroot()
    roads = {road.get("id"): road for road in map_.iter("road")}
    start, *ways, end = [place.attrib for place in scenario.iter("LanePosition")]
    assert start == ways[0]
    assert end == ways[-1]
    legs = json.loads((folder / "x.route.json").read_text())["route"]
    last = [] if len(legs) > 1 else legs
    assert [[int(way["roadId"]), int(way["laneId"])] for way in ways] == [*legs, *last]
    for way in ways:
        road = roads[way["roadId"]]
        assert 0 <= float(way["s"]) <= float(road.get("length"))
        ids = {lane.get("id") for lane in road.iter("lane") if lane.get("type") == "driving"}
        assert way["laneId"] in ids


def test_a_route_that_ends_beside_its_start_is_driven(saved: Saved) -> None:
    route, folder = saved("roundabout back")
    assert np.hypot(*(route.at(route.length) - route.at(0.0))[:2]) < 1
    groups = ET.parse(folder / "x.xosc").getroot().findall("Storyboard/StopTrigger/ConditionGroup")
    near, late = ([each.tag for each in group.iter()] for group in groups)
    assert "DistanceCondition" in near
    assert "TraveledDistanceCondition" in near
    assert "SimulationTimeCondition" in late
    (driven,) = groups[0].iter("TraveledDistanceCondition")
    assert 20 < float(driven.attrib["value"]) < route.length - 10


@pytest.mark.parametrize("line", [line for line in PLANS if "//" in line or "map" in line])
def test_the_car_starts_far_from_where_its_road_ends_and_stops_at_the_end_of_the_last(
    line: str, saved: Saved
) -> None:
    _, folder = saved(line)
    scenario = ET.parse(folder / "x.xosc").getroot()
    map_ = ET.parse(folder / "x.xodr").getroot()
    roads = {road.get("id"): road for road in map_.iter("road")}
    ways = [place.attrib for place in scenario.iter("LanePosition")][1:-1]
    first, last = roads[ways[0]["roadId"]], roads[ways[-1]["roadId"]]

    def leaves_at_its_end(road: ET.Element, other: ET.Element) -> bool:
        """Whether the successor of a road is another one, or the junction in which that one lies."""
        link = road.find("link/successor")
        if link is None:
            return False
        name = "junction" if link.get("elementType") == "junction" else "id"
        return link.get("elementId") == other.get(name)

    following = [roads[a] for a in (way["roadId"] for way in ways) if a != ways[0]["roadId"]]
    before = [roads[a] for a in (way["roadId"] for way in ways) if a != ways[-1]["roadId"]]
    at, length = float(ways[0]["s"]), float(first.get("length"))
    assert (at if leaves_at_its_end(first, following[0]) else length - at) < 5
    at, length = float(ways[-1]["s"]), float(last.get("length"))
    assert at == pytest.approx(0 if leaves_at_its_end(last, before[-1]) else length)
    assert all(one != two for one, two in pairwise(ways))
