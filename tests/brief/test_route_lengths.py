"""Lengths that words give to the first or the last road of a route, or to a whole route without junctions."""

import pytest

from roadgpt.brief import normal, read
from roadgpt.brief.plan import plan, read_plan


@pytest.mark.parametrize(
    ("words", "line"),
    [
        ("a road that reaches a fork after about 100 m, keep left", "| len=100 // y_junction left"),
        ("a road that reaches a fork after about 100 m", "| len=100 // y_junction"),
        ("die Straße erreicht nach 90 m einen Kreisel", "| len=90 // roundabout"),
        (
            "a road reaches a fork after 100 m, keep left and finish 80 m beyond it.",
            "| len=100 // y_junction left // | len=80",
        ),
        ("links an der Gabel, Ende 80 m dahinter", "y_junction left // | len=80"),
        ("left at the fork and end 80 m after it", "y_junction left // | len=80"),
        ("left at the fork, reach a crossroads after 100 m", "y_junction left // | len=100 // crossroads"),
        ("left at the fork and end 80 m after it, no, 90 m", "y_junction left // | len=90"),
    ],
)
def test_lengths_of_the_ends_are_those_of_their_roads(words: str, line: str) -> None:
    assert plan(normal(read(words))) == plan(normal(read_plan(line)))


@pytest.mark.parametrize(
    ("words", "line"),
    [
        ("Motorway, 800 m, then the exit. The ramp bends.", "| motorway len=800 // diverge ramp // turn"),
        ("Motorway, 800 m, exit.", "| motorway len=800 // diverge ramp"),
        ("after 200 m change to the right", "| len=200 // lane_change right"),
        ("two lanes, 200 m, then change to the right", "| lanes=2 len=200 // lane_change right"),
        ("two lanes, 200 m and the right one ends", "| lanes=2 len=200 // lane_drop side=right"),
        ("two lanes, 200 m, change right, 90 m", "| lanes=2 len=200 // lane_change right // | len=90"),
        ("200 m, left at the crossroads", "| len=200 // crossroads left"),
        ("after 600 m without junctions a lane ends", "| len=600 // lane_drop"),
    ],
)
def test_a_length_before_a_place_is_that_of_the_road_to_it(words: str, line: str) -> None:
    assert plan(normal(read(words))) == plan(normal(read_plan(line)))


def test_a_road_without_junctions_is_as_long_as_its_first_words_say() -> None:
    words = "Straße von 600 m ohne Kreuzungen, eine Spur endet"
    line = "lane_drop || len=600"
    assert plan(normal(read(words))) == plan(normal(read_plan(line)))
