"""The terrain around a road: near it below its edges, far away level to the horizon."""

from dataclasses import replace

import numpy as np
import pytest

from roadgpt.geometry import CubicProfile, GradeProfile, Piece, PieceCurve
from roadgpt.road import CrossSection, Road, World
from roadgpt.road.land import Land
from roadgpt.scene.scene import landscape

FAR = np.array([300.0, 900.0, 2500.0, 7000.0])  # m beyond the margin of 130 m
ROAD = Road(
    PieceCurve(10.0, 20.0, 0.4, (Piece(150.0), Piece(70.0, 0.0, 1 / 60))),
    GradeProfile(20.0, (0.0, 220.0), (0.05, -0.03)),
)


@pytest.fixture(scope="module")
def land() -> Land:
    return landscape(ROAD, World())[0]


def test_far_ground_comes_down_by_shares_to_four_metres_below_the_mean(land: Land) -> None:
    """Each far row and column: half of the way, nine tenths of it, and all of it in the last two."""
    near = land.heights[4:-4, 4:-4]
    level = near.mean() - 4.0
    for ring, share in enumerate((0.5, 0.9, 1.0, 1.0), 1):
        outer = 4 - ring
        for border, far in (
            (near[0], land.heights[outer, 4:-4]),
            (near[-1], land.heights[-1 - outer, 4:-4]),
            (near[:, 0], land.heights[4:-4, outer]),
            (near[:, -1], land.heights[4:-4, -1 - outer]),
        ):
            assert far == pytest.approx((1 - share) * border + share * level)
        corners = land.heights[[outer, outer, -1 - outer, -1 - outer], [outer, -1 - outer, outer, -1 - outer]]
        of_near = near[[0, 0, -1, -1], [0, -1, 0, -1]]
        assert corners == pytest.approx((1 - share) * of_near + share * level)
    assert land.away.shape == land.heights.shape
    assert land.away[0, 0] == land.away[4, 4]


def test_the_land_beside_a_road_lies_35_cm_or_more_below_it(land: Land) -> None:
    s = np.linspace(0.0, ROAD.length, 80)
    for t in (-6.0, 0.0, 6.0):
        x, y, _ = ROAD.at(s, t).T
        below = ROAD.at(s)[:, 2] - land.height(x, y)
        assert below.min() > 0.35 - 1e-9
        assert below.max() < 1.5
    x, y, _ = ROAD.at(s).T
    assert land.between(land.away, x, y) == pytest.approx(0.0)


def test_heights_between_the_points_of_the_grid_are_bilinear() -> None:
    x, y = np.array([0.0, 1.0, 5.0]), np.array([-2.0, 3.0, 4.0])
    table = np.random.default_rng(1).normal(size=(3, 3))
    land = Land(x, y, table, table, 4.0)
    for i in range(3):
        for j in range(3):
            assert land.height(x[[i]], y[[j]]) == pytest.approx(table[j, i])
    assert land.height(np.array([2.0]), np.array([4.0])) == pytest.approx(
        0.75 * table[2, 1] + 0.25 * table[2, 2]
    )
    assert land.height(np.array([5.0]), np.array([0.0])) == pytest.approx(
        0.6 * table[0, 2] + 0.4 * table[1, 2]
    )
    assert land.height(np.array([9.0]), np.array([-9.0])) == pytest.approx(table[0, 2])


@pytest.mark.parametrize(("floor", "level"), [(-28.0, -28.0), (50.0, 19.0)])
def test_without_a_shoulder_the_land_is_flat_and_a_metre_or_more_below_the_road(
    floor: float, level: float
) -> None:
    world = World(section=CrossSection(shoulder=0)).changed(z_floor=floor)
    land, _ = landscape(ROAD, world)
    assert land.heights[4:-4, 4:-4] == pytest.approx(level)
    assert land.heights[0] == pytest.approx(level - 4)
    assert np.isinf(land.away).all()


@pytest.mark.parametrize("side", [-1, 1])
def test_land_lies_below_the_lower_edge_of_a_banked_road(side: int) -> None:
    angle = CubicProfile.constant(side * 0.12)
    profile = replace(World().profile_of(ROAD), superelevation_angle=angle)
    road = ROAD.with_profile(profile)
    (land, _), s = landscape(road, World()), np.linspace(0.0, road.length, 80)
    rims = [road.at(s, t) for t in profile.rims(s)]
    lower = np.minimum(rims[0][:, 2], rims[1][:, 2])
    assert (road.at(s)[:, 2] - lower).min() > 0.5
    for x, y, _ in (road.at(s).T, rims[0].T, rims[1].T):
        below = lower - land.height(x, y)
        assert below.min() > 0.2
        assert below.max() < 1.5
