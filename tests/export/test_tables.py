"""CSV, SBFT tests and GeoJSON, and the place on Earth that GeoJSON needs."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest

from exported import ROADS, WORLD, drive
from roadgpt.export import save
from roadgpt.export.georeference import FLATTENING, LATITUDE, LONGITUDE, SEMI_MAJOR, degrees
from roadgpt.network import read_road
from roadgpt.road import Profile


def test_the_table_has_the_road_every_metre(tmp_path: Path) -> None:
    road = ROADS["arcs"]
    file, driven = save(road, tmp_path, ["csv"], WORLD, poses=drive(road))
    rows = list(csv.DictReader(file.open()))
    s = np.array([float(row["s_m"]) for row in rows])
    assert np.diff(s) == pytest.approx(1, abs=0.01)
    assert s[-1] == pytest.approx(road.length, abs=1e-6)
    for i, axis in enumerate("xyz"):
        assert [float(row[f"{axis}_m"]) for row in rows] == pytest.approx(road.at(s)[:, i], abs=2e-6)
    assert [float(row["curvature_per_m"]) for row in rows] == pytest.approx(road.curvature(s), abs=1e-3)
    assert {(row["lane_width_m"], row["verge_m"]) for row in rows} == {("4.0", "3.0")}
    steps = list(csv.DictReader(driven.open()))
    assert driven.name == "road.drive.csv"
    assert [float(row["time_s"]) for row in steps] == pytest.approx(drive(road).time, abs=1e-6)
    assert {row["speed_mps"] for row in steps} == {"8.0"}


@pytest.mark.parametrize("name", ["arcs", "spline", "flat points"])
def test_the_sbft_test_is_read_as_the_road(tmp_path: Path, name: str) -> None:
    road = ROADS[name]
    (file,) = save(road, tmp_path, ["sbft"], WORLD)
    again = read_road(file)
    assert again.control_points() == pytest.approx(road.control_points(), abs=1e-5)
    if name != "flat points":
        s = np.linspace(0, road.length, 200)
        _, away = road.locate(*again.at(s * again.length / road.length)[:, :2].T)
        assert np.abs(away).max() < 0.01


def test_geojson_has_the_lanes_the_right_way_round(tmp_path: Path) -> None:
    road = ROADS["arcs"]
    (file,) = save(road, tmp_path, ["geojson"], WORLD, poses=drive(road))
    features = {each["properties"]["name"]: each for each in json.loads(file.read_text())["features"]}
    assert list(features) == ["centre line", "right lane", "left lane", "drive"]
    line = np.array(features["centre line"]["geometry"]["coordinates"])
    assert line[:, 2] == pytest.approx(road.centreline()[:, 2], abs=1e-4)
    for name in ("right lane", "left lane"):
        (ring,) = features[name]["geometry"]["coordinates"]
        x, y = np.array(ring)[:, :2].T
        assert ring[0] == ring[-1]
        assert (x[:-1] * y[1:] - x[1:] * y[:-1]).sum() > 0  # counter-clockwise, RFC 7946
    assert len(features["drive"]["properties"]["time_s"]) == len(drive(road))


def test_geojson_counts_lanes_on_the_side_where_they_are(tmp_path: Path) -> None:
    """On the left: two lanes along the road and their shoulder; on the right: one lane against it."""
    profile = Profile.of(2, 1, 4.0, 1.0).mirrored
    (file,) = save(ROADS["arcs"].with_profile(profile), tmp_path, ["geojson"], WORLD)
    lanes = [each["properties"] for each in json.loads(file.read_text())["features"][1:]]
    assert [lane["name"] for lane in lanes] == ["right lane", "left lane 1", "left lane 2"]
    assert {lane["width_m"] for lane in lanes} == {4.0}


def test_the_corner_of_the_map_is_the_place() -> None:
    longitude, latitude = degrees(0.0, 0.0)
    assert (float(longitude), float(latitude)) == pytest.approx((LONGITUDE, LATITUDE), abs=1e-12)


def on_the_ellipsoid(longitude: np.ndarray, latitude: np.ndarray) -> np.ndarray:
    """Cartesian coordinates of places on WGS 84, from its definition."""
    e2 = FLATTENING * (2 - FLATTENING)
    lon, lat = np.radians(longitude), np.radians(latitude)
    n = SEMI_MAJOR / np.sqrt(1 - e2 * np.sin(lat) ** 2)
    return np.stack(
        [n * np.cos(lat) * np.cos(lon), n * np.cos(lat) * np.sin(lon), n * (1 - e2) * np.sin(lat)], -1
    )


def test_a_metre_on_the_map_is_a_metre_on_the_ellipsoid() -> None:
    """The projection keeps lengths but for 1 + x^2 / 2 R^2, and east is east."""
    rng = np.random.default_rng(4)
    x, y = rng.uniform(0, 10_000, (2, 200))
    turned = rng.uniform(0, 2 * np.pi, 200)
    here, there = degrees(x, y), degrees(x + 10 * np.cos(turned), y + 10 * np.sin(turned))
    apart = np.linalg.norm(on_the_ellipsoid(*there) - on_the_ellipsoid(*here), axis=-1)
    stretched = 1 + (x + 5 * np.cos(turned)) ** 2 / (2 * 6.38e6**2)
    assert apart * stretched == pytest.approx(10, abs=1e-5)
    assert degrees(100.0, 0.0)[0] > LONGITUDE
    assert degrees(0.0, 100.0)[1] > LATITUDE
