"""CSV and GeoJSON, and the place on Earth that GeoJSON needs."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest

from exported import ROADS, WORLD, drive
from roadgpt.export import save
from roadgpt.road import Profile
from roadgpt_formats.georeference import FLATTENING, LATITUDE, LONGITUDE, SEMI_MAJOR, degrees


def columns_of(file: Path) -> dict[str, np.ndarray]:
    rows = list(csv.DictReader(file.open()))
    return {name: np.array([float(row[name]) for row in rows]) for name in rows[0]}


def test_every_column_of_road_and_drive_is_what_its_name_says(tmp_path: Path) -> None:
    road, driven = ROADS["arcs"], drive(ROADS["arcs"])
    files = save(road, tmp_path, ["csv"], WORLD, poses=driven)
    assert [file.name for file in files] == ["road.csv", "road.drive.csv"]
    told, moved = map(columns_of, files)
    s = told["s_m"]
    assert np.diff(s) == pytest.approx(1, abs=0.01)
    assert (s[0], s[-1]) == pytest.approx((0.0, road.length), abs=1e-6)
    x, y, z = road.at(s).T
    on_road = {
        "s_m": s, "x_m": x, "y_m": y, "z_m": z, "heading_rad": road.heading(s),
        "curvature_per_m": road.curvature(s), "grade": road.grade(s), "lane_width_m": 4.0, "verge_m": 3.0,
    }  # fmt: skip
    of_drive = {
        "time_s": driven.time, "x_m": driven.x, "y_m": driven.y, "z_m": driven.z,
        "heading_rad": driven.heading, "pitch_rad": driven.pitch, "roll_rad": driven.roll,
        "speed_mps": driven.speed,
    }  # fmt: skip
    for found, wanted in ((told, on_road), (moved, of_drive)):
        assert list(found) == list(wanted)
        for name, values in wanted.items():
            assert found[name] == pytest.approx(values, abs=2e-6), name


def on_globe(points: np.ndarray) -> np.ndarray:
    return np.column_stack([*degrees(*points[:, :2].T), points[:, 2]])


@pytest.mark.parametrize("lanes", [(1, 1), (3, 2)])
def test_geojson_has_each_lane_between_its_edges_and_the_right_way_round(
    lanes: tuple[int, int], tmp_path: Path
) -> None:
    road, driven = ROADS["arcs"], drive(ROADS["arcs"])
    if lanes != (1, 1):
        road = road.with_profile(Profile.of(*lanes, 4.0, 1.0))
    (file,) = save(road, tmp_path, ["geojson"], WORLD, poses=driven)
    features = {each["properties"]["name"]: each for each in json.loads(file.read_text())["features"]}
    names = ["right lane", "left lane"] if lanes == (1, 1) else [
        *(f"right lane {n}" for n in (1, 2, 3)), *(f"left lane {n}" for n in (1, 2))
    ]  # fmt: skip
    assert list(features) == ["centre line", *names, "drive"]
    s = road.sample(1.0).s
    near = {"rtol": 0, "atol": 2e-9}  # degrees; heights are written to 0.1 mm
    line = np.array(features["centre line"]["geometry"]["coordinates"])
    np.testing.assert_allclose(line[:, :2], on_globe(road.at(s))[:, :2], **near)
    assert line[:, 2] == pytest.approx(road.at(s)[:, 2], abs=1e-4)
    assert features["centre line"]["properties"]["length_m"] == pytest.approx(road.length, abs=1e-3)
    assert features["centre line"]["properties"]["speed_kmh"] == 50.0
    for name in names:
        (ring,) = features[name]["geometry"]["coordinates"]
        assert ring[0] == ring[-1]
        corners, side = np.array(ring), -1 if name.startswith("right") else 1
        number = int(name[-1]) if name[-1].isdecimal() else 1
        inner, outer = (side * 4.0 * n for n in (number - 1, number))
        right, left = on_globe(road.at(s, min(inner, outer))), on_globe(road.at(s, max(inner, outer)))
        wanted = np.concatenate([right, left[::-1], right[:1]])  # counter-clockwise, RFC 7946
        np.testing.assert_allclose(corners[:, :2], wanted[:, :2], **near)
        assert corners[:, 2] == pytest.approx(wanted[:, 2], abs=1e-4)
        assert features[name]["properties"] == {"name": name, "width_m": 4.0, "friction": 0.6}
    way = np.array(features["drive"]["geometry"]["coordinates"])
    wanted = on_globe(np.stack([driven.x, driven.y, driven.z], axis=-1))
    np.testing.assert_allclose(way[:, :2], wanted[:, :2], **near)
    assert way[:, 2] == pytest.approx(driven.z, abs=1e-4)
    assert features["drive"]["properties"]["time_s"] == pytest.approx(driven.time, abs=1e-3)


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
