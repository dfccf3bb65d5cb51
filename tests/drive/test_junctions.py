"""How drivers drive through junctions, and what they see of them. Numbers are worked out on paper."""

import math
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from roadgpt import plugins
from roadgpt.brief.plan import read_plan
from roadgpt.design import draft
from roadgpt.design.room import world_for
from roadgpt.drive import Drive, JunctionAhead, simulate
from roadgpt.drive.driving_line import highest_speeds, kept_in_lane, line_along, stations, turning_speed
from roadgpt.drive.outlook import Outlook
from roadgpt.network import Route, build_route, made_from
from roadgpt.road import Limits, Road, World, read_design
from roadgpt.verdict import judge

WORLD = World(limits=Limits(speed_limit=50 / 3.6))
DRIVERS = ("beamng_like", "lane_centring", "pure_pursuit", "reference")


def route(*junctions: dict[str, Any], world: World = WORLD, length: float = 60.0) -> Route:
    """A route with 60 m (or ``length``) of straight road before, between and behind its junctions."""
    data: dict[str, Any] = {"starting_point": [0, 0, 0], "theta": 0}
    turns_back = junctions[-1]["take"] == 4  # on the road of arrival, which has no segments of its own
    for n in range(len(junctions) + (not turns_back)):
        data[f"road_segment{n + 1}"] = {
            "distance": length, "direction": "straight", "incline": 0, "turn_degrees": 0
        }  # fmt: skip
        if n < len(junctions):
            data[f"junction{n + 1}"] = {"after": n + 1, **junctions[n]}
    return build_route(read_design(data)[0], world).on_ground()


CROSS = {"kind": "crossroads", "take": "left", "control": "stop", "kerb": 8}
ROUND = {"kind": "roundabout", "take": 3, "radius": 16}


def test_people_turn_at_the_speeds_of_the_published_equation() -> None:
    # NCHRP 672, equation 6-2 in its own units: V = 3.4614 R^0.3673, mph and feet
    for feet in (30.0, 50.0, 100.0, 200.0):
        mph = 3.4614 * feet**0.3673
        assert turning_speed(-1 / (feet * 0.3048)) == pytest.approx(mph * 0.44704, rel=1e-3)
    assert turning_speed(0.0) == turning_speed(1 / 300) == math.inf


def test_a_driver_sees_the_junctions_that_are_still_ahead() -> None:
    way = route(CROSS, ROUND)
    outlook = Outlook(way, WORLD)
    seen, (first, second), left, right = outlook.at(12.5)
    assert seen is way
    assert isinstance(first, JunctionAhead)
    assert first.distance == pytest.approx(47.5)
    assert (first.kind, first.exit, first.control) == ("crossroads", 3, "stop")
    assert first.turn == pytest.approx(math.pi / 2)
    # a quarter of an arc with clothoids: shorter than the way around the corner, longer than straight across
    reach = math.dist(way.plan.at(60.0), way.plan.at(60.0 + first.length))
    assert reach < first.length < reach * math.sqrt(2)
    assert (second.kind, second.exit, second.control) == ("roundabout", 3, "yield")
    assert second.turn == pytest.approx(math.pi / 2)  # the third of four arms lies to the left
    assert second.distance == pytest.approx(47.5 + first.length + 60)
    assert (left, right) == (1, 0)

    inside = outlook.at(61.0)
    assert inside[1][0].distance == 0.0
    assert inside[1][0].length == pytest.approx(first.length - 1.0)
    assert inside[2:] == (0, 0)
    assert len(outlook.at(60.0 + first.length + 0.01)[1]) == 1
    assert outlook.at(way.length)[1] == ()


FILE = """
from roadgpt.drive import Command
class Old:
    def steer(self, view):
        if view.route is None or len(view.junctions) != 1 or view.junctions[0].kind != "crossroads":
            raise ValueError("saw nothing")
        return Command(0.0, 0.3, 0.0)
"""


def test_a_driver_in_its_own_process_sees_them_too(tmp_path: Path) -> None:
    (tmp_path / "old.py").write_text(FILE, encoding="utf-8")
    drive = simulate(route(CROSS), WORLD, f"{tmp_path / 'old.py'}:Old")
    assert drive.ended == "out_of_lane"  # it went straight on


def slowest_near(drive: Drive, station: float, reach: float) -> float:
    front = drive["s"] + drive.car.ahead + drive.car.length / 2
    near = (front > station - reach) & (front < station)
    return float(drive["speed"][near].min())


@pytest.mark.parametrize(
    ("name", "length"), [("beamng_like", 47.3), ("reference", 50.0), ("reference", 52.65)]
)
def test_they_stop_wherever_the_line_is(name: str, length: float) -> None:
    way = route(CROSS, length=length)
    drive = simulate(way, WORLD, name)
    assert slowest_near(drive, length - 0.5, 4.0) < 0.1
    assert judge(way, drive, WORLD).incidents == ()


