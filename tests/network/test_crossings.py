"""Bridges and tunnels: where they lie along a road or a route, the ground around them, and their solid parts.

The second opinion is geometry by hand: rays through triangles, and offsets from the centre line."""

from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from scipy.ndimage import label

from grids import diagonal, pairs
from network.random_designs import random_design
from roadgpt.geometry import GradeProfile, Piece, PieceCurve
from roadgpt.geometry.curve import Array
from roadgpt.ground.files import named
from roadgpt.ground.mesh import mesh_of
from roadgpt.ground.relief import Relief
from roadgpt.network import Continuation, Leg, Network, NetworkRoad, RoadEnd, Route, build_route, network_of
from roadgpt.network.landscape import MARGIN, SHORTEST, Crossing, crossings, ground_around
from roadgpt.network.structures import solids
from roadgpt.road import Design, Profile, Road, Segment, World, build, read_design

RIM = 7.0  # m from the centre line: a lane of 4 m and a shoulder of 3 m
BRIDGES = ("river across", "valley across; bridge len=60", "bridge x2", "lake across; bridge len=90")
TUNNELS = ("ridge through; tunnel len=70", "tunnel", "bridge; tunnel len=50")
ALIKE = (*BRIDGES, *TUNNELS[:2], "bridge x2; tunnel x2")
ROADS = {
    "straight": ((300, 0, 0),),
    "uphill": ((320, 0, 6),),
    "curved": ((80, 0, 3), (150, 70, 4), (100, 0, -5)),
}


@cache
def road(name: str) -> Road:
    """A road of these segments, with their lengths, their angles to the left, and their grades in percent."""
    parts = tuple(
        Segment(distance=a, direction="left" if b else "straight", turn_degrees=b, incline=c)
        for a, b, c in ROADS[name]
    )
    return build(Design(starting_point=(500, 500, 20), theta=20, segments=parts))


@cache
def world(scene: str, ground: str = "") -> World:
    return World().changed(scene=scene, map_size=2000, ground=ground)


@cache
def route(seed: int) -> Route:
    return build_route(read_design(random_design(seed))[0], world("")).on_ground()


def crossed(start: Array, end: Array, triangles: Array) -> Array:
    """The distances in metres from the start of a segment at which it crosses triangles ``(n, 3, 3)``, in
    ascending order: the point is start + u (end - start) and also a + v (b - a) + w (c - a)."""
    a, b, c = triangles.swapaxes(0, 1)
    sides = np.stack([np.broadcast_to(start - end, a.shape), b - a, c - a], axis=2)
    is_flat = np.abs(np.linalg.det(sides)) < 1e-9
    sides[is_flat] = np.eye(3)
    u, v, w = np.linalg.solve(sides, (start - a)[..., None])[..., 0].T
    hits = ~is_flat & (v >= 0) & (w >= 0) & (v + w <= 1) & (u >= 0) & (u <= 1)
    return np.sort(u[hits]) * np.linalg.norm(end - start)


def point(of: Road, s: float, t: float = 0.0, up: float = 0.0) -> Array:
    return of.at(np.array([s]), t)[0] + [0.0, 0.0, up]


def above(of: Road, on: World, s: Array | float, t: float = 0.0) -> Array:
    """By how many metres the ground is higher than the road."""
    points = of.at(np.atleast_1d(s), t)
    return ground_around(of, on).height(*points[:, :2].T) - points[:, 2]


def assert_apart(found: tuple[Crossing, ...], breaks: tuple[float, ...]) -> None:
    """They follow each other, and none is near the places where roads begin and end."""
    for one, two in pairwise(found):
        assert one.end < two.start
    for each in found:
        assert each.end - each.start >= SHORTEST - 1e-9
        assert not [at for at in breaks if each.start - MARGIN + 1e-6 < at < each.end + MARGIN - 1e-6]
        assert breaks[0] < each.start < breaks[-1]


