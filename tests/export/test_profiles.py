"""Every format has the widths, the lanes and the superelevation of the road, read by others or by hand."""

import csv
import json
import math
import re
import warnings
import xml.etree.ElementTree as ET
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pycrg
import pytest

from exported import contents, read_gltf
from profiled import smooth
from roadgpt import plugins
from roadgpt.export import save
from roadgpt.export.exporters.opendrive import LATITUDE, LONGITUDE
from roadgpt.geometry import CubicProfile, GradeProfile, Piece, PieceCurve
from roadgpt.road import CrossSection, Profile, Road, World
from roadgpt.road.profile import LaneStrip

LENGTH = 150.0
PLAN = PieceCurve(60.0, 60.0, 0.3, (Piece(30.0), Piece(40.0, 0.0, 1 / 60), Piece(80.0, 1 / 60, 1 / 60)))
CLIMB = GradeProfile(5.0, (0.0, LENGTH), (0.02, 0.05))
ANGLE = -math.atan(0.08)  # the bend turns left, so the surface falls to the left
BANK = CubicProfile(
    (0.0, 30.0, 70.0),
    ((0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 3 * ANGLE / 40**2, -2 * ANGLE / 40**3), (ANGLE, 0.0, 0.0, 0.0)),
)
THREE = replace(Profile.of(2, 1, smooth(3.0, 4.0, LENGTH), 2.0), superelevation_angle=BANK)
BANKED = Road(PLAN, CLIMB, profile=THREE)
"""Two lanes along the road and one against it, which widen from 3 m to 4 m; the bend has 8 %."""
SHOULDER = 1.5
WORLD = World()


def element(file: Path) -> ET.Element:
    return ET.parse(file).getroot()


def opendrive(folder: Path) -> float:
    (file,) = folder.glob("road*.xodr")
    (lane,) = [each for each in element(file).iter("lane") if each.attrib["id"] == "-1"]
    return float(lane.find("width").attrib["a"])  # type: ignore[union-attr]


def lanelets(folder: Path) -> float:
    root = element(folder / "road.osm")
    tags = {node.attrib["id"]: {t.attrib["k"]: t.attrib["v"] for t in node} for node in root.iter("node")}
    first = {way.attrib["id"]: tags[way.find("nd").attrib["ref"]] for way in root.iter("way")}  # type: ignore[union-attr]
    left, right = (first[each.attrib["ref"]] for each in next(root.iter("relation")).iter("member"))
    return math.hypot(*(float(left[axis]) - float(right[axis]) for axis in ("local_x", "local_y")))


def commonroad(folder: Path) -> float:
    lanelet = next(element(folder / "road.cr.xml").iter("lanelet"))
    left, right = (next(lanelet.find(name).iter("point")) for name in ("leftBound", "rightBound"))  # type: ignore[union-attr]
    return math.hypot(*(float(left.find(a).text) - float(right.find(a).text) for a in "xy"))  # type: ignore


def sumo(folder: Path) -> float:
    return float(next(element(folder / "road.edg.xml").iter("edge")).attrib["width"])


def crg(folder: Path) -> float:
    lines = (folder / "road.crg").read_text().splitlines()
    (right,) = [line for line in lines if line.startswith("long_section_v_right")]
    return -float(right.split("=")[1]) - SHOULDER


def geojson(folder: Path) -> float:
    features = json.loads((folder / "road.geojson").read_text())["features"]
    (lane,) = [each for each in features if each["properties"]["name"] == "right lane"]
    ring = np.array(lane["geometry"]["coordinates"][0])
    across = (ring[0] - ring[len(ring) - 2])[:2] * [math.cos(math.radians(48.0)), 1.0] * 111_200
    assert np.hypot(*across) == pytest.approx(lane["properties"]["width_m"], rel=5e-3)
    return float(lane["properties"]["width_m"])


def table(folder: Path) -> float:
    return float(next(csv.DictReader((folder / "road.csv").open()))["lane_width_m"])


def gltf(folder: Path) -> float:
    x, y, _ = read_gltf(folder / "road.glb")["road"].vertices.T
    aside = (y - 60.0) * math.cos(0.3) - (x - 60.0) * math.sin(0.3)
    return float(np.ptp(aside)) / 2


def beamng(folder: Path) -> float:
    (items,) = folder.rglob("roads/items.level.json")
    (lanes,) = [row for row in map(json.loads, items.read_text().splitlines()) if row["name"] == "lanes"]
    return float(lanes["nodes"][0][3]) / 2


