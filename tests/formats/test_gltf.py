"""glTF, as trimesh reads it: closed slabs where the road is, lines and a path on top of them."""

import json
import struct
from pathlib import Path

import numpy as np
import pytest
import trimesh

from exported import ROADS, WORLD, drive, read_gltf
from roadgpt.export import Poses, save
from roadgpt.road import CrossSection, Road, World


def saved(
    road: Road, folder: Path, world: World = WORLD, poses: Poses | None = None
) -> dict[str, trimesh.Trimesh]:
    (file,) = save(road, folder, ["gltf"], world, poses=poses)
    return read_gltf(file)


@pytest.mark.parametrize("name", ["arcs", "short", "far away"])
def test_slabs_are_closed_half_a_metre_thick_and_where_the_road_is(tmp_path: Path, name: str) -> None:
    road = ROADS[name]
    found = saved(road, tmp_path)
    bounds = {"road": (-4, 4), "left verge": (4, 7), "right verge": (-7, -4)}
    for node, (right, left) in bounds.items():
        slab = found[node]
        slab.merge_vertices(merge_norm=True, merge_tex=True)
        assert slab.is_watertight
        assert slab.is_winding_consistent
        turn = float(road.heading(road.length) - road.heading(0.0))
        area = (left - right) * (road.length - turn * (left + right) / 2)
        assert slab.volume == pytest.approx(0.5 * area, rel=0.002)
        s, t = road.locate(slab.vertices[:, 0], slab.vertices[:, 1])
        assert right - 0.01 < t.min() < right + 0.01
        assert left - 0.01 < t.max() < left + 0.01
        below = road.at(s)[:, 2] - slab.vertices[:, 2]
        assert np.minimum(np.abs(below), np.abs(below - 0.5)).max() < 0.01


@pytest.mark.parametrize("name", ["arcs", "spline"])
def test_faces_look_where_their_normals_say(tmp_path: Path, name: str) -> None:
    for node, mesh in saved(ROADS[name], tmp_path).items():
        facing = np.einsum("ij,ikj->ik", mesh.face_normals, mesh.metadata["normals"][mesh.faces])
        assert facing.min() > (0.7 if node == "ground" else 0.9)  # its normals are rounded over its edges


def test_lines_and_path_lie_on_the_road(tmp_path: Path) -> None:
    road = ROADS["arcs"]
    found = saved(road, tmp_path)
    centres = {"left edge line": 3.94, "right edge line": -3.94, "middle line": 0.0, "path": -2.0}
    for node, centre in centres.items():
        points = found[node].vertices
        s, t = road.locate(points[:, 0], points[:, 1])
        assert t.mean() == pytest.approx(centre, abs=0.01)
        assert np.ptp(t) < 0.32
        over = points[:, 2] - road.at(s)[:, 2]
        assert 0.002 < over.min() < over.max() < 0.03
        assert (found[node].face_normals[:, 2] > 0.9).all()
    painted = found["middle line"].area / 0.12
    assert painted == pytest.approx(road.length / 3, abs=4)
    assert found["right edge line"].visual.material.name == "paint"
    assert found["road"].visual.material.name == "asphalt"
    assert max(found["road"].visual.material.baseColorFactor[:3]) < 0.2 * 255


def test_the_path_is_the_driven_one_where_there_is_a_drive(tmp_path: Path) -> None:
    road = ROADS["arcs"]
    poses = drive(road)
    path = saved(road, tmp_path, poses=poses)["path"].vertices
    half = len(path) // 2
    middle = (path[:half] + path[half:]) / 2
    # under the car, which leans: 0.56 m of height times 0.11 rad
    assert np.hypot(middle[:, 0] - poses.x, middle[:, 1] - poses.y).max() < 0.07
    s, _ = road.locate(middle[:, 0], middle[:, 1])
    assert np.abs(middle[:, 2] - road.at(s)[:, 2]).max() < 0.05


def test_the_file_is_laid_out_as_the_standard_says(tmp_path: Path) -> None:
    (file,) = save(ROADS["far away"], tmp_path, ["gltf"], WORLD)
    data = file.read_bytes()
    magic, version, length, json_length, kind = struct.unpack("<4sIII4s", data[:20])
    assert (magic, version, length, kind) == (b"glTF", 2, len(data), b"JSON")
    described = json.loads(data[20 : 20 + json_length])
    binary_length, kind = struct.unpack("<I4s", data[20 + json_length : 28 + json_length])
    assert (binary_length, kind) == (described["buffers"][0]["byteLength"], b"BIN\0")
    assert 28 + json_length + binary_length == length
    assert json_length % 4 == binary_length % 4 == 0
    # far from the map's corner single precision would step by 8 mm
    assert max(abs(v) for each in described["accessors"] for v in each.get("max", [])) < 400


def heights_of(ground: trimesh.Trimesh, points: np.ndarray) -> np.ndarray:
    """The highest place of the ground at points ``(n, 3)``, by rays from the sky; NaN where none is."""
    found = np.full(len(points), np.nan)
    above = points + [0.0, 0.0, 500.0]
    down = np.tile([0.0, 0.0, -1.0], (len(points), 1))
    places, rays, _ = ground.ray.intersects_location(above, down, multiple_hits=True)
    for place, ray in zip(places, rays, strict=True):
        found[ray] = np.nanmax([found[ray], place[2]])
    return found


@pytest.mark.parametrize("name", ["arcs", "short", "far away"])
@pytest.mark.parametrize("land", ["", "mountain:2"])
def test_the_ground_meets_the_rims_and_never_covers_the_road(tmp_path: Path, name: str, land: str) -> None:
    road = ROADS[name]
    found = saved(road, tmp_path, WORLD.changed(ground=land) if land else WORLD)
    ground = found["ground"]
    s = np.linspace(0.5, road.length - 0.5, 60)
    rim = WORLD.section.lane_width + WORLD.section.shoulder
    for t in (-rim + 0.02, -4.0, 0.0, 4.0, rim - 0.02):
        assert np.isnan(heights_of(ground, road.at(s, t))).all(), f"it reaches under the road at t = {t}"
    # just beside the verge, the ground is as high as the verge, but for a slope of 1:2
    for t in (-rim - 0.05, rim + 0.05):
        beside = road.at(s, t)
        gaps = beside[:, 2] - heights_of(ground, beside)
        assert np.isfinite(gaps).all()
        assert np.abs(gaps).max() < 0.05
    edges = np.sort(ground.edges, axis=1)
    single, counts = np.unique(edges, axis=0, return_counts=True)
    assert counts.max() == 2
    border = ground.vertices[single[counts == 1].ravel()]
    box = np.isclose(border[:, :2], ground.bounds[0, :2]) | np.isclose(border[:, :2], ground.bounds[1, :2])
    s, t = road.locate(border[~box.any(axis=1), 0], border[~box.any(axis=1), 1])
    at_rim = np.isclose(np.abs(t), rim, atol=0.01) | (s < 0.01) | (s > road.length - 0.01)
    assert at_rim.all(), "there is a hole in the ground"


def test_a_road_without_verges_floats_in_empty_space(tmp_path: Path) -> None:
    world = World(section=CrossSection(shoulder=0))
    assert "ground" not in saved(ROADS["arcs"], tmp_path, world)
    assert "ground" in saved(ROADS["arcs"], tmp_path, world.changed(ground="hilly"))