@pytest.mark.parametrize("name", ROADS)
@pytest.mark.parametrize(
    ("scene", "expected"),
    [
        ("valley across; bridge len=60", [("bridge", 60)]),
        ("ridge through; tunnel len=70", [("tunnel", 70)]),
        ("bridge x2 len=40", [("bridge", 40)] * 2),
        ("river across; bridge len=45; tunnel len=55", [("bridge", 45), ("tunnel", 55)]),
        ("tunnel len=20; bridge len=30; tunnel len=25", [("tunnel", 20), ("bridge", 30), ("tunnel", 25)]),
        ("valley along; lake left; ridge across; forest through", []),
    ],
)
def test_they_are_as_long_as_asked_for_and_in_order(
    name: str, scene: str, expected: list[tuple[str, float]]
) -> None:
    found = crossings(road(name), world(scene))
    assert [each.kind for each in found] == [kind for kind, _ in expected]
    assert [each.end - each.start for each in found] == pytest.approx([long for _, long in expected])
    assert_apart(found, (0.0, road(name).length))


@pytest.mark.parametrize("length", [24.0, 40.0, 60.0, 100.0])
@pytest.mark.parametrize("scene", ["river across", "bridge x2; tunnel x2", "tunnel len=200"])
def test_where_there_is_less_room_they_are_shorter_or_not_there(scene: str, length: float) -> None:
    short = Road(PieceCurve(0.0, 0.0, 0.0, (Piece(length),)), GradeProfile.level(length, 0.0))
    found = crossings(short, world(scene))
    assert_apart(found, (0.0, length))
    assert found or length < SHORTEST + 2 * MARGIN or "x2" in scene  # where each has a small share
    assert all(each.end - each.start <= length - 2 * MARGIN + 1e-9 for each in found)
    if not found:
        s = np.linspace(0.5, length - 0.5, 20)
        assert above(short, world(scene), s) == pytest.approx(np.zeros(20), abs=0.01)


@pytest.mark.parametrize("kind", ["bridge", "tunnel"])
def test_one_that_is_asked_for_shorter_than_any_is_as_long_as_the_shortest(kind: str) -> None:
    (found,) = crossings(road("straight"), world(f"{kind} len=3"))
    assert (found.kind, found.end - found.start) == (kind, pytest.approx(SHORTEST))


@pytest.mark.parametrize("name", ROADS)
@pytest.mark.parametrize("side", ["left", "right"])
def test_a_river_beside_a_road_comes_from_one_border_and_goes_to_another(name: str, side: str) -> None:
    ground = ground_around(road(name), world(f"river {side}"))
    x, y = (each.ravel() for each in np.meshgrid(ground.x, ground.y))
    wet = ~np.isnan(ground.water(x, y)).reshape(ground.heights.shape)
    parts, _ = label(wet)
    border = np.concatenate([parts[0], parts[1:, -1], parts[-1, -2::-1], parts[-2:0:-1, 0]])
    into = np.flatnonzero((border > 0) & (np.roll(border, 1) == 0))
    assert any((border[into] == part).sum() >= 2 for part in set(border[into]))


@pytest.mark.parametrize(
    ("scene", "ground", "name"), pairs((*BRIDGES, *TUNNELS), ("", "flat", "mountain:3"), [*ROADS])
)
def test_there_is_air_under_bridges_and_rock_over_tunnels(name: str, scene: str, ground: str) -> None:
    of, on = road(name), world(scene, ground)
    assert crossings(of, on)
    for kind, start, end in crossings(of, on):
        for t in (-RIM + 0.1, 0.0, RIM - 0.1):
            if kind == "bridge":
                assert above(of, on, (start + end) / 2, t).max() < -3.0
            else:
                assert above(of, on, np.linspace(start + 0.5, end - 0.5, 30), t).min() > 6.0
            assert above(of, on, [start - 0.3, end + 0.3], t) == pytest.approx([0.0, 0.0], abs=0.01)
    if scene == "river across":
        middle = point(of, sum(crossings(of, on)[0][1:]) / 2)
        assert ground_around(of, on).water(*middle[:2, None])[0] < middle[2] - 3.0


