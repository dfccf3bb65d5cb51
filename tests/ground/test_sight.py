"""Who is seen over land: over crests, in bends in cuttings, through tunnels, and behind hills.

The second opinions: formulas of road design for crests and for bends beside an obstacle (AASHTO, *A Policy on
Geometric Design of Highways and Streets*, 3.2.6, 3.3.12, 3.4.6), and a slow caster of rays in fine steps."""

import math

import numpy as np
import pytest

from roadgpt.drive import Command, View, simulate
from roadgpt.drive.company import in_sight
from roadgpt.geometry import GradeProfile, Piece, PieceCurve
from roadgpt.geometry.curve import Array
from roadgpt.ground.files import named
from roadgpt.ground.relief import Relief
from roadgpt.ground.sight import GRAZING, OPEN, Horizon, horizon_of, is_behind_land
from roadgpt.network.landscape import crossings, ground_around, horizon_around
from roadgpt.network.sight import FARTHEST, sight_along
from roadgpt.road import Road, World
from roadgpt.traffic import SIZES, Actor, Tracks

EYE, TAIL_LIGHT = 1.08, 0.60  # m above the road, in the formulas
RIM, LANE = 7.0, -2.0  # m from the centre line to the rim, and to the middle of the driven lane
Point = tuple[float, float, float]


def land(heights: Array, cell: float = 10.0) -> World:
    relief = Relief(0.0, 0.0, cell, heights, np.full_like(heights, np.nan), np.empty((0, 3)))
    return World().changed(ground=named("x.npy", relief))


def plane(height: float, side: int = 61) -> World:
    return land(np.full((side, side), height))


def bend(radius: float, length: float, side: float = 1.0) -> Road:
    """A level bend at a height of 10 m, to the left with ``side`` 1."""
    curve = PieceCurve(300.0, 300.0, 0.0, (Piece(length, side / radius, side / radius),))
    return Road(curve, GradeProfile.level(length, 10.0))


def straight(length: float, x: float = 100.0, y: float = 300.0, height: float = 10.0) -> Road:
    return Road(PieceCurve(x, y, 0.0, (Piece(length),)), GradeProfile.level(length, height))


def over_chord(radius: float, aside: float) -> float:
    """The length of the arc that one sees past an obstacle ``aside`` metres inside of it, at its middle."""
    return 2.0 * radius * math.acos(1.0 - aside / radius)


def excess(horizon: Horizon, a: Point, b: Point) -> float:
    """By how many metres the land is at most above the line between two points, farther than a cell from its
    ends; in steps of 2 cm, with heights between four points of the grid."""
    far = math.hypot(b[0] - a[0], b[1] - a[1])
    share = np.arange(horizon.cell / far, 1.0 - horizon.cell / far, 0.02 / far)[:, None]
    x, y, z = (np.array(a) + share * (np.array(b) - np.array(a))).T
    u, v = (x - horizon.x) / horizon.cell, (y - horizon.y) / horizon.cell
    i, j = np.floor(u).astype(int), np.floor(v).astype(int)
    corners = [
        horizon.heights[j + n, i + m] * np.abs(1 - m - (u - i)) * np.abs(1 - n - (v - j))
        for n in (0, 1)
        for m in (0, 1)
    ]
    return float((np.sum(corners, axis=0) - z).max())


@pytest.mark.parametrize(("radius", "grade"), [(1000.0, 0.10), (2000.0, 0.08), (4000.0, 0.06)])
@pytest.mark.parametrize("ground", ["", "flat", "hilly:2"])
def test_over_a_crest_one_sees_as_far_as_the_formula_says(radius: float, grade: float, ground: str) -> None:
    """A line over a parabola touches it sqrt(2 R h) from a point h above it. It may graze the land a bit."""
    rise, before = radius * grade, 150.0
    stations = (0.0, before, before + 2 * rise, 2 * (before + rise))
    profile = GradeProfile(0.0, stations, (grade, grade, -grade, -grade))
    crest = Road(PieceCurve(0.0, 0.0, 0.3, (Piece(stations[-1]),)), profile)
    s, seen = sight_along(crest, World().changed(ground=ground), 1.0)
    expected = math.sqrt(2 * radius) * (math.sqrt(EYE) + math.sqrt(TAIL_LIGHT))
    grazing = math.sqrt(2 * radius) * (math.sqrt(EYE + GRAZING) + math.sqrt(TAIL_LIGHT + GRAZING))
    assert expected - 2.0 < seen.min() < grazing + 1.0
    # on the crest, wherever both ends of the line are on the parabola
    inner = (s > before) & (s < before + 2 * rise - grazing)
    assert seen[inner] == pytest.approx(seen.min(), abs=2.0)
    assert np.isinf(seen[s > before + 2 * rise]).all()  # downhill, to the end


