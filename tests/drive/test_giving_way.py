"""Drivers on routes among others who react to nobody: before whom they wait, what signs they see, and which
speed limits they keep."""

from dataclasses import replace
from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from drive.test_keeping_distance import Watched
from roadgpt.drive import Command, Drive, View, simulate
from roadgpt.drive.drivers.reference import Reference
from roadgpt.drive.driving_line import line_along, stations
from roadgpt.drive.giving_way import GivingWay
from roadgpt.drive.view import Other
from roadgpt.network import Route, is_route
from roadgpt.network.lanes import lanes_of
from roadgpt.network.line import driven_line
from roadgpt.network.network import Leg
from roadgpt.road import Limits, World
from roadgpt.run import Setup, perform
from roadgpt.traffic import Tracks
from roadgpt.verdict import judge
from staged import Motion, straight
from staged import tracks as level
from verdict.test_among_others import slower

LIMIT, FRONT = 40 / 3.6, 2.25


@cache
def planned(plan: str) -> tuple[Route, World]:
    run = perform(plan, 1, World(limits=Limits(speed_limit=LIMIT)), Setup(reader="plan", drives=False))
    assert is_route(run.road), run.description
    return run.road, run.world


def through(route: Route, world: World, turn: str) -> tuple[Leg, ...]:
    """The lanes of somebody who crosses straight on, from the left or the right."""
    lanes, (way,) = lanes_of(route.network), route.passages
    own = route.heading(way.start)
    for lane in lanes:
        if lane.member.junction is not None and abs(lane.turn) < 0.1:
            across = np.sin(lane.heading(0.0) - own)
            if (across < -0.9 and turn == "left") or (across > 0.9 and turn == "right"):
                return lane.predecessors[0], lane.id, lane.successors[0]
    raise AssertionError(turn)


def motion(route: Route, world: World, legs: tuple[Leg, ...], place: Any) -> Motion:
    """Along lanes; ``place`` is of times to metres from the start of the lane through the junction."""
    road = Route.along(route.network, legs)
    way = driven_line(road, world)
    begins = float(np.interp(road.starts[1], way.road_stations, way.stations))

    def moves(time: Any) -> Any:
        s = np.clip(begins + place(time), 0.0, way.length)
        return tuple(np.interp(s, way.stations, way.points[:, n]) for n in (0, 1, 3))

    return moves


def tracks(route: Route, duration: float, **motions: Any) -> Tracks:
    """Others at the height of the route beside them."""
    made = level(duration, **motions)
    s, _ = route.locate(*np.moveaxis(made.states[..., :2], -1, 0))
    made.states[..., 2] = np.round(route.at(s)[..., 2], 3)
    return made


def entered(drive: Drive, route: Route) -> float:
    """When the front of the car comes into the junction."""
    return float(np.interp(route.passages[0].start, drive["s"] + FRONT, drive["time"]))


CROSS = "straight 120 // crossroads straight {} // straight 80"


@pytest.mark.parametrize(
    ("driver", "turn", "control"),
    [
        ("reference", "left", "yield"),
        ("reference", "right", "stop"),
        ("beamng_like", "left", "stop"),
        ("lane_centring", "right", "stop"),
        ("pure_pursuit", "left", "yield"),
    ],
)
def test_the_car_waits_for_those_with_priority_and_goes_on(driver: str, turn: str, control: str) -> None:
    route, world = planned(CROSS.format(control))
    legs = through(route, world, turn)
    # one every 2.2 s at 10 m/s until 22 s: at most 1.7 s from bumper to bumper
    row = {
        f"car_{n}": ("car", motion(route, world, legs, lambda time, n=n: 10 * (time - 2.2 * n)))
        for n in range(1, 11)
    }
    drive = simulate(route, world, driver, replay=tracks(route, 40.0, **row))
    assert drive.ended == "goal"
    assert judge(route, drive, world).counts.keys() <= {"off road"}
    # the last one has left the place where the ways meet, in the middle of the junction
    assert entered(drive, route) > 22.0 - 1.0
    assert entered(drive, route) < 22.0 + 8.0


class Winks(Reference):
    """Sees only the nearest one in two of every three seconds."""

    time = 0.0

    def steer(self, view: View) -> Command:
        self.time += view.dt
        return super().steer(view if self.time % 3.0 < 1.0 else view._replace(others=view.others[:1]))


def test_who_is_hidden_for_a_moment_is_not_forgotten() -> None:
    route, world = planned(CROSS.format("yield"))
    legs = through(route, world, "left")
    x, y, _ = route.at(110.0, 12.0)
    stands, comes = straight(x, y, 0, 0), motion(route, world, legs, lambda time: 3.0 * time - 36.0)
    for row in ({}, {"car_1": ("car", comes)}):
        drive = simulate(route, world, Winks(), replay=tracks(route, 40.0, car_0=("car", stands), **row))
        assert drive.ended == "goal"
        assert (entered(drive, route) > 18.0) is bool(row)
    assert judge(route, drive, world).kept


@pytest.mark.parametrize(("speed", "waits"), [(0.0, 2.0), (1.0, 30.0)])
def test_who_is_beside_a_car_that_changes_lanes_does_not_keep_it_for_ever(speed: float, waits: float) -> None:
    route, world = planned("| lanes=2 oneway len=300 // lane_change left")
    giving_way = GivingWay(route, world, line_along(route, world.profile_of(route).middle(stations(route))))
    ((begin, end, offset),) = giving_way._changes
    x, y, _ = route.at((begin + end) / 2 - 1.0, offset)
    other = Other("car", x, y, float(route.heading(begin)), speed, 4.7, 1.8)
    view: Any = SimpleNamespace(
        speed=0.0, s=(begin + end) / 2, t=offset - 2, dt=0.1, road=route, others=[other]
    )
    goes = [giving_way.behind(view) >= 0.0 for _ in range(600)]
    first = goes.index(True)
    assert 0.1 * first == pytest.approx(waits, abs=0.2)
    assert all(goes[first:])


