"""Roads laid into land: exact on the roads, slopes as asked beside them, and the land elsewhere.

The second opinion is slow: cones around thousands of points of each rim instead of exact ones around its
segments, and volumes by formulas of earthworks."""

import numpy as np
import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from roadgpt.geometry import GradeProfile, Piece, PieceCurve
from roadgpt.ground.ground import Ground, Pavement
from roadgpt.ground.mesh import mesh_of
from roadgpt.ground.relief import Relief, Way, made, sampled
from roadgpt.network import network_of
from roadgpt.network.landscape import ground_around
from roadgpt.network.surface import pavement_of
from roadgpt.road import Design, Road, World, build
from strategies import designs

WORLD = World()
RIM = WORLD.section.lane_width + WORLD.section.shoulder
LANDS = ("flat", "rolling", "hilly", "mountain")


def plane(height: float, rise_x: float = 0.0, rise_y: float = 0.0, half: float = 200.0) -> Relief:
    x = np.arange(-half, half + 1, 10.0)
    heights = height + rise_x * x + rise_y * x[:, None]
    return Relief(-half, -half, 10.0, heights, np.full_like(heights, np.nan), np.empty((0, 3)))


def straight(length: float, grade: float = 0.0) -> Road:
    plan = PieceCurve(-length / 2, 0.0, 0.0, (Piece(length),))
    return Road(plan, GradeProfile(0.0, (0.0, length), (grade, grade)))


def pavement(road: Road) -> Pavement:
    return pavement_of(network_of(road, WORLD))


def dense(ring: np.ndarray, step: float = 0.02) -> np.ndarray:
    parts = []
    for a, b in zip(ring, np.roll(ring, -1, axis=0), strict=True):
        n = max(2, int(np.hypot(*(b - a)[:2]) / step) + 1)
        parts.append(a + (b - a) * np.linspace(0, 1, n)[:, None])
    return np.concatenate(parts)


@settings(max_examples=12)
@given(design=designs(), kind=st.sampled_from(LANDS), seed=st.integers(0, 99))
def test_roads_lie_in_the_ground_to_a_centimetre(design: Design, kind: str, seed: int) -> None:
    road = build(design)
    ground = ground_around(road, WORLD.changed(ground=f"{kind}:{seed}"))
    s = np.linspace(0.0, road.length, 200)[1:-1]
    for t in np.linspace(-RIM + 0.01, RIM - 0.01, 9):
        surface = road.at(s, t)
        apart = np.abs(ground.height(*surface[:, :2].T) - surface[:, 2])
        # where legs of the road lie over each other, one of them is deeper
        x, y = surface[:, :2].T
        alone = np.abs(road.locate(x, y)[1] - t) < 1e-6
        assert apart[alone].max(initial=0.0) < 0.01


@pytest.mark.parametrize(
    ("height", "rise_x", "rise_y"), [(6.0, 0.0, 0.0), (-5.0, 0.05, 0.2), (1.0, 0.0, -0.3)]
)
def test_slopes_are_the_cones_of_the_rims(height: float, rise_x: float, rise_y: float) -> None:
    surface = pavement(Road(
        PieceCurve(-60.0, -20.0, 0.2, (Piece(50.0), Piece(70.0, 1 / 45, 1 / 45))),
        GradeProfile(0.0, (0.0, 120.0), (0.06, -0.08)),
    ))  # fmt: skip
    ground = Ground.of(plane(height, rise_x, rise_y), surface)
    rng = np.random.default_rng(3)
    x, y = rng.uniform(-120, 120, (2, 3000))
    beside = np.isnan(ground.road(x, y))
    x, y = x[beside], y[beside]
    rim = np.concatenate([dense(ring) for ring in surface.rims])
    away = np.hypot(x[:, None] - rim[None, ::5, 0], y[:, None] - rim[None, ::5, 1])
    top = (rim[None, ::5, 2] + 0.5 * away).min(axis=1)
    floor = (rim[None, ::5, 2] - 0.5 * away).max(axis=1)
    land = height + rise_x * x + rise_y * y
    assert (np.abs(land - np.clip(land, floor, top)) > 0.5).any()  # something is cut or filled
    assert ground.height(x, y) == pytest.approx(np.clip(land, floor, top), abs=0.06)


def test_the_volume_of_a_straight_cutting_is_that_of_a_trapezium() -> None:
    """Area across: (bottom + depth / slope) * depth; its ends are half-pyramids with quarter cones."""
    depth, length = 4.0, 200.0
    works = Ground.of(plane(depth), pavement(straight(length))).earthworks
    wide = depth / 0.5
    across = (2 * RIM + wide) * depth
    ends = 2 * (2 * RIM * depth * wide / 2) + np.pi * wide**2 * depth / 3
    assert works.cut == pytest.approx(across * length + ends, rel=0.01)
    assert works.fill == 0.0
    filled = Ground.of(plane(-depth), pavement(straight(length))).earthworks
    assert filled == pytest.approx((0.0, works.cut), rel=1e-9)


