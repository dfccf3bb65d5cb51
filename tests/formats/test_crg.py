"""OpenCRG, as ASAM's own C library reads it."""

from pathlib import Path

import numpy as np
import pycrg
import pytest

from exported import ROADS, WORLD
from roadgpt.errors import ExportError
from roadgpt.export import save
from roadgpt.road import Road, World

pycrg.set_message_level(pycrg.MSG_LEVEL_NONE)


def saved(road: Road, folder: Path, world: World = WORLD) -> Path:
    (file,) = save(road, folder, ["crg"], world)
    return file


@pytest.mark.parametrize("name", ROADS)
def test_asams_library_finds_our_points_within_a_millimetre(tmp_path: Path, name: str) -> None:
    road = ROADS[name]
    with pycrg.DataSet.open(saved(road, tmp_path)) as data:
        assert data.check()
        with data.create_contact_point() as contact:
            # the last hair is left out: beyond the end of its steps the library answers nothing
            u = np.linspace(0, road.length * (1 - 1e-9), 400)
            for v in (-6.9, -4.0, -1.3, 0.0, 4.0, 6.9):
                x, y = contact.uv_to_xy_many(u, np.full(len(u), v))
                ours = road.at(u, v)
                # a reader's cross sections are square to its steps, not to the curve
                allowed = 1e-3 if v == 0 else 0.03
                assert np.hypot(x - ours[:, 0], y - ours[:, 1]).max() < allowed
                z = contact.uv_to_z_many(u, np.full(len(u), v))
                assert np.abs(z - ours[:, 2]).max() < 1e-3


def test_a_bend_too_tight_for_the_verge_narrows_the_surface(tmp_path: Path) -> None:
    angles = np.linspace(0, np.pi / 2, 12)
    road = Road.through(np.column_stack([6 * np.cos(angles), 6 * np.sin(angles), 0 * angles]))
    with pycrg.DataSet.open(saved(road, tmp_path)) as data:
        assert data.check()
        right, left = data.v_range()
    assert 4 <= left <= 6
    assert right == pytest.approx(-left)


def test_a_bend_too_tight_for_a_lane_is_refused(tmp_path: Path) -> None:
    angles = np.linspace(0, np.pi / 2, 12)
    road = Road.through(np.column_stack([3 * np.cos(angles), 3 * np.sin(angles), 0 * angles]))
    with pytest.raises(
        ExportError, match=r"cannot hold the bend at s = \d m, whose radius of [23]\.\d m is less"
    ):
        saved(road, tmp_path)
