"""Where a car on a route has ground: exactly on the paved area and its shoulder. Shapely gives the second
opinion, point by point."""

import numpy as np
import pytest
import shapely

from network.random_designs import random_design
from roadgpt.drive import Command, View, simulate
from roadgpt.drive.sampled_road import locate_on, room_at, sample_road, stations_of
from roadgpt.network import Route, build_route
from roadgpt.network.route import windows
from roadgpt.road import CrossSection, World, read_design

WORLD = World(section=CrossSection(shoulder=1.5))
NEAR = 25.0  # m from the reference line
STEP = 0.5  # m between the stations of the edges; between two of them an edge may jump
FOLD = 0.25  # of the metres of path per metre of road: nearer to the next fold, stations cannot be told apart


def paved_with_shoulder(route: Route) -> shapely.Geometry:
    return route.network.paved.buffer(1.5, quad_segs=8)


def on_ground(route: Route, area: shapely.Geometry, s: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Whether the whole way from the reference line to each point is ground."""
    ends = np.stack([route.plan.at(s), route.at(s, t)[:, :2]], axis=1)
    found: np.ndarray = shapely.covers(area, shapely.linestrings(ends))
    return found


@pytest.mark.parametrize("seed", range(6))
def test_a_wheel_has_ground_exactly_where_the_polygon_is(seed: int) -> None:
    route = build_route(read_design(random_design(seed))[0], WORLD).on_ground()
    area, sampled = paved_with_shoulder(route), sample_road(route)
    shapely.prepare(area)
    rims = np.column_stack(WORLD.profile_of(route).rims(stations_of(sampled)))
    rng = np.random.default_rng(seed)
    low, high = np.array(windows(route.passages, route.length)).T
    at = rng.integers(len(low), size=2000)
    s, t = rng.uniform(low[at], high[at]), rng.uniform(-NEAR, NEAR, 2000)
    s, t = (each[1 - route.curvature(s) * t > FOLD] for each in (s, t))
    xy = route.at(s, t)[:, :2]
    wanted = on_ground(route, area, s, t)
    given = np.zeros(len(s), bool)
    for i, (x, y) in enumerate(xy):
        found = locate_on(sampled.table, sampled.first, sampled.step, x, y, s[i])
        assert found[:2] == pytest.approx((s[i], t[i]), abs=0.05)
        given[i] = room_at(rims, sampled.first, sampled.step, found[0], found[1]) >= 0
    edge = shapely.distance(area.boundary, shapely.points(xy))
    around = [on_ground(route, area, np.clip(s + d, 0, route.length), t) for d in (-STEP, STEP)]
    jumps = (around[0] != wanted) | (around[1] != wanted)
    wrong = (given != wanted) & (edge > 0.05)
    assert not (wrong & ~jumps).any()
    assert wrong.mean() < 0.01
    assert 0.1 < wanted.mean() < 0.9  # the points say something


class GoesStraight:
    """Drives straight on at 8 m/s, whatever the route does."""

    def steer(self, view: View) -> Command:
        return Command(0.0, 0.3 if view.speed < 8 else 0.0, 0.0)


def test_a_car_that_misses_the_turn_falls_behind_the_edge_and_not_before() -> None:
    design = {
        "starting_point": [0, 0, 0],
        "theta": 0,
        "road_segment1": {"distance": 50, "direction": "straight", "incline": 0, "turn_degrees": 0},
        "junction1": {"after": 1, "kind": "t_junction", "take": "left", "kerb": 8},
        "road_segment2": {"distance": 50, "direction": "straight", "incline": 0, "turn_degrees": 0},
    }
    route = build_route(read_design(design)[0], WORLD).on_ground()
    drive = simulate(route, WORLD, GoesStraight(), keep_driving=True)
    assert drive.ended == "fell"
    area = paved_with_shoulder(route)
    front = shapely.points(drive["x"] + 1.36, drive["y"])  # the front axle
    is_on = shapely.contains(area, front)
    height = drive["z"] - drive["z"][0]
    assert np.abs(height[is_on]).max() < 0.1  # level as long as it is on the ground
    last = int(np.flatnonzero(is_on)[-1])
    # it crossed the whole road behind the T: contact, 4 m to the node and beyond, shoulder
    assert drive["x"][last] + 1.36 == pytest.approx(area.bounds[2], abs=0.2)
    assert height[-1] < -1.0
