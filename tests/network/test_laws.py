"""Laws of networks: roads join, lanes meet, kerbs are as wide as asked, and the paved area has no holes."""

import math
from functools import cache

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from matplotlib.path import Path
from scipy.special import fresnel

from network.changing import built, design, passing
from network.random_designs import random_design
from network.shared_laws import Motion, check_that_ways_join_the_arms, pose
from roadgpt.geometry import PieceCurve
from roadgpt.network import Junction, Network, Route, build_route
from roadgpt.network.pose import SHARE, curve_between, tangent_length
from roadgpt.road import World, read_design

SEEDS = range(12)
settled = settings(max_examples=12, deadline=None)
seeds = st.integers(0, 11)
"""Few, so that all laws look at the same networks."""
EXACT = 1e-9  # m and rad


@cache
def drawn(seed: int) -> Route:
    return build_route(read_design(random_design(seed))[0], World())


@given(seeds)
@settled
def test_connecting_roads_begin_and_end_on_the_arms(seed: int) -> None:
    check_that_ways_join_the_arms(drawn(seed).network, EXACT)


@given(seeds)
@settled
def test_junctions_are_level(seed: int) -> None:
    network = drawn(seed).network
    for junction in network.junctions:
        for arm in junction.arms:
            _, _, z, *_, grade = pose(network, arm.end, inwards=True)
            assert z == pytest.approx(junction.node[2], abs=EXACT)
            assert grade == 0
        for each in junction.connections:
            road = network.road(each.road).road
            assert np.ptp(road.at(np.linspace(0, road.length, 50))[:, 2]) == 0


@pytest.mark.parametrize(("length", "incline"), [(30, 8), (30, -10), (35, 5), (60, 10), (60, -3)])
def test_the_last_six_metres_before_a_junction_are_level(length: float, incline: float) -> None:
    steep = {"distance": length, "incline": incline}
    route = built(
        design(
            60.0,
            {"kind": "crossroads", "take": "straight"},
            steep,
            {"kind": "t_junction", "take": "left"},
            60.0,
        )
    )
    road = route.roads[1][1].road
    heights = road.at(np.linspace(0, road.length, round(10 * road.length) + 1))[:, 2]
    assert (heights[-1] - heights[0]) * incline > 0
    assert np.ptp(heights[:60]) < 1e-9
    assert np.ptp(heights[-60:]) < 1e-9


@given(seeds)
@settled
def test_lanes_are_as_wide_on_both_sides_of_a_contact(seed: int) -> None:
    network = drawn(seed).network
    for junction in network.junctions:
        for each in junction.connections:
            own = network.road(each.road)
            pairs = ((each.incoming, 0.0, True), (each.outgoing, own.road.length, False))
            for end, s, into in pairs:
                arm = network.road(end.road)
                at = 0.0 if end.contact == "start" else arm.road.length
                on_right = (end.contact == "end") == into
                edges = arm.profile.edges(at)
                width = -float(edges.right) if on_right else float(edges.left)
                assert -float(own.profile.edges(s).right) == pytest.approx(width, abs=EXACT)
                assert float(own.profile.edges(s).left) == 0


@given(seeds)
@settled
def test_every_way_into_a_junction_leads_to_every_other_arm(seed: int) -> None:
    network = drawn(seed).network
    for junction in network.junctions:
        ways = [(each.incoming, each.outgoing) for each in junction.connections]
        ends = [arm.end for arm in junction.arms]
        if junction.kind != "roundabout":
            assert sorted(ways) == sorted((a, b) for a in ends for b in ends if a != b)
            continue
        arm, after, before = ends
        assert sorted(ways) == sorted([(before, after), (before, arm), (arm, after)])
        assert (after.contact, before.contact) == ("start", "end")


@given(seeds)
@settled
def test_arms_stand_counter_clockwise_and_look_out(seed: int) -> None:
    network = drawn(seed).network
    for junction in network.junctions:
        directions = []
        for arm in junction.arms:
            *_, dx, dy, _ = pose(network, arm.end, inwards=False)
            assert math.cos(math.atan2(dy, dx) - arm.direction) == pytest.approx(1, abs=1e-12)
            directions.append(math.atan2(dy, dx))
        turned = [(each - directions[0]) % (2 * math.pi) for each in directions]
        assert turned == sorted(turned)


@given(seeds, st.floats(-200, 200), st.floats(-200, 200), st.floats(-50, 50), st.floats(-180, 180))
@settled
def test_a_design_that_is_moved_and_turned_gives_the_network_moved_and_turned(
    seed: int, dx: float, dy: float, dz: float, degrees: float
) -> None:
    moved = Motion(random_design(seed), (dx, dy, dz), degrees)
    one, other = drawn(seed), build_route(read_design(moved.design)[0], World())
    assert other.legs == one.legs
    for a, b in zip(one.network.roads, other.network.roads, strict=True):
        assert (a.id, a.junction) == (b.id, b.junction)
        s = np.linspace(0, a.road.length, 7)
        there, expected = b.road.at(np.minimum(s, b.road.length)), moved(a.road.at(s))
        assert there[:, :2] == pytest.approx(expected[:, :2], abs=1e-6)
        assert there[:, 2] == pytest.approx(expected[:, 2], abs=1e-9)


