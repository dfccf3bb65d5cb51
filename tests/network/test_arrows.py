"""Arrows before junctions show the ways on that lanes really have, as a walk along the roads finds them."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from network.changing import design
from network.mirrored import in_mirror
from network.random_designs import random_design, random_lanes_design
from roadgpt.network import Network, RoadEnd, Route, build_route
from roadgpt.network.markings import PaintedArrow, arrows
from roadgpt.road import Site, World, read_design

WORLD = World(site=Site(map_size=600))
STOP_LINE = 0.5  # m
ROOM = 10.0 + STOP_LINE + 5.0 + 5.5  # m: to the stop line, its width, an arrow, and room at the other end
CROSSED = 5.0  # m, that a crosswalk and the gap before it take
OTHER = {"left": "right", "right": "left", "straight": "straight"}
Shown = dict[tuple[int, str, int], frozenset[str]]
"""For the id of a road, the end towards which one drives, and the id of a lane: the ways on."""
settled = settings(max_examples=12, deadline=None)
seeds = st.integers(0, 10_000)
DRAWINGS = pytest.mark.parametrize("draw", [random_design, random_lanes_design])
Drawing = Callable[[int], dict[str, Any]]


def network_of(data: dict[str, Any]) -> Network:
    return build_route(read_design(data)[0], WORLD).network


def shown(network: Network) -> Shown:
    found = {(each.end.road, each.end.contact, each.lane): frozenset(each.ways) for each in arrows(network)}
    assert len(found) == len(arrows(network))
    return found


def turn_of(network: Network, road: int) -> float:
    """By how many degrees a connecting road turns, by its own points."""
    line = network.road(road).road.centreline(0.05)[:, :2]
    first, last = line[1] - line[0], line[-1] - line[-2]
    cross, dot = first[0] * last[1] - first[1] * last[0], first @ last
    return math.degrees(math.atan2(cross, dot))


def walked(network: Network) -> Shown:
    """The ways on of every lane that leads to a junction, by a walk along all roads inside junctions."""
    found: dict[tuple[int, str, int], set[str]] = {}
    for road in network.roads:
        if road.junction is None:
            continue
        junction, way = network.connection_of[road.id]
        arm = network.road(way.incoming.road)
        ways_on = {each.road for each in junction.connections if each.incoming == way.incoming}
        turn = turn_of(network, road.id)
        if junction.kind == "roundabout" or (junction.kind in ("merge", "diverge") and len(ways_on) < 2):
            continue
        side = "left" if turn > 25 else "right" if turn < -25 else "straight"
        if junction.kind == "diverge" and abs(turn) > 2:
            side = "left" if turn > 0 else "right"
        lanes = [lane for lane in ids_of(arm.profile) if leads_to(network, way.incoming, lane)]
        others = [lane for lane in ids_of(arm.profile) if lane not in lanes]
        if len(lanes) > 1 or not others:
            for link in way.lanes:
                found.setdefault((*way.incoming, link.incoming), set()).add(side)
    return {key: frozenset(ways) for key, ways in found.items()}


def ids_of(profile: Any) -> list[int]:
    return [*profile.along_ids, *profile.against_ids]


def leads_to(network: Network, end: RoadEnd, lane: int) -> bool:
    """Whether traffic in a lane drives towards an end; with traffic on the right, ids below 0 lead along."""
    is_along = (lane < 0) != network.left_hand
    return is_along == (end.contact == "end")


def has_room(network: Network, key: tuple[int, str, int]) -> bool:
    end = RoadEnd(key[0], "end" if key[1] == "end" else "start")
    return network.road(key[0]).road.length >= ROOM + (CROSSED if is_crossed(network, end) else 0.0)


@DRAWINGS
@given(seed=seeds)
@settled
def test_an_arrow_shows_what_a_walk_through_the_junction_finds(draw: Drawing, seed: int) -> None:
    network = network_of(draw(seed))
    expected = {key: ways for key, ways in walked(network).items() if has_room(network, key)}
    assert shown(network) == expected


def strip_of(network: Network, arrow: PaintedArrow) -> shapely.Polygon:
    """The lane of an arrow, seen from above."""
    road, profile = network.road(arrow.end.road).road, network.road(arrow.end.road).profile
    s = np.arange(0.0, road.length, 0.25)
    left, right = profile.lane_edges(s)
    number, centre = abs(arrow.lane) - 1, profile.centre(s)
    rows = [centre, *left] if arrow.lane > 0 else [centre, *right]
    one, two = (road.at(s, t)[:, :2] for t in rows[number : number + 2])
    return shapely.Polygon(np.concatenate([one, two[::-1]]))


@DRAWINGS
@given(seed=seeds)
@settled
def test_an_arrow_lies_in_its_lane_and_points_to_the_junction(draw: Drawing, seed: int) -> None:
    network = network_of(draw(seed))
    for arrow in arrows(network):
        outline = shapely.Polygon(arrow.points[:, :2])
        assert outline.is_valid
        assert outline.exterior.is_ccw
        assert strip_of(network, arrow).buffer(-0.24).contains(outline)
        triangles = shapely.polygons(arrow.points[arrow.corners][:, :, :2])
        assert sum(each.area for each in triangles) == pytest.approx(outline.area)
        assert all(each.exterior.is_ccw for each in triangles)
        away, aside = as_driven(network, arrow)
        lines = STOP_LINE + (CROSSED if is_crossed(network, arrow.end) else 0.0)
        assert [away.min(), away.max()] == pytest.approx([lines + 10.0, lines + 15.0], abs=0.03)
        foot = aside[away > away.max() - 0.05]
        assert np.ptp(foot) == pytest.approx(0.15, abs=0.01)
        assert (aside.max() - foot.max() > 0.5) == ("left" in arrow.ways)
        assert (foot.min() - aside.min() > 0.5) == ("right" in arrow.ways)


def as_driven(network: Network, arrow: PaintedArrow) -> tuple[np.ndarray, np.ndarray]:
    """How far the points of an arrow are before the end of its road, and how far to the left of a line that
    leads there."""
    line = network.road(arrow.end.road).road.centreline(0.02)[:, :2]
    if arrow.end.contact == "start":
        line = line[::-1]
    behind = np.r_[0.0, np.cumsum(np.hypot(*np.diff(line[::-1], axis=0).T))][::-1]
    nearest = np.argmin(((arrow.points[:, None, :2] - line[None]) ** 2).sum(axis=2), axis=1)
    along = np.gradient(line, axis=0)[nearest]
    off = arrow.points[:, :2] - line[nearest]
    return behind[nearest], (along[:, 0] * off[:, 1] - along[:, 1] * off[:, 0]) / np.hypot(*along.T)


def is_crossed(network: Network, end: RoadEnd) -> bool:
    (arm,) = (arm for junction in network.junctions for arm in junction.arms if arm.end == end)
    return arm.crosswalk


@given(seed=seeds)
@settled
def test_traffic_on_the_left_has_the_arrows_of_the_mirrored_design(seed: int) -> None:
    data = random_lanes_design(seed)
    left, right = network_of({**data, "left_hand": True}), network_of(in_mirror(data))
    assert shown(left) == {
        (road, contact, -lane): frozenset(map(OTHER.__getitem__, ways))
        for (road, contact, lane), ways in shown(right).items()
    }


def crossing(distance: float = 60.0, take: str = "straight", **more: Any) -> Route:
    data = design(distance, {"kind": "crossroads", "take": take, **more}, 60.0)
    data["lanes"] = {"forward": 2, "backward": 2, "width": 3.5}
    return build_route(read_design(data)[0], WORLD)


@pytest.mark.parametrize(
    ("distance", "crosswalk", "count"),
    [(60.0, False, 2), (20.9, False, 0), (21.1, False, 2), (25.9, True, 0), (26.1, True, 2)],
)
def test_a_road_that_is_too_short_has_no_arrows(distance: float, crosswalk: bool, count: int) -> None:
    route = crossing(distance, crosswalk=crosswalk)
    first = route.legs[0].road
    assert len([each for each in arrows(route.network) if each.end.road == first]) == count
