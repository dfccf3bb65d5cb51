"""Ways over given land: they keep grade, radius and depth, and lie where a slow search would lay them.

The second opinions: planes, whose ways can be computed by hand, samples of every finished way, and a linear
programme over heights 2 m apart. The mountains are real: near Jacksboro, Tennessee, from matplotlib."""

import math
import re

import matplotlib.cbook
import numpy as np
import pytest
import shapely
from scipy.optimize import linprog

from roadgpt.errors import UsageError
from roadgpt.geometry import Piece, PieceCurve
from roadgpt.geometry.curve import Array
from roadgpt.ground.relief import Relief
from roadgpt.ground.wayfinding import DEEPEST, LEAST_VERTICAL, FoundWay, profile_over, way_between

Place = tuple[float, float]
RIM = 7.0  # m from the centre line of the usual road


def relief(heights: Array, cell: float = 10.0) -> Relief:
    table = np.ascontiguousarray(heights, float)
    return Relief(0.0, 0.0, cell, table, np.full_like(table, np.nan), np.empty((0, 3)))


def plane(east: float, north: float = 0.0, side: float = 1000.0) -> Relief:
    x = np.arange(0.0, side + 1, 10.0)
    return relief(100.0 + east * x + north * x[:, None])


def cliffs(gap: tuple[float, float] | None = None) -> Relief:
    """Level land with a wall of 200 m across it, open between two y."""
    x = np.arange(0.0, 1001.0, 10.0)
    wall = np.where((x > 480) & (x < 520), 200.0, 0.0) * np.ones((101, 1))
    if gap is not None:
        wall[(x > gap[0]) & (x < gap[1])] = 0.0
    return relief(wall)


def jacksboro(row: int, column: int) -> Relief:
    """1.8 km of mountains, measured every 90 m."""
    with matplotlib.cbook.get_sample_data("jacksboro_fault_dem.npz") as data:
        return relief(data["elevation"][row : row + 21, column : column + 21], 90.0)


def steep_garden(seed: int) -> tuple[Relief, Place, Place]:
    """200 m of steep waves, and two places on them."""
    rng, x = np.random.default_rng(seed), np.arange(0.0, 201.0, 10.0)
    waves = rng.uniform((2.0, -0.06, -0.06, -3.0), (14.0, 0.06, 0.06, 3.0), (4, 4))
    heights = sum(high * np.sin(east * x + north * x[:, None] + at) for high, east, north, at in waves)
    start, end = map(tuple, rng.uniform(20.0, 180.0, (2, 2)).tolist())
    return relief(100.0 + heights), start, end


def places(seed: int, count: int = 10) -> list[tuple[Place, Place]]:
    """Pairs of places that are 300 to 700 m apart."""
    rng, found = np.random.default_rng(seed), list[tuple[Place, Place]]()
    while len(found) < count:
        (ax, ay), (bx, by) = rng.uniform(100.0, 1700.0, (2, 2)).tolist()
        if 300.0 < math.hypot(bx - ax, by - ay) < 700.0:
            found.append(((ax, ay), (bx, by)))
    return found


def assert_obeys(
    way: FoundWay, land: Relief, start: Place, end: Place, steepest: float, radius: float
) -> None:
    """The limits hold at every half metre, and between parts of the way there is room for its verges."""
    s = np.linspace(0.0, way.plan.length, round(2 * way.plan.length))
    points, z = way.plan.at(s), way.elevation.height(s)
    ground = land.at(*points.T)
    assert points[[0, -1]] == pytest.approx(np.array([start, end]), abs=0.01)
    assert z[[0, -1]] == pytest.approx(ground[[0, -1]], abs=0.01)
    assert np.abs(way.elevation.grade(s)).max() <= steepest + 1e-6
    assert np.abs(np.diff(z) / np.diff(s)).max() <= steepest + 1e-6
    assert np.abs(way.plan.curvature(s)).max() <= 1 / radius + 1e-9
    turned = np.diff(np.unwrap(np.arctan2(*np.diff(points, axis=0).T[::-1])))
    assert np.abs(turned).max() <= 0.5 / radius * 1.02  # radians in half a metre
    assert np.abs(way.elevation.vertical_curvature(s)).max() <= 1 / LEAST_VERTICAL + 1e-9
    assert np.abs(z - ground).max() < DEEPEST + 0.3  # between two knots
    assert np.abs(z - ground).max() - 1.0 < way.deepest < np.abs(z - ground).max() + 0.3
    assert shapely.LineString(points).is_simple
    few = points[::4]
    apart = np.hypot(*(few[:, None] - few).transpose(2, 0, 1))
    along = 2.0 * np.abs(np.arange(len(few))[:, None] - np.arange(len(few)))
    assert apart[along > 70].min(initial=np.inf) > 2 * RIM


