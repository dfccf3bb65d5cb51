"""Turns and junctions that words name by their places, in roads that were read wrongly."""

import pytest

from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.readers.model.numbered_junctions import with_numbered_junctions
from roadgpt.brief.readers.model.numbered_sides import with_numbered_sides
from roadgpt.brief.readers.model.ordinals import place_of, places_in
from roadgpt.brief.readers.model.slots import slotted


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
    ("words", "read", "meant"),
    [
        (
            "Drei Kurven, keine davon nach rechts außer der ersten",
            "turn x3 right",
            "turn right; turn x2 left",
        ),
        (
            "Siete curvas; ninguna va a la izquierda salvo la tercera y la sexta",
            "turn x7 right",
            "turn x2 right; turn left; turn x2 right; turn left; turn right",
        ),
        (
            "Cinq virages, dont deux à droite : le deuxième et le dernier",
            "turn x5 right",
            "turn left; turn right; turn x2 left; turn right",
        ),
        (
            "Cinque curve: la prima, la terza e la quinta a destra, le altre due a sinistra",
            "straight len=50; turn right; turn x2 left; turn right",  # a turn was lost
            "straight len=50; turn right; turn left; turn right; turn left; turn right",
        ),
        ("tre curve, tranne l'ultima tutte a sinistra", "turn x3 left", "turn x2 left; turn right"),
        ("four bends, only the second goes right", "turn x4 right", "turn left; turn right; turn x2 left"),
        (
            "four bends of 40 degrees; the first two to the left, the last two to the right",
            "turn x4 left deg=40",
            "turn x2 left deg=40; turn x2 right deg=40",
        ),
        (
            "three bends, the middle one to the right, the rest left",
            "turn x3 left",
            "turn left; turn right; turn left",
        ),
        (
            "Six turns. From the third on they all go right; the first two don't.",
            "turn x6",
            "turn x2 left; turn x4 right",
        ),
        (
            "Ab der dritten Kurve keine Linkskurve mehr, davor nur Linkskurven, insgesamt fünf Kurven.",
            "turn x4 left; turn right",
            "turn x2 left; turn x3 right",
        ),
        (
            "quattro curve: dalla seconda in poi nessuna va a sinistra, la prima sì",
            "turn x4",
            "turn left; turn x3 right",
        ),
        (
            "due tornanti: il primo gira a sinistra, il secondo no",
            "hairpin x2 left",
            "hairpin left; hairpin right",
        ),
        ("three turns, only one of which is a right", "turn x3 left", "turn x3 | lefts=2 rights=1"),
        ("vier Kurven, davon nur eine nach links", "turn x4 left", "turn x4 | lefts=1 rights=3"),
        (
            "two hairpins and then a bend, all three to the left but the first",
            "hairpin x2 left; turn right",
            "hairpin right; hairpin left; turn left",
        ),
    ],
)
def test_turns_lead_to_the_sides_that_are_told(words: str, read: str, meant: str) -> None:
    assert plan(with_numbered_sides(read_plan(read), slotted(words))) == plan(read_plan(meant))


@pytest.mark.parametrize(
    ("words", "read"),
    [
        ("four bends, the second one to the right", "turn x4 left"),  # nothing is said of the others
        ("four bends, the second one not to the right but to the left, the others right", "turn x4 left"),
        ("four bends, the first, sorry, the second to the right, the others left", "turn x4 left"),
        ("four bends, the fifth to the right, the others left", "turn x4 left"),
        ("an S-bend, the first turn to the left, the second to the right", "s_bend left"),
        ("8 virages, dont 2 pas à gauche", "turn x8 | lefts=6 rights=2"),
        (
            "six bends, none left but the last two. After these 4 left curves",
            "turn x4 right; turn x2 left; turn x4 left up",
        ),
        ("una curva a la derecha, otra a la izquierda y una tercera a la derecha", "turn x3 right"),
        ("three bends that alternate, the first to the left, the rest right", "turn x3 left alternating"),
        ("the first crossroads to the left, the rest right", "crossroads left // crossroads right"),
    ],
)
def test_sides_that_are_not_clear_stay(words: str, read: str) -> None:
    assert with_numbered_sides(read_plan(read), slotted(words)) == read_plan(read)


