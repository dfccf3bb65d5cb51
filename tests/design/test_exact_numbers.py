"""A number in a description is met closely, although its tolerance is wide; a range is used as a whole."""

import numpy as np
import pytest

import roadgpt
from roadgpt.brief.plan import read_plan
from roadgpt.brief.ranges import Range, overlap
from roadgpt.check.measures import Measures, measure

SEEDS = range(12)


def measured(plan: str) -> list[Measures]:
    brief = read_plan(plan)
    drafts = [roadgpt.draft(brief, roadgpt.World(), seed=seed) for seed in SEEDS]
    return [measure(roadgpt.build(draft).centreline()) for draft in drafts]


@pytest.mark.parametrize(("way", "sign"), [("up", 1), ("down", -1)])
def test_a_road_of_four_percent_has_four_percent(way: str, sign: int) -> None:
    for found in measured(f"turn x2 | {way} pct=4 len=250"):
        assert found.grade == pytest.approx(4 * sign, abs=0.05)
        assert found.length == pytest.approx(250, rel=0.015)


def test_a_level_road_is_level() -> None:
    for found in measured("turn x3 | flat"):
        assert found.steepest == 0


def test_level_turns_beside_a_slope_are_level() -> None:
    for found in measured("hairpin left flat; straight up len=70 pct=8; hairpin right flat"):
        assert [turn.grade for turn in found.turns] == pytest.approx([0, 0], abs=0.05)
        assert found.highest_grade == pytest.approx(8, abs=0.05)


@pytest.mark.parametrize(
    ("plan", "metres"), [("turn x3 | climb=12", 12), ("turn left up; straight down | climb=3", 3)]
)
def test_a_climb_is_as_high_as_was_said(plan: str, metres: float) -> None:
    for found in measured(plan):
        assert found.climb == pytest.approx(metres, abs=0.3)


def test_angles_and_radii_are_those_that_were_said() -> None:
    for found in measured("turn left deg=90 r=30; straight len=60; turn right deg=60 r=40"):
        assert [turn.degrees for turn in found.turns] == pytest.approx([90, 60], abs=1.2)
        assert [turn.radius for turn in found.turns] == pytest.approx([30, 40], rel=0.04)


def test_what_looks_straight_is_about_as_long_as_was_said() -> None:
    """The transitions of wide turns begin so slightly that they look straight: here for 9 m in all. Half of
    that is taken off the straight.
    """
    lengths = [
        found.gaps[1][0].end - found.gaps[1][0].start
        for found in measured("turn left deg=60 r=80; straight len=60; turn right deg=60 r=80")
    ]
    assert np.mean(lengths) == pytest.approx(60 + 9 / 2, abs=1)
    assert max(lengths) < 69


def test_a_range_is_used_as_a_whole() -> None:
    grades = [found.grade for found in measured("turn | up pct=4..8")]
    assert max(grades) - min(grades) > 1.5
    assert all(4 <= grade <= 8 for grade in grades)


def test_a_number_stays_with_its_range_as_long_as_it_lies_inside() -> None:
    four = Range(3, 5, number=4.0)
    assert four == Range(3, 5)
    both = overlap(four, Range(3.5, 9))
    assert both is not None
    assert (both, both.number) == (Range(3.5, 5), 4.0)
    cut = overlap(Range(4.5, 9), four)
    assert cut is not None
    assert cut.number is None
    near = four.drawn_in(0.5, 1.0).around(0.5)
    assert near == Range(3.75, 4.25)
    assert Range(3, 5).around(0.5) == Range(3, 5)
