"""The land around roads: rivers that fall, water and ridges as far away as told, hills, and crossings.

The second opinion is measuring by hand: distances from points of the road to all points of a grid."""

from functools import cache

import numpy as np
import pytest
from scipy.spatial import cKDTree

from grids import diagonal, pairs
from roadgpt.geometry import GradeProfile, Piece, PieceCurve
from roadgpt.geometry.curve import Array
from roadgpt.ground.ground import Ground
from roadgpt.network.landscape import crossings, ground_around
from roadgpt.road import Road, World

LONG, HEIGHT = 400.0, 50.0
SHORES = [(kind, (20, 30, 60, 100)) for kind in ("lake", "coast", "river")]


def road(grade: float = 0.0, radius: float = 0.0, length: float = LONG, more: float = 0.0) -> Road:
    """A straight road, or a bend to the left with a radius above 0; its slope changes by ``more``."""
    bend = 1 / radius if radius else 0.0
    plan = PieceCurve(500.0, 700.0, 0.3, (Piece(length, bend, bend),))
    return Road(plan, GradeProfile(HEIGHT, (0.0, length), (grade, grade + more)))


@cache
def world(scene: str, ground: str = "") -> World:
    return World().changed(scene=scene, ground=ground, map_size=2000)


def ground_of(of: Road, scene: str, ground: str = "") -> Ground:
    on = world(scene, ground)
    return ground_around(on.lay(of), on)


def points_of(ground: Ground, is_wet: bool) -> Array:
    """All points of the grid with the height of the ground, or the wet ones with that of the water."""
    x, y = (each.ravel() for each in np.meshgrid(ground.x, ground.y))
    points = np.column_stack([x, y, ground.water(x, y) if is_wet else ground.heights.ravel()])
    return points[~np.isnan(points[:, 2])]


def away_from(of: Road, points: Array, beyond: float = 0.0) -> tuple[Array, Array]:
    """How far points are from a road that leads straight on beyond its ends, and their stations."""
    line, far = of.centreline(1.0)[:, :2], np.arange(1.0, beyond + 1.0)[:, None]
    start, end = line[0] + far * (line[0] - line[1]), line[-1] + far * (line[-1] - line[-2])
    away, nearest = cKDTree(np.concatenate([start[::-1], line, end])).query(points[:, :2])
    return np.asarray(away), np.asarray(nearest - len(far), float)


def seen_from_middle(of: Road, points: Array) -> Array:
    """Metres ahead and to the left of the middle of a road, ``(2, n)``."""
    x, y, _ = of.at(of.length / 2).tolist()
    turned = (points[:, 0] - x + 1j * (points[:, 1] - y)) * np.exp(-1j * of.heading(of.length / 2))
    return np.stack([turned.real, turned.imag])


@pytest.mark.parametrize(
    ("grade", "scene", "radius"),
    pairs(
        (0.0, 0.03, -0.03, 0.06, -0.06),
        ("river left", "river right", "valley along; river left"),
        (0.0, 250.0, -150.0),
    ),
)
def test_a_river_beside_a_road_lies_below_it_and_falls(scene: str, grade: float, radius: float) -> None:
    of = road(grade, radius)
    wet = points_of(ground_of(of, scene), is_wet=True)
    away, s = away_from(of, wet)
    assert (wet[:, 2] - HEIGHT - grade * s)[away < 40.0].max() < -2.0
    _, s = away_from(of, wet, beyond=120.0)
    levels = np.array([np.median(wet[np.abs(s - at) < 6.0, 2]) for at in range(-60, 461, 12)])
    if grade:  # towards the lower end of the road, and nearly as much
        assert (levels[-1] - levels[0]) / (grade * LONG) == pytest.approx(1.0, abs=0.2)
    falling = levels if levels[0] >= levels[-1] else levels[::-1]
    assert (falling - np.minimum.accumulate(falling)).max() <= 0.05


@pytest.mark.parametrize(
    ("scene", "kind", "radius"),
    pairs(
        ("river across", "lake across", "coast across", "valley across; bridge"),
        ("", "rolling:2", "hilly:3", "mountain:5", "mountain:6"),
        (0.0, -150.0),
    ),
)
def test_no_earth_stands_on_a_bridge(scene: str, kind: str, radius: float) -> None:
    """Nor in its last metre, where the slope of the land below begins at the height of the road."""
    of = road(0.04, radius)
    ground = ground_of(of, scene, kind)
    (bridge,) = crossings(of, world(scene, kind))
    s = np.linspace(bridge.start + 0.05, bridge.end - 0.05, 200)
    lines = [of.at(s, np.full_like(s, t)) for t in (-6.9, -3.0, 0.0, 3.0, 6.9)]
    apart = [line[:, 2] - ground.height(*line[:, :2].T) for line in lines]
    assert np.min(apart) > 0.0
    assert np.min(np.asarray(apart)[:, 40:-40]) > 0.9  # m, of the deck


