"""What every driver on the shelf promises, and what each of ours is meant to do; driven in a test double."""

import math
from functools import cache
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drive.slippery_bicycle import SlipperyBicycle
from roadgpt import plugins
from roadgpt.drive import Drive, View
from roadgpt.drive.drivers.beamng_like import HALF_TRACK, BeamngLike
from roadgpt.drive.drivers.pure_pursuit import PurePursuit
from roadgpt.drive.drivers.reference import Reference
from roadgpt.drive.driving_line import stations
from roadgpt.road import CrossSection, Design, Limits, Road, Segment, Site, World, build
from roadgpt.verdict import judge

SHELF = plugins.names("drivers")
USUAL = World()


def bent(radius: float, hand: int, degrees: float = 65.0, grade: float = 0.0) -> Road:
    """40 m straight, one bend with clothoids of 4 m, 40 m straight."""
    length = math.radians(degrees) * radius + 4.0
    turn: Any = {"direction": "left" if hand > 0 else "right", "turn_degrees": degrees * hand}
    bend = Segment(distance=length, transition=4.0, incline=grade, **turn)
    straight = Segment(distance=40, direction="straight", incline=grade)
    return build(Design(starting_point=(50, 50, 0), theta=20, segments=(straight, bend, straight)))


@cache
def hilly(seed: int) -> Road:
    """Five bends of 16 to 60 m radius either way, climbing and falling by up to 12 %."""
    rng = np.random.default_rng(seed)
    segments = [Segment(distance=20, direction="straight")]
    for _ in range(5):
        radius, degrees, hand = rng.uniform(16, 60), rng.uniform(30, 68), rng.choice([-1, 1])
        turn: Any = {"direction": "left" if hand > 0 else "right", "turn_degrees": degrees * hand}
        grade = rng.uniform(-12, 12)
        segments.append(Segment(distance=math.radians(degrees) * radius * 1.3, incline=grade, **turn))
        segments.append(Segment(distance=rng.uniform(15, 30), direction="straight", incline=grade))
    return build(Design(starting_point=(0, 0, 0), theta=0, segments=tuple(segments)))


def drive(road: Road, driver: Any, world: World = USUAL) -> Drive:
    return SlipperyBicycle().simulate(road, world, driver, seed=7, keep_driving=True)


@pytest.mark.parametrize("name", SHELF)
def test_every_driver_answers_with_a_command_and_drives_the_same_twice(name: str) -> None:
    road = hilly(1)
    first, second = (drive(road, plugins.find("drivers", name)()) for _ in range(2))
    for column in ("steer", "throttle", "brake", "x", "y"):
        assert np.isfinite(first[column]).all()
        assert np.array_equal(first[column], second[column])
    for pedal in ("throttle", "brake"):
        assert ((first[pedal] >= 0) & (first[pedal] <= 1)).all()
    assert not ((first["throttle"] > 0) & (first["brake"] > 0)).any()
    assert first.driver == name
    assert first["speed"].max() < USUAL.limits.speed_limit + 1.5


@pytest.mark.parametrize("name", SHELF)
def test_every_driver_steers_wherever_the_car_may_be(name: str) -> None:
    """Backwards, across, far off the road, beyond its end, standing still."""
    road = hilly(2)
    driver = plugins.find("drivers", name)()
    driver.start(road, USUAL, 0)
    for s in (0.0, 1.0, road.length / 2, road.length, road.length + 5):
        for t, heading, vx in ((-2, 0, 0), (-2, math.pi, -3), (3, 1.5, 30), (-30, -3, 0), (-2, 0, 60)):
            x, y, z = (float(v) for v in road.at(min(s, road.length), t))
            view = View(0, x, y, z, heading, abs(vx), 0.0, s, t, road, USUAL, 0.0, 0.02, vx, 0.0)
            steer, throttle, brake = driver.steer(view)
            assert math.isfinite(steer)
            assert 0 <= throttle <= 1
            assert 0 <= brake <= 1