@pytest.mark.parametrize(("length", "ground"), [(300.0, ""), (300.0, "mountain:1"), (620.0, "flat")])
def test_a_straight_level_road_is_seen_to_its_end(length: float, ground: str) -> None:
    s, seen = sight_along(straight(length), World().changed(ground=ground))
    to_the_end = length - s <= FARTHEST
    assert np.isinf(seen[to_the_end]).all()
    assert seen[~to_the_end].tolist() == [FARTHEST] * int((length - FARTHEST) / 5.0)


@pytest.mark.parametrize(("radius", "side"), [(60.0, 1.0), (60.0, -1.0), (120.0, 1.0), (120.0, -1.0)])
def test_in_a_bend_in_a_cutting_one_sees_as_far_as_its_slope_lets(radius: float, side: float) -> None:
    """The slope of 1:2 is as high as the line of sight, (1.08 + 0.60) / 2 m, 1.68 m beyond the rim."""
    road = bend(radius, 1.5 * radius, side)
    own = radius - side * LANE  # radius of the middle of the lane
    aside = RIM - side * LANE + (EYE + TAIL_LIGHT) / 2 * 2
    expected = over_chord(own, aside) * radius / own  # in stations, which are those of the centre line
    s, deep = sight_along(road, plane(20.0), 1.0)
    assert deep[s < road.length - expected - 3] == pytest.approx(expected, abs=2.0)
    for open_land in (plane(10.0), plane(2.0)):
        assert np.isinf(sight_along(road, open_land, 1.0)[1]).all()
    _, in_words = sight_along(road, World().changed(scene="cutting", map_size=600), 1.0)
    assert in_words.min() == pytest.approx(expected, abs=2.0)


def test_one_sees_through_a_straight_tunnel_and_not_over_its_hill() -> None:
    road, world = straight(300.0), World().changed(scene="ridge through; tunnel len=80", map_size=600)
    (tunnel,) = crossings(road, world)
    assert tunnel.end - tunnel.start == pytest.approx(80.0)
    assert np.isinf(sight_along(road, world)[1]).all()
    horizon = horizon_around(road, world)
    ends = [road.at(s, 0.0) + [0.0, 0.0, 1.2] for s in (tunnel.start - 5, tunnel.end + 5)]
    assert not is_behind_land(horizon, *ends[0], *ends[1])
    for aside in (-12.0, 12.0):
        one, other = (end + [0.0, aside, 0.0] for end in ends)
        assert is_behind_land(horizon, *one, *other)
        assert excess(horizon, tuple(one), tuple(other)) > 5.0


def test_the_wall_of_a_tunnel_hides_what_is_round_the_bend() -> None:
    """It stands at the rim, within a cell of the grid."""
    road, world = bend(100.0, 250.0, -1.0), World().changed(scene="tunnel len=170", map_size=600)
    (tunnel,) = crossings(road, world)
    s, seen = sight_along(road, world, 1.0)
    least, most = (over_chord(98.0, aside) * 100 / 98 for aside in (RIM + LANE - 1.2, RIM + LANE + 0.2))
    inside = (s > tunnel.start) & (s < tunnel.end - most - 2)
    assert inside.sum() > 50
    assert least - 2 < seen[inside].min() < seen[inside].max() < most + 2


@pytest.mark.parametrize("ground", ["hilly:3", "rolling:1", "mountain:2"])
def test_a_slow_caster_of_rays_says_the_same(ground: str) -> None:
    horizon = horizon_around(bend(80.0, 200.0), World().changed(ground=ground))
    assert horizon.heights.shape > (100, 100)
    rng, hidden, known = np.random.default_rng(4), 0, 0
    rows, columns = horizon.heights.shape
    for _ in range(300):
        i, j = rng.integers(2, columns - 2, 2), rng.integers(2, rows - 2, 2)
        z = horizon.heights[j, i] + rng.uniform(0.3, 4.0, 2)
        one, other = np.column_stack([horizon.x + horizon.cell * i, horizon.y + horizon.cell * j, z]).tolist()
        if math.dist(one[:2], other[:2]) < 4 * horizon.cell:
            continue
        above, is_hidden = excess(horizon, tuple(one), tuple(other)), is_behind_land(horizon, *one, *other)
        if abs(above - GRAZING) > GRAZING:
            known += 1
            assert is_hidden == (above > GRAZING), (one, other, above)
            assert is_hidden == is_behind_land(horizon, *other, *one)
        hidden += is_hidden
    assert known > 250
    assert 40 < hidden < 260


