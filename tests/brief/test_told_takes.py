"""How often a route turns, told in no order."""

import pytest

from roadgpt.brief import normal, read
from roadgpt.brief.plan import plan, read_plan


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (
            "four crossroads, left at two of them and right at the other two",
            "crossroads left // crossroads left // crossroads right // crossroads right",
        ),
        (
            "four crossroads, left at two of them and right at the other two, in any order",
            "crossroads left // crossroads left // crossroads right // crossroads right",
        ),
        ("three junctions, left twice and right once", "junction left // junction left // junction right"),
        (
            "drei Kreuzungen, zweimal links, einmal rechts in beliebiger Reihenfolge",
            "crossroads left // crossroads left // crossroads right",
        ),
        (
            "trois carrefours, deux fois à gauche, une fois à droite",
            "crossroads left // crossroads left // crossroads right",
        ),
        (
            "tres cruces, dos veces a la izquierda y una vez a la derecha",
            "crossroads left // crossroads left // crossroads right",
        ),
        (
            "tre incroci, due volte a sinistra, una volta a destra",
            "crossroads left // crossroads left // crossroads right",
        ),
    ],
)
def test_a_route_turns_as_often_as_told(words: str, line: str) -> None:
    assert plan(normal(read(words))) == plan(normal(read_plan(line)))


@pytest.mark.parametrize(
    ("words", "line"),
    [
        ("the road bends right twice, then left at the crossroads", "turn x2 right // crossroads left"),
        ("two lefts, then a crossroads", "turn x2 left // crossroads"),
    ],
)
def test_bends_before_a_junction_are_no_ways_at_it(words: str, line: str) -> None:
    assert plan(normal(read(words))) == plan(normal(read_plan(line)))