@pytest.mark.parametrize("name", SHELF)
def test_every_driver_copes_with_a_road_through_a_few_points(name: str) -> None:
    road = Road.through([[10, 10], [60, 30], [90, 80], [150, 90]])
    assert drive(road, plugins.find("drivers", name)()).ended == "goal"


@given(seed=st.integers(0, 10_000), kmh=st.sampled_from([40, 70, 100]), friction=st.sampled_from([1.0, 0.6]))
@settings(max_examples=4, deadline=None)
def test_the_reference_stays_in_the_middle(seed: int, kmh: int, friction: float) -> None:
    road, world = hilly(seed), World(limits=Limits(speed_limit=kmh / 3.6), site=Site(friction=friction))
    seen = drive(road, Reference(), world)
    assert np.abs(seen["t"] + 2.0).max() < 0.35
    assert judge(road, seen, world).kept


def test_the_reference_takes_bends_at_its_risk_and_not_above() -> None:
    for risk in (0.4, 0.6):
        road = bent(30.0, 1, degrees=69.0)
        seen = drive(road, Reference(risk=risk))
        arc = (seen["s"] > 50) & (seen["s"] < 65)  # a lane of 32 m radius
        assert seen["speed"][arc].max() ** 2 / 32 / 9.81 == pytest.approx(risk, abs=0.03)


def test_the_reference_knows_a_slippery_road_and_beamng_like_takes_it_for_dry() -> None:
    road, snow = bent(30.0, -1), World(site=Site(friction=0.35))
    slow = drive(road, Reference(), snow)
    assert slow["speed"][(slow["s"] > 50) & (slow["s"] < 65)].max() < math.sqrt(0.35 * 9.81 * 28)
    assert judge(road, slow, snow).kept
    assert not judge(road, drive(road, BeamngLike(), snow), snow).kept
    assert judge(road, drive(road, BeamngLike(assumed_friction=None), snow), snow).kept


@pytest.mark.parametrize("hand", [-1, 1])
def test_beamng_like_draws_its_line_by_the_law(hand: int) -> None:
    road = bent(20.0, hand, degrees=69.0)
    middle = road.length / 2  # of the arc, farther than 5 m from its clothoids
    offsets = np.interp(middle, stations(road), BeamngLike(cut=4.0).offsets(road, USUAL))
    lane = 1 / (20.0 + 2.0 * hand)  # the right lane is wider in a left bend, tighter in a right one
    assert offsets + 2.0 == pytest.approx(hand * 4.0 * math.tanh(lane / 0.104) - 0.1, abs=0.02)


def test_beamng_like_minds_the_edge_of_a_floating_road_only() -> None:
    road = bent(16.0, -1)
    floating = World(section=CrossSection(shoulder=0.0))
    edge = HALF_TRACK - 4.0
    assert BeamngLike().offsets(road, floating).min() >= edge + 0.3 - 1e-9
    assert BeamngLike(edge_room=None).offsets(road, floating).min() < edge
    assert BeamngLike().offsets(road, USUAL).min() == BeamngLike(edge_room=None).offsets(road, floating).min()
    assert drive(road, BeamngLike(), floating)["t"].min() > edge
    assert drive(road, BeamngLike(edge_room=None), floating)["t"].min() < edge


def test_pure_pursuit_cuts_in_when_slow_and_runs_wide_when_fast() -> None:
    road = bent(40.0, 1, degrees=69.0)
    slow = drive(road, PurePursuit(nearest=12.0), World(limits=Limits(speed_limit=15 / 3.6)))
    fast = drive(road, PurePursuit(risk=0.9), World(limits=Limits(speed_limit=28.0)))
    bend = 60.0, 85.0
    for seen, way in ((slow, 1), (fast, -1)):
        here = (seen["s"] > bend[0]) & (seen["s"] < bend[1])
        assert way * (seen["t"][here].mean() + 2.0) > 0.1
