"""``s``, ``t`` and ``lane`` of the others that drivers see, against polygons and lines of shapely."""

import math
from typing import Any

import numpy as np
import pytest
import shapely

from roadgpt.brief.plan import read_plan
from roadgpt.drive import Command, View, simulate
from roadgpt.drive.drivers.reference import Reference
from roadgpt.network import legs_of, network_of
from roadgpt.network.lanes import lanes_of
from roadgpt.network.network import Leg
from roadgpt.road import Road, World
from roadgpt.run import Setup, perform

NEAR = 0.1  # m, to an edge of a lane, within which both sides are right
PLANS = [
    "straight 250 && ego v=50; car ahead gap=30 v=40; car oncoming v=40; car beside right gap=40; "
    "van behind gap=20 v=50",
    "| lanes=2 len=200 // lane_change left // straight 100 && light",
    "| lanes=2 against=2 // crossroads left lights || left_hand && medium",
    "turn left 90 r30; straight 40 // roundabout exit=2 // turn right && medium",
]  # fmt: skip


def seen_in(words: str) -> tuple[Road, World, list[View]]:
    """A road, its world, and what a driver sees every half a second."""
    run = perform(read_plan(words), 5, setup=Setup(reader="plan", drives=False))
    assert run.road is not None, run.description
    views = list[View]()

    class Watcher(Reference):
        def steer(self, view: View) -> Command:
            if round(view.time / view.dt) % 23 == 0:  # also between the samples of the others
                views.append(view)
            return super().steer(view)

    simulate(run.road, run.world.changed(), Watcher, run.seed)
    return run.road, run.world, views[:40]


@pytest.mark.parametrize("words", PLANS)
def test_others_are_where_geometry_has_them(words: str) -> None:
    road, world, views = seen_in(words)
    network, legs = network_of(road, world), legs_of(road, world)
    lanes, line = lanes_of(network), shapely.LineString(road.at(np.arange(0.0, road.length, 0.05))[:, :2])
    asked = 0
    for each in [one for view in views for one in view.others]:
        at = shapely.Point(each.x, each.y)
        if not 1.0 < each.s < road.length - 1.0 or line.distance(at) > 25.0:
            continue  # before and behind the road and far beside it, the nearest place says little
        assert abs(abs(each.t) - line.distance(at)) < 0.05
        assert math.dist(road.at(each.s, each.t)[:2], (each.x, each.y)) < 0.1
        leg = legs[int(np.searchsorted(road.starts[1:-1], each.s))]
        number = _counted(each, road, network.road(leg.road), lanes, leg, at)
        if number is not ...:
            assert each.lane == number, each
            asked += 1
    assert asked > 20


def _counted(each: Any, road: Road, member: Any, lanes: Any, leg: Any, at: shapely.Point) -> Any:
    """The lane, by how many lanes' polygons lie between the place and the middle of the lane of the leg; the
    ellipsis where it is near an edge."""
    ids = (*member.profile.along_ids, *member.profile.against_ids)
    areas = {lane: lanes[Leg(leg.road, lane)].area for lane in ids}
    if min(area.boundary.distance(at) for area in areas.values()) < NEAR:
        return ...
    if not any(area.contains(at) for area in areas.values()):
        return None
    if areas[leg.lane].contains(at):
        return 0
    straight = shapely.shortest_line(at, _middle_of(road, areas[leg.lane], each.s))
    between = sum(area.intersection(straight).length > 1e-3 for area in areas.values())
    (x, y), (x_2, y_2) = (point[:2] for point in straight.coords)
    heading = float(road.heading(each.s))
    is_left = math.cos(heading) * (y - y_2) > math.sin(heading) * (x - x_2)
    return (between - 1) * (1 if is_left else -1)


def _middle_of(road: Road, area: shapely.Polygon, s: float) -> shapely.LineString:
    """The middle of a lane's polygon around a station, by rays across it."""
    points = []
    for place in np.linspace(max(s - 2.0, 0.0), min(s + 2.0, road.length), 5):
        ray = area.intersection(shapely.LineString(road.at([place, place], [20.0, -20.0])[:, :2]))
        points += (
            [ray.interpolate(0.5, normalized=True)] if ray.geom_type == "LineString" and ray.length else []
        )
    return shapely.LineString(points)


def test_the_scene_says_who_is_in_which_lane() -> None:
    _, _, views = seen_in(PLANS[0])
    first = {(each.kind, each.lane) for view in views for each in view.others}
    assert first >= {("car", 0), ("van", 0), ("car", 1), ("car", None)}
    ahead = next(each for each in views[0].others if each.kind == "car" and each.lane == 0)
    view = views[0]
    gap = ahead.s - ahead.length / 2 - view.s - (4.7 / 2 - 0.1)
    assert gap == pytest.approx(30.0, abs=0.5)
    assert ahead.t == pytest.approx(view.t, abs=0.3)
