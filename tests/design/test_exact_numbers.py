"""A number in a description is met closely, although its tolerance is wide; a range is used as a whole."""

import numpy as np
import pytest

import roadgpt
from roadgpt.brief.plan import read_plan
from roadgpt.check.measures import RoadMeasures, measure

SEEDS = range(6)


def measured(plan: str) -> list[RoadMeasures]:
    brief = read_plan(plan)
    drafts = [roadgpt.draft(brief, roadgpt.World(), seed=seed) for seed in SEEDS]
    return [measure(roadgpt.build(draft).centreline()) for draft in drafts]


@pytest.mark.parametrize(("way", "sign"), [("up", 1), ("down", -1)])
def test_a_road_of_four_percent_has_four_percent(way: str, sign: int) -> None:
    for found in measured(f"turn x2 | {way} pct=4 len=250"):
        assert found.grade == pytest.approx(4 * sign, abs=0.05)
        assert found.length == pytest.approx(250, rel=0.015)


def test_level_turns_beside_a_slope_are_level() -> None:
    for found in measured("hairpin left flat; straight up len=70 pct=8; hairpin right flat"):
        assert [turn.grade for turn in found.turns] == pytest.approx([0, 0], abs=0.05)
        assert found.highest_grade == pytest.approx(8, abs=0.05)


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


@pytest.mark.parametrize(
    ("plan", "metres", "climbs"),
    [
        ("straight up len=60 pct=4; straight up len=60 pct=8", 120, 7.2),
        ("straight up len=80 pct=3; straight up len=80 pct=9; straight up len=80 pct=3", 240, 12),
        ("straight down len=80 pct=8; straight down len=50 pct=4 | turns=0", 130, -8.4),
    ],
)
def test_straights_of_two_grades_follow_each_other_without_a_level_piece(
    plan: str, metres: float, climbs: float
) -> None:
    for found in measured(plan):
        assert found.length == pytest.approx(metres, rel=0.03)
        assert found.climb == pytest.approx(climbs, rel=0.06)


@pytest.mark.parametrize(
    ("plan", "least"),
    [
        ("turn x5 r=25.. | lefts=3 rights=2 steepest=6 climb=18 len=450", 25),
        ("| turns=6 r=30..", 30),
        ("turn left r=50..; turn x2 right r=50..", 50),
    ],
)
def test_a_bound_of_the_radius_of_several_turns_is_reached_by_one(plan: str, least: float) -> None:
    for found in measured(plan):
        assert least <= found.radius <= 1.1 * least


def test_halves_with_grades_are_halves_and_end_where_they_began() -> None:
    for found in measured("straight up pct=5; straight down pct=5 | turns=0 len=240"):
        (road,) = found.straights
        up, down = road.pieces[0], road.pieces[-1]
        assert up.end - up.start == pytest.approx(down.end - down.start, rel=0.02)
        assert found.climb == pytest.approx(0, abs=0.05)