def heightmap(folder: Path) -> float:
    (road,) = json.loads((folder / "road.json").read_text())["roads"]
    return float(road["nodes"][0][3]) / 2


READERS: dict[str, Callable[[Path], float] | None] = {
    "beamng": beamng,
    "commonroad": commonroad,
    "crg": crg,
    "csv": table,
    "geojson": geojson,
    "gltf": gltf,
    "heightmap": heightmap,
    "lanelet2": lanelets,
    "opendrive": opendrive,
    "opendrive17": opendrive,
    "openscenario": opendrive,
    "sbft": None,  # holds the centre line, and no lanes
    "sumo": sumo,
}


@pytest.mark.parametrize("own", [False, True], ids=["of the world", "of the road"])
@pytest.mark.parametrize("format_", plugins.names("exporters"))
def test_a_lane_of_3_m_and_one_of_4_m(tmp_path: Path, format_: str, own: bool) -> None:
    """The width of the lane of the World, and of a road that has another one than its World."""
    line = Road(PieceCurve(60.0, 60.0, 0.3, (Piece(LENGTH),)), GradeProfile(0, (0, LENGTH), (0, 0)))
    for width in (3.0, 4.0):
        road = line.with_profile(Profile.of(1, 1, width, SHOULDER)) if own else line
        world = (
            World(section=CrossSection(lane_width=3.5))
            if own
            else World(section=CrossSection(lane_width=width, shoulder=SHOULDER))
        )
        save(road, tmp_path / str(width), [format_], world)
        read = READERS[format_]
        if read is not None:
            assert read(tmp_path / str(width)) == pytest.approx(width, abs=1e-3)
    same = contents(tmp_path / "3.0") == contents(tmp_path / "4.0")
    assert same == (READERS[format_] is None)


@pytest.mark.parametrize("lanes", ["1+0", "2+0", "3+2"])
@pytest.mark.parametrize("format_", plugins.names("exporters"))
def test_every_format_takes_every_road(tmp_path: Path, format_: str, lanes: str) -> None:
    forward, backward = map(int, lanes.split("+"))
    begins = CubicProfile((40.0, 60.0), ((0.0, 0.15, 0.0, 0.0), (3.0, 0.0, 0.0, 0.0)))
    profile = replace(Profile.of(forward, backward, 3.25, 0.0), superelevation_angle=BANK)
    right = (*profile.right, LaneStrip("driving", begins, "solid"), LaneStrip("shoulder", 1.0))
    assert save(Road(PLAN, CLIMB, profile=replace(profile, right=right)), tmp_path, [format_], WORLD)


def missed(points: Any, lift: float = 0.0) -> float:
    """The largest distance in height between points and the surface of the road."""
    points = np.asarray(points, float)
    s, t = BANKED.locate(points[:, 0], points[:, 1])
    return float(np.abs(BANKED.at(s, t)[:, 2] + lift - points[:, 2]).max())


def boundaries(points: Any) -> set[int]:
    """The boundaries of lanes on which points lie: 0 is the centre line, 2 the right edge; -1 the left."""
    s, t = BANKED.locate(*np.asarray(points, float)[:, :2].T)
    lanes = -t / THREE.width(s)
    assert np.abs(lanes - np.round(lanes)).max() < 1e-3
    return {*np.round(lanes).astype(int).tolist()}


def test_lanelet2_itself_finds_banked_lanes_side_by_side(tmp_path: Path) -> None:
    lanelet2 = pytest.importorskip("lanelet2")
    for part in ("core", "geometry", "io", "projection", "routing", "traffic_rules"):
        pytest.importorskip(f"lanelet2.{part}")
    (file,) = save(BANKED, tmp_path, ["lanelet2"], WORLD)
    projector = lanelet2.projection.UtmProjector(lanelet2.io.Origin(LATITUDE, LONGITUDE))
    map_, errors = lanelet2.io.loadRobust(str(file), projector)
    assert list(errors) == []
    points = [[point.x, point.y, point.z] for point in map_.pointLayer]
    assert missed(points) < 1e-3
    assert boundaries(points) == {-1, 0, 1, 2}
    which = lanelet2.traffic_rules
    rules = which.create(which.Locations.Germany, which.Participants.Vehicle)
    graph = lanelet2.routing.RoutingGraph(map_, rules)
    assert not list(graph.checkValidity(False))

    def lanelet_at(s: float, t: float) -> Any:
        x, y, _ = BANKED.at(s, t)
        place = lanelet2.core.BasicPoint2d(float(x), float(y))
        ((distance, found),) = lanelet2.geometry.findNearest(map_.laneletLayer, place, 1)
        assert distance < 1e-3
        return found

    inner, outer, against = (lanelet_at(20.0, t) for t in (-1.5, -4.5, 1.5))
    assert graph.right(inner) == outer  # a lane change over the broken line
    assert graph.left(outer) == inner
    assert graph.left(inner) is None  # the centre line is solid
    assert graph.left(against) is None
    route = graph.shortestPath(outer, lanelet_at(149.0, -5.9))
    assert len(list(route)) == 3


