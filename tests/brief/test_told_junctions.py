"""Junctions that are told twice, totals of junctions, and nouns that can only mean a junction."""

import pytest

from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.readers.model.armed_junctions import with_told_arms
from roadgpt.brief.readers.model.junction_nouns import names_a_junction
from roadgpt.brief.readers.model.slots import slotted
from roadgpt.brief.readers.model.told_junctions import (
    has_told_kinds,
    most_of_kinds,
    number_of_listed,
    with_told_letter,
    with_told_total,
)


@pytest.mark.parametrize(
    ("words", "most"),
    [
        ("a crossroads where I have priority and the crossing road has stop signs", {"crossroads": 1}),
        ("two roads meet at a crossroads; you reach the crossroads uphill", {"crossroads": 2}),
        ("eine Kreuzung, dann ein Kreisverkehr, dritte Ausfahrt", {"crossroads": 1, "roundabout": 1}),
        ("a roundabout with five arms; the car leaves it at the third exit", {"roundabout": 1}),
        ("a roundabout, third exit, then a second one", {}),
        ("a roundabout that is 50 m across, third exit, then one that is smaller", {}),
        ("une fourche, puis un giratoire", {"y_junction": 1, "roundabout": 1}),
        ("a roundabout, then another", {}),
        ("two roundabouts and a crossroads", {"crossroads": 1, "roundabout": 2}),
        ("no left turns: three crossroads, two rights and one straight", {"crossroads": 3}),
        ("two roundabouts, then another", {}),
        ("two roundabouts and a few junctions", {}),
        ("straight over 2 crossroads", {"crossroads": 2}),
        ("an uphill road", {}),
    ],
)
def test_junctions_are_counted_unless_more_may_be_meant(words: str, most: dict[str, int]) -> None:
    assert most_of_kinds(slotted(words)) == most


def test_a_route_has_no_more_junctions_of_a_kind_than_are_told() -> None:
    twice, once = read_plan("crossroads // crossroads"), read_plan("crossroads // roundabout // t_junction")
    assert not has_told_kinds(twice, {"crossroads": 1})
    assert has_told_kinds(once, {"crossroads": 1})
    assert has_told_kinds(twice, {})


@pytest.mark.parametrize(
    ("words", "line", "wanted"),
    [
        (
            "four junctions in all; the first is a roundabout and the last a T-junction where I turn left",
            "roundabout // junction // junction // junction // t_junction left",
            "roundabout // junction // junction // t_junction left",
        ),
        (
            "insgesamt 3 Kreuzungen, die erste ein Kreisverkehr",
            "roundabout // junction // junction // junction",
            "roundabout // junction // junction",
        ),
        (
            "a route with five junctions, one of them a roundabout; at the last one, a T, left",
            "roundabout // junction // junction // junction // junction // t_junction left",
            "roundabout // junction // junction // junction // t_junction left",
        ),
        (
            "Strecke mit drei Knotenpunkten, darunter ein Kreisverkehr",
            "roundabout // junction",
            "roundabout // junction // junction",
        ),
        (
            "a route with three junctions and a roundabout",
            "junction // junction // junction // roundabout",
            "junction // junction // junction // roundabout",
        ),
        (
            "seven junctions would be too many, so three: roundabout, roundabout, crossroads",
            "roundabout // roundabout // crossroads",
            "roundabout // roundabout // crossroads",
        ),
        (
            "two crossroads in total, left, then right",
            "crossroads left // crossroads right // crossroads straight",
            "crossroads left // crossroads right // crossroads straight",
        ),
        (
            "four junctions in any order, exactly two with traffic lights for me",
            "junction lights // junction lights // junction",
            "junction lights // junction lights // junction // junction",
        ),
        (
            "la ruta pasa por tres intersecciones, las dos primeras en T, recto, y la última a la izquierda",
            "t_junction // t_junction // t_junction straight // t_junction straight // crossroads left",
            "t_junction straight // t_junction straight // crossroads left",
        ),
        (
            "the route has three junctions, the first two T-junctions, straight, and the last to the left",
            "t_junction // t_junction straight // t_junction straight // t_junction right // crossroads left",
            None,
        ),
        (
            "three junctions in all, then the ramp",
            "junction // merge ramp",
            "junction // merge ramp",
        ),
        (
            "insgesamt fünf Knoten, zwei Kreuzungen, zwei Einmündungen und ein Kreisverkehr",
            "crossroads // crossroads // t_junction // t_junction // t_junction // roundabout",
            "crossroads // crossroads // t_junction // t_junction // roundabout",
        ),
        (
            "four junctions in all, two crossroads and two T-junctions, the first crossroads with lights",
            "crossroads lights // crossroads // crossroads // t_junction // t_junction",
            "crossroads lights // crossroads // t_junction // t_junction",
        ),
        (
            "four junctions, one of them a fork",
            "y_junction // junction // junction // junction // junction",
            "y_junction // junction // junction // junction",
        ),
        (
            "after a bend four junctions, one of them a fork",
            "y_junction // junction // junction // junction // junction",
            None,
        ),
    ],
)
def test_a_total_adds_or_takes_away_only_junctions_of_no_kind(
    words: str, line: str, wanted: str | None
) -> None:
    assert plan(with_told_total(read_plan(line), slotted(words))) == (wanted or line)


@pytest.mark.parametrize(
    ("words", "number"),
    [
        ("five junctions: left at a T, straight over a crossroads", 5),
        ("Drei Kreuzungen: links, rechts, geradeaus", 3),
        ("left at a T, then two junctions: straight over both", None),
        ("five junctions, the first a T", None),
    ],
)
def test_a_number_of_junctions_before_their_list(words: str, number: int | None) -> None:
    assert number_of_listed(slotted(words)) == number


@pytest.mark.parametrize(
    ("words", "line", "wanted"),
    [
        (
            "Turn left at the three-way junction, then right at the crossroads",
            "crossroads left // crossroads right",
            "junction left arms=3 // crossroads right",
        ),
        (
            "a roundabout, then right at an intersection with five arms",
            "roundabout // crossroads right",
            "roundabout // star right arms=5",
        ),
        ("un cruce de cuatro brazos a la izquierda", "crossroads left", None),
        ("a three-way junction, then again one", "crossroads // crossroads", None),
        ("a three-way junction where I turn left", "t_junction left", None),
        ("a roundabout with five arms", "roundabout arms=5", None),
    ],
)
def test_the_arms_that_are_told_decide_the_kind(words: str, line: str, wanted: str | None) -> None:
    assert read_plan(plan(with_told_arms(read_plan(line), slotted(words)))) == read_plan(wanted or line)


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
    ("words", "line", "wanted"),
    [
        ("en el cruce en Y sigue por la izquierda", "crossroads left", "y_junction left"),
        ("au carrefour en T, à droite", "crossroads right", "t_junction right"),
        ("a un incrocio a T con semaforo giro a destra", "junction right lights", "t_junction right lights"),
        ("an einer Kreuzung in Form eines Y links", "crossroads left", "y_junction left"),
        ("a junction in the shape of a T, left", "junction left", "t_junction left"),
        ("en el cruce a la izquierda", "crossroads left", "crossroads left"),
        ("un cruce en T? no: oblicuo", "crossroads right skew", "crossroads right skew"),
        ("un cruce en Y, luego un cruce", "crossroads left // crossroads", "crossroads left // crossroads"),
    ],
)
def test_a_junction_has_the_letter_of_its_noun(words: str, line: str, wanted: str) -> None:
    assert plan(with_told_letter(read_plan(line), slotted(words))) == plan(read_plan(wanted))
