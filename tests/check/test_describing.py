"""A road is described as it was drawn."""

import pytest

from roadgpt.brief.plan import plan
from roadgpt.check.describing import describe
from roadgpt.road import Design, Segment, build

ROAD = Design(
    starting_point=(100.0, 20.0, -28.0),
    theta=90.0,
    segments=(
        Segment(distance=60.0, direction="straight", incline=0.0, turn_degrees=0.0),
        Segment(distance=40.0, direction="left", incline=0.0, turn_degrees=60.0),
        Segment(distance=70.0, direction="straight", incline=6.0, turn_degrees=0.0),
    ),
)


def test_turns_and_straights_are_named_in_driving_order() -> None:
    first, turn, last = describe(build(ROAD)).clauses
    assert (first.kind, turn.kind, last.kind) == ("straight", "turn", "straight")
    assert turn.side == "left"
    assert turn.degrees is not None
    assert turn.degrees.lo == pytest.approx(60, abs=1)
    assert first.slope == "flat"
    assert last.slope == "up"


def test_the_whole_road_has_length_and_climb() -> None:
    brief = describe(build(ROAD))
    assert brief.length is not None
    assert brief.length.lo == pytest.approx(170, abs=2)
    assert brief.climb is not None
    assert brief.climb.lo == pytest.approx(0.06 * 70, abs=1)


def test_a_straight_road_has_no_turns() -> None:
    brief = describe(
        build(
            Design(
                starting_point=(10.0, 20.0, -28.0),
                theta=45.0,
                segments=(Segment(distance=80.0, direction="straight", incline=0.0, turn_degrees=0.0),),
            )
        )
    )
    assert plan(brief) == "straight flat len=80 | turns=0 len=80"