@pytest.mark.parametrize("height", [-1.0, 0.0, 3.0])
def test_no_ground_is_above_a_bridge_on_given_land(height: float) -> None:
    """The land is a plane so many metres above the road, which has a bridge by the words."""
    level = np.full((41, 41), 20.0 + height)
    relief = Relief(0.0, 0.0, 50.0, level, np.full_like(level, np.nan), np.empty((0, 3)))
    on = world("bridge len=60").changed(ground=named("x.npy", relief))
    s = np.linspace(1.0, road("straight").length - 1.0, 300)
    assert above(road("straight"), on, s).max() < 0.01


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("scene", [*ALIKE, "bridge; tunnel len=50"])
def test_on_a_route_each_lies_on_one_road_outside_junctions(scene: str, seed: int) -> None:
    found = crossings(route(seed), world(scene))
    assert found
    assert_apart(found, route(seed).ends)


@pytest.mark.parametrize(("seed", "scene"), [(0, "bridge; tunnel"), (1, "bridge x2"), (2, "tunnel")])
def test_the_ground_of_a_route_is_under_its_bridges_and_over_its_tunnels(seed: int, scene: str) -> None:
    of, on = route(seed), world(scene)
    for kind, start, end in crossings(of, on):
        over = above(of, on, (start + end) / 2)[0]
        assert over < -3.0 if kind == "bridge" else over > 6.0
        assert above(of, on, [start - 0.3, end + 0.3]) == pytest.approx([0.0, 0.0], abs=0.02)


def places(of: Route, on: World) -> list[tuple[str, Array, Array]]:
    """The ends of all bridges and tunnels by the stations of the route, and by those of the roads."""
    found, spans = crossings(of, on), ground_around(of, on).pavement.spans
    assert len(found) == len(spans)
    by_route = [of.at(np.array([each.start, each.end]), 0.0)[:, :2] for each in found]
    of_roads = {each.id: each.road for each in of.network.roads}
    by_road = [of_roads[each.road].at(np.array([each.start, each.end]), 0.0)[:, :2] for each in spans]
    nearest = [min(by_road, key=lambda two, one=one: np.hypot(*(two - one).mean(axis=0))) for one in by_route]
    return list(zip((each.kind for each in found), by_route, nearest, strict=True))


@pytest.mark.parametrize("scene", ALIKE)
def test_in_both_directions_they_are_at_the_same_places(scene: str) -> None:
    network = network_of(road("curved"), world(""))
    both = [Route.along(network, [Leg(1, lane)]).on_ground() for lane in (-1, 1)]
    there, back = (places(each, world(scene)) for each in both)
    assert not np.allclose(both[0].at(np.array([0.0]), 0.0), both[1].at(np.array([0.0]), 0.0), atol=50)
    for _, by_route, by_road in there:
        assert by_route == pytest.approx(by_road, abs=1e-6)
    for _, by_route, by_road in back:
        assert by_route == pytest.approx(by_road[::-1], abs=1e-6)
    if "tunnel x2" not in scene:  # in the order of the scene from either end
        for (_, one, _), (_, other, _) in zip(there, back[::-1], strict=True):
            assert one == pytest.approx(other[::-1], abs=1e-6)


def test_they_lie_where_the_car_is_also_where_its_lane_is_shorter_than_the_road() -> None:
    """The line of this route is the middle of its lane, 2 m inside a bend of 40 m, since the reference line
    of the second road begins beside the first one's end."""
    bend = Road(PieceCurve(0.0, 0.0, 0.0, (Piece(200.0, -1 / 40, -1 / 40),)), GradeProfile.level(200.0, 0.0))
    x, y, _ = point(bend, 200.0, 4.0)
    line = PieceCurve(x, y, float(bend.heading(200.0)), (Piece(200.0),))
    after = Road(line, GradeProfile.level(200.0, 0.0), profile=Profile.of(2, 0, 4.0, 3.0))
    joint = Continuation(RoadEnd(1, "end"), RoadEnd(2, "start"), ((-1, -2),))
    members = NetworkRoad(1, bend.with_profile(Profile.of(1, 1, 4.0, 3.0))), NetworkRoad(2, after)
    of = Route.along(Network(members, continuations=(joint,)), [Leg(1, -1), Leg(2, -2)]).on_ground()
    assert of.length == pytest.approx(390.0, abs=0.1)
    for (_, by_route, by_road), aside in zip(places(of, world("bridge x2")), (2.0, 6.0), strict=True):
        assert np.hypot(*(by_route - by_road).T) == pytest.approx([aside, aside], abs=0.5)


