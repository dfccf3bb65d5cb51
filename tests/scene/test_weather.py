"""Images in fog, in rain, at night and against a low sun: laws that are checked on the pixels alone."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from roadgpt.drive import CameraSpec
from roadgpt.drive.camera_sensor import CameraSensor
from roadgpt.road import Road, World
from roadgpt.scene import Camera, CameraPlacement, Pose, Scenery

HEADING = 0.9  # rad, of the road at its start
ALONG = np.array([math.cos(HEADING), math.sin(HEADING)])
ROAD = Road.through([40 + s * ALONG for s in (0, 60, 120, 180, 240)])
HIGH, UP = 0.56, 1.4  # m, centre of gravity and camera
CAMERA = Camera(480, 270, math.radians(60), "bonnet", CameraPlacement(0.0, UP, 0.0))
FOCAL = 240 / math.tan(math.radians(30))


def scene(text: str) -> Scenery:
    return Scenery.of(ROAD, World().changed(scene=text))


def linear(picture: np.ndarray) -> np.ndarray:
    """IEC 61966-2-1, backwards."""
    c = picture / 255
    return np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)


def seen(text: str, turned: float = 0.0) -> np.ndarray:
    x, y, z = ROAD.at(10.0, -2.0)
    return linear(scene(text).render(CAMERA, Pose(x, y, z + HIGH, HEADING + turned)))


def row_at(distance: float) -> int:
    """The row of the image that shows the lane so many metres ahead."""
    return int(135 + FOCAL * UP / distance)


def lane(picture: np.ndarray, distance: float) -> float:
    return float(picture[row_at(distance), 220:260].mean())


def test_scenes_without_weather_look_as_no_scene_does() -> None:
    plain = seen("")
    for text in ("medium; oncoming dense", "wet", "ice; ego v=50"):
        assert scene(text).weather is None
        assert (seen(text) == plain).all()


@pytest.mark.parametrize("fog", [40, 90])
def test_contrast_before_the_horizon_falls_to_5_percent_at_the_visual_range(fog: float) -> None:
    clear, foggy = seen(""), seen(f"fog {fog}")
    horizon = foggy[:20].mean(axis=(0, 1))
    assert np.ptp(horizon) < 0.01  # grey
    assert foggy[:100].std(axis=(0, 1)).max() < 0.01  # no sky, no hills
    for about in (8, 15, 0.5 * fog, fog):
        distance = UP * math.hypot(1, FOCAL / (row_at(about) + 0.5 - 135))  # of the middle of that row
        left = (lane(foggy, distance) - horizon.mean()) / (lane(clear, distance) - horizon.mean())
        assert left == pytest.approx(0.05 ** (distance / fog), abs=0.008)


def test_at_night_headlights_show_the_road_below_their_cut_off_and_turn_with_the_car() -> None:
    day, night = seen(""), seen("night")
    ratio = {distance: lane(night, distance) / lane(day, distance) for distance in (12, 25, 50, 110)}
    assert ratio[12] > 0.5
    assert ratio[12] > 2 * ratio[25]
    assert ratio[25] > 3 * ratio[50]
    assert ratio[50] > 2 * ratio[110]
    assert ratio[110] < 0.03  # the cut-off falls by 1 %, from 0.65 m
    assert night[:130].max() < 0.05  # nothing above it
    aside = seen("night", turned=0.5)
    assert aside[170:230, 230:250].mean() > 5 * night[170:230, 470:].mean()


def test_the_sun_stands_ahead_of_the_start_and_dazzles_only_who_looks_to_it() -> None:
    day = seen("")
    for turned in (0.0, 0.2, -0.25):
        glare = seen("low_sun", turned)
        toward = Rotation.from_euler("ZY", [-turned, -math.radians(8)]).apply([1, 0, 0])
        column, row = 240 - FOCAL * toward[1] / toward[0], 135 - FOCAL * toward[2] / toward[0]
        brightest = np.argwhere(glare.sum(axis=2) >= glare.sum(axis=2).max() - 1e-9).mean(axis=0)
        assert brightest == pytest.approx([row, column], abs=4)
        around = glare[int(row) - 12 : int(row) + 12, int(column) - 12 : int(column) + 12]
        assert around.mean() > day[:60].mean()
    away = seen("low_sun", math.pi)
    assert away.max() <= seen("", math.pi).max()


def test_more_rain_is_darker_and_more_blurred() -> None:
    pictures = [seen(text) for text in ("", "rain 2", "rain 10", "rain 50")]
    means = [picture[150:].mean() for picture in pictures]
    assert means == sorted(means, reverse=True)
    grain = [np.abs(np.diff(picture[200:], axis=1)).mean() / picture[200:].mean() for picture in pictures]
    assert grain == sorted(grain, reverse=True)
    assert grain[1] > 0.8 * grain[0]  # lightly


def test_the_same_weather_gives_the_same_bytes_and_reaches_the_cameras_of_drivers() -> None:
    assert (seen("rain 7; night") == seen("rain 7; night")).all()
    x, y, z = ROAD.at(10.0, -2.0)
    row = {"x": x, "y": y, "z": z + HIGH, "heading": HEADING, "pitch": 0, "roll": 0}
    row |= {"steer": 0, "speed": 9, "brake": 0}
    images = [
        CameraSensor(CameraSpec(), ROAD, World().changed(scene=text)).see(row) for text in ("", "fog 30")
    ]
    assert images[1][:60].std() < 2 < images[0][:60].std()