def test_land_in_the_plane_of_the_road_needs_no_earthworks() -> None:
    works = Ground.of(plane(0.0, 0.05), pavement(Road(
        PieceCurve(-80.0, 0.0, 0.0, (Piece(160.0),)), GradeProfile(-4.0, (0.0, 160.0), (0.05, 0.05)),
    ))).earthworks  # fmt: skip
    assert works == pytest.approx((0.0, 0.0), abs=1e-6)


@pytest.mark.parametrize("slope", [0.25, 0.5, 1.0])
def test_no_slope_is_steeper_than_asked(slope: float) -> None:
    ground = Ground.of(plane(7.0), pavement(straight(150.0)), slope)
    steep = np.hypot(*np.gradient(ground.heights, ground.cell))
    assert steep.max() == pytest.approx(slope, rel=0.03)  # of a grid, at corners of cones


def test_two_roads_without_room_between_them_have_a_wall_and_keep_their_heights() -> None:
    low, high = straight(120.0), straight(120.0).moved(0.0, 2 * RIM + 2.0, 5.0)
    parts = [pavement(each) for each in (low, high)]
    whole = Pavement(np.concatenate([p.triangles for p in parts]), (*parts[0].rims, *parts[1].rims))
    ground = Ground.of(plane(0.0), whole)
    x = np.linspace(-50.0, 50.0, 30)
    for road in (low, high):
        points = road.at(x + 60.0, 0.0)
        assert ground.height(*points[:, :2].T) == pytest.approx(points[:, 2], abs=1e-6)
    between = ground.height(x, np.full_like(x, RIM + 1.0))
    assert between == pytest.approx(np.full_like(x, 0.5), abs=1e-6)  # 1:2 from the lower road
    assert np.hypot(*np.gradient(ground.heights, ground.cell)).max() > 2.0


@settings(max_examples=10)
@given(design=designs(), kind=st.sampled_from(LANDS), seed=st.integers(0, 99))
def test_the_mesh_has_no_hole_and_only_rims_and_the_border_as_edges(
    design: Design, kind: str, seed: int
) -> None:
    tightest = min(s.distance / max(abs(np.radians(s.turn_degrees)), 1e-9) for s in design.segments)
    assume(tightest > 12.0)  # else the verges of the inner side lie over each other
    road = build(design)
    ground = ground_around(road, WORLD.changed(ground=f"{kind}:{seed}"))
    mesh = mesh_of(ground, to_horizon=False)
    sides = np.concatenate([mesh.triangles[:, k] for k in ([0, 1], [1, 2], [2, 0])])
    edges, counts = np.unique(np.sort(sides, axis=1), axis=0, return_counts=True)
    assert counts.max() == 2
    ends = mesh.points[edges[counts == 1]]
    x, y = ends[..., 0], ends[..., 1]
    at_border = np.zeros(len(ends), bool)
    for of, axis in ((x, ground.x), (y, ground.y)):
        at_border |= (np.abs(of - axis[0]) < 1e-6).all(axis=1) | (np.abs(of - axis[-1]) < 1e-6).all(axis=1)
    rims = shapely.union_all([shapely.LinearRing(ring[:, :2]) for ring in ground.pavement.rims])
    middles = ends[~at_border].mean(axis=1)
    assert shapely.distance(rims, shapely.points(middles[:, :2])).max() < 3e-4
    apart = mesh.points[:, 2] - ground.height(*mesh.points[:, :2].T)
    assert np.abs(apart).max() < 1e-3
    a, b, c = (mesh.points[mesh.triangles[:, k], :2] for k in range(3))
    turn = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    assert (turn > 0).all()


def test_the_cubic_passes_through_the_points_of_the_grid_and_keeps_planes() -> None:
    rng = np.random.default_rng(5)
    table = rng.normal(size=(7, 9))
    j, i = map(np.ravel, np.mgrid[0:7, 0:9])
    assert sampled(table, 3.0, -2.0, 4.0, 3.0 + 4.0 * i, -2.0 + 4.0 * j) == pytest.approx(table[j, i])
    plain = 2.0 + 0.5 * np.arange(9.0) - 0.25 * np.arange(7.0)[:, None]
    x, y = rng.uniform(7, 31, 50), rng.uniform(2, 18, 50)  # not in the outermost cells
    assert sampled(plain, 3.0, -2.0, 4.0, x, y) == pytest.approx(2 + 0.5 * (x - 3) / 4 - 0.25 * (y + 2) / 4)


def test_the_same_seed_gives_the_same_bytes_and_another_one_other_land() -> None:
    way = Way.through_the_middle(500.0, 10.0, 4)
    one, same, other = (made(way, "hilly", (), seed).heights for seed in (1, 1, 2))
    assert one.tobytes() == same.tobytes()
    assert np.abs(one - other).max() > 3.0


def test_kinds_of_land_differ_in_height() -> None:
    way = Way.through_the_middle(800.0, 10.0, 4)
    spread = [np.std([np.ptp(made(way, kind, (), n).heights) for n in range(3)]) for kind in LANDS]
    ranges = [np.mean([np.ptp(made(way, kind, (), n).heights) for n in range(3)]) for kind in LANDS]
    assert ranges == sorted(ranges)
    assert ranges[-1] > 8 * ranges[0]
    assert np.isfinite(spread).all()
