"""Pictures of heights, as rasterio and Pillow read them."""

import json
from pathlib import Path

import numpy as np
import pytest
import rasterio
import shapely
from PIL import Image

from exported import ROADS
from network.random_maps import map_route
from roadgpt.export import save
from roadgpt.geometry import GradeProfile, Piece, PieceCurve
from roadgpt.network.landscape import ground_around
from roadgpt.road import Road, World

LONG = Road(PieceCurve(40.0, 60.0, 0.6, (Piece(1400.0),)), GradeProfile(5.0, (0.0, 1400.0), (0.02, -0.01)))


def world(scene: str = "", ground: str = "", lanes: str = "1+1") -> World:
    return World().changed(scene=scene, ground=ground, lanes=lanes, map_size=2000)


@pytest.mark.parametrize(
    ("road", "scene", "ground"),
    [
        (ROADS["arcs"], "", "hilly:3"), (ROADS["arcs"], "bridge x2", "rolling:2"), (LONG, "", "rolling:4"),
        (ROADS["arcs"], "ridge through; tunnel", "hilly:1"), (ROADS["arcs"], "", "mountain:2"),
        (ROADS["flat points"], "lake left", "flat"),
    ],
)  # fmt: skip
def test_a_picture_of_heights_is_read_with_its_place_as_the_ground_is(
    road: Road, scene: str, ground: str, tmp_path: Path
) -> None:
    on = world(scene, ground)
    save(road, tmp_path, ["heightmap"], on)
    told = json.loads((tmp_path / "road.json").read_text())
    with Image.open(tmp_path / "road.png") as image:
        levels = np.asarray(image)
    with rasterio.open(tmp_path / "road.png") as data:
        assert data.dtypes == ("uint16",)
        assert (data.read(1) == levels).all()
        rows, columns = np.mgrid[0 : data.height : 7, 0 : data.width : 7]
        x, y = map(np.ravel, data.xy(rows, columns))
        assert data.res == (told["cell"], told["cell"])
    z = told["lowest"] + told["step"] * levels[rows, columns].ravel()
    exact = ground_around(road, on)
    # two ways to the lowest slope, from cell to cell or along a rim, may end 2 cm apart
    assert np.abs(z - exact.height(x, y)).max() < 0.51 * told["step"] + 0.02
    assert 0.001 <= told["step"] < 0.02
    line = shapely.LineString(road.centreline()[:, :2]).buffer(100.0)
    assert shapely.box(x.min(), y.min(), x.max(), y.max()).contains(line)
    found = [tuple(each.values()) for each in told["structures"]]
    assert found == [tuple(each) for each in exact.pavement.spans]
    assert {kind for kind, *_ in found} == {kind for kind in ("bridge", "tunnel") if kind in scene}


@pytest.mark.parametrize(("lanes", "middle", "width"), [("1+1", 0.0, 8.0), ("2+1", -2.0, 12.0)])
def test_the_roads_of_a_picture_are_nodes_with_widths(
    lanes: str, middle: float, width: float, tmp_path: Path
) -> None:
    """Land keeps the height of a road up to 1 m beyond the verges, which are 3 m wide."""
    road = ROADS["arcs"]
    save(road, tmp_path, ["heightmap"], world(ground="hilly", lanes=lanes))
    (told,) = json.loads((tmp_path / "road.json").read_text())["roads"]
    nodes = np.array(told["nodes"])
    s, t = road.locate(*nodes[:, :2].T)
    assert s[[0, -1]] == pytest.approx([0.0, road.length], abs=0.01)
    assert np.diff(s) == pytest.approx(np.full(len(s) - 1, 5.0), abs=0.5)
    assert t == pytest.approx(np.full(len(s), middle), abs=0.01)
    assert nodes[:, 2] == pytest.approx(road.at(s)[:, 2], abs=0.001)
    assert nodes[:, 3].tolist() == [width] * len(s)
    assert told["margin"] == 1.0
    assert told["domain_of_influence"] == pytest.approx(width / 2 + 3.0 + told["margin"])
    route = map_route(1).on_ground()
    save(route, tmp_path, ["heightmap"], world(ground="rolling"))
    told = json.loads((tmp_path / "road.json").read_text())["roads"]
    assert {each["id"] for each in told} == {each.id for each in route.network.roads}