@pytest.mark.parametrize(
    ("east", "north", "ends"),
    [
        (0.0, 0.0, ((700.0, 150.0), (310.0, 420.0))),
        (0.04, 0.0, ((200.0, 200.0), (800.0, 500.0))),
        (-0.03, 0.04, ((700.0, 150.0), (310.0, 420.0))),
    ],
)
def test_on_a_plane_the_way_is_nearly_straight(east: float, north: float, ends: tuple[Place, Place]) -> None:
    land = plane(east, north)
    way = way_between(land, *ends, 0.08, 40.0)
    assert_obeys(way, land, *ends, 0.08, 40.0)
    assert way.plan.length < 1.02 * math.dist(*ends)
    assert way.deepest < 0.5


def test_on_level_land_the_profile_is_level() -> None:
    """The road of least area has no waves, however small."""
    way = way_between(plane(0.0), (200.0, 200.0), (800.0, 500.0), 0.08, 40.0)
    s = np.arange(0.0, way.plan.length, 0.5)
    assert np.abs(way.elevation.height(s) - 100.0).max() < 0.001
    assert np.abs(way.elevation.grade(s)).max() < 0.001


def test_points_may_be_whole_numbers() -> None:
    ends = ((200.0, 200.0), (800.0, 500.0))
    whole = way_between(plane(0.02), (200, 200), (800, 500), 0.08, 40)
    assert repr(whole.plan) == repr(way_between(plane(0.02), *ends, 0.08, 40.0).plan)


@pytest.mark.parametrize(("steepest", "radius", "is_up"), [(0.15, 15.0, True), (0.10, 25.0, False)])
def test_straight_up_a_slope_of_20_percent_it_winds(steepest: float, radius: float, is_up: bool) -> None:
    land, ends = plane(0.2), ((250.0, 500.0), (700.0, 480.0))
    ends = ends if is_up else ends[::-1]
    way = way_between(land, *ends, steepest, radius)
    assert_obeys(way, land, *ends, steepest, radius)
    assert way.plan.length >= 0.2 * 450.0 / steepest
    assert way.plan.length < 1.25 * 0.2 * 450.0 / steepest  # without detours


def test_a_wall_without_a_way_is_refused_with_the_place_and_the_limits() -> None:
    """The place is where a car from the start would stand, though from the end one would come nearer."""
    with pytest.raises(UsageError, match=r"no road of 8 % or less with bends of 40 m") as caught:
        way_between(cliffs(), (300.0, 500.0), (900.0, 500.0), 0.08, 40.0)
    said = str(caught.value)
    assert "\n" not in said
    assert f"up to {DEEPEST:g} m" in said
    assert "from (300, 500) to (900, 500)" in said
    found = re.search(r"ends at \((\d+), (\d+)\), (\d+) m before it", said)
    assert found is not None
    x, y, left = map(float, found.groups())
    assert 400 < x < 490
    assert math.dist((x, y), (900, 500)) == pytest.approx(left, abs=1.5)


@pytest.mark.parametrize("gap", [(700.0, 860.0), (100.0, 300.0)])
def test_through_a_gap_in_the_wall_leads_the_way(gap: tuple[float, float]) -> None:
    land, ends = cliffs(gap), ((300.0, 500.0), (700.0, 520.0))
    way = way_between(land, *ends, 0.08, 40.0)
    assert_obeys(way, land, *ends, 0.08, 40.0)
    points = way.plan.at(np.linspace(0.0, way.plan.length, 2000))
    through = points[(points[:, 0] > 485) & (points[:, 0] < 515), 1]
    assert gap[0] < through.min() < through.max() < gap[1]
    corners = [(500.0, min(gap, key=lambda y: abs(y - 510))), *ends]
    least = math.dist(corners[0], ends[0]) + math.dist(corners[0], ends[1])
    assert least < way.plan.length < 1.25 * least


@pytest.mark.parametrize(
    ("start", "end", "said"),
    [
        ((5.0, 500.0), (800.0, 500.0), r"the start \(5, 500\) is not on the land"),
        ((200.0, 500.0), (800.0, 1200.0), r"the end \(800, 1200\) is not on the land"),
        ((200.0, 500.0), (230.0, 500.0), r"are 30 m apart"),
    ],
)
def test_places_off_the_land_or_too_close_are_refused(start: Place, end: Place, said: str) -> None:
    with pytest.raises(UsageError, match=said):
        way_between(plane(0.0), start, end, 0.08, 40.0)


