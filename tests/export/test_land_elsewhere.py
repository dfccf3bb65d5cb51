"""Land in files for other programs: pictures of heights, bridges and tunnels in OpenDRIVE, and meshes.

The second opinions: rasterio and Pillow read the pictures, a slow reader the maps, trimesh and Shapely the
meshes."""

import json
import struct
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import shapely
import trimesh

import slow_opendrive
from exported import ROADS, TO_MAP, contents, read_gltf
from network.random_maps import map_route
from roadgpt import plugins
from roadgpt.export import doubts, save
from roadgpt.geometry.curve import Array
from roadgpt.network import Route
from roadgpt.network.landscape import ground_around
from roadgpt.road import World

LEFT_OUT = "the land around left out"
CROSSED = "bridge; tunnel len=50"
BESIDE = 0.05  # m from a rim


@cache
def world(scene: str = "", ground: str = "", lanes: str = "1+1") -> World:
    return World().changed(scene=scene, ground=ground, lanes=lanes, map_size=2000)


@cache
def route(seed: int) -> Route:
    return map_route(seed).on_ground()


def tops(meshes: list[trimesh.Trimesh], points: Array) -> Array:
    """The height of the highest triangle seen from above at each of the points ``(n, 2)``; -inf where there
    is none, as rays straight down would find it."""
    corners = np.concatenate([mesh.triangles for mesh in meshes])
    u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    corners = corners[u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0] > 1e-9]  # seen from above
    tree = shapely.STRtree(shapely.polygons(corners[:, :, :2]))
    hit, which = tree.query(shapely.points(points), predicate="intersects")
    a, b, c = (corners[which, k] for k in range(3))
    facing = np.cross(b - a, c - a)
    z = a[:, 2] - ((points[hit] - a[:, :2]) * facing[:, :2]).sum(axis=1) / facing[:, 2]
    found = np.full(len(points), -np.inf)
    np.maximum.at(found, hit, z)
    return found


def is_closed(mesh: trimesh.Trimesh) -> bool:
    """Whether each edge of each triangle, but for those of slivers, is passed as often in one direction as in
    the other; where a block meets itself in a corner, more than two triangles have an edge."""
    points = np.round(mesh.triangles.reshape(-1, 3), 4)
    _, at = np.unique(points, axis=0, return_inverse=True)
    sides = np.concatenate([at.reshape(-1, 3)[:, pair] for pair in ([0, 1], [1, 2], [2, 0])])
    names = np.sort(sides, axis=1) @ [len(points), 1]
    passed = np.bincount(np.unique(names, return_inverse=True)[1], np.sign(sides[:, 0] - sides[:, 1]))
    return not passed.any()


@pytest.mark.parametrize("name", plugins.names("exporters"))
def test_each_format_holds_the_land_or_says_that_it_does_not(name: str, tmp_path: Path) -> None:
    """What holds it differs with the land."""
    for number in (1, 2):
        save(ROADS["arcs"], tmp_path / str(number), [name], world(ground=f"hilly:{number}"))
    is_held = contents(tmp_path / "1") != contents(tmp_path / "2")
    said = doubts(ROADS["arcs"], [name], world(ground="hilly:1"))
    assert (f"{name}: {LEFT_OUT}" in said) is not is_held
    assert not any(LEFT_OUT in each for each in doubts(ROADS["arcs"], [name], world()))


@pytest.mark.parametrize(
    ("of", "scene", "format_"),
    [
        ("arcs", CROSSED, "opendrive"), ("arcs", "ridge through; tunnel len=70", "opendrive17"),
        (0, CROSSED, "opendrive"), (1, "bridge x2", "openscenario"),
    ],
)  # fmt: skip
def test_opendrive_has_bridges_and_tunnels_where_the_ground_has_them(
    of: str | int, scene: str, format_: str, tmp_path: Path
) -> None:
    """After the objects of the right road, with ids of their own; there, the ground is far below or above."""
    road = ROADS[of] if isinstance(of, str) else route(of)
    files = save(road, tmp_path, [format_], world(scene))
    root = slow_opendrive.read(next(file for file in files if file.suffix == ".xodr"))
    ground, found, kinds = ground_around(road, world(scene)), [], ["object", "tunnel", "bridge"]
    for member in root.findall("road"):
        inside = member.findall("objects/*")
        assert sorted(inside, key=lambda each: kinds.index(each.tag)) == inside
        for each in [each for each in inside if each.tag != "object"]:
            start, length = float(each.get("s", "")), float(each.get("length", ""))
            found.append((each.tag, int(member.get("id", "")), start, start + length))
            s, x, y, _ = slow_opendrive.line(member).T
            at = int(np.abs(s - start - length / 2).argmin())
            z = slow_opendrive.cubic(member.findall("elevationProfile/elevation"), s[at], 0.0, "s")
            over = ground.height(x[[at]], y[[at]])[0] - z
            assert over < -3.0 if each.tag == "bridge" else over > 6.0
    ids = [each.get("id") for each in root.findall("road/objects/*")]
    assert len(ids) == len(set(ids))
    assert len(found) == len(ground.pavement.spans) > 0
    for one, other in zip(sorted(found), sorted(ground.pavement.spans), strict=True):
        assert one[:2] == other[:2]
        assert one[2:] == pytest.approx(other[2:])


