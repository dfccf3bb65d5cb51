"""BeamNG's level folder: what its files hold, and that the curves through its nodes are the road."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from beamngpy import MeshRoad, Road, angle_to_quat
from beamngpy.misc.quat import compute_rotation_matrix
from hypothesis import given
from hypothesis import strategies as st

from exported import ROADS, WORLD
from roadgpt.export import save
from roadgpt.export.exporters.opendrive.lanes import DASH, GAP
from roadgpt.road import CrossSection, Design, Profile, Segment, World, build
from roadgpt_beamng.level import rotation
from roadgpt_beamng.level.roads import level_road

Item = dict[str, Any]


def level(tmp_path: Path, name: str = "arcs", world: World = WORLD) -> Path:
    (folder,) = save(ROADS[name], tmp_path, ["beamng"], world, "My road 7")
    assert folder.name == "My road 7-beamng"
    return folder / "levels" / "roadgpt_my_road_7"


def objects(folder: Path) -> dict[str, Item]:
    lines = [line for path in folder.rglob("items.level.json") for line in path.read_text().splitlines()]
    found = [json.loads(line) for line in lines]
    assert len({each["name"] for each in found}) == len(found)
    return {each["name"]: each for each in found}


@pytest.mark.parametrize("name", ROADS)
def test_every_file_is_read_and_every_object_has_its_place(tmp_path: Path, name: str) -> None:
    folder = level(tmp_path, name)
    info = json.loads((folder / "info.json").read_text())
    materials = json.loads((folder / "main.materials.json").read_text())
    found = objects(folder)
    assert info["defaultSpawnPointName"] in found
    assert len({each["persistentId"] for each in found.values()}) == len(found)
    for path in folder.rglob("items.level.json"):
        for line in path.read_text().splitlines():
            parent = json.loads(line).get("__parent")
            assert parent is None or (found[parent]["class"] == "SimGroup" and path.parent.name == parent)
    used = {
        value for each in found.values() for key, value in each.items() if key.lower().endswith("material")
    }
    assert used <= set(materials)
    (about,) = json.loads((folder / "scenarios" / "drive" / "drive.json").read_text())
    prefab = Path(*folder.parts[:-2], about["prefabs"][0])
    (car, _) = [json.loads(line) for line in prefab.read_text().splitlines()]
    assert (car["class"], car["name"], car["position"]) == (
        "BeamNGVehicle",
        "ego",
        found["spawn"]["position"],
    )
    assert about["lapConfig"] == ["goal"]


def test_the_nodes_are_such_as_beamngs_own_client_takes(tmp_path: Path) -> None:
    found = objects(level(tmp_path))
    meshes = [each for each in found.values() if each["class"] == "MeshRoad"]
    decals = [each for each in found.values() if each["class"] == "DecalRoad"]
    for each in meshes:
        MeshRoad("m").add_nodes(*(node[:5] for node in each["nodes"]))
        assert all(node[5:] == [0, 0, 1] for node in each["nodes"])
        assert each["position"] == each["nodes"][0][:3]
    for each in decals:
        Road("m").add_nodes(*each["nodes"])
    assert [each["drivability"] for each in decals] == [1] + [-1] * (len(decals) - 1)
    assert [each["renderPriority"] for each in decals] == sorted(each["renderPriority"] for each in decals)
    assert {each["name"]: each["nodes"][0][3] for each in meshes} == {
        "verge": 2 * (WORLD.section.lane_width + WORLD.section.shoulder),
        "road": WORLD.section.road_width,
    }


def test_the_middle_line_is_broken_as_in_our_opendrive_files(tmp_path: Path) -> None:
    road = ROADS["arcs"]
    dashes = [each for name, each in objects(level(tmp_path)).items() if name.startswith("middle")]
    ends = [np.array(each["nodes"])[[0, -1], :3] for each in dashes]
    stations = [road.locate(*end[:, :2].T)[0] for end in ends]
    # a map's metres: stations count metres in plan, paint lies on the slope
    assert np.allclose([first for first, _ in stations], np.arange(len(dashes)) * (DASH + GAP), atol=0.3)
    assert all(last - first == pytest.approx(DASH, abs=0.1) for first, last in stations[:-1])
    assert stations[-1][1] > road.length - DASH - GAP
    for end, (first, last) in zip(ends, stations, strict=True):
        np.testing.assert_allclose(end, road.at([first, last]), atol=0.05)


def test_painted_lines_end_where_the_judged_markings_do(tmp_path: Path) -> None:
    found, (left, right) = objects(level(tmp_path)), map(float, Profile.of().marking_limits(0.0))
    dash = next(name for name in found if name.startswith("middle"))
    for name, outer in (("right", right), ("left", -right), (dash, left)):
        x, y, _, width = np.array(found[name]["nodes"])[1:-1].T
        t = ROADS["arcs"].locate(x, y)[1]
        assert np.allclose(t + np.sign(outer) * width / 2, outer, atol=0.01), name


@pytest.mark.parametrize("incline", [0.0, 8.0, -8.0])
def test_the_ground_lies_at_the_road_and_what_is_higher_stands_on_it(tmp_path: Path, incline: float) -> None:
    parts = tuple(Segment(distance=60, direction="straight", incline=slope) for slope in (0, incline))
    road = build(Design(starting_point=(60, 60, 12), theta=20, segments=parts))
    (folder,) = save(road, tmp_path, ["beamng"], World(), "r")
    found = objects(folder / "levels" / "roadgpt_r")
    ground = found["ground"]["position"][2]
    lowest = road.sample(0.5).z.min()
    assert 0.02 < lowest - ground < 0.15
    for node in found["verge"]["nodes"]:
        assert node[2] - node[4] <= ground + 1e-3, "it floats"
    (floating,) = save(road, tmp_path, ["beamng"], World(section=CrossSection(shoulder=0)), "f")
    far = objects(floating / "levels" / "roadgpt_f")["ground"]["position"][2]
    assert far == pytest.approx(World().site.z_floor, abs=0.1)


def catmull_rom(nodes: np.ndarray, parts: int = 8) -> np.ndarray:
    """The curve that BeamNG lays through nodes; the ends are held."""
    held = np.vstack([nodes[0], nodes, nodes[-1]])
    u = np.linspace(0, 1, parts, endpoint=False)[:, None]
    a, b, c, d = (held[i : i + len(nodes) - 1, None] for i in range(4))
    curve = 0.5 * (2 * b + (c - a) * u + (2 * a - 5 * b + 4 * c - d) * u**2 + (3 * b - a - 3 * c + d) * u**3)
    return curve.reshape(-1, nodes.shape[1])


@given(
    radius=st.floats(14.4, 80),
    degrees=st.floats(20, 170),
    incline=st.floats(-15, 15),
    hand=st.sampled_from([-1, 1]),
)
def test_the_curve_through_the_nodes_is_the_road(
    radius: float, degrees: float, incline: float, hand: int
) -> None:
    side: Any = "left" if hand > 0 else "right"
    bend = Segment(
        distance=np.radians(degrees) * radius + 8,
        direction=side,
        turn_degrees=hand * degrees,
        radius=radius,
        incline=incline,
    )
    straight = Segment(distance=40, direction="straight", incline=-incline)
    road = build(Design(starting_point=(0, 0, 0), theta=10, segments=(straight, bend, straight)))
    scene = level_road(road, World(), 3)
    decal = next(strip for strip in scene.strips if strip.name == "lanes").nodes
    curve = catmull_rom(decal[:, :3])
    s, t = road.locate(curve[:, 0], curve[:, 1])
    above = curve[:, 2] - road.at(s)[:, 2]
    assert np.abs(t).max() < 0.03
    assert above.min() > 0
    assert above.max() < 0.05
    steps = np.hypot(*np.diff(decal[:, :2], axis=0).T)
    assert steps.min() > 0.5  # nodes too near to one another fold


def test_the_road_shakes_with_the_seed_and_the_decal_lies_above_the_mesh() -> None:
    one, same, other = (level_road(ROADS["arcs"], WORLD, seed) for seed in (1, 1, 2))
    for a, b in zip(one.strips, same.strips, strict=True):
        assert (a.nodes == b.nodes).all()
    verge, mesh, decal = one.strips[:3]
    assert (mesh.nodes != other.strips[1].nodes).any()
    assert np.abs(mesh.nodes[1:-1, :2] - decal.nodes[:, :2]).max() < 0.02
    gap = decal.nodes[:, 2] - mesh.nodes[1:-1, 2]
    assert gap.min() > 0.009
    assert gap.max() < 0.021
    assert (verge.nodes[:, 2] < mesh.nodes[:, 2]).all()


@given(st.floats(-np.pi, np.pi), st.floats(-0.15, 0.15))
def test_cars_look_along_the_road(heading: float, grade: float) -> None:
    turned = rotation(heading, grade)
    assert turned @ turned.T == pytest.approx(np.eye(3), abs=1e-12)
    assert np.linalg.det(turned) == pytest.approx(1.0)
    assert -turned[1, 2] / np.hypot(*turned[1, :2]) == pytest.approx(grade)
    level_car = compute_rotation_matrix(angle_to_quat((0, 0, -(np.degrees(heading) + 90))))
    assert rotation(heading, 0.0) == pytest.approx(level_car, abs=1e-9)
