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


@pytest.mark.parametrize("line", ["turn up climb=3; straight up", "turn x3 down climb=2"])
def test_heights_of_parts_ask_no_slope_of_the_whole_road(line: str) -> None:
    assert plan(normal(read_plan(line))) == line
    check(read_plan(line + (" | climb=-5" if "up" in line else " | climb=5")))


@pytest.mark.parametrize(
    "line", ["crest len=100 climb=5; turn", "dip len=60.. pct=4; turn", "crest pct=5; turn"]
)
def test_a_crest_keeps_its_length_and_its_percent(line: str) -> None:
    assert plan(normal(read_plan(line))) == line


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


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("straight down len=100 climb=5; turn", "a straight of 100 metres that falls by 5 metres"),
        ("hairpin x2 up climb=3..4; turn", "2 hairpins that rise by 3 to 4 metres each"),
        ("crest climb=2; turn", "a crest 2 metres high"),
        ("dip climb=1.5; turn", "a dip 1.5 metres deep"),
        ("crest len=80 climb=3; turn", "a crest of 80 metres that is 3 metres high"),
        ("dip pct=5; turn", "a dip with slopes of 5 percent"),
        ("slalom x4 up climb=4; straight", "a slalom with 4 turns that rises by 4 metres"),
        (
            "turn deg=90 r=30 climb=3; straight",
            "of 90 degrees with a radius of 30 metres that rises by 3 metres",
        ),
    ],
)
def test_the_sentence_says_the_height(line: str, said: str) -> None:
    assert said in sentence(read_plan(line))


@pytest.mark.parametrize(
    ("line", "why"),
    [
        ("straight flat climb=5", "level"),
        ("straight len=30 climb=8", "15 percent"),  # 27 %
        ("crest len=40 climb=5", "15 percent"),  # 25 %, on 20 m of it
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
    [
        ("straight up climb=-3", "leave out the minus"),
        ("crest climb=-3", "leave out the minus"),
        ("straight climb=-2..3", "both rise and fall"),
    ],
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