@pytest.mark.parametrize(
    ("name", "friction"), [*((name, 1.0) for name in DRIVERS), ("beamng_like", 0.6), ("reference", 0.6)]
)
def test_all_drivers_stop_at_the_sign_and_turn_as_people_do(name: str, friction: float) -> None:
    world = WORLD.changed(friction=friction)
    way = route(CROSS, ROUND, world=world)
    drive = simulate(way, world, name)
    verdict = judge(way, drive, world)
    assert verdict.kept, verdict.description
    assert slowest_near(drive, 59.5, 4.0) < 0.1  # before the line, which is 0.5 m wide
    assert verdict.incidents == ()
    inside = np.zeros(len(drive), bool)
    for each in Outlook(way, world).at(0.0)[1]:
        inside |= (drive["s"] > each.distance) & (drive["s"] < each.distance + each.length)
    lateral = np.abs(drive["speed"] * drive["yaw_rate"])[inside]
    assert 1.5 < lateral.max() < 5.0  # people accept 3 m/s^2 here, and drivers follow their plan with errors
    assert drive.max_outside < (0.25 if name == "beamng_like" else 0.05)


def test_only_a_stop_sign_stops_them() -> None:
    for control in ("none", "yield", "priority", "lights"):
        drive = simulate(route({**CROSS, "control": control}), WORLD, "reference")
        assert slowest_near(drive, 60.0, 4.0) > 3.0


def test_lines_in_junctions_keep_one_and_a_half_metres_from_the_edges() -> None:
    way = route({"kind": "crossroads", "take": "left"})
    s = np.linspace(0, way.length, 400)
    profile = WORLD.profile_of(way)
    line = profile.middle(s) + 3.0  # far to the left
    kept = kept_in_lane(way, WORLD, s, line, np.zeros(s.shape))
    end = 60 + Outlook(way, WORLD).at(0.0)[1][0].length
    inside = (s >= 60) & (s <= end)
    assert kept[inside] == pytest.approx(profile.lane(s[inside]).left - 1.5)
    away = (s < 50) | (s > end + 10)
    assert kept[away] == pytest.approx(line[away])
    assert np.abs(np.diff(kept)).max() < 0.2  # without jumps
    single = Road.through([[0, 0], [50, 0], [100, 0]])
    assert kept_in_lane(single, WORLD, s, line, line) is line
    assert highest_speeds(single, WORLD, None) is None  # type: ignore[arg-type]


def designed(plan: str, left_hand: bool = False) -> tuple[Route, World]:
    brief = read_plan(plan).model_copy(update={"left_hand": left_hand})
    world = world_for(brief, WORLD)
    made = made_from(draft(brief, world, seed=3), world)
    assert isinstance(made, Route)
    return made.on_ground(), world


@pytest.mark.parametrize(("arms", "radius"), [(3, 14), (4, 16), (5, 32)])
def test_lines_through_roundabouts_have_no_kinks(arms: int, radius: int) -> None:
    for leave in range(1, arms + 1):
        way, world = designed(f"roundabout exit={leave} arms={arms} r={radius}", leave == 2)
        offset = plugins.find("drivers", "beamng_like")().offsets(way, world)
        middle = world.profile_of(way).middle(stations(way))
        planned, connection = (max(map(abs, line_along(way, t).curvature)) for t in (offset, middle))
        assert 1 / planned > 0.8 / connection  # its radius, against that of the tightest connection


@pytest.mark.parametrize("leave", [1, 3])
def test_they_do_not_crawl_through_a_ring_of_16_m(leave: int) -> None:
    way, world = designed(f"roundabout exit={leave} arms=4 r=16")
    (ring,) = way.passages
    for name in ("beamng_like", "reference"):
        drive = simulate(way, world, name)
        inside = (drive["s"] > ring.start) & (drive["s"] < ring.end)
        assert 3.6 * drive["speed"][inside].min() > 17


def test_speeds_before_a_junction_fall_no_faster_than_asked() -> None:
    way = route(ROUND)
    line = line_along(way, -2.0)
    free, eased = highest_speeds(way, WORLD, line), highest_speeds(way, WORLD, line, 3.4)
    assert free is not None
    assert eased is not None
    squares, lengths = np.square(eased), line.step * np.array(line.stretch[:-1])
    slowing = [(a - b) / 2 / d for (a, b), d in zip(pairwise(squares), lengths, strict=True) if a < math.inf]
    assert max(slowing) == pytest.approx(3.4)
    assert all(gentle <= most for gentle, most in zip(eased, free, strict=True))
    assert min(eased) == min(free)
