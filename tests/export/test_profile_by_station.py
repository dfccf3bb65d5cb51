"""Exporters and rules ask the cross-section by station: shown with lanes that grow from 3 m to 4 m."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest

from roadgpt.check import inspect
from roadgpt.export import save
from roadgpt.export.embankments import embankments
from roadgpt.export.exporters.beamng.roads import level_road
from roadgpt.export.exporters.gltf.surfaces import meshes
from roadgpt.export.georeference import degrees
from roadgpt.export.lanelets import lanelet_sections
from roadgpt.geometry import CubicProfile, GradeProfile, Piece, PieceCurve
from roadgpt.road import CrossSection, Profile, Road, World
from roadgpt.road.land import Land
from roadgpt.road.speed_profile import expected_speed

LENGTH = 150.0
SHOULDER = 2.0
WIDENING = CubicProfile((0.0, LENGTH), ((3.0, 1 / LENGTH, 0.0, 0.0), (4.0, 0.0, 0.0, 0.0)))
PROFILE = Profile.of(1, 1, WIDENING, SHOULDER)
ROAD = Road(
    PieceCurve(60.0, 60.0, 0.3, (Piece(50.0), Piece(100.0, 0.0, 1 / 40))),
    GradeProfile(0.0, (0.0, LENGTH), (0.02, 0.02)),
    profile=PROFILE,
)
WORLD = World()


def offsets(points) -> np.ndarray:
    """Stations and distances to the left of the centre line, by the road's own projection."""
    return np.array(ROAD.locate(points[:, 0], points[:, 1]))


def test_lanelets_follow_the_edges() -> None:
    for section in lanelet_sections(ROAD, WORLD):
        right, left = section[-1][0].points, section[1][1].points
        s, t = offsets(left)
        assert t == pytest.approx(3.0 + s / LENGTH, abs=2e-4)
        s, t = offsets(right)
        assert t == pytest.approx(-3.0 - s / LENGTH, abs=2e-4)


def test_a_level_lays_its_strips_as_wide_as_the_road_is_there() -> None:
    strips = {strip.name: strip.nodes for strip in level_road(ROAD, WORLD, 0).strips}
    s, t = offsets(strips["lanes"])
    assert t == pytest.approx(0.0, abs=1e-6)
    assert strips["lanes"][:, 3] == pytest.approx(6.0 + 2 * s / LENGTH, abs=1e-6)
    s, _ = offsets(strips["road"][1:-1])
    assert strips["road"][1:-1, 3] == pytest.approx(6.0 + 2 * s / LENGTH, abs=1e-3)
    assert strips["verge"][1:-1, 3] == pytest.approx(10.0 + 2 * s / LENGTH, abs=1e-3)
    s, t = offsets(strips["right"])
    assert t == pytest.approx(0.06 - 3.0 - s / LENGTH, abs=1e-6)  # half of the painted line of 0.12 m


def test_slabs_and_paint_of_a_gltf_scene_follow_the_edges() -> None:
    found = {mesh.name: mesh for mesh in meshes(ROAD, WORLD)}
    for name, least, most in (
        ("road", 0.0, 0.0),
        ("left verge", 0.0, SHOULDER),
        ("right verge", 0.0, SHOULDER),
        ("left edge line", -0.12, 0.0),
    ):
        s, t = offsets(found[name].points)
        beyond = np.abs(t) - 3.0 - s / LENGTH
        assert beyond.min() == pytest.approx(least, abs=1e-6)
        assert beyond.max() == pytest.approx(most, abs=1e-6)


def test_embankments_begin_where_the_shoulder_ends() -> None:
    s = np.linspace(0.0, LENGTH, 40)
    first, second, *_ = embankments(ROAD, WORLD.profile_of(ROAD), s, Land.around(ROAD, WORLD))
    for bank, side in ((first, -1.0), (second, 1.0)):
        at, t = offsets(bank.edge)
        assert t == pytest.approx(side * (5.0 + at / LENGTH), abs=1e-6)


def test_tables_hold_the_width_at_each_station(tmp_path: Path) -> None:
    save(ROAD, tmp_path, ["csv", "geojson"], WORLD)
    rows = list(csv.DictReader((tmp_path / "road.csv").open()))
    assert [float(row["lane_width_m"]) for row in rows] == pytest.approx(
        [3.0 + float(row["s_m"]) / LENGTH for row in rows], abs=1e-6
    )
    features = json.loads((tmp_path / "road.geojson").read_text())["features"]
    (ring,) = next(f for f in features if f["properties"]["name"] == "right lane")["geometry"]["coordinates"]
    end = ROAD.at(LENGTH, -4.0)
    assert ring[len(rows) - 1][:2] == pytest.approx(np.ravel(degrees(*end[:2])).tolist(), abs=1e-8)


def test_rules_see_the_edge_where_it_is() -> None:
    """The end of the road is 3.5 m from the border: too near for a lane of 4 m, and not for one of 3 m."""
    road = Road(PieceCurve(60.0, 3.5, 0.0, (Piece(LENGTH),)), GradeProfile(0.0, (0.0, LENGTH), (0.0, 0.0)))
    assert inspect(road, None, World(section=CrossSection(lane_width=3.0))) == ()
    first, *_ = inspect(road.with_profile(PROFILE), None, WORLD)
    assert first.rule == "inside_map"
    assert first.s == pytest.approx(0.5 * LENGTH, abs=1.0)


def test_a_wider_lane_is_a_longer_way_round_the_outside_and_a_faster_one() -> None:
    bend = np.full(60, 1 / 20)  # to the left, so that the right lane is on the outside
    wide, narrow = (
        expected_speed(bend, 0.0, 1.0, World(section=CrossSection(lane_width=w)))[-1] for w in (4.0, 2.0)
    )
    assert wide / narrow == pytest.approx(np.sqrt(22 / 21), abs=1e-3)
