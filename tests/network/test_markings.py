"""What is painted on networks: lines lie where the geometry says, and parts of the surface do not overlap."""

import math
from functools import cache

import numpy as np
import pytest
import shapely
from tests.network.random_designs import random_design

from roadgpt.network import Network, Route, made_from
from roadgpt.network.markings import STOP_LINE, strokes
from roadgpt.network.surface import NetworkSurface, free_ends, triangulated
from roadgpt.road import World, read_design
from roadgpt.road.profile import LINE

STRAIGHT = {"distance": 60, "direction": "straight", "incline": 0, "turn_degrees": 0}


def route_of(junction: dict[str, object], lanes: dict[str, object] | None = None, **world: object) -> Route:
    data = {
        **({} if lanes is None else {"lanes": lanes}),
        "starting_point": [40, 60, 2],
        "theta": 0,
        "road_segment1": STRAIGHT,
        "junction1": {"after": 1, **junction},
        "road_segment2": STRAIGHT,
    }
    found = made_from(read_design(data)[0], World(**world))
    assert isinstance(found, Route)
    return found


def drawn(seed: int) -> Network:
    found = made_from(read_design(random_design(seed))[0], World())
    assert isinstance(found, Route)
    return found.network


@cache
def apart() -> list[Network]:
    """Three networks whose roads do not cover each other: their area is that of their parts."""
    found = []
    for network in map(drawn, range(8)):
        surface = NetworkSurface.of(network)
        parts = sum(each.paved.area for each in surface.areas)
        roads = sum(each.road.length * 2 * each.profile.paved_reach for each in surface.roads)
        if abs(network.paved.area - parts - roads) < 0.02 * network.paved.area:
            found.append(network)
        if len(found) == 3:
            return found
    raise AssertionError(found)


@pytest.fixture(params=range(3))
def network(request: pytest.FixtureRequest) -> Network:
    return apart()[request.param]


def test_lines_between_lanes_end_where_a_junction_begins(network: Network) -> None:
    inside = shapely.union_all([each.paved for each in NetworkSurface.of(network).areas]).buffer(-0.2)
    lanes = [stroke for stroke in strokes(network) if stroke.kind == "lane"]
    assert lanes
    for stroke in lanes:
        assert not shapely.LineString(stroke.points[:, :2]).intersects(inside)


def test_all_paint_lies_on_the_carriageway(network: Network) -> None:
    wide = network.paved.buffer(0.02)
    for stroke in strokes(network):
        line = shapely.LineString(stroke.points[:, :2]).buffer(stroke.width / 2, cap_style="flat")
        assert shapely.difference(line, wide).area < 0.01 * line.area


def test_edge_lines_follow_the_whole_edge_of_the_carriageway(network: Network) -> None:
    edges = [stroke.points[:, :2] for stroke in strokes(network) if stroke.kind == "edge"]
    lines = shapely.union_all([shapely.LineString(points) for points in edges])
    ends = []
    for member in NetworkSurface.of(network).roads:
        for s, is_free in zip((0.0, member.road.length), free_ends(network, member), strict=True):
            if is_free:
                ends.append(shapely.Point(member.road.at(s)[:2]).buffer(member.profile.paved_reach + 0.2))
    edge = shapely.difference(network.paved.boundary, shapely.union_all(ends))
    places = shapely.line_interpolate_point(edge, np.arange(0.0, 1.0, 0.002), normalized=True)
    assert shapely.distance(places, lines).max() < LINE


def test_paint_along_kerbs_lies_beside_the_kerb_to_a_millimetre(network: Network) -> None:
    """Half of a line of 12 cm lies between its middle and the kerb, but for the tips of pointed islands."""
    kerb = network.paved.boundary
    lines = [stroke for stroke in strokes(network) if stroke.kind == "edge" and stroke.road is None]
    assert {stroke.width for stroke in lines} == {0.12}
    away, on_left, on_right = [], [], []
    for stroke in lines:
        middle = shapely.LineString(stroke.points[:, :2])
        places = np.arange(0.005, middle.length - 0.005, 0.5)
        spots, ahead = (shapely.line_interpolate_point(middle, places + step) for step in (0.0, 0.004))
        away.append(shapely.distance(kerb, spots))
        at, way = (
            shapely.get_coordinates(spots),
            shapely.get_coordinates(ahead) - shapely.get_coordinates(spots),
        )
        left = 0.08 * np.column_stack([-way[:, 1], way[:, 0]]) / np.hypot(*way.T)[:, None]
        on_left.append(shapely.contains_xy(network.paved, at + left))
        on_right.append(shapely.contains_xy(network.paved, at - left))
    assert np.concatenate(away).min() > 0.059
    assert (np.concatenate(away) < 0.061).mean() > 0.98
    assert np.concatenate(on_left).all()
    assert np.concatenate(on_right).mean() < 0.05


@pytest.mark.parametrize("radius", [7.0, 16.0, 30.0])
def test_traffic_gives_way_at_the_edge_of_the_ring(radius: float) -> None:
    route = route_of({"kind": "roundabout", "take": "straight", "radius": radius})
    (ring,) = route.network.roundabouts
    blocks = [stroke for stroke in strokes(route.network) if stroke.kind == "give_way"]
    assert len(blocks) >= 4 * 4
    outer = ring.radius + ring.width + STOP_LINE / 2
    for block in blocks:
        away = np.hypot(*(block.points[:, :2] - ring.centre[:2]).T)
        np.testing.assert_allclose(away, outer, atol=0.02)
    # from the west one enters on the south side of the arm, from the others a quarter turn on
    angles = np.arctan2(*(np.array([b.points.mean(axis=0)[:2] for b in blocks]) - ring.centre[:2]).T[::-1])
    quarter = (angles - math.pi) % (math.pi / 2)
    assert quarter.min() > 0.02
    assert quarter.max() < math.pi / 4


