"""Heights of single turns and straights: how plans say them, and when they contradict what stands beside."""

import pytest

from roadgpt.brief.normal import normal
from roadgpt.brief.outline import outline
from roadgpt.brief.plan import plan, read_plan
from tables import rows


@pytest.mark.parametrize(("line", "written"), rows(__file__, "slope_says_whether"))
def test_the_slope_says_whether_a_height_is_up_or_down(line: str, written: str) -> None:
    found = normal(read_plan(line))
    assert plan(found) == written
    assert normal(found) == found
    assert read_plan(plan(found)) == found


def test_each_slope_of_a_crest_has_half_of_its_length() -> None:
    up, down = outline(read_plan("crest len=100 climb=5")).groups
    for group in (up, down):
        assert group.feature.length is not None
        assert group.feature.length.number == 50


def test_the_slopes_that_a_dip_shares_with_a_crest_have_both_heights() -> None:
    _, rise, _ = outline(read_plan("dip climb=2; crest climb=4")).groups
    assert rise.feature.climb is not None
    assert rise.feature.climb.number == 6


def test_a_part_that_rises_by_at_most_so_much_does_not_fall() -> None:
    (group,) = outline(read_plan("turn x3 up climb=..2")).groups
    assert group.feature.climb is not None
    assert (group.feature.climb.lo, group.feature.climb.hi) == (0, 2)


def test_a_height_and_a_length_give_the_grade() -> None:
    (group,) = outline(read_plan("straight down len=100 climb=5")).groups
    assert group.feature.grade is not None
    assert group.feature.grade.number == -5
    assert group.feature.climb is not None
    assert (group.feature.climb.lo, group.feature.climb.hi) == (-6.25, -3.75)


def test_a_height_and_a_grade_give_the_length() -> None:
    (group,) = outline(read_plan("straight up pct=5 climb=6")).groups
    assert group.feature.length is not None
    assert group.feature.length.number == 120
