"""Sharp bends before skew crossroads, and the lanes of the motorway that a route joins."""

import pytest

from roadgpt.brief import normal, read
from roadgpt.brief.plan import plan, read_plan


@pytest.mark.parametrize(
    ("words", "line"),
    [
        ("a sharp left bend, left at a skew crossroads", "turn left sharp // crossroads left skew"),
        ("sharp right, then left at a skew crossroads", "turn right sharp // crossroads left skew"),
    ],
)
def test_a_sharp_bend_is_no_sharp_side_at_a_skew_crossroads(words: str, line: str) -> None:
    assert plan(normal(read(words))) == plan(normal(read_plan(line)))


@pytest.mark.parametrize(
    ("words", "line"),
    [
        ("on-ramp onto a three-lane motorway", "merge ramp // | motorway lanes=3"),
        ("join the 2-lane freeway", "merge ramp // | motorway lanes=2"),
        ("Auffahrt auf eine dreispurige Autobahn", "merge ramp // | motorway lanes=3"),
        ("rejoindre une autoroute à deux voies", "merge ramp // | motorway lanes=2"),
        ("me incorporo a una autopista de tres carriles", "merge ramp // | motorway lanes=3"),
        ("entro in un'autostrada a tre corsie", "merge ramp // | motorway lanes=3"),
    ],
)
def test_the_lanes_of_the_motorway_that_is_joined(words: str, line: str) -> None:
    assert plan(normal(read(words))) == plan(normal(read_plan(line)))
