"""Criteria: a road that does something else than was asked for fails in that criterion and in no other."""

from typing import Any

import pytest

from roadgpt.check.measures import RoadMeasures, measure
from roadgpt.check.truth import Truth, criteria_of
from roadgpt.road import Design, build, read_design


def road(*segments: tuple[str, float, float, float]) -> RoadMeasures:
    """Of (direction, distance, turn, incline)."""
    rows = [
        {"direction": way, "distance": far, "turn_degrees": turn, "incline": up}
        for way, far, turn, up in segments
    ]
    named = {f"road_segment{number}": row for number, row in enumerate(rows, 1)}
    data = {"starting_point": [20, 20, 0], "theta": 45, **named}
    design: Design = read_design(data)[0]
    return measure(build(design).centreline())


UP = road(
    ("straight", 30, 0, 5), ("left", 40, 60, 5), ("straight", 30, 0, 5), ("right", 40, 60, 5),
    ("straight", 30, 0, 5),
)  # fmt: skip
TWO = [{"kind": "turn", "dir": "left", "grade": "up"}, {"kind": "turn", "dir": "right", "grade": "up"}]


@pytest.mark.parametrize(
    ("truth", "broken"),
    [
        ({"turns": 2, "sequence": TWO}, set()),
        ({"turns": 3}, {"turns"}),
        ({"turns": 2, "grade": "down"}, {"incline"}),
        ({"sequence": [{"kind": "turn", "dir": "right"}, {"kind": "turn", "dir": "left"}]}, {"order"}),
        ({"sequence": [{"kind": "turn", "grade": "up"}, {"kind": "turn", "grade": "down"}]}, {"incline"}),
        ({"sequence": [{"kind": "turn", "deg": [80, 100]}, {"kind": "turn"}]}, {"extent"}),
        ({"left": 2, "length": [100, 300]}, {"turns"}),
        ({"max_grade": [None, 3]}, {"incline"}),
        ({"climb": [20, None]}, {"incline"}),
        ({"hilly": 1}, {"incline"}),
        ({"turning": [200, None]}, {"extent"}),
        ({"min_radius": [100, None]}, {"extent"}),
        ({"min_radius": [10, 60], "turning": [110, 130], "hilly": 0, "climb": [5, 15]}, set()),
        ({"alternating": True, "length": [500, None]}, {"extent"}),
        ({"ends": {"kind": "turn", "dir": "left"}}, {"order"}),
        ({"starts": {"kind": "straight", "grade": "up"}}, set()),
    ],
)
def test_one_thing_wrong(truth: dict[str, Any], broken: set[str]) -> None:
    found = criteria_of(UP, Truth.model_validate(truth).outline())
    assert {name for name, good in found.items() if not good} == broken | ({"general"} if broken else set())
    assert "general" in found


def test_what_nobody_asked_for_is_no_criterion() -> None:
    assert {*criteria_of(UP, Truth(turns=(2, 2)).outline())} == {"turns", "general"}
    found = criteria_of(UP, Truth.model_validate({"sequence": TWO}).outline())
    assert {*found} == {"turns", "incline", "order", "general"}


def test_a_road_that_is_too_short_keeps_nothing() -> None:
    stub = measure([[0, 0], [15, 0]])
    found = criteria_of(stub, Truth.model_validate({"turns": 0, "sequence": [], "grade": "flat"}).outline())
    assert not any(found.values())