def test_in_real_mountains_most_ways_are_found_and_obey() -> None:
    land, found = jacksboro(200, 150), 0
    assert np.ptp(land.heights) > 500.0
    for start, end in places(2, 6):
        try:
            way = way_between(land, start, end, 0.10, 30.0)
        except UsageError as error:
            assert re.search(r"10 % or less with bends of 30 m .* ends at \(\d+, \d+\)", str(error))  # noqa: PT017
            continue
        found += 1
        assert_obeys(way, land, start, end, 0.10, 30.0)
    assert found >= 4


def test_the_same_call_gives_the_same_way_and_the_way_back_is_found_too() -> None:
    land, (start, end) = jacksboro(100, 100), places(2)[1]
    one, same = (way_between(land, start, end, 0.10, 30.0) for _ in range(2))
    assert repr(one.plan) == repr(same.plan)
    assert repr(one.elevation) == repr(same.elevation)
    assert one.deepest == same.deepest
    back = way_between(land, end, start, 0.10, 30.0)
    assert_obeys(back, land, end, start, 0.10, 30.0)
    assert back.plan.length == pytest.approx(one.plan.length, rel=0.5)


@pytest.mark.parametrize("seed", [206, 165, 28, 17, 567, 173, 4, 1128])
def test_each_try_finds_ways_that_no_other_one_finds(seed: int) -> None:
    """A garden for each of the tries, in their order: without it there is no way through them."""
    land, start, end = steep_garden(seed)
    assert_obeys(way_between(land, start, end, 0.10, 15.0), land, start, end, 0.10, 15.0)


@pytest.mark.parametrize("seed", [29, 120, 509])
def test_the_last_arc_keeps_clear_of_the_way_before_it(seed: int) -> None:
    """In these gardens the nearest arc to the end crosses the way, or lies on it; another one does not."""
    land, start, end = steep_garden(seed)
    assert_obeys(way_between(land, start, end, 0.10, 15.0), land, start, end, 0.10, 15.0)


def least_area(land: Array, step: float, steepest: float) -> float:
    """The least area in m^2 between land and a road, over heights at these points; infinite if there is none.

    Unknown are heights z and depths d: -d <= z - land <= d; slopes and their changes are limited."""
    n = len(land)
    each = np.eye(n)
    one, two = np.diff(each, axis=0), np.diff(each, 2, axis=0)
    of_z = np.vstack([one, -one, two, -two, each, -each])
    of_d = np.vstack([np.zeros((4 * n - 6, n)), -each, -each])
    slopes, bends = np.full(2 * n - 2, steepest * step), np.full(2 * n - 4, step**2 / LEAST_VERTICAL)
    ends = [(z, z) for z in land[[0, -1]]]
    weights = np.r_[np.zeros(n), 0.5, np.ones(n - 2), 0.5] * step
    solved = linprog(
        weights,
        np.hstack([of_z, of_d]), np.r_[slopes, bends, land, -land],
        bounds=[ends[0], *[(None, None)] * (n - 2), ends[1], *[(0.0, DEEPEST)] * n],
    )  # fmt: skip
    return math.inf if solved.x is None else float(solved.fun)


@pytest.mark.parametrize(
    ("height", "steepest"), [(6.0, 0.06), (12.0, 0.08), (9.0, 0.03), (4.0, 0.15), (60.0, 0.05)]
)
def test_a_profile_has_the_least_area_between_road_and_land(height: float, steepest: float) -> None:
    """Over waves; the last ones are too high for cuttings and fills."""
    x = np.arange(0.0, 501.0, 10.0)
    land = relief(100.0 + height * np.sin(x / 37.0) * np.cos(x[:, None] / 61.0))
    plan = PieceCurve(60.0, 90.0, 0.5, (Piece(120.0), Piece(80.0, 0.01, 0.01), Piece(60.0)))
    s = np.arange(0.0, plan.length + 1e-9, 2.0)
    expected = least_area(land.at(*plan.at(s).T), 2.0, steepest)
    found = profile_over(land, plan, steepest)
    assert (found is None) == math.isinf(expected) == (height > 50)
    if found is not None:
        fine = np.linspace(0.0, plan.length, 5201)
        depth = np.abs(found[0].height(fine) - land.at(*plan.at(fine).T))
        assert depth.mean() * plan.length == pytest.approx(expected, rel=0.05, abs=0.01 * plan.length)
        assert found[1] == pytest.approx(depth.max(), abs=0.05)