@pytest.mark.parametrize(("shore", "where"), diagonal(SHORES, [("left", 1.0), ("right", -1.0)]))
def test_a_shore_is_as_far_away_as_told(shore: tuple[str, tuple[int, ...]], where: tuple[str, float]) -> None:
    (kind, told), (side, sign) = shore, where
    of, found = road(), list[float]()
    for away in told:
        wet = points_of(ground_of(of, f"flat; {kind} {side} away={away}"), is_wet=True)
        ahead, left = seen_from_middle(of, wet)
        assert (sign * left[np.hypot(ahead, left) < 120.0] > 0).all()
        found.append(float(np.hypot(ahead, left).min()))
    assert found == pytest.approx(told, abs=12.0)
    assert (np.diff(found) > 0).all()


@pytest.mark.parametrize(("side", "sign"), [("left", 1.0), ("right", -1.0)])
def test_the_crest_of_a_ridge_is_as_far_away_as_told(side: str, sign: float) -> None:
    of, told, found = road(), (60, 85, 120), list[float]()
    for away in told:
        land = points_of(ground_of(of, f"flat; ridge {side} away={away}"), is_wet=False)
        beside, left = away_from(of, land)[0], seen_from_middle(of, land)[1]
        top = np.where((sign * left > 0) & (beside < 200.0), land[:, 2], -np.inf).argmax()
        assert land[top, 2] > HEIGHT + 20.0
        found.append(float(beside[top]))
    assert found == pytest.approx(told, abs=25.0)
    assert (np.diff(found) > 0).all()


@pytest.mark.parametrize(
    ("scene", "kind", "count", "over_water"),
    [
        ("river x2 across; bridge x2", "bridge", 2, 2),
        ("river across; bridge x2", "bridge", 2, 1),
        ("bridge x2; river across", "bridge", 2, 1),
        ("bridge x3", "bridge", 3, 0),
        ("ridge x2 through; tunnel x2", "tunnel", 2, 0),
    ],
)
def test_crossings_are_paired_by_their_count(scene: str, kind: str, count: int, over_water: int) -> None:
    of = road(length=1200.0)
    found = crossings(of, world(scene))
    assert [each.kind for each in found] == [kind] * count
    middles = of.at(np.array([(each.start + each.end) / 2 for each in found]))
    assert np.isfinite(ground_of(of, scene).water(*middles[:, :2].T)).sum() == over_water


def spread(of: Road, scene: str, ground: str = "") -> float:
    """The 90th minus the 10th percentile of heights of the land within 120 m of a road."""
    relief = ground_of(of, scene, ground).relief
    j, i = (each.ravel() for each in np.indices(relief.heights.shape))
    away = away_from(of, np.column_stack([relief.x + relief.cell * i, relief.y + relief.cell * j]))[0]
    return float(np.subtract(*np.percentile(relief.heights.ravel()[away < 120.0], [90, 10])))


@pytest.mark.parametrize("of", [road(), road(0.03, 200.0), road(0.05, -300.0, more=-0.1)])
def test_the_kinds_of_land_are_higher_and_higher(of: Road) -> None:
    spreads = [spread(of, scene) for scene in ("flat", "rolling", "hilly", "mountain")]
    assert (np.diff(spreads) > 0).all(), spreads
    other = spread(of, "", "hilly:3")
    assert other != pytest.approx(spreads[2], rel=1e-6)
    assert 0.5 < other / spreads[2] < 2.0


@pytest.mark.parametrize("radius", [0.0, 200.0, -120.0])
@pytest.mark.parametrize(("grade", "more"), [(0.0, 0.0), (0.06, 0.0), (-0.06, 0.0), (0.06, -0.12)])
def test_the_land_has_nearly_the_height_of_the_road(grade: float, more: float, radius: float) -> None:
    line = (of := road(grade, radius, more=more)).centreline(1.0)
    assert np.abs(ground_of(of, "rolling").relief.at(*line[:, :2].T) - line[:, 2]).mean() < 0.6


@pytest.mark.parametrize("radius", [0.0, 200.0, -120.0])
@pytest.mark.parametrize("grade", [0.0, 0.06, -0.06])
def test_the_land_leads_on_behind_the_start_of_a_road(grade: float, radius: float) -> None:
    of, back = road(grade, radius), np.arange(0.0, 12.5, 0.5)
    angle, (x, y, z) = float(of.heading(0.0)), of.at(0.0).tolist()
    land = ground_of(of, "rolling").relief.at(x - back * np.cos(angle), y - back * np.sin(angle))
    assert land == pytest.approx(z - grade * back, abs=1.5)
