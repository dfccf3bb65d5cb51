"""Roads whose parts have heights in metres: measured on the heights of the points along the finished road."""

import numpy as np
import pytest

import roadgpt
from roadgpt.brief.plan import read_plan
from tables import rows

SEEDS = range(8)


def heights(plan: str) -> list[np.ndarray]:
    """Returns the heights above the start, in metres, of the points along one road per seed."""
    brief = read_plan(plan)
    roads = [roadgpt.build(roadgpt.draft(brief, roadgpt.World(), seed=seed)) for seed in SEEDS]
    return [road.sample().z - road.sample().z[0] for road in roads]


@pytest.mark.parametrize(
    ("plan", "ends"),
    rows(__file__, "the_parts_rise_and_fall_as_was_said_and_the_rest_is_level"),
)
def test_the_parts_rise_and_fall_as_was_said_and_the_rest_is_level(plan: str, ends: float) -> None:
    for z in heights(plan):
        assert z[-1] == pytest.approx(ends, abs=1.1)
    assert np.median([z[-1] for z in heights(plan)]) == pytest.approx(ends, abs=0.35)


@pytest.mark.parametrize("plan", ["crest climb=3", "crest len=100 climb=3"])
def test_a_crest_alone_is_as_high_as_was_said(plan: str) -> None:
    tops = [z.max() for z in heights(plan)]
    assert np.median(tops) == pytest.approx(3, abs=0.2)
    assert min(tops) > 2.7


@pytest.mark.parametrize(("height", "length"), [(5, 130), (6, 150), (6, 160)])
def test_a_steep_hill_on_a_short_road_is_as_high_on_both_sides(height: int, length: int) -> None:
    for z in heights(f"straight up climb={height}; straight down climb={height} | turns=0 len={length}"):
        assert z.max() == pytest.approx(height, abs=0.2)
        assert z.max() - z[-1] == pytest.approx(height, abs=0.2)


def test_a_crest_behind_a_dip_rises_from_its_depth_to_its_height() -> None:
    found = heights("dip climb=2; crest climb=4")
    assert np.median([z.min() for z in found]) == pytest.approx(-2, abs=0.3)
    assert np.median([z.max() for z in found]) == pytest.approx(4, abs=0.4)
    assert np.median([z[-1] for z in found]) == pytest.approx(0, abs=0.3)


@pytest.mark.parametrize("way", [1, -1])
def test_parts_that_rise_or_fall_by_at_most_so_much_are_built(way: int) -> None:
    for z in heights(f"turn x3 {'up' if way > 0 else 'down'} climb=..2"):
        assert 1 < way * z[-1] < 8


@pytest.mark.parametrize("ends", [10, -5])
def test_the_other_parts_make_up_for_the_height_of_one(ends: int) -> None:
    for z in heights(f"turn left climb=3; turn right | climb={ends}"):
        assert z[-1] == pytest.approx(ends, abs=0.6)


def test_a_height_by_a_bound_is_met_from_the_side_of_the_level() -> None:
    for z in heights("turn left; straight up climb=3..5; turn right | len=300"):
        assert 2.9 < z[-1] < 5.1
