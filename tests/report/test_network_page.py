"""The page of a route: its data hold the whole network, and a browser draws it without complaint."""

from collections.abc import Iterator
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import shapely
from tests.report.test_networks import TWO

from roadgpt.network import Route, made_from
from roadgpt.network.markings import arrows, strokes
from roadgpt.report import view
from roadgpt.road import World, read_design
from roadgpt.run import Run, Setup, prove
from tests import chromium


@cache
def run_of(lanes: int = 1) -> Run:
    world = World()
    data = {**TWO, "junction2": {**TWO["junction2"], "ring_lanes": lanes}}
    if lanes > 1:
        data["lanes"] = {"forward": lanes, "backward": lanes, "width": 3.5}
    return prove(made_from(read_design(data)[0], world), setup=Setup(drives=False), world=world)


@pytest.fixture(scope="module")
def run() -> Run:
    return run_of()


@pytest.fixture(scope="module")
def route(run: Run) -> Route:
    assert isinstance(run.road, Route)
    return run.road


def polygons(triangles: dict[str, list[float]]) -> list[shapely.Polygon]:
    points = np.reshape(triangles["points"], (-1, 2))
    return [shapely.Polygon(points[corners]) for corners in np.reshape(triangles["corners"], (-1, 3))]


def swept(road: dict[str, object]) -> shapely.Polygon:
    """The carriageway of a road of the page, as the page's scripts sweep it."""
    lanes = road["lanes"]
    heading = np.array(road["heading"])
    sides = []
    for bound in (lanes["bounds"][0], lanes["bounds"][-1]):  # type: ignore[index]
        x = np.array(road["x"]) - bound["t"] * np.sin(heading)
        y = np.array(road["y"]) + bound["t"] * np.cos(heading)
        sides.append(np.column_stack([x, y]))
    return shapely.Polygon(np.concatenate([sides[0], sides[1][::-1]]))


def test_roads_and_junctions_of_the_page_are_the_paved_area(run: Run, route: Route) -> None:
    network = view.scene(run)["network"]
    parts = [polygon for area in network["areas"] for polygon in polygons(area["paved"])]
    parts += [swept(road) for road in network["roads"]]
    whole = shapely.union_all(parts, grid_size=1e-4)
    assert shapely.symmetric_difference(whole, route.network.paved).area < 0.002 * route.network.paved.area
    assert sum(part.area for part in parts) == pytest.approx(route.network.paved.area, rel=0.002)


def test_every_line_and_every_sign_is_on_the_page(run: Run, route: Route) -> None:
    network = view.scene(run)["network"]
    assert len(network["strokes"]) == len(strokes(route.network))
    assert {face["colour"] for face in network["signs"]} == {"grey", "red", "white", "yellow"}
    assert [each["name"] for each in network["stretches"]] == ["crossroads", "roundabout"]


def test_every_arrow_is_on_the_page_with_triangles_seen_from_above() -> None:
    run = run_of(lanes=2)
    assert isinstance(run.road, Route)
    told, painted = view.scene(run)["network"]["arrows"], arrows(run.road.network)
    assert len(told) == len(painted) > 2
    for each, arrow in zip(told, painted, strict=True):
        points = np.reshape(each["points"], (-1, 3))
        np.testing.assert_allclose(points, arrow.points, atol=1e-3)
        flat = polygons({**each, "points": points[:, :2].reshape(-1)})
        assert all(polygon.exterior.is_ccw for polygon in flat)
        outline = shapely.Polygon(arrow.points[:, :2])
        assert sum(polygon.area for polygon in flat) == pytest.approx(outline.area, abs=0.02)


@pytest.fixture(scope="module")
def page() -> Iterator[chromium.BrowserTab]:
    if chromium.FOUND is None:
        pytest.skip("needs chromium")
    with chromium.browser() as page:
        page.size(900, 600)
        yield page


def test_a_browser_draws_the_network(page: chromium.BrowserTab, tmp_path: Path) -> None:
    run = run_of(lanes=2)
    assert isinstance(run.road, Route)
    path = view.write([run], tmp_path / "page.html")
    page.open(path, "#camera=free")
    picture = page.picture(".scene")[..., :3]
    assert page.told == []
    is_dark = (picture.max(axis=2) < 0.4) & (np.ptp(picture, axis=2) < 0.12)
    assert 0.01 < is_dark.mean() < 0.3
    page.run("roadgpt.player.moveTo(roadgpt.player.duration * 0.6)")
    plan = page.picture(".plan canvas")[..., :3]
    assert page.told == []
    is_road = np.abs(plan - np.array([0x62, 0x66, 0x6D]) / 255).max(axis=2) < 0.02
    assert is_road.mean() > 0.015
    lane = run.road.legs[0]
    (arrow,) = (each for each in arrows(run.road.network) if (each.end.road, each.lane) == lane[:2])
    share = (arrow.s - 9) / run.road.length
    page.run(f"roadgpt.player.choose('bonnet'); roadgpt.player.moveTo(roadgpt.player.duration * {share})")
    picture = page.picture(".scene")[..., :3]
    high, wide = picture.shape[:2]
    # between the stop line and the car, where the lane has no other paint
    ahead = picture[int(0.53 * high) : int(0.75 * high), int(0.42 * wide) : int(0.58 * wide)]
    assert 0.05 < (ahead.min(axis=2) > 0.7).mean() < 0.5


def test_a_browser_draws_a_map_without_a_route(page: chromium.BrowserTab, tmp_path: Path) -> None:
    road = run_of().road
    assert isinstance(road, Route)
    shares = []
    for legs in (road.legs, ()):
        shown = prove(Route.along(road.network, legs).on_ground(), setup=Setup(drives=False))
        page.open(view.write([shown], tmp_path / "page.html"), "#camera=free")
        plan = page.picture(".plan canvas")[..., :3]
        assert page.told == []
        tint = np.abs(plan - np.array([0x4F, 0x86, 0xB5]) / 255).max(axis=2) < 0.02
        shares.append(tint.mean())
    assert shares[0] > 0.005
    assert shares[1] == 0