def in_view(eye: Array, boxes: Array, horizon: Horizon) -> set[int]:
    """Which of the boxes the eye sees; their rows are x, y, z, heading, speed and sizes."""
    order = np.argsort(np.hypot(*(boxes[:, :2] - eye[:2]).T))
    seen = np.ascontiguousarray(boxes[order, :4])
    states, sizes = np.ascontiguousarray(boxes[:, :5]), np.ascontiguousarray(boxes[:, 5:])
    kept = in_sight(states, sizes, eye, np.empty((0, 3)), horizon, order, seen, len(boxes), 200.0)
    return set(order[:kept].tolist())


def test_a_hill_hides_who_is_behind_it_and_not_who_stands_on_it() -> None:
    """A ridge of 8 m across the way of the light, 40 m ahead; the others stand 80 m ahead."""
    x = np.arange(0.0, 301.0, 5.0)
    ridge = np.broadcast_to(8.0 * np.exp(-(((x - 140.0) / 15.0) ** 2)), (len(x), len(x))).copy()
    horizon, eye = Horizon(ridge, 0.0, 0.0, 5.0), np.array([100.0, 150.0, 1.2])
    places = [(140.0, 150.0, 8.0), (180.0, 150.0, 0.03), (180.0, 170.0, 16.0), (100.0, 190.0, 0.0)]
    boxes = np.array([[*place, 0.0, 0.0, *SIZES["adult"]] for place in places])
    assert in_view(eye, boxes, OPEN) == {0, 1, 2, 3}
    assert in_view(eye, boxes, horizon) == {0, 2, 3}
    assert in_view(eye + [0.0, 0.0, 30.0], boxes, horizon) == {0, 1, 2, 3}
    # the line over the top of the ridge, 40 m ahead, is twice as far above the eye 80 m ahead
    for up, is_seen in ((-0.3, False), (0.3, True)):
        needed = 1.2 + 2 * (8.0 - 1.2) - SIZES["adult"].height + up
        box = np.array([[180.0, 150.0, needed, 0.0, 0.0, *SIZES["adult"]]])
        assert (in_view(eye, box, horizon) == {0}) is is_seen


class Looker:
    """Rolls on slowly and notes whom it sees."""

    name = "looker"

    def __init__(self) -> None:
        self.views: list[View] = []

    def steer(self, view: View) -> Command:
        self.views.append(view)
        return Command(0.0, 0.3 * max(8.0 - view.vx, 0.0), 0.0)


def test_in_a_drive_somebody_behind_a_hill_is_told_when_the_land_lets() -> None:
    """Land rises beside the road; somebody stands behind the rise and is seen once the car has passed it."""
    x, y = np.meshgrid(np.arange(0.0, 401.0, 10.0), np.arange(0.0, 401.0, 10.0))
    hill = 10.0 + 12.0 * np.exp(-(((x - 150.0) / 25.0) ** 2) - ((y - 240.0) / 20.0) ** 2)
    road, world, driver = straight(140.0, y=200.0), land(hill), Looker()
    stands = np.array([190.0, 260.0, 10.0, 0.0, 0.0])
    tracks = Tracks((Actor("adult 1", "adult", SIZES["adult"]),), np.tile(stands, (900, 1, 1)))
    drive = simulate(road, world, driver, 1, replay=tracks)
    horizon = horizon_of(ground_around(road, world))
    top, told, checked = 10.0 + SIZES["adult"].height, [], 0
    for view in driver.views[::10]:
        ahead = drive.car.ahead
        eye = (view.x + ahead * math.cos(view.heading), view.y + ahead * math.sin(view.heading), 11.2)
        above = excess(horizon, eye, (190.0, 260.0, top))
        told.append(bool(view.others))
        if abs(above - GRAZING) > 0.1:
            checked += 1
            assert bool(view.others) == (above < GRAZING), (eye, above)
    assert checked > 0.8 * len(told)
    assert not told[0]
    assert told[-1]