def test_commonroad_io_reads_all_lanes(tmp_path: Path) -> None:
    (file,) = save(BANKED, tmp_path, ["commonroad"], WORLD)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        from commonroad.common.file_reader import CommonRoadFileReader

        scenario, problems = CommonRoadFileReader(str(file)).open()
    lanelets_ = {each.lanelet_id: each for each in scenario.lanelet_network.lanelets}
    assert len(lanelets_) == 9
    for each in lanelets_.values():
        assert len(boundaries(each.left_vertices) | boundaries(each.right_vertices)) == 2
    inner, outer, against = (lanelets_[id_] for id_ in (1, 4, 7))
    assert (inner.adj_right, inner.adj_right_same_direction) == (4, True)
    assert (outer.adj_left, outer.adj_left_same_direction, outer.adj_right) == (1, True, None)
    assert (inner.adj_left, inner.adj_left_same_direction) == (7, False)
    assert (against.adj_left, against.adj_left_same_direction, against.predecessor) == (1, False, [8])
    (problem,) = problems.planning_problem_dict.values()
    assert problem.goal.lanelets_of_goal_position[0] == [6]  # the end of the outer lane
    assert outer.polygon.contains_point(problem.initial_state.position)


def test_asams_crg_library_finds_the_banked_surface(tmp_path: Path) -> None:
    (file,) = save(BANKED, tmp_path, ["crg"], WORLD)
    with pycrg.DataSet.open(file) as data, data.create_contact_point() as contact:
        assert data.check()
        s = np.linspace(0.5, LENGTH - 0.5, 200)
        for t in (-9.9, -4.0, 0.0, 5.9):
            x, y, z = BANKED.at(s, np.full(len(s), t) * THREE.width(s) / 4.0).T
            assert contact.xy_to_z_many(x, y) == pytest.approx(z, abs=3e-3)


def test_meshes_and_lines_of_a_gltf_scene_lie_on_the_banked_surface(tmp_path: Path) -> None:
    (file,) = save(BANKED, tmp_path, ["gltf"], WORLD)
    found = read_gltf(file)
    lines = [name for name in found if "line" in name]
    assert sorted(lines) == ["lane line 3", "left edge line", "middle line", "right edge line"]
    for name in lines:
        assert missed(found[name].vertices, lift=0.005) < 1e-3
    road = found["road"]
    s, t = BANKED.locate(*road.vertices[:, :2].T)
    top = road.metadata["normals"][:, 2] > 0.9
    assert missed(road.vertices[top]) < 1e-3
    level = road.metadata["normals"][top & (s > 75)]
    across = np.stack([-np.sin(BANKED.heading(s)), np.cos(BANKED.heading(s))], -1)[top & (s > 75)]
    leans = np.einsum("ij,ij->i", level[:, :2], across) / level[:, 2]
    assert leans == pytest.approx(0.08, abs=1e-3)  # to the left, the inside of the bend
    assert t[top].min() == pytest.approx(-8.0, abs=1e-3)
    assert t[top].max() == pytest.approx(4.0, abs=1e-3)