@pytest.mark.parametrize("driver", ["reference", "lane_centring"])
def test_nobody_waits_for_who_gives_way_or_stands(driver: str) -> None:
    far = {"car_0": ("car", straight(-400, -400, 0, 0))}
    for control, most in (("priority", 0.1), ("yield", 9.0)):
        route, world = planned(CROSS.format(control))
        stands = {
            f"car_{turn}": (
                "car",
                motion(route, world, through(route, world, turn), lambda time: -4.0 + 0 * time),
            )
            for turn in ("left", "right")
        }
        alone = entered(simulate(route, world, driver, replay=tracks(route, 30.0, **far)), route)
        among = simulate(route, world, driver, replay=tracks(route, 30.0, **stands))
        assert among.ended == "goal"
        assert entered(among, route) - alone < most, control
        assert (entered(among, route) - alone > 0.5) is (control == "yield")


def test_emergency_braking_is_not_for_who_is_ahead_of_a_turning_car_and_beside_its_way() -> None:
    route, world = planned("straight 120 // crossroads right priority // straight 80")
    world = world.changed(scene="ego robot v=20")
    legs = through(route, world, "right")
    row = {
        f"car_{n}": ("car", motion(route, world, legs, lambda time, n=n: 10 * (time - 1.2 * n)))
        for n in range(1, 25)
    }
    drive = simulate(route, world, "lane_centring", replay=tracks(route, 40.0, **row))
    assert drive.ended == "goal"
    assert drive["speed"].min() > 19.5 / 3.6


@pytest.mark.parametrize("driver", ["reference", "lane_centring"])
def test_the_car_lets_persons_cross_at_a_crosswalk_and_ignores_who_stands_or_walks_by(driver: str) -> None:
    route, world = planned("straight 120 // crossroads straight priority crosswalk // straight 80")
    (way,) = route.passages
    far = tracks(route, 30.0, adult=("adult", straight(-400, 0, 0, 0)))
    alone = simulate(route, world, driver, replay=far)
    for begin in (way.start - 4.0, way.end + 1.0):

        def walks(t: float, speed: float, at: float, along: float = 0.0, begin: float = begin) -> Motion:
            def moves(time: Any) -> Any:
                gone = speed * np.maximum(time - at, 0)
                s = begin + 1.5 + along * gone
                x, y, _ = route.at(s, t + (1 - along) * gone).T
                turn = 0.0 if along else np.pi / 2 * np.sign(speed or 1)
                return x, y, route.heading(s) + turn

            return moves

        still, by = walks(6.0, 0.0, 0.0), walks(-5.0, 1.4, 0.0, 1.0)
        both = tracks(route, 30.0, adult_1=("adult", still), adult_2=("adult", by))
        drive = simulate(route, world, driver, replay=both)
        assert drive["speed"].tolist() == alone["speed"].tolist()
        # from the left edge of the road, 4 m away; the middle of the car's lane is 2 m to the right
        reaches = float(np.interp(begin, alone["s"] + FRONT, alone["time"]))
        slowly = tracks(route, 60.0, adult=("adult", walks(4.3, -0.8, reaches - 3.0)))
        drive = simulate(route, world, driver, replay=slowly)
        assert drive.ended == "goal"
        passes = float(np.interp(begin, drive["s"] + FRONT, drive["time"]))
        assert passes > reaches - 3.0 + (4.3 + 2.0 + 0.93) / 0.8 - 1.0
        stood = drive["s"][drive["speed"] < 0.5] + FRONT
        assert begin - 3.0 < stood.max() < begin


def test_signs_are_seen_where_they_stand() -> None:
    route, world = planned(
        "straight 120 // crossroads straight stop // straight 150 // t_junction left yield // straight 80"
    )
    stop, give = route.passages
    last = route.legs[-1].road
    slow = [
        replace(each, road=each.road.with_profile(slower(each.profile))) if each.id == last else each
        for each in route.network.roads
    ]
    route = Route.along(replace(route.network, roads=tuple(slow)), route.legs).on_ground()
    for driver in ("reference", "lane_centring", "pure_pursuit", "beamng_like"):
        watched = Watched(driver)
        drive = simulate(route, world, watched)
        views: list[View] = watched.views
        for view in views[:: len(views) // 40]:
            told = [("speed limit", 0.0, LIMIT)] if view.s < route.starts[-2] else []
            told += [("stop", stop.start - 0.5 - view.s, None), ("yield", give.start - 0.5 - view.s, None)]
            told += [("speed limit", max(route.starts[-2] - view.s, 0.0), 5.0)]
            told = [each for each in told if each[1] > 0 or each[0] == "speed limit"]
            assert [each.kind for each in view.signs] == [each[0] for each in told]
            np.testing.assert_allclose(
                [each.distance for each in view.signs], [each[1] for each in told], atol=0.01
            )
            assert [each.limit for each in view.signs] == pytest.approx([each[2] for each in told])
        there = drive["s"] > route.starts[-2] + 5.0
        assert drive["speed"][there].max() < 5.25
        assert drive["speed"][~there].max() > 0.9 * LIMIT
