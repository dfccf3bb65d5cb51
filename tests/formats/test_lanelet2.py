"""Lanelet2 maps: the library itself loads them, finds our points again and a way from start to end."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from shapely.geometry import Polygon

from exported import ROADS, WORLD
from profiled import bend
from roadgpt.export import doubts, save
from roadgpt.export.exporters.opendrive import LATITUDE, LONGITUDE
from roadgpt.road import Road, World
from roadgpt_formats.lanelets import lanelets_of

NEAR = [name for name in ROADS if name != "far away"]  # the others leave the UTM zone's middle


def saved(name: str, folder: Path) -> Path:
    (file,) = save(ROADS[name], folder, ["lanelet2"], WORLD)
    return file


@pytest.fixture(scope="module")
def lanelet2() -> Any:
    """Its wheels are for Python 3.11 on Linux."""
    library = pytest.importorskip("lanelet2")
    for part in ("core", "geometry", "io", "projection", "routing", "traffic_rules"):
        pytest.importorskip(f"lanelet2.{part}")
    return library


def loaded(lanelet2: Any, file: Path) -> Any:
    projector = lanelet2.projection.UtmProjector(lanelet2.io.Origin(LATITUDE, LONGITUDE))
    map_, errors = lanelet2.io.loadRobust(str(file), projector)
    assert list(errors) == []
    return map_


def rules_of(lanelet2: Any) -> Any:
    which = lanelet2.traffic_rules
    return which.create(which.Locations.Germany, which.Participants.Vehicle)


def lanelet_at(lanelet2: Any, map_: Any, road: Road, s: float, t: float) -> Any:
    x, y, _ = road.at(s, t)
    place = lanelet2.core.BasicPoint2d(float(x), float(y))
    ((distance, found),) = lanelet2.geometry.findNearest(map_.laneletLayer, place, 1)
    assert distance < 1e-3
    return found


@pytest.mark.parametrize("name", NEAR)
def test_lanelet2_finds_our_points_within_a_millimetre(lanelet2: Any, tmp_path: Path, name: str) -> None:
    road = ROADS[name]
    map_ = loaded(lanelet2, saved(name, tmp_path))
    points = np.array([[point.x, point.y, point.z] for point in map_.pointLayer])
    s, t = road.locate(points[:, 0], points[:, 1])
    assert np.abs(t[:, None] - [-4.0, 0.0, 4.0]).min(axis=1).max() < 1e-3
    assert np.abs(road.at(s, t) - points).max() < 1e-3
    assert {-4, 0, 4} == {*np.round(t).astype(int).tolist()}


@pytest.mark.parametrize("name", NEAR)
def test_a_route_leads_from_start_to_end_and_another_one_back(
    lanelet2: Any, tmp_path: Path, name: str
) -> None:
    road = ROADS[name]
    map_ = loaded(lanelet2, saved(name, tmp_path))
    rules = rules_of(lanelet2)
    graph = lanelet2.routing.RoutingGraph(map_, rules)
    assert not list(graph.checkValidity(False))
    for t, stations in ((-2.0, (0.1, road.length - 0.1)), (2.0, (road.length - 0.1, 0.1))):
        start, end = (lanelet_at(lanelet2, map_, road, s, t) for s in stations)
        route = list(graph.shortestPath(start, end))
        assert len(route) == len(list(map_.laneletLayer)) / 2
        length = sum(lanelet2.geometry.length2d(each) for each in route)
        turn = float(road.heading(road.length) - road.heading(0.0))
        assert length == pytest.approx(road.length - turn * t, rel=5e-3)
        for each in route:
            assert rules.canPass(each)
            assert rules.isOneWay(each)
            assert rules.speedLimit(each).speedLimit == pytest.approx(50.0)  # km/h, in its bindings
        assert graph.shortestPath(end, start) is None or len(route) == 1


@pytest.mark.parametrize("ends", [False, True])
@pytest.mark.parametrize("side", [-1, 1])
@pytest.mark.parametrize("radius", [2.5, 5.0, 8.0, 15.0])
def test_where_lanelet2_loses_a_way_or_a_lane_folds_it_is_said(
    lanelet2: Any, tmp_path: Path, radius: float, side: int, ends: bool
) -> None:
    road = bend(radius, 4.5, side, 2, ends)
    (file,) = save(road, tmp_path, ["lanelet2"], World())
    map_ = loaded(lanelet2, file)
    graph = lanelet2.routing.RoutingGraph(map_, rules_of(lanelet2))
    wanted = sum(len(each.after) for each in lanelets_of(road, World()))
    found = sum(len(list(graph.following(each))) for each in map_.laneletLayer)
    whole = all(Polygon([(p.x, p.y) for p in each.polygon2d()]).is_valid for each in map_.laneletLayer)
    said = doubts(road, ["lanelet2"], World())
    if wanted != found or not whole:
        (sentence,) = said
        s = float(re.findall(r"at s = (\d+) m", sentence)[0])
        assert 30 <= s <= 30 + np.pi / 2 * radius + 0.5
        assert f"a radius of {radius:.1f} m" in sentence
    if radius > 9.5:
        assert said == ()