@pytest.mark.parametrize("of", ["arcs", "spline", 1])
def test_plain_worlds_have_no_land_and_level_land_changes_no_map(of: str | int, tmp_path: Path) -> None:
    road = ROADS[of] if isinstance(of, str) else route(of)
    plain = [path.name for path in save(road, tmp_path / "plain", ["opendrive"], world())]
    level = [path.name for path in save(road, tmp_path / "level", ["opendrive"], world(ground="flat"))]
    assert plain == ["road.route.json", "road.xodr"]
    assert level == ["road.ground.glb", *plain]
    one, other = contents(tmp_path / "plain"), contents(tmp_path / "level")
    assert one.items() <= other.items()
    assert b"<tunnel" not in one["road.xodr"]


@pytest.mark.parametrize(
    ("name", "ground"), [("arcs", "hilly:2"), ("flat points", "rolling:1"), ("far away", "hilly:5")]
)
def test_the_mesh_beside_a_map_is_as_high_as_the_ground(name: str, ground: str, tmp_path: Path) -> None:
    road, on = ROADS[name], world(ground=ground)
    save(road, tmp_path, ["opendrive"], on)
    exact, mesh = ground_around(road, on), read_gltf(tmp_path / "road.ground.glb")["ground"]
    rng = np.random.default_rng(7)
    corners = mesh.vertices[rng.integers(0, len(mesh.vertices), 500)]
    # as far from the origin as numbers of single precision tell a millimetre
    assert corners[:, 2] == pytest.approx(exact.height(*corners[:, :2].T), abs=0.002)
    anywhere = rng.uniform([exact.x[0], exact.y[0]], [exact.x[-1], exact.y[-1]], (500, 2))
    near = road.at(rng.uniform(0, road.length, 500), rng.uniform(-40, 40, 500))[:, :2]
    points = np.concatenate([anywhere, near])
    rims = shapely.union_all([shapely.LinearRing(ring[:, :2]) for ring in exact.pavement.rims])
    away = shapely.distance(rims, shapely.points(points))
    z, on_road = tops([mesh], points), ~np.isnan(exact.road(*points.T))
    assert np.isneginf(z).tolist() == on_road.tolist()
    apart = np.abs(z - exact.height(*points.T))[~on_road]
    assert apart[away[~on_road] < 60].max() < 0.4
    assert apart.max() < 4.0  # on squares of 32 m
    assert (away[~on_road] < 60).sum() > 200


def test_the_file_of_land_has_its_height_up_and_its_place_in_the_root(tmp_path: Path) -> None:
    save(ROADS["far away"], tmp_path, ["opendrive"], world(ground="hilly"))
    data = (tmp_path / "road.ground.glb").read_bytes()
    length = struct.unpack("<I", data[12:16])[0]
    told = json.loads(data[20 : 20 + length])
    root = told["nodes"][told["scenes"][told["scene"]]["nodes"][0]]
    assert TO_MAP @ root["translation"] == pytest.approx(ROADS["far away"].at(0.0), abs=0.51)
    assert [told["nodes"][child]["name"] for child in root["children"]] == ["ground"]
    (own,) = (each for each in told["accessors"] if "max" in each)
    assert np.abs([own["min"], own["max"]]).max() < 500.0
    assert np.ptp([own["min"][1], own["max"][1]]) < 120.0  # y is the height


@pytest.mark.parametrize(("seed", "ground"), [(0, "hilly:1"), (1, ""), (6, "flat")])
def test_a_network_has_each_road_closed_junctions_and_no_gap(seed: int, ground: str, tmp_path: Path) -> None:
    of, on = route(seed), world(ground=ground)
    save(of, tmp_path, ["gltf"], on)
    found = read_gltf(tmp_path / "road.glb")
    outside = {each.id for each in of.network.roads if each.junction is None} - set(of.network.roundabout_of)
    roads = {name for name in found if name.startswith("road ")}
    assert roads == {f"road {number}" for number in outside}
    in_rings = sum(len(ring.junctions) - 1 for ring in of.network.roundabouts)
    blocks = [name for name in found if name.startswith("junction ") and "verge" not in name]
    assert len(blocks) == len(of.network.junctions) - in_rings
    for name in [*roads, *blocks, *(name for name in found if "verge" in name or "island" in name)]:
        assert is_closed(found[name]), name
        assert found[name].volume > 0
    solids = [mesh for name, mesh in found.items() if name not in ("lines", "path", "water")]
    exact = ground_around(of, on)
    for ring in [each for each in exact.pavement.rims if shapely.Polygon(each).area > 0.01]:  # or a slit
        a, b = ring, np.roll(ring, -1, axis=0)
        ahead = (b - a)[:, :2] / np.maximum(np.hypot(*(b - a)[:, :2].T), 1e-9)[:, None]
        out = np.column_stack([ahead[:, 1], -ahead[:, 0]])
        middle = (a + b) / 2
        inside, beside = (tops(solids, middle[:, :2] + way * BESIDE * out) for way in (-1, 1))
        assert np.isfinite(inside).all()
        assert np.isfinite(beside).all()
        assert np.abs(inside - middle[:, 2]).max() < 0.15  # kerbs are 12 cm high
        long = np.hypot(*(b - a)[:, :2].T) > 1.0
        assert np.quantile(np.abs(beside - middle[:, 2])[long], 0.98) < 0.05
    points = np.random.default_rng(2).uniform([exact.x[0], exact.y[0]], [exact.x[-1], exact.y[-1]], (4000, 2))
    assert np.isfinite(tops(solids, points)).all()