@given(st.floats(0.01, 3.0))
@settled
def test_the_tangent_length_is_that_of_two_clothoids_and_an_arc(turn: float) -> None:
    """The classical formula T = (R + p) tan(turn / 2) + k, with the clothoid from Fresnel's integrals."""
    spiral = SHARE * turn  # length of a clothoid that ends with radius 1 m and turns by half its length
    theta = spiral / 2
    a = math.sqrt(math.pi * spiral)
    sine, cosine = fresnel(spiral / a)
    x, y = a * cosine, a * sine
    p, k = y - (1 - math.cos(theta)), x - math.sin(theta)
    expected = (1 + p) * math.tan(turn / 2) + k
    assert tangent_length(turn) == pytest.approx(expected, rel=1e-9)


@given(st.floats(1, 60), st.floats(1, 60), st.floats(0.02, 2.9), st.sampled_from([-1, 1]))
@settled
def test_a_connecting_curve_uses_all_the_room_on_its_shorter_side(
    before: float, after: float, turn: float, hand: int
) -> None:
    curve = PieceCurve(0.0, 0.0, 0.0, curve_between(before, after, hand * turn))
    end = [before + after * math.cos(turn), hand * after * math.sin(turn)]
    assert curve.at(curve.length) == pytest.approx(end, abs=1e-9)
    assert float(curve.heading(curve.length)) == pytest.approx(hand * turn, abs=1e-12)
    straight = [piece.length for piece in curve.pieces if piece.k0 == piece.k1 == 0]
    assert sum(straight) == pytest.approx(abs(before - after), abs=1e-6)
    assert all(piece.k0 * hand >= 0 and piece.k1 * hand >= 0 for piece in curve.pieces)


def kerbs(network: Network, junction: Junction) -> list[float]:
    """The smallest radius of the right edge of each way from an arm to the next one, if it turns right."""
    found = []
    ends = [arm.end for arm in junction.arms]
    for each in junction.connections:
        if ends.index(each.outgoing) != (ends.index(each.incoming) + 1) % len(ends):
            continue
        road = network.road(each.road).road
        s = np.linspace(0, road.length, 3000)
        right = road.at(s, -4.0)[:, :2]
        step = np.hypot(*np.diff(right, axis=0).T)
        turned = np.diff(road.heading(s))
        if turned.sum() < -0.01:
            found.append(float((step / np.maximum(-turned, 1e-12)).min()))
    return found


@given(
    st.sampled_from(["t_junction", "y_junction", "crossroads", "star"]),
    st.floats(1, 25),
    st.integers(0, 10**6),
)
@settled
def test_kerbs_are_as_wide_as_asked_or_wider(kind: str, kerb: float, seed: int) -> None:
    """Arms are drawn at any angles 25 degrees apart; the edge of a turn is at 4 m from its reference line."""
    count = {"t_junction": 2, "y_junction": 2, "crossroads": 3, "star": 4}[kind]
    rng = np.random.default_rng(seed)
    while True:
        angles = np.sort(rng.uniform(-154, 154, count))
        if count == 1 or np.diff(angles).min() > 25.1:
            break
    route = passing(kind, 1, kerb=kerb, arms=[{"angle": float(each)} for each in angles])
    found = kerbs(route.network, route.network.junctions[0])
    assert found
    assert min(found) >= kerb - 1e-3


def raster(network: Network, step: float) -> float:
    """The area in m^2 of all lanes, counted on a grid of points, tested against the edges of roads."""
    x0, y0, x1, y1 = network.paved.bounds
    x, y = np.arange(x0 - 1, x1 + 1, step), np.arange(y0 - 1, y1 + 1, step)
    points = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    inside = np.zeros(len(points), bool)
    for each in network.roads:
        s = np.linspace(0, each.road.length, max(2, round(each.road.length / 0.3)))
        edges = each.profile.edges(s)
        left, right = each.road.at(s, edges.left)[:, :2], each.road.at(s, edges.right)[:, :2]
        ring = np.concatenate((left, right[::-1]))
        inside |= Path(ring).contains_points(points)
    return float(inside.sum() * step**2)


@pytest.mark.parametrize("kind", ["t_junction", "y_junction", "crossroads", "star", "roundabout"])
def test_the_paved_area_is_that_which_a_grid_of_points_counts(kind: str) -> None:
    network = built(design(30.0, {"kind": kind, "take": 1}, 30.0, theta=17.0)).network
    assert network.paved.area == pytest.approx(raster(network, 0.5), rel=0.006)


@pytest.mark.parametrize("radius", [12.0, 18.0, 30.0])
@pytest.mark.parametrize("angles", [(-90, 0, 90), (-108, -36, 36, 108), (-60, 60)])
def test_a_roundabout_has_one_island(radius: float, angles: tuple[float, ...]) -> None:
    arms = [{"angle": angle} for angle in angles]
    network = passing("roundabout", 1, radius=radius, arms=arms).network
    (polygon,) = shapely.get_parts(network.paved)
    holes = sorted((shapely.Polygon(hole) for hole in polygon.interiors), key=lambda each: -each.area)
    assert holes[0].area == pytest.approx(math.pi * radius**2, rel=1e-3)
    x, y, _ = network.roundabouts[0].centre
    assert holes[0].centroid.distance(shapely.Point(x, y)) < 0.01
    contacts = [pose(network, each.arms[0].end, inwards=True) for each in network.junctions]
    for other in holes[1:]:  # islands that separate the two lanes of an arm
        assert min(other.distance(shapely.Point(*each[:2])) for each in contacts) < 8.0
        assert other.area < 60


def test_the_paved_area_is_in_one_piece() -> None:
    for seed in SEEDS:
        assert len(shapely.get_parts(drawn(seed).network.paved)) == 1
