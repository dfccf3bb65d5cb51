"""What words promise, against the table of meanings in the project's brief: written out by hand."""

from math import inf, radians

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from roadgpt.brief.element import Element
from roadgpt.brief.model import Brief, Clause, at_least, at_most, between, exactly
from roadgpt.brief.normal import normal
from roadgpt.brief.outline import Outline, outline
from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.ranges import Range
from tables import rows


def of(*clauses: Clause, **wishes: object) -> Outline:
    return outline(Brief.model_validate({"clauses": clauses, **wishes}))


@pytest.mark.parametrize(("kind", "turns", "degrees", "radius", "alternating"), rows(__file__, "kinds"))
def test_kinds_of_turns(
    kind: str, turns: list[int | None], degrees: list[float], radius: list[float] | None, alternating: bool
) -> None:
    (group,) = of(Clause.model_validate({"kind": kind})).groups
    assert [group.lo, group.hi] == turns
    assert group.feature.degrees == Range(*degrees)
    assert group.feature.radius == (radius and Range(*radius))
    assert group.alternating == alternating


@pytest.mark.parametrize(
    ("asked", "lo", "hi"), [(45, 40.5, 49.5), (60, 54, 66), (80, 73, 87), (90, 81, 99), (150, 140, 160)]
)
def test_a_number_of_degrees_has_a_tenth_and_never_more_than_seven_or_ten(
    asked: float, lo: float, hi: float
) -> None:
    (group,) = of(Clause(kind="turn", degrees=exactly(asked))).groups
    assert group.feature.degrees is not None
    assert (group.feature.degrees.lo, group.feature.degrees.hi) == pytest.approx((lo, hi))


def test_lengths_and_percents_have_their_tolerance() -> None:
    (group,) = of(Clause(kind="straight", length=exactly(60), slope="down", incline=exactly(8))).groups
    assert group.feature.length == Range(51, 69)
    assert group.feature.grade == Range(-9, -7)
    assert of(length=exactly(300)).length == Range(270, 330)


def test_gentle_and_sharp_turns() -> None:
    gentle, sharp, hairpin = of(
        Clause(kind="turn", sharpness="gentle"),
        Clause(kind="turn", sharpness="sharp"),
        Clause(kind="hairpin", sharpness="sharp"),
    ).groups
    assert (gentle.feature.degrees, gentle.feature.radius) == (Range(15, 90), Range(40))
    assert (sharp.feature.degrees, sharp.feature.radius) == (Range(30, 120), Range(0, 30))
    assert (hairpin.feature.degrees, hairpin.feature.radius) == (Range(140, 210), Range(0, 30))


def test_a_sweeping_turn_is_gentle_where_the_map_is_small() -> None:
    brief = Brief(clauses=(Clause(kind="turn", sharpness="sweeping"),))
    assert outline(brief).groups[0].feature.radius == Range(60)
    assert outline(brief, map_size=149).groups[0].feature.radius == Range(40)


@pytest.mark.parametrize(("slope", "grade", "span"), rows(__file__, "slopes"))
def test_the_slope_of_the_whole_road(slope: str | None, grade: str | None, span: list[float] | None) -> None:
    seen = of(slope=slope)
    assert (seen.grade, seen.grade_range) == (grade, span and Range(*span))
    assert seen.steepest == (Range(0, 3.5) if slope == "nearly_flat" else None)


def test_turns_are_counted_from_clauses_or_wishes() -> None:
    three = Clause(kind="turn", count=exactly(3))
    assert of(three, Clause(kind="chicane")).turns == Range(5, 7)
    assert of(Clause(kind="straight")).turns == Range(0, 0)
    assert of(Clause(kind="straight"), turns=exactly(2)).turns == Range(2, 2)
    assert of(turns=at_least(3), left=exactly(0)).turns == Range(3, inf)
    assert of(left=exactly(2), right=exactly(1)).turns == Range(3, inf)
    assert of().turns == Range(1, inf)
    assert of(ends=Clause(kind="hairpin")).turns == Range(1, inf)
    assert of(three, Clause(kind="turn", count=between(1, 3)), turns=at_most(5)).turns == Range(4, 5)


def test_a_crest_is_a_climb_and_a_fall_and_a_dip_the_reverse() -> None:
    up, down = of(Clause(kind="crest")).groups
    assert (up.feature.grade, down.feature.grade) == (Range(3, 12), Range(-12, -3))
    down, up = of(Clause(kind="dip")).groups
    assert (up.feature.grade, down.feature.grade) == (Range(3, 12), Range(-12, -3))


def test_bounds_on_angles_stay_turns_that_can_be_seen() -> None:
    most, least = of(
        Clause(kind="turn", degrees=at_most(20)), Clause(kind="turn", degrees=at_least(90))
    ).groups
    assert most.feature.degrees == Range(12, 20)
    assert least.feature.degrees is not None
    assert least.feature.degrees.lo == 90
    assert least.feature.degrees.hi < inf


@pytest.mark.parametrize(
    ("line", "same"),
    [
        ("straight up len=60; crest; straight down len=60", "straight up len=60; straight down len=60"),
        ("straight steeply_down; dip; straight up", "straight steeply_down; straight up"),
    ],
)
def test_a_crest_between_a_climb_and_a_fall_is_where_they_meet(line: str, same: str) -> None:
    assert outline(read_plan(line)) == outline(read_plan(same))


@pytest.mark.parametrize("line", rows(__file__, "other_crests_two"))
def test_other_crests_have_two_slopes_of_their_own(line: str) -> None:
    without = "; ".join(part for part in line.split("; ") if not part.startswith("crest"))
    assert outline(read_plan(line)).groups != outline(read_plan(without)).groups


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


@given(
    st.floats(10, 300), st.sampled_from([1, -1]), st.floats(12, 300), st.floats(0, 1), st.floats(0.1, 10_000)
)
def test_curvature_over_the_length_of_a_turn_adds_up_to_its_angle(
    degrees: float, hand: int, radius: float, share: float, straight: float
) -> None:
    """A clothoid, an arc and a clothoid: the area under the curvature is the change of heading."""
    transition = share * radius * radians(degrees)
    turn = Element(turn=hand * degrees, radius=radius, transition=transition)
    s = [0.0, transition, turn.length - transition, turn.length]
    bend = [0.0, turn.curvature, turn.curvature, 0.0]
    assert np.degrees(np.trapezoid(bend, s)) == pytest.approx(hand * degrees)
    assert Element(straight).length == straight
    assert Element(straight).curvature == 0
