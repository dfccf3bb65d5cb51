"""The test of a road as the competition has it is read as the road."""

from pathlib import Path

import numpy as np
import pytest

from exported import ROADS, WORLD
from roadgpt.export import save
from roadgpt.network import read_road


@pytest.mark.parametrize("name", ["arcs", "spline", "flat points"])
def test_the_sbft_test_is_read_as_the_road(tmp_path: Path, name: str) -> None:
    road = ROADS[name]
    (file,) = save(road, tmp_path, ["sbft"], WORLD)
    again = read_road(file)
    assert again.control_points() == pytest.approx(road.control_points(), abs=1e-5)
    if name != "flat points":
        s = np.linspace(0, road.length, 200)
        _, away = road.locate(*again.at(s * again.length / road.length)[:, :2].T)
        assert np.abs(away).max() < 0.01
