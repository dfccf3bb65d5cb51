"""Compares the distance that a car reaches beyond its lane's markings with Shapely's polygons."""

import numpy as np
import pytest
import shapely
from shapely import Polygon

from authorities.test_verdict_shapely import bent, random_drive
from drive.slippery_bicycle import SlipperyBicycle
from roadgpt.drive import Box
from roadgpt.drive.drivers.beamng_like import BeamngLike
from roadgpt.drive.lane_position import MarkingMonitor
from roadgpt.road import Limits, Road, World
from roadgpt.verdict import judge

CENTRE_LINE = 0.12  # m, narrow mark of the German RMS-1: half of it lies beyond the middle of the road


def between_markings(road: Road) -> Polygon:
    s = np.linspace(0, road.length, int(road.length * 20))
    left, right = road.at(s, CENTRE_LINE / 2)[:, :2], road.at(s[::-1], -4.0)[:, :2]
    return Polygon(np.concatenate([left, right]))


class ShapelyLane:
    """Shapely's distances from a polygon; its tree of the sides finds the nearest without asking them all."""

    def __init__(self, road: Road) -> None:
        self.polygon = between_markings(road)
        shapely.prepare(self.polygon)
        corners = np.asarray(self.polygon.exterior.coords)
        self.sides = shapely.STRtree(shapely.linestrings(np.stack([corners[:-1], corners[1:]], axis=1)))

    def farthest(self, places: np.ndarray) -> float:
        """Metres outside the lane, of the farthest point outside; negative: inside, from its border."""
        (asked, _), away = self.sides.query_nearest(
            shapely.points(places), all_matches=False, return_distance=True
        )
        assert (asked == np.arange(len(places))).all()
        return float(np.where(shapely.contains_xy(self.polygon, places), -away, away).max())


@pytest.mark.parametrize("hand", [-1, 1])
@pytest.mark.parametrize("radius", [15.0, 40.0])
def test_body_and_tyres_reach_as_far_as_shapely_says(radius: float, hand: int) -> None:
    road, world = bent(radius, hand), World()
    drive = random_drive(road, seed=round(radius) + hand)
    lane = ShapelyLane(road)
    body = MarkingMonitor.for_body(road, world, drive.car).along(drive)
    tyres = MarkingMonitor.for_tyres(road, world, drive.car).along(drive)
    for step in range(len(drive)):
        box = Polygon(drive.corners(step))
        sides = shapely.line_interpolate_point(box.exterior, np.linspace(0, 1, 400), normalized=True)
        assert body[step] == pytest.approx(lane.farthest(shapely.get_coordinates(sides)), abs=0.02)
        x, y, heading = (drive[name][step] for name in ("x", "y", "heading"))
        ahead, left = (
            np.array([np.cos(heading), np.sin(heading)]),
            np.array([-np.sin(heading), np.cos(heading)]),
        )
        feet = [[x, y] + 1.36 * ahead + side * 0.9025 * left for side in (-1, 1)]
        assert tyres[step] == pytest.approx(lane.farthest(np.array(feet)), abs=0.005)


@pytest.mark.parametrize("hand", [-1, 1])
def test_a_share_outside_and_a_distance_beyond_the_edge_line_go_together(hand: int) -> None:
    road = bent(16.0, hand)
    drive = SlipperyBicycle().simulate(road, World(), BeamngLike(), 0, keep_driving=True)
    monitor = MarkingMonitor.for_body(road, World(), drive.car)
    both = monitor._replace(edges=monitor.edges * [0.0, 1.0])
    is_out = drive["outside"] > 1e-3
    assert is_out.any()
    assert (both.along(drive)[is_out] > -0.02).all()
    assert (both.along(drive)[drive["outside"] == 0] < 0.03).all()
    floored = both.along(drive, floor=0.0)
    assert (np.maximum(floored, 0) == np.maximum(both.along(drive), 0)).all()


def test_the_farthest_of_a_whole_drive_is_told() -> None:
    road, world = bent(15.0, -1), World(limits=Limits(oob_tolerance=1.0))
    drive = SlipperyBicycle().simulate(road, world, BeamngLike(), 0)
    lane = ShapelyLane(road)
    every = [lane.farthest(np.asarray(drive.corners(step))) for step in range(drive.lane_steps)]
    told = judge(road, drive, world).beyond
    assert told is not None
    # the middle of a side may reach farther over the inside of a bend than the corners do
    assert max(every) - 0.01 <= told <= max(every) + 0.3


def test_a_car_that_leans_is_turned_about_its_centre_of_gravity() -> None:
    # on paper: heading east on a straight, leaning to its right, its feet are to the left of where it is
    road = Road.through([[10, 20], [60, 20], [110, 20]])
    box = Box(4.7, 1.86, height=0.5, under=0.4, tyres=1.8)
    pose = np.array([[40.0, 18.0, 0.0, 0.0, 0.1, 30.0]])
    feet = MarkingMonitor.for_tyres(road, World(), box).beyond(pose)[0]
    assert feet == pytest.approx(-2.0 + 0.9 * np.cos(0.1) + 0.5 * np.sin(0.1) - 0.06)
    body = MarkingMonitor.for_body(road, World(), box).beyond(pose)[0]
    assert body == pytest.approx(-2.0 + 0.93 * np.cos(0.1) + 0.4 * np.sin(0.1) - 0.06)
