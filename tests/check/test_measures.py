import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from paper_roads import road_of, straight, turn
from roadgpt.check.measures import measure, way
from roadgpt.road import Design, Segment, build
from strategies import designs


def line_of(*segments: Segment) -> np.ndarray:
    return road_of(*segments).centreline()


def test_a_left_and_a_right_turn_with_straights_around_them() -> None:
    found = measure(line_of(straight(40), turn(60, 30), straight(50), turn(-45, 50), straight(30)))
    assert [feature.kind for feature in found.features] == [
        "straight",
        "turn",
        "straight",
        "turn",
        "straight",
    ]
    first, second = found.turns
    assert (first.side, second.side) == ("left", "right")
    assert (first.degrees, second.degrees) == pytest.approx((60, 45), abs=0.5)
    assert (first.radius, second.radius) == pytest.approx((30, 50), rel=0.02)
    assert [s.length for s in found.straights] == pytest.approx([40, 50, 30], abs=4)
    assert found.length == pytest.approx(120 + 30 * np.radians(60) + 50 * np.radians(45) + 12, abs=0.1)
    assert found.turning == pytest.approx(105, abs=1)
    assert found.radius == pytest.approx(30, rel=0.02)
    assert (found.count("left"), found.count("right")) == (1, 1)
    assert [len(gap) for gap in found.gaps] == [1, 1, 1]


@pytest.mark.parametrize(("gap", "number"), [(4, 1), (16.5, 2), (30, 2)])
def test_turns_of_one_hand_are_two_only_with_room_between_them(gap: float, number: int) -> None:
    found = measure(line_of(straight(30), turn(45), straight(gap), turn(45), straight(30)))
    assert len(found.turns) == number
    assert sum(turn.degrees for turn in found.turns) == pytest.approx(90, abs=1)


def test_turns_of_opposite_hands_are_two_without_any_straight() -> None:
    found = measure(line_of(straight(30), turn(45), turn(-45), straight(30)))
    assert [turn.side for turn in found.turns] == ["left", "right"]
    assert len(found.straights) == 2


def test_a_kink_of_less_than_ten_degrees_is_no_turn() -> None:
    assert not measure(line_of(straight(30), turn(8), straight(30))).turns
    assert len(measure(line_of(straight(30), turn(12), straight(30))).turns) == 1


def test_a_straight_is_cut_where_its_grade_changes_class() -> None:
    found = measure(line_of(straight(60, 6), straight(60, 0), straight(60, -6)))
    (whole,) = found.features
    assert [way(piece.grade) for piece in whole.pieces] == ["up", "flat", "down"]
    assert whole.grade == pytest.approx(0, abs=0.1)
    assert found.hills == 1
    assert found.steepest == pytest.approx(6, abs=0.01)
    assert (found.lowest_grade, found.highest_grade) == pytest.approx((-6, 6), abs=0.01)


@settings(max_examples=60, deadline=None)
@given(designs(), st.floats(0, 6.3), st.floats(-50, 50))
def test_where_a_road_lies_does_not_matter(design: Design, angle: float, shift: float) -> None:
    points = build(design).centreline()
    cos, sin = np.cos(angle), np.sin(angle)
    moved = points @ np.array([[cos, sin, 0], [-sin, cos, 0], [0, 0, 1]]) + shift
    one, other = measure(points), measure(moved)
    assert one.length == pytest.approx(other.length, abs=1e-6)
    assert one.turning == pytest.approx(other.turning, abs=1e-6)
    assert one.climb == pytest.approx(other.climb, abs=1e-6)
    assert one.radius == pytest.approx(other.radius, rel=1e-4)


@settings(max_examples=60, deadline=None)
@given(designs())
def test_a_mirror_swaps_left_and_right_and_nothing_else(design: Design) -> None:
    points = build(design).centreline()
    one, other = measure(points), measure(points * [1, -1, 1])
    swapped = {"left": "right", "right": "left", None: None}
    assert [(f.kind, swapped[f.side]) for f in one.features] == [(f.kind, f.side) for f in other.features]
    assert (one.count("left"), one.count("right")) == (other.count("right"), other.count("left"))
    assert one.hills == other.hills


@settings(max_examples=60, deadline=None)
@given(designs())
def test_features_lie_in_order_within_the_road(design: Design) -> None:
    found = measure(build(design).centreline())
    ends = [at for feature in found.features for at in (feature.start, feature.end)]
    assert ends == sorted(ends)
    assert not ends or (ends[0] >= 0 and ends[-1] <= found.length)
    assert all(feature.length >= 10 for feature in found.straights)
    assert all(feature.degrees >= 10 for feature in found.turns)
    assert len(found.gaps) == len(found.turns) + 1
