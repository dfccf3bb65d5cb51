"""The drivers of examples/vision: what they see, beside the camera's own geometry and slow sums."""

import math
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from scipy.signal import correlate

from road_parts import road_of
from roadgpt.drive import Drive, simulate
from roadgpt.drive.camera_sensor import CameraSensor
from roadgpt.drive.loading import load_driver
from roadgpt.export.ego import CAR
from roadgpt.road import Road, World
from roadgpt.scene import Camera as Pinhole
from roadgpt.scene import CameraPlacement, Pose
from roadgpt.verdict import judge

FOLDER = Path(__file__).resolve().parents[2] / "examples" / "vision"
DRIVERS = "lane_finder.py:LaneFinder", "small_network.py:SmallNetwork"


def made(spec: str) -> Any:
    return load_driver(str(FOLDER / spec))


def module_of(spec: str) -> ModuleType:
    return sys.modules[type(made(spec)).__module__]


def pose(road: Road, s: float, t: float, turned: float) -> dict[str, float]:
    """A row of a car that stands level on its road."""
    x, y, z = road.at(s, t).tolist()
    row = dict.fromkeys(("roll", "steer", "speed", "brake"), 0.0)
    heading = float(road.heading(s)) + turned
    return {**row, "x": x, "y": y, "z": z + CAR.gravity_height, "heading": heading, "pitch": 0.0}


def test_the_ground_lies_where_the_camera_sees_it() -> None:
    module = module_of(DRIVERS[0])
    camera = module.LaneFinder.camera
    ground = module.FlatGround(camera)
    wide = 2 * math.atan(math.tan(camera.field_of_view / 2) * camera.width / camera.height)
    pinhole = Pinhole(
        camera.width, camera.height, wide, "bonnet", CameraPlacement(camera.ahead, camera.up, -camera.down)
    )
    eye = pinhole.eye(Pose(0.0, 0.0, CAR.gravity_height, 0.0))
    for x, y in ((3.0, 0.0), (5.0, -1.8), (9.0, 2.0), (13.0, -6.0)):
        right, down, ahead = eye.axes @ (np.array([x, y, 0.0]) - eye.position)
        column = int(camera.width / 2 + eye.focal * right / ahead)
        row = int(camera.height / 2 + eye.focal * down / ahead)
        assert abs(ground.ahead[row, column] - x) < 0.012 * x * x
        assert abs(ground.aside[row, column] - y) < 0.012 * x * max(abs(y), 1.0)
        assert ground.is_near[row, column]


@pytest.mark.parametrize(
    ("turn", "bend", "near"), [(0.0, 0.0, 0.3), (60.0, 1 / 30, 0.6), (-90.0, -1 / 20, 1.0)]
)
@pytest.mark.parametrize(("t", "turned"), [(-2.0, 0.0), (-1.3, 0.06)])
def test_the_lane_is_found_in_a_picture(
    turn: float, bend: float, near: float, t: float, turned: float
) -> None:
    module = module_of(DRIVERS[0])
    around = math.radians(abs(turn)) / abs(bend) if bend else 60.0
    road = road_of((30.0, 0.0, 0.0), (around + 14.0, turn, 0.0), (30.0, 0.0, 0.0))
    # in the middle of the bend, where the curvature is steady
    s = 30.0 + (around + 14.0) / 2
    bend = float(road.curvature(s + 5.0))
    camera = module.LaneFinder.camera
    image = CameraSensor(camera, road, World()).see(pose(road, s, t, turned))
    ground = module.FlatGround(camera)
    own = bend / (1 + 2 * bend)  # of the lane, whose middle lies 2 m to the right
    lane = module.LaneArc(-1.9 - t, 0.03 - turned, 0.85 * own + 0.004)  # about what was seen before
    for _ in range(6):  # a car that stands looks again
        lane = ground.lane_in(image, lane, (-1.825, 2.0, 5.825))
    assert lane.aside == pytest.approx(-2.0 - t, abs=0.4 * near)
    assert lane.turned == pytest.approx(-turned, abs=0.12 * near)
    assert lane.bend == pytest.approx(own, abs=0.014 * near)
    seen = ground.marked(image, lane)
    assert (seen != image).any(axis=2).mean() > 0.01


@pytest.fixture(scope="module")
def drives() -> Callable[[str], Drive]:
    road = road_of((14.0, 0.0, 0.0), (24.0, 45.0, 3.0), (10.0, 0.0, 0.0))
    kept: dict[str, Drive] = {}

    def drive(spec: str) -> Drive:
        if spec not in kept:
            kept[spec] = simulate(road, World(), made(spec))
            assert judge(road, kept[spec], World()).kept
        return kept[spec]

    return drive


@pytest.mark.parametrize("spec", DRIVERS)
def test_it_keeps_the_lane_of_an_easy_road(spec: str, drives: Callable[[str], Drive]) -> None:
    drive = drives(spec)
    assert drive.ended == "goal"
    speed = np.asarray(drive.columns["speed"])
    assert 23 / 3.6 < speed.max() < 27 / 3.6
    assert np.abs(np.asarray(drive.columns["t"]) + 2.0).max() < 1.0


def test_the_network_says_what_slow_sums_say() -> None:
    module = module_of(DRIVERS[1])
    assert module.WEIGHTS.stat().st_size < 300_000
    driver = made(DRIVERS[1])
    weights = [weight.astype(float) for weight in driver._weights]
    assert sum(weight.size for weight in weights) == 70_831
    image = np.random.default_rng(4).integers(0, 256, (66, 200, 3), np.uint8)
    x = np.moveaxis(image, 2, 0) / 127.5 - 1
    for layer, stride in enumerate((2, 2, 2, 1, 1)):
        kernels, bias = weights[2 * layer : 2 * layer + 2]
        whole = [correlate(x, kernel, mode="valid", method="direct")[0] for kernel in kernels]
        x = np.maximum(np.array(whole)[:, ::stride, ::stride] + bias[:, None, None], 0)
    flat = x.ravel()
    for layer in range(5, 8):
        matrix, bias = weights[2 * layer : 2 * layer + 2]
        flat = (np.maximum(flat, 0) if layer > 5 else flat) @ matrix.T + bias
    assert module.answer(driver._weights, image) == pytest.approx(float(flat[0]), rel=1e-3, abs=1e-4)
