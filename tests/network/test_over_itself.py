"""Roads that cross over themselves and others: bridges where they lie high enough, findings where not."""

import math
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import shapely

from network.ruled import all_findings
from roadgpt.geometry import GradeProfile, Piece, PieceCurve
from roadgpt.ground.mesh import mesh_of
from roadgpt.network import read_road
from roadgpt.network.landscape import crossings, ground_around
from roadgpt.road import Road, World

LAND = World().changed(ground="rolling:2", map_size=1500)
RIM = 7.0  # m from the centre line


def loop(grade: float, degrees: float = 270.0, radius: float = 60.0) -> Road:
    """A road that climbs round to the left until it crosses itself."""
    bend = math.radians(degrees) * radius
    pieces = Piece(200.0), Piece(bend, 1 / radius, 1 / radius), Piece(250.0)
    length = 450.0 + bend
    return Road(PieceCurve(500.0, 600.0, 0.3, pieces), GradeProfile(20.0, (0.0, length), (grade, grade)))


def crossing_of(road: Road) -> tuple[float, float]:
    """The two stations at which the centre line crosses itself, by shapely."""
    s = np.arange(0.0, road.length, 0.5)
    line = shapely.LineString(road.at(s)[:, :2])
    parts = shapely.get_parts(shapely.node(line))
    return parts[0].length, parts[0].length + parts[1].length


@pytest.mark.parametrize("grade", [0.06, 0.03, -0.05])
@pytest.mark.parametrize("degrees", [250.0, 270.0, 290.0])
def test_a_road_high_above_itself_has_a_bridge_there_and_no_finding(grade: float, degrees: float) -> None:
    road = loop(grade, degrees)
    first, second = crossing_of(road)
    rise = abs(grade) * (second - first)
    assert rise > 5.5
    upper = second if grade > 0 else first
    (bridge,) = crossings(road, LAND)
    assert bridge.kind == "bridge"
    assert bridge.start + RIM < upper < bridge.end - RIM
    assert all_findings("no_overlap", road, LAND) == ()
    (told,) = all_findings("no_overlap", road, World().changed(map_size=1500))  # without land, as before
    assert told.rule == "no_overlap"


@pytest.mark.parametrize("grade", [0.0, 0.005, 0.012, -0.012])
def test_a_road_close_above_itself_overlaps(grade: float) -> None:
    (told,) = all_findings("no_overlap", loop(grade), LAND)
    assert "the road overlaps itself" in told.sentence
    assert crossings(loop(grade), LAND) == ()


def test_the_ground_passes_under_the_bridge_and_covers_no_part_of_the_road() -> None:
    road = LAND.lay(loop(0.05))
    first, second = crossing_of(road)
    ground, (bridge,) = ground_around(road, LAND), crossings(road, LAND)
    mesh = mesh_of(ground)
    s = np.concatenate([np.arange(1.0, bridge.start - 1), np.arange(bridge.end + 1, road.length - 1)])
    for t in (-5.0, 0.0, 5.0):
        points = road.at(s, t)
        np.testing.assert_allclose(ground.height(*points[:, :2].T), points[:, 2], atol=2e-3)
    under = road.at(np.array([first]))
    assert ground.height(*under[:, :2].T)[0] == pytest.approx(under[0, 2], abs=2e-3)
    assert road.at(np.array([second]))[0, 2] - under[0, 2] > 5.5
    triangles = shapely.polygons(mesh.points[mesh.triangles][:, :, :2])
    tree = shapely.STRtree(triangles)
    assert not len(tree.query(shapely.points(road.at(s)[:, :2]), predicate="within")[0])


def test_an_asked_bridge_keeps_away_from_the_one_over_the_road() -> None:
    road = loop(0.05)
    world = LAND.changed(scene="bridge x2; tunnel")
    built = crossings(road, world)
    assert [each.kind for each in built].count("bridge") == 3
    for one, other in pairwise(built):
        assert other.start - one.end > 5.0


LANE = '<lane id="{}" type="driving"><width sOffset="0" a="3.5" b="0" c="0" d="0"/></lane>'
STRAIGHT = (
    '<road id="{}" length="400" junction="-1"><planView><geometry s="0" x="{}" y="{}" hdg="{}" length="400">'
    "<line/></geometry></planView>"
    '<elevationProfile><elevation s="0" a="{}" b="0" c="0" d="0"/></elevationProfile>'
    f'<lanes><laneSection s="0"><left>{LANE.format(1)}</left><center><lane id="0" type="none"/></center>'
    f"<right>{LANE.format(-1)}</right></laneSection></lanes></road>"
)


@pytest.mark.parametrize(("rise", "angle"), [(8.0, 90), (-9.0, 90), (6.0, 45), (4.0, 90), (0.0, 60)])
def test_a_road_of_a_map_over_another_one_has_a_bridge(rise: float, angle: float, tmp_path: Path) -> None:
    turn = math.radians(angle)
    start = 400.0 - 200.0 * math.cos(turn), 400.0 - 200.0 * math.sin(turn)
    roads = STRAIGHT.format(1, 200, 400, 0, 20) + STRAIGHT.format(2, *start, turn, 20 + rise)
    head = '<header revMajor="1" revMinor="6"/>'
    (tmp_path / "two.xodr").write_text(f"<OpenDRIVE>{head}{roads}</OpenDRIVE>", encoding="utf-8")
    place = read_road(tmp_path / "two.xodr")
    told = [each for each in all_findings("no_overlap", place, LAND) if "overlap" in each.sentence]
    ground = ground_around(LAND.lay(place), LAND)
    if abs(rise) < 5.5:
        assert len(told) == 1
        assert not ground.pavement.spans
        return
    assert told == []
    (span,) = ground.pavement.spans
    assert span.road == (2 if rise > 0 else 1)
    assert (span.start + span.end) / 2 == pytest.approx(200.0, abs=2.0)
    assert span.end - span.start >= 7.0 / math.sin(turn) + 2 * abs(rise)  # slopes of 1:1 at its ends
    middle = ground.height(np.array([400.0]), np.array([400.0]))
    assert middle == pytest.approx(min(20.0, 20.0 + rise), abs=1e-3)
