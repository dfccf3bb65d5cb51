"""The driver ``lane_centring``: what limits it, what it sees, and on which side it leaves its lane."""

import math

import numpy as np
import pytest

from drive.slippery_bicycle import SlipperyBicycle
from road_parts import road_of
from roadgpt.drive import Drive
from roadgpt.drive.drivers.lane_centring import LaneCentring
from roadgpt.road import Limits, Road, World
from roadgpt.run import Setup, perform
from roadgpt.verdict import Verdict, judge

MIDDLE = -2.0  # m, the middle of the right lane of a usual road


def bend(radius: float, degrees: float, before: float = 40.0) -> Road:
    """A straight, then bends of at most 60 degrees each with the same radius, then 40 m straight."""
    pieces = math.ceil(abs(degrees) / 60)
    part = (math.radians(abs(degrees)) * radius / pieces, degrees / pieces, 0.0)
    return road_of((before, 0.0, 0.0), *[part] * pieces, (40.0, 0.0, 0.0))


def driven(road: Road, driver: LaneCentring, speed_kmh: float = 70.0) -> Drive:
    world = World(limits=Limits(speed_limit=speed_kmh / 3.6))
    return SlipperyBicycle().simulate(road, world, driver, seed=7, keep_driving=True)


def test_the_steering_gives_no_more_than_its_lateral_acceleration() -> None:
    """By the yaw rate of the car, on a bend that it takes far too fast."""
    drive = driven(bend(40.0, 100.0, before=90.0), LaneCentring(strength=2.0, aim=50.0))
    lateral = np.abs(np.array(drive["yaw_rate"]) * np.array(drive["speed"]))
    assert 1.8 < lateral.max() < 2.2
    assert np.max(np.array(drive["speed"]) ** 2 / 40.0) > 4.0  # what the bend asks for


@pytest.mark.parametrize("hand", [1, -1])
def test_cruise_control_slows_down_to_the_lateral_acceleration_it_aims_at(hand: int) -> None:
    """In a long bend v^2 / R is the aim, R being the radius of the lane, not of the road."""
    drive = driven(bend(30.0, hand * 200.0), LaneCentring())
    s, speed = np.array(drive["s"]), np.array(drive["speed"])
    within = speed[(s > 90.0) & (s < 120.0)]
    lane = 30.0 + 2.0 * hand  # a left bend is wider for the right lane
    assert np.median(within) == pytest.approx(math.sqrt(1.9 * lane), rel=0.03)


def test_what_is_beyond_its_sight_changes_nothing() -> None:
    """Two roads that part at 100 m are driven alike until the car is 40 m away, and then not."""
    one = driven(road_of((100.0, 0.0, 0.0), (30.0, 60.0, 0.0), (40.0, 0.0, 0.0)), LaneCentring())
    other = driven(road_of((100.0, 0.0, 0.0), (70.0, 0.0, 0.0)), LaneCentring())
    steps = int(np.searchsorted(one["s"], 57.0))
    for name in ("s", "t", "speed", "steer"):
        assert one[name][:steps].tolist() == other[name][:steps].tolist()
    at = [float(np.interp(98.0, drive["s"], drive["speed"])) for drive in (one, other)]
    assert at[0] < at[1] - 1.0


def test_a_crest_hides_the_bend_behind_it() -> None:
    """From 1.3 m the road ends behind the crest; from 30 m it does not. By the usual formula a crest of
    56 m radius hides the road after sqrt(2 * 56 m * 1.3 m) = 12 m, instead of 40 m.
    """
    road = road_of((90.0, 0.0, 12.0), (15.0, 0.0, -12.0), (30.0, 60.0, -12.0), (40.0, 0.0, -12.0))
    low, high = driven(road, LaneCentring()), driven(road, LaneCentring(eye_height=30.0))
    fast, slow = (float(np.interp(105.0, drive["s"], drive["speed"])) for drive in (low, high))
    assert fast > slow + 2.0


@pytest.mark.parametrize(("hand", "side"), [(1, "right"), (-1, "left")])
def test_it_leaves_its_lane_on_the_outside(hand: int, side: str) -> None:
    road = bend(22.0, hand * 110.0, before=80.0)
    drive = driven(road, LaneCentring(strength=1.0))
    verdict = judge(road, drive, World())
    assert (verdict.outcome, verdict.side) == ("FAIL", side)


def crossing(kmh: float) -> tuple[Drive, Verdict]:
    plan = f"straight 150 // crossroads straight none // straight 60 && ego robot v={kmh}; "
    plan += "car junction left v=30 impact=50: cross"
    run = perform(plan, 1, World(), Setup(driver="lane_centring", reader="plan"))
    assert run.drive is not None
    assert run.verdict is not None
    return run.drive, run.verdict


def test_emergency_braking_stays_the_cars_where_somebody_else_steers() -> None:
    drive, verdict = crossing(40)
    assert (drive.ended, verdict.counts.get("collision")) == ("goal", None)
    by = np.array([drive.handed_to(step) for step in range(len(drive))])
    brakes = np.array(drive["brake"]) > 0.5
    before = (by == "robot") & (np.cumsum(drive["brake"] > 0.05) == 0)
    assert np.ptp(drive["speed"][before]) < 0.5 / 3.6  # Euro NCAP's tolerance of a speed that is held
    assert brakes[by == "robot"].any()
    assert drive["ax"].min() < -5.0
    assert np.ptp(drive["t"]) < 0.1  # the robot steers on


@pytest.mark.parametrize(("kmh", "whose"), [(40, None), (70, "robot")])
def test_an_avoidable_collision_is_the_cars_at_the_speeds_of_the_regulation(
    kmh: float, whose: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """UN R152 has 10 to 60 km/h: there a car without emergency braking has failed, whoever steers."""
    monkeypatch.setattr("roadgpt.drive.drivers.lane_centring.EMERGENCY", math.inf)
    drive, verdict = crossing(kmh)
    hit = next(each.at_time for each in verdict.incidents or () if each.contact)
    assert np.ptp(drive["speed"][drive["time"] < hit]) < 0.5 / 3.6
    assert (verdict.outcome, verdict.cause, verdict.handed_to) == ("FAIL", "collision", whose)
    said = "so the failure is not lane_centring's" if whose else "emergency braking stays lane_centring's"
    assert said in verdict.description
