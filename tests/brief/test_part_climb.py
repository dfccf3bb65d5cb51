"""Heights of single turns and straights: how plans say them, and when they contradict what stands beside."""

import pytest

from roadgpt.brief import sentence
from roadgpt.brief.feasible import check
from roadgpt.brief.normal import normal
from roadgpt.brief.outline import outline
from roadgpt.brief.plan import plan, read_plan
from roadgpt.errors import BriefError


@pytest.mark.parametrize(
    ("line", "written"),
    [
        ("straight down len=100 climb=5; turn left", "straight down len=100 climb=5; turn left"),
        ("straight climb=-5; turn left", "straight down climb=5; turn left"),
        ("turn left; straight climb=5", "turn left; straight up climb=5"),
        ("turn left; straight down climb=..-3", "turn left; straight down climb=3.."),
        ("hairpin steeply_up climb=3..5; straight", "hairpin up climb=3..5; straight"),
        ("crest climb=5; turn right", "crest climb=5; turn right"),
        ("turn x2 up climb=2; straight down", "turn x2 up climb=2; straight down"),
    ],
)
def test_the_slope_says_whether_a_height_is_up_or_down(line: str, written: str) -> None:
    found = normal(read_plan(line))
    assert plan(found) == written
    assert normal(found) == found
    assert read_plan(plan(found)) == found


def test_a_height_stays_on_its_clause_where_all_slopes_are_alike() -> None:
    assert plan(normal(read_plan("turn up climb=3; straight up"))) == "turn up climb=3; straight | up"


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("straight down len=100 climb=5; turn", "a straight of 100 metres that falls by 5 metres"),
        ("hairpin x2 up climb=3..4; turn", "2 hairpins that rise by 3 to 4 metres each"),
        ("crest climb=2; turn", "a crest 2 metres high"),
        ("dip climb=1.5; turn", "a dip 1.5 metres deep"),
    ],
)
def test_the_sentence_says_the_height(line: str, said: str) -> None:
    assert said in sentence(read_plan(line))


@pytest.mark.parametrize(
    ("line", "why"),
    [
        ("straight flat climb=5", "level"),
        ("straight len=30 climb=8", "15 percent"),  # 27 %
        ("straight len=100 pct=2 climb=9", "leave out one of the three"),  # 2 m
        ("straight len=100 pct=10 climb=2", "leave out one of the three"),  # 10 m
        ("turn up climb=0", "more than 0 m"),
        ("| down", ""),
    ],
)
def test_heights_that_cannot_be(line: str, why: str) -> None:
    if not why:
        check(read_plan(line))
        return
    with pytest.raises(BriefError, match=why):
        check(read_plan(line))


@pytest.mark.parametrize(
    "line", ["straight len=100 pct=5 climb=5", "straight len=100 climb=..3", "crest climb=5"]
)
def test_heights_that_can_be(line: str) -> None:
    check(read_plan(line))


@pytest.mark.parametrize(
    ("line", "why"),
    [("straight up climb=-3", "leave out the minus"), ("straight climb=-2..3", "both rise and fall")],
)
def test_plans_whose_heights_have_two_directions_are_refused(line: str, why: str) -> None:
    with pytest.raises(BriefError, match=why):
        read_plan(line)


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


def test_the_turns_of_an_s_bend_share_its_height() -> None:
    (group,) = outline(read_plan("s_bend up climb=4")).groups
    assert group.feature.climb is not None
    assert group.feature.climb.number == 2
