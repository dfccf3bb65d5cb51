"""The test robot against the tolerances of Euro NCAP's protocols: 0.5 km/h, and 0.05 m to either side."""

import math

import numpy as np
import pytest

from drive.test_junctions import route
from roadgpt.brief.amount import exactly
from roadgpt.brief.scene import Scene
from roadgpt.drive import Drive, simulate
from roadgpt.road import Limits, Road, World
from staged import straight, tracks


def world(kmh: float) -> World:
    return World(limits=Limits(speed_limit=140 / 3.6), scene=Scene(speed=exactly(kmh)))


def held(road: Road, kmh: float) -> Drive:
    """The drive, which kept the speed from 1 s after its start."""
    drive = simulate(road, world(kmh), "robot")
    assert drive.ended == "goal"
    assert np.abs(drive["speed"][drive["time"] >= 1] * 3.6 - kmh).max() <= 0.5
    return drive


@pytest.mark.parametrize("kmh", [10, 60, 130])
@pytest.mark.parametrize("grade", [-0.06, 0.0, 0.06])
def test_on_a_straight_road_it_holds_its_speed_and_the_middle_of_its_lane(kmh: int, grade: float) -> None:
    road = Road.through([[x, 0.0, 400 + grade * x] for x in (0.0, 5.0 * kmh / 7, 5.0 * kmh / 3)])
    drive = held(road, kmh)
    assert np.abs(drive["y"] + 2.0).max() <= 0.05


@pytest.mark.parametrize("hand", [-1, 1])
def test_in_a_wide_bend_it_stays_on_the_circle(hand: int) -> None:
    angles = np.linspace(0.0, 0.8, 60)
    points = 250 * np.stack([np.sin(angles), hand * (1 - np.cos(angles))], axis=1)
    drive = held(Road.through(points), 60)
    away = np.hypot(drive["x"], drive["y"] - hand * 250) - (250 + hand * 2)
    assert np.abs(away[drive["time"] >= 1]).max() <= 0.1


@pytest.mark.parametrize(("take", "kmh"), [("left", 10), ("left", 20), ("right", 20)])
def test_it_turns_at_a_crossroads_and_stops_at_no_sign(take: str, kmh: int) -> None:
    way = route({"kind": "crossroads", "take": take, "control": "stop", "kerb": 8}, world=world(kmh))
    drive = held(way, kmh)
    middle = world(kmh).profile_of(way).middle(drive["s"])
    assert np.abs(drive["t"] - middle).max() <= 0.15


def test_it_reacts_to_nobody() -> None:
    others = tracks(1.0, child=("child", straight(80, -2, math.pi / 2, 0)))
    drive = simulate(Road.through([[0, 0], [100, 0], [300, 0]]), world(40), "robot", replay=others)
    assert drive.ended == "collision"
    before = drive["x"] < 80 - 0.25 - 2.3
    assert np.abs(drive["speed"][before] * 3.6 - 40).max() <= 0.5
