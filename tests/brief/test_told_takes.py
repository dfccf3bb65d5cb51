"""How often a route turns, told in no order."""

import pytest

from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.readers.model.slots import slotted
from roadgpt.brief.readers.model.told_takes import told_takes, with_told_takes


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ("I turn left exactly three times and never right", {"left": 3, "right": 0}),
        ("left at two of them and right at the other two, in any order", {"left": 2, "right": 2}),
        ("left twice, right once, straight on at two of these", {"left": 2, "right": 1, "straight": 2}),
        ("zweimal links, einmal rechts in beliebiger Reihenfolge", {"left": 2, "right": 1}),
        ("deux fois à gauche, jamais à droite", {"left": 2, "right": 0}),
        ("dos veces a la izquierda y una vez a la derecha", {"left": 2, "right": 1}),
        ("due volte a sinistra, mai a destra", {"left": 2, "right": 0}),
        ("Five junctions: two lefts, the rest straight on, the last a T.", {"left": 2}),
        ("two lefts, then a crossroads", {}),
        ("the road bends right twice, then left at the crossroads", {}),  # bends of the road
        ("left twice, no, make that left once, right once", {}),
        ("left at 150 m, right at 200 m", {}),
    ],
)
def test_numbers_of_ways_are_counted(words: str, told: dict[str, int]) -> None:
    assert told_takes(slotted(words)) == told


@pytest.mark.parametrize(
    ("words", "line", "wanted"),
    [
        (
            "six junctions, left exactly three times and never right",
            " // ".join(["junction left"] * 6),
            "junction left // junction left // junction left // junction straight // junction straight"
            " // junction straight",
        ),
        (
            "four crossroads, left at two of them and right at the other two",
            "crossroads straight lights // crossroads left // crossroads slight_right // crossroads right",
            "crossroads left lights // crossroads left // crossroads slight_right // crossroads right",
        ),
        ("left twice and right once", "crossroads left // t_junction left // crossroads right", None),
        ("left twice and right once", "crossroads left // roundabout exit=2 // crossroads left", None),
        ("left twice and right twice", "crossroads left // crossroads left", None),
    ],
)
def test_a_route_turns_as_often_as_told(words: str, line: str, wanted: str | None) -> None:
    found = with_told_takes(read_plan(line), slotted(words))
    assert plan(found) == plan(read_plan(wanted or line))
