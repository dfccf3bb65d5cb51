"""Shapely's polygons against the formula: moved sideways by its margin, a car is at the tolerance."""

import math

import numpy as np
import pytest
from shapely.affinity import translate
from shapely.geometry import LineString, Polygon

from drive.slippery_bicycle import BOX, SlipperyBicycle
from grids import pairs
from roadgpt.drive import COLUMNS, Columns, Drive
from roadgpt.drive.drivers.beamng_like import BeamngLike
from roadgpt.road import Design, Limits, Road, Segment, World, build
from roadgpt.verdict import consult, judge
from roadgpt.verdict.oracle import margins


def bent(radius: float, hand: int) -> Road:
    turn = {"direction": "left" if hand > 0 else "right", "turn_degrees": 65.0 * hand, "radius": radius}
    straight = Segment(distance=30, direction="straight")
    bend = Segment(distance=1.6 * radius, transition=5.0, **turn)  # type: ignore[arg-type]
    return build(Design(starting_point=(50, 50, 0), theta=30, segments=(straight, bend, straight)))


def lane_of(road: Road) -> Polygon:
    s = np.linspace(0, road.length, int(road.length * 5))
    return Polygon(np.concatenate([road.at(s, 0.0)[:, :2], road.at(s[::-1], -4.0)[:, :2]]))


def share(road_lane: Polygon, box: Polygon) -> float:
    return 1 - box.intersection(road_lane).area / box.area


def random_drive(road: Road, seed: int, n: int = 60) -> Drive:
    rng = np.random.default_rng(seed)
    s = rng.uniform(10, road.length - 10, n)
    t = rng.uniform(-6.0, 2.0, n)
    columns = {name: np.zeros(n) for name in COLUMNS}
    place = road.at(s, t)
    columns |= {"s": s, "t": t, "x": place[:, 0], "y": place[:, 1], "time": 0.02 * np.arange(n)}
    columns["heading"] = road.heading(s) + rng.uniform(-0.4, 0.4, n)
    lane = lane_of(road)
    drive = Drive("none", "shapely", 0, Columns(columns), "timeout", BOX)
    columns["outside"] = np.array([share(lane, Polygon(drive.corners(i))) for i in range(n)])
    return Drive("none", "shapely", 0, Columns(columns), "timeout", BOX)


@pytest.mark.parametrize(("tolerance", "hand", "radius"), pairs((0.5, 0.85, 0.95), (-1, 1), (15.0, 40.0)))
def test_moved_by_the_margin_the_car_is_at_the_tolerance(radius: float, hand: int, tolerance: float) -> None:
    road, world = bent(radius, hand), World(limits=Limits(oob_tolerance=tolerance))
    lane, drive = lane_of(road), random_drive(bent(radius, hand), seed=3)
    off = []
    for i, margin in enumerate(margins(road, drive, world)):
        away = math.copysign(1.0, drive["t"][i] + 2.0)
        across = road.heading(drive["s"][i]) + math.pi / 2
        box = Polygon(drive.corners(i))

        def moved(by: float, box: Polygon = box, away: float = away, across: float = float(across)) -> float:
            return share(lane, translate(box, away * by * math.cos(across), away * by * math.sin(across)))

        # where shapely's own share passes the tolerance, by halving
        low, high = -abs(drive["t"][i] + 2.0), 9.0  # from the middle of the lane outwards
        for _ in range(30):
            mid = (low + high) / 2
            low, high = (mid, high) if moved(mid) <= tolerance else (low, mid)
        if abs(drive["t"][i] + 2.0) > 0.3:  # in the middle of the lane either side may be the nearer
            off.append(abs(low - margin))
    assert np.median(off) < 0.02
    assert max(off) < 0.12  # a box turned by 0.4 rad on the tightest bend


def test_the_verdict_is_shapelys_on_real_drives() -> None:
    ended = set()
    for radius, cut in ((15.0, 9.0), (15.0, 2.0), (30.0, 14.0), (60.0, 4.8)):
        for hand in (-1, 1):
            road, world = bent(radius, hand), World(limits=Limits(oob_tolerance=0.85))
            drive = SlipperyBicycle().simulate(road, world, BeamngLike(cut=cut), 0, keep_driving=True)
            lane = lane_of(road)
            # The step of the goal is not asked about the lane.
            shares = np.array([share(lane, Polygon(drive.corners(i))) for i in range(len(drive) - 1)])
            verdict = judge(road, drive, world)
            out = np.flatnonzero(shares > 0.85)
            assert verdict.max_oob == pytest.approx(shares.max(), abs=0.03)  # the double counts a grid
            if abs(shares.max() - 0.85) < 0.03:
                continue
            assert verdict.kept == (len(out) == 0)
            ended.add(verdict.kept)
            if len(out):
                soon, late = (drive["s"][np.argmax(shares > 0.85 + by)] for by in (-0.03, 0.03))
                assert soon - 1e-3 <= verdict.at_s <= late + 1e-3
                assert late - soon < 1.0
                assert verdict.side == ("left" if hand > 0 else "right")
    assert ended == {True, False}


def test_oob_distance_is_that_of_shapelys_line() -> None:
    road = bent(20.0, 1)
    drive = SlipperyBicycle().simulate(road, World(), BeamngLike(), 0, keep_driving=True)
    s = np.linspace(0, road.length, 4000)
    middle = LineString(road.at(s, -2.0)[:, :2])
    from shapely.geometry import Point

    theirs = [2 - middle.distance(Point(x, y)) for x, y in zip(drive["x"], drive["y"], strict=True)]
    assert consult(road, drive, World()).oob_distance == pytest.approx(np.array(theirs), abs=2e-3)