def test_the_parts_of_the_surface_cover_the_paved_area_once(network: Network) -> None:
    surface = NetworkSurface.of(network)
    for area in surface.areas:
        points, triangles = triangulated(area.paved)
        a, b, c = (points[triangles[:, k]] for k in range(3))
        sizes = ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]) / 2
        assert sizes.min() > 0
        assert sizes.sum() == pytest.approx(area.paved.area, abs=1e-6)
        assert shapely.intersection(area.shoulder, network.paved).area < 1e-3
        for island in (*area.kerbed, *area.green):
            assert shapely.intersection(island, network.paved).area < 1e-3


@pytest.mark.parametrize("kind", ["crossroads", "roundabout"])
def test_a_crosswalk_leads_over_each_arm_behind_its_stop_line(kind: str) -> None:
    fields = {"kind": kind, "take": "straight", "control": "stop", "crosswalk": True}
    route = route_of(fields)
    network, without = route.network, route_of({**fields, "crosswalk": False}).network
    stripes = [stroke for stroke in strokes(network) if stroke.kind == "crosswalk"]
    assert not [stroke for stroke in strokes(without) if stroke.kind == "crosswalk"]
    lines = [shapely.LineString(stroke.points[:, :2]) for stroke in stripes]
    assert len(lines) == 4 * 8  # arms, each 8 m wide, with a stripe on every metre
    assert all(line.length == pytest.approx(3.0) and network.paved.contains(line) for line in lines)
    outer = [arm for junction in network.junctions for arm in junction.arms if arm.crosswalk]
    assert len(outer) == 4
    for arm in outer:
        road = network.road(arm.end.road).road
        s = road.length if arm.end.contact == "end" else 0.0
        contact = shapely.Point(road.at(s)[:2])
        near = sorted(line.distance(contact) for line in lines)[:2]
        assert near == pytest.approx([math.hypot(1.0, 0.5)] * 2, abs=1e-6)  # half a metre from mid-road
    walked = shapely.union_all(lines).buffer(0.9)
    lanes = {
        each: shapely.union_all([shapely.LineString(x.points) for x in strokes(each) if x.kind == "lane"])
        for each in (network, without)
    }
    assert not lanes[network].intersects(walked)
    assert lanes[without].intersects(walked)
    (stopped,) = (passage.stop_line for passage in route.passages)
    assert stopped is not None
    assert route.passages[0].start - stopped == pytest.approx(1 + 3 + 1 + 0.5)


@pytest.mark.parametrize("kind", ["merge", "diverge"])
def test_the_line_between_the_lanes_of_a_motorway_goes_on_beside_a_ramp(kind: str) -> None:
    route = route_of({"kind": kind, "take": "main", "length": 60}, lanes={"forward": 2, "backward": 0})
    lanes = [x.points[:, :2] for x in strokes(route.network) if x.kind == "lane"]
    painted = shapely.union_all(
        [shapely.LineString(points).buffer(0.02, cap_style="flat") for points in lanes]
    )
    (passage,) = route.passages
    s = np.arange(passage.start, passage.end, 0.05)
    between = shapely.points(route.at(s, route.profile.lane(s)[0])[:, :2])
    assert shapely.contains(painted, between).mean() == pytest.approx(4 / 12, abs=0.08)


@pytest.mark.parametrize("radius", [7.0, 16.0])
def test_a_roundabout_has_grass_in_its_middle_and_kerbs_at_its_arms(radius: float) -> None:
    route = route_of({"kind": "roundabout", "take": "straight", "radius": radius})
    (area,) = NetworkSurface.of(route.network).areas
    (green,) = area.green
    assert green.centroid.distance(shapely.Point(route.network.roundabouts[0].centre[:2])) < 0.1
    assert green.area == pytest.approx(math.pi * (radius - 3) ** 2, rel=0.02)
    # at a mini roundabout they would be smaller than 1 m^2, and are paved instead
    assert len(area.kerbed) == (4 if radius > 10 else 0)


DIVIDED = {"forward": 2, "backward": 2, "width": 3.5, "divided": True}


@pytest.mark.parametrize("left_hand", [False, True])
def test_a_median_ends_with_a_kerb_in_the_junction(left_hand: bool) -> None:
    junction = {"after": 1, "kind": "crossroads", "take": "straight"}
    data = {"starting_point": [40, 60, 2], "theta": 0, "lanes": DIVIDED, "road_segment1": STRAIGHT,
            "junction1": junction, "road_segment2": STRAIGHT}  # fmt: skip
    route = made_from(read_design(data | ({"left_hand": True} if left_hand else {}))[0], World())
    assert isinstance(route, Route)
    (area,) = NetworkSurface.of(route.network).areas
    for leg, is_end in ((route.legs[0], True), (route.legs[-1], False)):
        member = route.network.road(leg.road)
        s = member.road.length if is_end else 0.0
        edges = member.profile.edges_of(-member.profile.side, s)
        end = shapely.LineString(member.road.at(np.full(2, s), np.ravel(edges))[:, :2])
        assert end.length == pytest.approx(2.0)
        (nose,) = (island for island in area.kerbed if island.dwithin(end, 1e-3))
        assert end.buffer(1e-3).intersection(nose.boundary).length == pytest.approx(2.0, abs=0.01)
        assert nose.intersection(area.shoulder).area < 1e-3
        assert nose.area > 2.0
