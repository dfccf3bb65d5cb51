"""Roads whose parts have heights in metres: measured on the heights of the points along the finished road."""

import numpy as np
import pytest

import roadgpt
from roadgpt.brief.plan import read_plan

SEEDS = range(8)


def heights(plan: str) -> list[np.ndarray]:
    """Returns the heights above the start, in metres, of the points along one road per seed."""
    brief = read_plan(plan)
    roads = [roadgpt.build(roadgpt.draft(brief, roadgpt.World(), seed=seed)) for seed in SEEDS]
    return [road.sample().z - road.sample().z[0] for road in roads]


@pytest.mark.parametrize(
    ("plan", "ends"),
    [
        ("straight down len=100 climb=5; turn left", -5),
        ("turn x3 up climb=2", 6),
        ("s_bend up climb=4; straight", 4),
        ("hairpin down climb=3 r=20", -3),
        ("straight up len=120 climb=6; hairpin left; straight up len=120 climb=6", 12),
        ("straight up climb=6 pct=5; straight down climb=4", 2),
        ("straight len=60; crest climb=5; turn right sharp", 0),
        ("turn left; straight down climb=4; turn right; straight up climb=4; turn left", 0),
    ],
)
def test_the_parts_rise_and_fall_as_was_said_and_the_rest_is_level(plan: str, ends: float) -> None:
    for z in heights(plan):
        assert z[-1] == pytest.approx(ends, abs=1.1)
    assert np.median([z[-1] for z in heights(plan)]) == pytest.approx(ends, abs=0.35)


def test_a_hill_between_straights_is_as_high_as_was_said() -> None:
    tops = [z.max() for z in heights("straight len=60; crest climb=5; turn right sharp")]
    assert np.median(tops) == pytest.approx(5, abs=0.3)
    assert min(tops) > 4


def test_a_hollow_in_a_straight_road_is_as_deep_as_was_said() -> None:
    depths = [-z.min() for z in heights("straight; dip climb=2; straight")]
    assert np.median(depths) == pytest.approx(2, abs=0.3)


def test_a_height_by_a_bound_is_met_from_the_side_of_the_level() -> None:
    for z in heights("turn left; straight up climb=3..5; turn right | len=300"):
        assert 2.9 < z[-1] < 5.1


def test_a_whole_climb_beside_that_of_a_part_is_met_too() -> None:
    for z in heights("turn left; straight up len=80 climb=4; turn right | climb=10"):
        assert z[-1] == pytest.approx(10, abs=0.6)
