"""Drivers among others: the distance that they keep, and for whom they brake. Gaps are those of the published
formula; others are functions of time."""

from functools import cache

import numpy as np
import pytest
import shapely

from roadgpt.drive import Drive, simulate
from roadgpt.road import Limits, Road, World
from roadgpt.traffic import SIZES, Tracks
from roadgpt.traffic.actor import corners
from staged import straight, tracks

V = 20.0
WORLD = World(limits=Limits(speed_limit=V))
ROAD = Road.through([[0, 0, 0], [300, 0, 0], [900, 0, 0]])
LANE, FRONT = -2.0, 2.25
DRIVERS = ("beamng_like", "lane_centring", "pure_pursuit", "reference")


@cache
def alone(driver: str) -> Drive:
    """A drive with somebody who is far away, so that the car rolls at the start."""
    return simulate(ROAD, WORLD, driver, replay=tracks(1.0, barrier=("barrier", straight(450, -90, 0, 0))))


def gaps(drive: Drive, others: Tracks, kind: str) -> np.ndarray:
    rear = others.at(drive["time"])[:, 0, 0] - SIZES[kind].length / 2
    return np.asarray(rear - drive["x"] - FRONT)


@pytest.mark.parametrize("driver", DRIVERS)
@pytest.mark.parametrize("v", [6.0, 13.0])
def test_behind_an_even_leader_the_gap_is_that_of_the_published_formula(driver: str, v: float) -> None:
    others = tracks(60.0, van=("van", straight(60, LANE, 0, v)))
    drive = simulate(ROAD, WORLD, driver, replay=others)
    followed = (drive["time"] > 30.0) & (drive["time"] < 45.0)
    # Treiber, Hennecke, Helbing (2000), equation 4, where the acceleration and the change of the gap are 0
    assert gaps(drive, others, "van")[followed] == pytest.approx(2.0 + 1.5 * v, abs=0.3)
    assert drive.ended == "goal"


@pytest.mark.parametrize("driver", DRIVERS)
@pytest.mark.parametrize(("kind", "y", "heading"), [("truck", LANE, 0.0), ("car", LANE - 2.3, 0.3)])
def test_the_car_stops_behind_who_stands_in_its_path(
    driver: str, kind: str, y: float, heading: float
) -> None:
    others = tracks(1.0, other=(kind, straight(300, y, heading, 0)))
    drive = simulate(ROAD, WORLD, driver, replay=others)
    assert drive.ended == "stuck"
    box = shapely.Polygon(corners(others.states[0, 0], SIZES[kind]))
    strip = shapely.box(0, LANE - 0.93, 900, LANE + 0.93)
    assert 1.0 < box.intersection(strip).bounds[0] - drive["x"][-1] - FRONT < 4.0
    assert drive["speed"][-500:].max() < 0.02  # it does not creep


@pytest.mark.parametrize("driver", DRIVERS)
def test_nobody_brakes_for_who_is_beside_the_path(driver: str) -> None:
    oncoming = {
        f"{kind}_{n}": (kind, straight(300 + 90 * n, 2.0, np.pi, 18.0))
        for n, kind in enumerate(["truck", "car", "van", "bus"] * 3)
    }
    parked = {f"car_{n}": ("car", straight(40 + 20 * n, LANE - 2.4, 0, 0)) for n in range(20, 40)}
    walker = {"adult_9": ("adult", straight(100, LANE - 3, 0, 1.4))}
    drive = simulate(ROAD, WORLD, driver, replay=tracks(60.0, **oncoming, **parked, **walker))
    for name in ("speed", "brake", "throttle", "steer", "t"):
        assert drive[name].tolist() == alone(driver)[name].tolist()


@pytest.mark.parametrize("driver", DRIVERS)
@pytest.mark.parametrize("kind", ["adult", "bicycle", "animal"])
def test_the_car_lets_pass_who_crosses_and_goes_on(driver: str, kind: str) -> None:
    speed = {"adult": 1.5, "bicycle": 4.0, "animal": 3.0}[kind]
    arrival = float(np.interp(200, alone(driver)["x"], alone(driver)["time"]))
    across = straight(200, LANE - speed * arrival, np.pi / 2, speed)
    drive = simulate(ROAD, WORLD, driver, replay=tracks(60.0, other=(kind, across)))
    assert drive.ended == "goal"
    assert drive.duration > alone(driver).duration + 0.5


def test_cruise_control_brakes_within_its_standard_and_an_emergency_harder() -> None:
    slower = simulate(ROAD, WORLD, "lane_centring", replay=tracks(60, car=("car", straight(120, LANE, 0, 8))))
    assert 1.0 < -slower["ax"].min() < 3.5 + 0.3
    for ahead, speed in ((30.0, 2.0), (15.0, 0.5)):
        late = straight(200, LANE - 1.7 - speed * (200 - ahead - FRONT) / V, np.pi / 2, speed)
        drive = simulate(ROAD, WORLD, "lane_centring", replay=tracks(60, adult=("adult", late)))
        assert -drive["ax"].min() > 5.0
