"""Junctions that are told twice, totals of junctions, and nouns that can only mean a junction."""

import pytest

from roadgpt.brief import normal, read
from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.readers.model.junction_nouns import names_a_junction
from roadgpt.brief.readers.model.slots import slotted


@pytest.mark.parametrize(
    ("words", "line"),
    [
        ("two roads meet at a crossroads; you reach the crossroads uphill", "| up // crossroads"),
        ("a roundabout with five arms; the car leaves it at the third exit", "roundabout exit=3 arms=5"),
    ],
)
def test_a_junction_that_is_told_twice_is_one(words: str, line: str) -> None:
    assert plan(normal(read(words))) == plan(normal(read_plan(line)))


@pytest.mark.parametrize(
    ("words", "line"),
    [
        ("eine Kreuzung, dann ein Kreisverkehr, dritte Ausfahrt", "crossroads // roundabout exit=3"),
        ("une fourche, puis un giratoire", "y_junction // roundabout"),
        ("a roundabout, then another", "roundabout // roundabout"),
        ("two roundabouts and a crossroads", "roundabout // roundabout // crossroads"),
        ("straight over 2 crossroads", "crossroads straight // crossroads straight"),
        ("zwei Kreuzungen geradeaus", "crossroads straight // crossroads straight"),
    ],
)
def test_junctions_are_counted(words: str, line: str) -> None:
    assert plan(normal(read(words))) == plan(normal(read_plan(line)))


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (
            "four junctions in all; the first is a roundabout and the last a T-junction where I turn left",
            "roundabout // junction // junction // t_junction left",
        ),
        ("Strecke mit drei Knotenpunkten, darunter ein Kreisverkehr", "roundabout // junction // junction"),
        ("a route with three junctions and a roundabout", "junction // junction // junction // roundabout"),
        (
            "seven junctions would be too many, so three: roundabout, roundabout, crossroads",
            "roundabout // roundabout // crossroads",
        ),
        ("two crossroads in total, left, then right", "crossroads left // crossroads right"),
        (
            "insgesamt fünf Knoten, zwei Kreuzungen, zwei Einmündungen und ein Kreisverkehr",
            "crossroads // crossroads // t_junction // t_junction // roundabout",
        ),
        ("four junctions, one of them a fork", "y_junction // junction // junction // junction"),
        (
            "Drei Kreuzungen: links, rechts, geradeaus",
            "crossroads left // crossroads right // crossroads straight",
        ),
        (
            "left at a T, then two junctions: straight over both",
            "t_junction left // junction straight // junction straight",
        ),
    ],
)
def test_a_total_counts_the_junctions_that_are_listed_and_the_rest(words: str, line: str) -> None:
    assert plan(normal(read(words))) == plan(normal(read_plan(line)))


@pytest.mark.parametrize(
    ("words", "line"),
    [
        ("a roundabout, then right at an intersection with five arms", "roundabout // star right arms=5"),
        ("un cruce de cuatro brazos a la izquierda", "crossroads left"),
        ("a roundabout with five arms", "roundabout arms=5"),
    ],
)
def test_the_arms_that_are_told_decide_the_kind(words: str, line: str) -> None:
    assert plan(normal(read(words))) == plan(normal(read_plan(line)))


@pytest.mark.parametrize(
    ("words", "is_named"),
    [
        ("links mündet eine Nebenstraße ein", True),
        ("zwei Kreuzungen geradeaus", True),
        ("a roundabout, second exit", True),
        ("past a side road on the left", True),
        ("die Autobahn hat einen Verzögerungsstreifen von 200 m", True),
        ("une voie d'accélération de 150 m", True),
        ("a motorway with two lanes", False),
        ("the road crosses a hill, then turns left", False),
        ("a road with a fork-shaped tree", False),
        ("three turns and a hairpin", False),
    ],
)
def test_some_nouns_can_only_mean_a_junction(words: str, is_named: bool) -> None:
    assert names_a_junction(slotted(words).text) == is_named


@pytest.mark.parametrize(
    ("words", "line"),
    [
        ("en el cruce en Y sigue por la izquierda", "y_junction left"),
        ("au carrefour en T, à droite", "t_junction right"),
        ("a un incrocio a T con semaforo giro a destra", "t_junction right lights"),
        ("an einer Kreuzung in Form eines Y links", "y_junction left"),
        ("a junction in the shape of a T, left", "t_junction left"),
        ("un cruce en Y, luego un cruce", "y_junction // crossroads"),
    ],
)
def test_a_junction_has_the_letter_of_its_noun(words: str, line: str) -> None:
    assert plan(normal(read(words))) == plan(normal(read_plan(line)))