def test_a_level_for_beamng_leans_into_the_bend(tmp_path: Path) -> None:
    (folder,) = save(BANKED, tmp_path, ["beamng"], WORLD)
    (items,) = folder.rglob("roads/items.level.json")
    found = {row["name"]: row for row in map(json.loads, items.read_text().splitlines())}
    assert {name.split("_0")[0] for name in found} == {
        "verge", "road", "lanes", "left", "right", "middle", "line_4",
    }  # fmt: skip
    assert found["line_4_001"]["material"] == found["left"]["material"]
    nodes = np.array(found["road"]["nodes"])[1:-1]
    s, t = BANKED.locate(nodes[:, 0], nodes[:, 1])
    assert missed(nodes) < 2e-3  # nodes are shifted by up to a centimetre
    assert nodes[:, 3] == pytest.approx(3 * THREE.width(s), abs=2e-3)
    assert t == pytest.approx(-THREE.width(s) / 2, abs=0.015)
    heading = BANKED.heading(s)
    leans = (-np.sin(heading) * nodes[:, 5] + np.cos(heading) * nodes[:, 6]) / nodes[:, 7]
    assert leans[s > 75] == pytest.approx(0.08, abs=1e-3)
    assert leans[s < 25] == pytest.approx(0.0, abs=2e-4)
    ground = json.loads(next(folder.rglob("sky_and_ground/items.level.json")).read_text().splitlines()[-1])
    rims = THREE.rims(np.linspace(0, LENGTH, 300))
    lowest = min(BANKED.at(np.linspace(0, LENGTH, 300), t)[:, 2].min() for t in rims)
    assert ground["position"][2] < lowest


def test_sumo_has_as_many_lanes_as_the_road(tmp_path: Path) -> None:
    widths = (LaneStrip("driving", 3.0, "broken"), LaneStrip("driving", 3.5, "solid"))
    roads = {"both": BANKED, "one way": Road(PLAN, CLIMB, profile=Profile((), widths, 1, "solid"))}
    edges = {}
    for name, road in roads.items():
        save(road, tmp_path / name, ["sumo"], WORLD)
        edges[name] = {edge.attrib["id"]: edge for edge in element(tmp_path / name / "road.edg.xml")}
    assert {name: edge.attrib["numLanes"] for name, edge in edges["both"].items()} == {
        "road": "2",
        "back": "1",
    }
    assert float(edges["both"]["road"].attrib["width"]) == pytest.approx(3.5, abs=1e-3)  # the mean
    (edge,) = edges["one way"].values()
    lanes = {lane.attrib["index"]: float(lane.attrib["width"]) for lane in edge.iter("lane")}
    assert lanes == {"0": 3.5, "1": 3.0}  # from the right


def test_tables_and_maps_name_every_lane(tmp_path: Path) -> None:
    save(BANKED, tmp_path, ["csv", "geojson"], WORLD)
    rows = list(csv.DictReader((tmp_path / "road.csv").open()))
    assert [name for name in rows[0] if name.startswith("lane_") and "edge" in name] == [
        f"lane_{n}_edge_m" for n in (2, 1, -1, -2, -3)
    ]
    for row in rows:
        s = float(row["s_m"])
        assert float(row["superelevation_rad"]) == pytest.approx(float(BANK.height(s)), abs=1e-6)
        assert float(row["lane_-2_edge_m"]) == pytest.approx(-2 * float(row["lane_width_m"]), abs=2e-6)
    features = json.loads((tmp_path / "road.geojson").read_text())["features"]
    names = [each["properties"]["name"] for each in features]
    assert names == ["centre line", "right lane 1", "right lane 2", "left lane"]
    assert features[1]["properties"]["width_min_m"] == 3.0
    assert features[1]["properties"]["width_max_m"] == 4.0


@pytest.mark.parametrize("format_", ["geojson", "lanelet2", "sbft", "sumo"])
def test_lanes_lie_where_they_are_whatever_line_they_lie_beside(tmp_path: Path, format_: str) -> None:
    """The same lanes beside two lines that are 6 m apart, with a median of 2 m."""
    at, numbers = {0.0: 60.0, 6.0: 54.0}, []
    for offset, y in at.items():
        own = Profile.of(2, 1, 3.5, 1.0)
        own = replace(own, left=(LaneStrip("median", 2.0, "solid"), *own.left), offset=offset)
        road = Road(PieceCurve(60.0, y, 0.0, (Piece(LENGTH),)), GradeProfile.level(LENGTH), profile=own)
        files = save(road, tmp_path / str(y), [format_], WORLD)
        numbers.append([float(n) for file in files for n in re.findall(r"-?\d+\.\d+", file.read_text())])
    assert numbers[0] == pytest.approx(numbers[1], abs=2e-4)
    if format_ == "sumo":
        edges = element(tmp_path / "54.0/road.edg.xml").iter("edge")
        starts = [edge.attrib["shape"].split()[-1 if edge.attrib["id"] == "back" else 0] for edge in edges]
        assert [float(start.split(",")[1]) for start in starts] == pytest.approx([60.0, 62.0])