@pytest.mark.parametrize("name", ROADS)
def test_parapets_are_one_metre_high_and_nothing_else_is_above_the_deck(name: str) -> None:
    of, on = road(name), world("valley across; bridge len=60")
    ground, (bridge,) = ground_around(of, on), crossings(of, on)
    (triangles,) = solids(network_of(of, on), ground)
    for s in np.linspace(bridge.start + 0.5, bridge.end - 0.5, 13):
        for t in (-RIM + 0.1, RIM - 0.1):
            top = 20.0 - crossed(point(of, s, t, 20.0), point(of, s, t, 0.05), triangles)[0]
            assert top == pytest.approx(1.0, abs=0.02)
        for t in (-RIM + 0.5, 0.0, RIM - 0.5):
            assert not len(crossed(point(of, s, t, 20.0), point(of, s, t, 0.05), triangles))
            assert len(crossed(point(of, s, t), point(of, s, t, -5.0), triangles))  # the underside
    foot = triangles.reshape(-1, 3)[triangles.reshape(-1, 3)[:, 2].argmin()]
    assert 0.0 < ground.height(*foot[:2, None])[0] - foot[2] < 3.0


@pytest.mark.parametrize("name", ROADS)
def test_the_ceiling_of_a_tunnel_is_5_m_above_the_road_and_its_walls_at_the_rims(name: str) -> None:
    of, on = road(name), world("ridge through; tunnel len=70")
    (tunnel,) = crossings(of, on)
    (triangles,) = solids(network_of(of, on), ground_around(of, on))
    for s in np.linspace(tunnel.start + 1.0, tunnel.end - 1.0, 13):
        for t in (-RIM + 0.2, 0.0, RIM - 0.2):
            up = crossed(point(of, s, t, 0.05), point(of, s, t, 30.0), triangles)
            assert up[0] + 0.05 == pytest.approx(5.0, abs=0.02)
        for side in (-1.0, 1.0):
            wall = crossed(point(of, s, 0.0, 2.0), point(of, s, side * 20.0, 2.0), triangles)
            assert wall[0] == pytest.approx(RIM, abs=0.1)


@pytest.mark.parametrize(("name", "scene"), diagonal([*ROADS], TUNNELS))
def test_the_mesh_of_the_ground_leaves_the_mouths_of_tunnels_open(name: str, scene: str) -> None:
    of, on = road(name), world(scene, "hilly:2")
    mesh = mesh_of(ground_around(of, on), to_horizon=False)
    triangles = mesh.points[mesh.triangles]
    (tunnel,) = (each for each in crossings(of, on) if each.kind == "tunnel")
    for at, way in ((tunnel.start, 1.0), (tunnel.end, -1.0)):
        for t in (-3.0, 0.0, 3.0):
            assert not len(crossed(point(of, at - way, t, 1.5), point(of, at + 3 * way, t, 1.5), triangles))
    middle = (tunnel.start + tunnel.end) / 2
    roof = crossed(point(of, middle, 0.0, 1.5), point(of, middle, 0.0, 200.0), triangles)
    assert len(roof) == 1
    assert roof[0] + 1.5 == pytest.approx(above(of, on, middle)[0], abs=1.0)
    ends = point(of, tunnel.start - 1, 0.0, 1.5), point(of, tunnel.end + 1, 0.0, 1.5)
    assert name == "curved" or not len(crossed(*ends, triangles))  # one sees through