@pytest.mark.parametrize(
    ("words", "read", "meant"),
    [
        (
            "Four crossroads. Lights only at the second of them.",
            "crossroads // crossroads // crossroads // crossroads lights",
            "crossroads // crossroads lights // crossroads // crossroads",
        ),
        (
            "five crossroads, stop signs at the first and the last and lights at the other three",
            " // ".join(["crossroads stop"] * 5),
            " // ".join(["crossroads stop", *["crossroads lights"] * 3, "crossroads stop"]),
        ),
        (
            "Drei Kreuzungen: Stoppschild an der ersten und letzten, Ampel an der zweiten",
            "crossroads // crossroads stop // crossroads lights",
            "crossroads stop // crossroads lights // crossroads stop",
        ),
        (
            "trois carrefours, des feux au deuxième, un stop aux deux autres",
            "crossroads // crossroads // crossroads",
            "crossroads stop // crossroads lights // crossroads stop",
        ),
        (
            "tres cruces; el segundo tiene semáforo y los demás tienen stop",
            "crossroads // crossroads // crossroads",
            "crossroads stop // crossroads lights // crossroads stop",
        ),
        (
            "tre incroci, semaforo solo all'ultimo, al primo a sinistra",
            "crossroads lights // crossroads // crossroads",
            "crossroads left // crossroads // crossroads lights",
        ),
        (
            "left at a T, right at a crossroads, second exit at a roundabout. I have priority at the first"
            " junction.",
            "t_junction left // crossroads right priority // roundabout exit=2",
            "t_junction left priority // crossroads right // roundabout exit=2",
        ),
        (
            "Five crossroads. Turn right at the first and the fourth, go straight over at the rest. All but"
            " the last have traffic lights.",
            "crossroads right // crossroads left // crossroads // crossroads straight // crossroads lights",
            "crossroads right lights // crossroads straight lights // crossroads straight lights"
            " // crossroads right lights // crossroads straight",
        ),
        (
            "a crossroads, a roundabout and a crossroads; a stop sign at the second crossroads",
            "crossroads stop // roundabout // crossroads",
            "crossroads // roundabout // crossroads stop",
        ),
        (
            "straight over two crossroads with lights, left at the third",
            "crossroads straight // crossroads straight // crossroads left lights",
            "crossroads straight lights // crossroads straight lights // crossroads left",
        ),
        (
            "passer devant deux rues latérales à droite où l'on a la priorité, puis un rond-point",
            "t_junction straight // t_junction straight priority // roundabout",
            "t_junction straight priority // t_junction straight priority // roundabout",
        ),
        (
            "Four T-junctions, priority at all of them except the last, where there is a stop sign for me",
            " // ".join(["t_junction priority"] * 4),
            "t_junction priority // t_junction priority // t_junction priority // t_junction stop",
        ),
        (
            "A T, crossroads, a T and crossroads. Left at both T-junctions, straight on at both crossroads.",
            "t_junction left // crossroads left // t_junction left // crossroads straight",
            "t_junction left // crossroads straight // t_junction left // crossroads straight",
        ),
        (
            "Three crossroads, all with traffic lights but the last, which has a stop sign for me.",
            "crossroads lights // crossroads stop // crossroads",
            "crossroads lights // crossroads lights // crossroads stop",
        ),
        (
            "Three crossroads, the first and the second have lights, at the third the others have to stop",
            "crossroads lights // crossroads priority others_stop // crossroads priority others_stop",
            "crossroads lights // crossroads lights // crossroads priority others_stop",
        ),
        (
            "Three crossroads, straight over every one of them except the second, where I turn left",
            " // ".join(["crossroads straight"] * 3),
            "crossroads straight // crossroads left // crossroads straight",
        ),
        (
            "Drei Kreuzungen, geradeaus an jeder außer der ersten, wo wir nach links abbiegen",
            " // ".join(["crossroads straight"] * 3),
            "crossroads left // crossroads straight // crossroads straight",
        ),
        (
            "Three crossroads in a row, straight over all but the last.",
            "crossroads straight // crossroads straight // crossroads straight",
            "crossroads straight // crossroads straight // crossroads right",
        ),
        (
            "you have priority everywhere, straight over a crossroads, then left at a T-junction",
            "crossroads straight priority // t_junction left",
            "crossroads straight priority // t_junction left priority",
        ),
        (
            "two crossroads, only the second is with traffic lights on every approach",
            "crossroads lights all_way // crossroads",
            "crossroads // crossroads lights all_way",
        ),
    ],
)
def test_junctions_have_what_is_told_of_their_places(words: str, read: str, meant: str) -> None:
    found = with_numbered_junctions(read_plan(read), slotted(words))
    assert plan(found) == plan(read_plan(meant))


@pytest.mark.parametrize(
    ("words", "read"),
    [
        ("at the first junction turn left, sorry, right", "junction right // crossroads"),
        ("two crossroads, no lights at the first", "crossroads // crossroads lights"),
        (
            "two crossroads and a roundabout, lights at the second",
            "crossroads lights // roundabout // crossroads",
        ),
        ("two crossroads; take the road on the left at the second exit", "crossroads // crossroads"),
        ("a side road on the right at the second junction", "crossroads // t_junction straight"),
        ("two crossroads, lights at the third", "crossroads lights // crossroads"),
        ("two crossroads, I give priority at the first", "crossroads yield // crossroads"),
        (
            "Zwei Einmündungen, an der ersten zweigt sie links ab",
            "t_junction straight ways=left+straight // t_junction",
        ),
        (
            "two crossroads, the side roads have to stop at both",
            "crossroads priority others_stop // crossroads priority",
        ),
        ("left at the second roundabout", "roundabout exit=1 // roundabout exit=3"),
        (
            "a crossroads, then two crossroads with lights",
            "crossroads // crossroads lights // crossroads lights",
        ),
    ],
)
def test_junctions_of_which_nothing_clear_is_told_stay(words: str, read: str) -> None:
    assert with_numbered_junctions(read_plan(read), slotted(words)) == read_plan(read)
