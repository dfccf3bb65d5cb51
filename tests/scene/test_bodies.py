"""The others on the road in images: each covers what its box covers, and nothing else changes."""

import numpy as np
import pytest

from roadgpt.road import Road, World
from roadgpt.scene import Camera, Pose, Scenery
from roadgpt.traffic import SIZES

FOV, HIGH, WIDE = 1.2, 270, 480
CAMERA = Camera(WIDE, HIGH, FOV, "bonnet")
POSE = Pose(10.0, -2.0, 0.56, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


@pytest.fixture(scope="module")
def scene() -> Scenery:
    return Scenery.of(Road.through([[0, 0], [100, 0], [200, 0]]), World())


@pytest.mark.parametrize("kind", SIZES)
def test_what_changes_in_the_image_is_where_the_box_is(scene: Scenery, kind: str) -> None:
    """By hand: a pinhole at the camera's place, looking along x."""
    size, x, y = SIZES[kind], 30.0, -3.0  # type: ignore[index]
    before = scene.render(CAMERA, POSE)
    after = scene.render(CAMERA, POSE, others=[(kind, size, (x, y, 0.0, 0.5))])  # type: ignore[arg-type]
    rows, columns = np.nonzero((before != after).any(axis=2))
    eye = CAMERA.eye(POSE)
    long, wide = size.length / 2 * np.exp(0.5j), size.width / 2 * 1j * np.exp(0.5j)
    plan = [complex(x, y) + a * long + b * wide for a in (-1, 1) for b in (-1, 1)]
    corners = np.array([[each.real, each.imag, h] for each in plan for h in (0.0, size.height)])
    right, down, ahead = ((corners - eye.position) @ eye.axes.T).T
    u, v = WIDE / 2 + eye.focal * right / ahead, HIGH / 2 + eye.focal * down / ahead
    for found, place in ((columns, u), (rows, v)):
        assert found.min() >= place.min() - 1.5
        assert found.max() <= place.max() + 1.5
        assert np.ptp(found) > 0.55 * np.ptp(place) - 2


def test_who_is_nearer_hides_who_is_behind(scene: Scenery) -> None:
    truck = ("truck", SIZES["truck"], (40.0, -2.0, 0.0, 0.0))
    child = ("child", SIZES["child"], (60.0, -2.0, 0.0, 0.0))
    both, one = (scene.render(CAMERA, POSE, others=each) for each in ([child, truck], [truck]))
    assert np.array_equal(both, one)
    assert not np.array_equal(scene.render(CAMERA, POSE, others=[child]), scene.render(CAMERA, POSE))


def test_there_is_room_for_many(scene: Scenery) -> None:
    crowd = [("car", SIZES["car"], (20.0 + n, -2.0, 0.0, 0.0)) for n in range(70)]
    assert np.array_equal(
        scene.render(CAMERA, POSE, others=crowd), scene.render(CAMERA, POSE, others=crowd[::-1])
    )
