"""Slopes beside and across the ends of a road: each begins at the edge and leads outwards, 1.7 m for every
metre of drop, to 0.4 m below the land 2 m beyond the edge.
"""

import numpy as np
import pytest

from roadgpt.export.edges import Embankment, embankments
from roadgpt.geometry import GradeProfile, Piece, PieceCurve
from roadgpt.road import Profile, Road
from roadgpt.road.land import Land
from roadgpt.road.profile import Lane

LENGTH = 120.0
PROFILE = Profile(
    (Lane("driving", 3.0, "solid"), Lane("shoulder", 1.0, "none")),
    (Lane("driving", 3.5, "broken"), Lane("driving", 4.0, "solid"), Lane("shoulder", 2.0, "none")),
)
LEFT, RIGHT = 4.0, -9.5  # m, outer edges of the shoulders
ROAD = Road(
    PieceCurve(10.0, 20.0, 0.4, (Piece(50.0), Piece(70.0, 0.0, 1 / 60))),
    GradeProfile(20.0, (0.0, LENGTH), (0.05, -0.03)),
    profile=PROFILE,
)
STATIONS = np.linspace(0.0, LENGTH, 31)


def leaning(at_origin: float) -> Land:
    """Land that rises by 4 % to the east and falls by 2 % to the north."""
    x, y = np.array([-200.0, 0.0, 400.0]), np.array([-200.0, 50.0, 400.0])
    heights = at_origin + 0.04 * x - 0.02 * y[:, None]
    return Land(x, y, heights, np.zeros_like(heights), 4.0)


def made(land: Land) -> dict[str, Embankment]:
    found = embankments(ROAD, PROFILE, STATIONS, land)
    return dict(zip(("right", "left", "start", "end"), found, strict=True))


OUTWARDS = {
    "right": lambda e: ROAD.at(STATIONS, RIGHT - 1)[:, :2] - e[:, :2],
    "left": lambda e: ROAD.at(STATIONS, LEFT + 1)[:, :2] - e[:, :2],
    "start": lambda e: np.tile(-np.array([np.cos(0.4), np.sin(0.4)]), (len(e), 1)),
    "end": lambda e: np.tile(np.cross([0, 0, 1.0], ROAD.at(LENGTH, -1.0) - ROAD.at(LENGTH))[:2], (len(e), 1)),
}


@pytest.mark.parametrize("side", OUTWARDS)
@pytest.mark.parametrize("below", [9.0, 4.0])
def test_every_slope_leads_outwards_by_1_7_m_for_each_metre_of_drop(side: str, below: float) -> None:
    land = leaning(20.0 - below)
    edge, foot, is_left = made(land)[side]
    way = OUTWARDS[side](edge)
    assert np.linalg.norm(way, axis=1) == pytest.approx(1.0)
    x, y = (edge[:, :2] + 2.0 * way).T
    ground = 20.0 - below + 0.04 * x - 0.02 * y
    drop = np.maximum(edge[:, 2] - ground, 0.0) + 0.4
    assert drop.max() > 1.0
    assert edge[:, 2] - foot[:, 2] == pytest.approx(drop, abs=1e-9)
    assert foot[:, :2] - edge[:, :2] == pytest.approx(1.7 * drop[:, None] * way, abs=1e-9)
    along = np.gradient(edge[:, :2], axis=0)
    turns = along[:, 0] * way[:, 1] - along[:, 1] * way[:, 0]
    assert (turns > 0).all() if is_left else (turns < 0).all()


def test_a_slope_whose_land_is_higher_than_the_road_is_only_a_step_of_40_cm() -> None:
    for edge, foot, _ in made(leaning(60.0)).values():
        assert edge[:, 2] - foot[:, 2] == pytest.approx(0.4, abs=1e-9)
