"""Turns and junctions that words name by their places: the first, the last but one, the others."""

import pytest

from roadgpt.brief import read
from roadgpt.brief.normal import normal
from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.readers.model.ordinals import place_of, places_in


@pytest.mark.parametrize(
    ("words", "number", "places"),
    [
        ("the first and the last", 4, {0, 3}),
        ("the first 2", 5, {0, 1}),
        ("die letzten beiden", 5, {3, 4}),
        ("the middle", 5, {2}),
        ("the middle", 4, None),
        ("le premier , le troisieme et l ' avant - dernier", 6, {0, 2, 4}),
        ("la segunda y la quinta", 5, {1, 4}),
        ("la segunda y la quinta", 4, None),
        ("l ' ultimo", 3, {2}),
        ("les premiers", 3, None),  # how many is not said
        ("the second 2", 5, None),
        ("the second - to - last", 7, {5}),
    ],
)
def test_places_in_a_row(words: str, number: int, places: set[int] | None) -> None:
    assert places_in(words, number) == places


@pytest.mark.parametrize(
    ("word", "place"),
    [("third", 3), ("dritter", 3), ("dernieres", -1), ("penultima", -2), ("thirteen", None)],
)
def test_places_of_ordinals(word: str, place: int | None) -> None:
    assert place_of(word) == place


@pytest.mark.parametrize(
    ("words", "wanted"),
    [
        ("Drei Kurven, keine davon nach rechts außer der ersten", "turn right; turn x2 left"),
        (
            "Siete curvas; ninguna va a la izquierda salvo la tercera y la sexta",
            "turn x2 right; turn left; turn x2 right; turn left; turn right",
        ),
        (
            "Cinque curve: la prima, la terza e la quinta a destra, le altre due a sinistra",
            "turn right; turn left; turn right; turn left; turn right",
        ),
        ("four bends, only the second goes right", "turn left; turn right; turn x2 left"),
        ("four bends, the second one to the right", "turn; turn right; turn x2"),
        (
            "four bends of 40 degrees; the first two to the left, the last two to the right",
            "turn x2 left deg=40; turn x2 right deg=40",
        ),
        ("three bends, the middle one to the right, the rest left", "turn left; turn right; turn left"),
        (
            "Six turns. From the third on they all go right; the first two don't.",
            "turn x2 left; turn x4 right",
        ),
        (
            "Ab der dritten Kurve keine Linkskurve mehr, davor nur Linkskurven, insgesamt fünf Kurven.",
            "turn x2 left; turn x3 right",
        ),
        (
            "quattro curve: dalla seconda in poi nessuna va a sinistra, la prima sì",
            "turn left; turn x3 right",
        ),
        ("due tornanti: il primo gira a sinistra, il secondo no", "hairpin left; hairpin right"),
        ("three turns, only one of which is a right", "turn x3 | lefts=2 rights=1"),
        ("vier Kurven, davon nur eine nach links", "turn x4 | lefts=1 rights=3"),
        ("8 virages, dont 2 pas à gauche", "turn x8 | lefts=6 rights=2"),
        (
            "four bends, the second one not to the right but to the left, the others right",
            "turn right; turn left; turn x2 right",
        ),
        (
            "four bends, the first, sorry, the second to the right, the others left",
            "turn left; turn right; turn x2 left",
        ),
        (
            "una curva a la derecha, otra a la izquierda y una tercera a la derecha",
            "turn right; turn left; turn right",
        ),
        ("an S-bend, the first turn to the left, the second to the right", "s_bend left"),
    ],
)
def test_turns_lead_to_the_sides_that_are_told(words: str, wanted: str) -> None:
    assert plan(normal(read(words))) == plan(normal(read_plan(wanted)))


@pytest.mark.parametrize(
    ("words", "wanted"),
    [
        (
            "Four crossroads. Lights only at the second of them.",
            "crossroads // crossroads lights // crossroads // crossroads",
        ),
        (
            "five crossroads, stop signs at the first and the last and lights at the other three",
            "crossroads stop // crossroads lights // crossroads lights // crossroads lights"
            " // crossroads stop",
        ),
        (
            "Drei Kreuzungen: Stoppschild an der ersten und letzten, Ampel an der zweiten",
            "crossroads stop // crossroads lights // crossroads stop",
        ),
        (
            "trois carrefours, des feux au deuxième, un stop aux deux autres",
            "crossroads stop // crossroads lights // crossroads stop",
        ),
        (
            "tres cruces; el segundo tiene semáforo y los demás tienen stop",
            "crossroads stop // crossroads lights // crossroads stop",
        ),
        (
            "tre incroci, semaforo solo all'ultimo, al primo a sinistra",
            "crossroads left // crossroads // crossroads lights",
        ),
        (
            "left at a T, right at a crossroads, second exit at a roundabout. I have"
            " priority at the first junction.",
            "t_junction left priority // crossroads right // roundabout exit=2",
        ),
        (
            "passer devant deux rues latérales à droite où l'on a la priorité, puis un rond-point",
            "t_junction straight priority ways=right+straight // t_junction straight"
            " priority ways=right+straight // roundabout",
        ),
        (
            "Four T-junctions, priority at all of them except the last, where there is a stop sign for me",
            "t_junction priority // t_junction priority // t_junction priority // t_junction stop",
        ),
        (
            "A T, crossroads, a T and crossroads. Left at both T-junctions, straight on at both crossroads.",
            "t_junction left // crossroads straight // t_junction left // crossroads straight",
        ),
        (
            "Three crossroads, all with traffic lights but the last, which has a stop sign for me.",
            "crossroads lights // crossroads lights // crossroads stop",
        ),
        (
            "Three crossroads, straight over every one of them except the second, where I turn left",
            "crossroads straight // crossroads left // crossroads straight",
        ),
        (
            "you have priority everywhere, straight over a crossroads, then left at a T-junction",
            "crossroads straight priority // t_junction left priority",
        ),
        (
            "two crossroads, the side roads have to stop at both",
            "crossroads priority others_stop // crossroads priority others_stop",
        ),
        (
            "two crossroads and a roundabout, lights at the second",
            "crossroads // crossroads lights // roundabout",
        ),
        (
            "a crossroads, then two crossroads with lights",
            "crossroads // crossroads lights // crossroads lights",
        ),
        ("the first crossroads to the left, the rest right", "crossroads left // crossroads right"),
    ],
)
def test_junctions_have_what_is_told_of_their_places(words: str, wanted: str) -> None:
    assert plan(normal(read(words))) == plan(normal(read_plan(wanted)))
