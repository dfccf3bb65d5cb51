"""Lengths that words give to the first or the last road of a route, or to a whole route without junctions."""

import pytest

from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.readers.model.route_lengths import (
    with_length_of_route,
    with_length_past_lanes,
    with_lengths_of_ends,
)
from roadgpt.brief.readers.model.slots import slotted

CHANGE = "lane_change right"


@pytest.mark.parametrize(
    ("words", "read", "meant"),
    [
        ("a road that reaches a fork after about 100 m", "y_junction left", "| len=100 // y_junction left"),
        ("die Straße erreicht nach 90 m einen Kreisel", "roundabout exit=2", "| len=90 // roundabout exit=2"),
        (
            "a road reaches a fork after 100 m, keep left and finish 80 m beyond it.",
            "y_junction left",
            "| len=100 // y_junction left // | len=80",
        ),
        ("links an der Gabel, Ende 80 m dahinter", "y_junction left", "y_junction left // | len=80"),
        (
            "left at the fork and end 80 m after it",
            "y_junction left // | len=80",
            "y_junction left // | len=80",
        ),
        ("left at the fork, reach a crossroads after 100 m", "y_junction left // crossroads", None),
        ("left at the fork, stop 80 m before the lights", "y_junction left // crossroads lights", None),
        ("left at the fork and end 80 m after it, no, 90 m", "y_junction left", None),
    ],
)
def test_lengths_of_the_ends_are_added(words: str, read: str, meant: str | None) -> None:
    found = with_lengths_of_ends(read_plan(read), slotted(words))
    assert plan(found) == plan(read_plan(meant or read))


@pytest.mark.parametrize(
    ("words", "read", "meant"),
    [
        (
            "one-way, two lanes, 200 m dead straight. Change to the right.",
            f"straight len=200 | turns=0 lanes=2 oneway // {CHANGE}",
            f"straight | turns=0 lanes=2 oneway // {CHANGE} || len=200",
        ),
        (
            "autoroute, 1200 m, on change de voie à droite",
            f"| motorway len=1200 // {CHANGE}",
            f"| motorway // {CHANGE} || len=1200",
        ),
        (
            "Motorway, two lanes, 1500 m. An entry joins, later an exit leaves.",
            "| motorway lanes=2 len=1500 // merge main // diverge main",
            "| motorway lanes=2 // merge main // diverge main || len=1500",
        ),
        (
            "Motorway, 800 m, then the exit. The ramp bends.",
            "| motorway len=800 // diverge ramp",
            None,
        ),
        ("Motorway, 800 m, exit.", "| motorway len=800 // diverge ramp", None),
        ("after 200 m change to the right", f"| len=200 // {CHANGE}", None),
        ("two lanes, 200 m, then change to the right", f"| lanes=2 len=200 // {CHANGE}", None),
        ("two lanes, 200 m and the right one ends", "| lanes=2 len=200 // lane_drop side=right", None),
        ("two lanes, 200 m, change right, 90 m", f"| lanes=2 len=200 // {CHANGE} // | len=90", None),
        ("200 m, left at the crossroads", "| len=200 // crossroads left", None),
    ],
)
def test_a_length_between_commas_is_that_of_a_route_without_junctions(
    words: str, read: str, meant: str | None
) -> None:
    found = with_length_past_lanes(read_plan(read), slotted(words))
    assert plan(found) == plan(read_plan(meant or read))


@pytest.mark.parametrize(
    ("words", "read", "meant"),
    [
        (
            "Motorway section of 600 m without junctions, after 300 m reduced to two lanes",
            "| motorway lanes=3 len=300 // lane_drop",
            "| motorway lanes=3 len=300 // lane_drop || len=600",
        ),
        (
            "Straße von 600 m ohne Kreuzungen, eine Spur endet",
            "| lanes=2 len=600 // lane_drop",
            "| lanes=2 // lane_drop || len=600",
        ),
        ("after 600 m without junctions a lane ends", "| lanes=2 len=600 // lane_drop", None),
        ("Road of 600 m without lights, left at the fork", "| len=600 // y_junction left", None),
    ],
)
def test_a_road_without_junctions_is_as_long_as_its_first_words_say(
    words: str, read: str, meant: str | None
) -> None:
    found = with_length_of_route(read_plan(read), slotted(words))
    assert plan(found) == plan(read_plan(meant or read))
