"""Drafts in a World with more lanes and banked bends."""

import numpy as np
import pytest

from roadgpt.brief import read
from roadgpt.check import inspect
from roadgpt.design import draft
from roadgpt.road import CrossSection, World, build

WORLD = World(section=CrossSection(lanes="3+2", lane_width=3.5, bank="auto"))
BRIEF = read("turn x3", "plan")


@pytest.mark.parametrize("seed", range(3))
def test_drafts_leave_room_for_all_lanes(seed: int) -> None:
    design = draft(BRIEF, WORLD, seed=seed)
    road = WORLD.lay(build(design))
    assert inspect(road, BRIEF, WORLD) == ()
    edge = road.at(np.linspace(0.0, road.length, 500), -10.5)[:, :2]
    assert edge.min() > 0.0
    assert edge.max() < 250.0
