"""The camera sees the lanes and the inclined surface of the road on which it is."""

import math

import numpy as np
import pytest

from roadgpt.geometry import GradeProfile, Piece, PieceCurve
from roadgpt.road import CrossSection, Profile, Road, World
from roadgpt.scene import Camera, Pose, Scenery
from roadgpt.scene.network_mesh import patches_of
from roadgpt.scene.patterns import noise
from roadgpt.scene.shade import LaneBoundaries, paved

LENGTH = 120.0
STRAIGHT = Road(PieceCurve(60.0, 100.0, 0.0, (Piece(LENGTH),)), GradeProfile(0.0, (0.0, LENGTH), (0.0, 0.0)))


def is_white(lanes: LaneBoundaries, s: float, t: float) -> bool:
    """Whether a spot of 1 cm is painted: asphalt has a brightness of at most 0.3, paint about 0.75."""
    return bool(paved(noise(), s, t, 0.01, 0.01, -6.0, lanes)[0] > 0.5)


def test_paint_lies_at_the_boundaries_of_a_road_with_three_lanes() -> None:
    lanes = LaneBoundaries.of(Profile.of(2, 1, 3.0), LENGTH)
    # lines of 15 cm: at the edges 10 cm inside; in the middle and between lanes over the boundary
    for t, paint in ((2.82, True), (2.95, False), (1.5, False), (0.0, True), (-1.5, False), (-5.83, True)):
        assert [is_white(lanes, s, t) for s in (61.0, 67.0)] == [paint, paint], t
    assert is_white(lanes, 61.0, -3.0)  # dashes of 4 m from 60 m on, then 8 m without
    assert not is_white(lanes, 67.0, -3.0)


def test_the_goal_lies_across_the_driven_lane_only() -> None:
    lanes = LaneBoundaries.of(Profile.of(2, 1, 3.0), LENGTH)
    shades = {t: [is_white(lanes, LENGTH - 0.3, t + d) for d in np.linspace(0, 0.7, 8)] for t in (-4.8, -2.0)}
    assert any(shades[-4.8])
    assert not all(shades[-4.8])
    assert not any(shades[-2.0])


def test_a_one_way_road_has_grass_to_the_left_of_its_lane() -> None:
    image = Scenery.of(STRAIGHT, World(section=CrossSection(lanes="1+0", lane_width=3.0))).render(
        Camera(width=200, height=120), Pose(90.0, 98.5, 0.56, 0.0)
    )
    row = image[100].astype(int)
    is_green = row[:, 1] > row[:, 0] + 8
    assert is_green[:20].all()
    assert is_green[-20:].all()
    assert not is_green[95:105].any()


@pytest.mark.parametrize("ratio", [0.04, 0.08])
def test_the_surface_of_a_bend_falls_to_its_inside(ratio: float) -> None:
    k = 1 / 40
    plan = PieceCurve(60.0, 60.0, 0.0, (Piece(30.0), Piece(30.0, 0.0, k), Piece(60.0, k, k)))
    world = World(section=CrossSection(bank=ratio, shoulder=2.0))
    road = world.lay(Road(plan, GradeProfile(3.0, (0.0, plan.length), (0.0, 0.0))))
    scene = Scenery.of(road, world)
    patches, _ = patches_of(road, world, scene.ground)
    surface = np.concatenate([patch.points for patch in patches if (patch.kinds == 0).all()])
    s, t = road.locate(surface[:, 0], surface[:, 1])
    arc = (s > 95.0) & (np.abs(t) < 5.9)  # all of the arc has the whole superelevation there
    assert arc.sum() > 20
    height = 3.0 - t[arc] * math.sin(math.atan(ratio))
    assert surface[arc, 2] == pytest.approx(height, abs=2e-3)
    land = scene.ground.height(surface[arc, 0], surface[arc, 1])
    assert land == pytest.approx(surface[arc, 2], abs=2e-3)
