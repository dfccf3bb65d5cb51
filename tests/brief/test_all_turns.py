"""Words about all turns: how many alternate, what none of them may be, what all but one are."""

import pytest

from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.readers.model.all_turns import with_words_of_all_turns
from roadgpt.brief.readers.model.closed_loops import asks_for_a_closed_loop
from roadgpt.brief.readers.model.plan_choice import brief_of
from roadgpt.brief.readers.model.slots import slotted


def corrected(words: str, written: str) -> str:
    return plan(with_words_of_all_turns(read_plan(written), slotted(words)))


FIVE = "turn left r=30; turn right r=30; turn left r=30; turn right r=30; turn left r=30"


@pytest.mark.parametrize(
    ("words", "written", "right"),
    [
        (
            "five bends, alternating, the first to the left, each with a radius of 30 m",
            "turn left r=30; turn right r=30; turn left r=30; turn right r=30",
            FIVE,
        ),
        ("fünf Bögen im Wechsel, erst links, Radius 30 m", f"{FIVE}; turn right r=30", FIVE),
        (
            "tranne l'ultima, che è un tornante a sinistra, nessuna curva supera i 40 gradi",
            "turn x3; hairpin left | deg=..40",
            "turn x3 deg=..40; hairpin left",
        ),
        ("no turn over 40 degrees, and a hairpin", "turn x3; hairpin left | deg=..40", None),  # cannot be
        ("four bends, none under 40 m radius, last one right", "turn x3 r=40..; turn right", None),
        ("vier Kurven, keine davon mehr als 60 Grad", "turn x2; turn x2 deg=..60", None),
        ("no bend under 60 degrees, left then right", "turn left deg=60..; turn right", None),
        ("six bends, all but the last to the left", "turn x5 left; turn", "turn x5 left; turn right"),
        (
            "sechs Kurven, alle außer der letzten nach rechts",
            "turn x5 right; turn",
            "turn x5 right; turn left",
        ),
        (
            "five turns of the same radius but different angles",
            "turn x5 | alike",
            "turn x5 | beside(compared)",
        ),
        ("quattro curve tutte diverse", "turn x4 | alike", "turn x4 | beside(compared)"),
        (
            "evenly spaced, each sharper than the one before",
            "turn x5 | alike beside(compared)",
            "turn x5 | beside(compared)",
        ),
        (
            "six corners, all with 20 m radius, 2 of them hairpins",
            "hairpin x2; turn x4 r=20",
            "hairpin x2 r=20; turn x4 r=20",
        ),
        ("cinco curvas, todas de 40 grados", "turn x2; turn x3 deg=40", "turn x2 deg=40; turn x3 deg=40"),
        (
            "three lefts, all with 30 m radius, then two rights",
            "turn x3 left r=30; turn x2 right",
            "turn x3 left r=30; turn x2 right",
        ),
        (
            "fünf Kurven, alle 30 Grad bis auf eine Kehre",
            "turn x4 deg=30; hairpin",
            "turn x4 deg=30; hairpin",
        ),
        (
            "six bends of 20 m, all of them 20 degrees",
            "turn x2 deg=20 r=20; turn x4 deg=20",
            "turn x2 deg=20 r=20; turn x4 deg=20",
        ),
        ("alle Kurven nach rechts bis auf die erste", "turn; turn x3 right", "turn left; turn x3 right"),
    ],
)
def test_what_follows_for_all_turns_is_put_right(words: str, written: str, right: str | None) -> None:
    found = corrected(words, written)
    if right is not None:
        assert found == right
        return
    limited = read_plan(found)
    assert limited.radius or limited.degrees
    assert all(not (c.radius or c.degrees) for c in limited.clauses)
    assert [c.side for c in limited.clauses] == [c.side for c in read_plan(written).clauses]


@pytest.mark.parametrize(
    ("words", "written"),
    [
        ("three pairs of bends, left then right", "turn left; turn right; turn left; turn right; turn left"),
        ("Ensayo 7: izquierda, derecha y otra vez", "turn left; turn right; turn left"),
        ("left, right, left, 3 of them", "turn left; turn right; turn left"),
        ("5 bends, 2 of them tight: right, left, right", "turn right; turn left; turn right"),
        ("five bends left and right, the first wide", "turn left gentle; turn right; turn left"),
        ("a last hairpin of no more than 20 m and three turns", "turn x3; hairpin r=..20"),
        ("none of the turns is tight, the last one has 40 m", "turn x2; turn r=40"),
        ("all turns to the left but one, which is to the right", "turn x3 left; turn"),
        ("four turns to the left, then one", "turn x4 left; turn"),
        ("all downhill: two lefts, but then a hairpin", "turn x2 left down; hairpin down"),
        ("a turn to the left on each climb, but then one more turn", "turn left; turn"),
        ("three equal turns", "turn x3 | alike"),
    ],
)
def test_other_words_change_nothing(words: str, written: str) -> None:
    assert corrected(words, written) == written


@pytest.mark.parametrize(
    ("words", "written", "right"),
    [
        ("a slalom of six turns, left one first", "slalom left", "slalom x6 left"),
        ("ein Slalom mit acht Kurven", "slalom", "slalom x8"),
        ("six slaloms", "slalom", "slalom"),
        ("a slalom and six bends", "slalom; turn x6", "slalom; turn x6"),
        (
            "a chicane, 40 degrees each turn, after a straight of 60 m",
            "turn left; turn right; straight len=60",
            "straight len=60; turn left; turn right",
        ),
        (
            "una chicane izquierda-derecha después de una recta de 60 m",
            "turn left; turn right; straight len=60",
            "straight len=60; turn left; turn right",
        ),
        ("two bends; after a straight, done", "turn x2; straight", "turn x2; straight"),
        ("a bend after a straight, and a straight", "turn; straight", "turn; straight"),
        ("four bends, dopo un rettilineo", "turn x4; straight", "turn x4; straight"),
    ],
)
def test_kinds_have_their_number_and_a_straight_its_place(words: str, written: str, right: str) -> None:
    assert corrected(words, written) == right


def test_turns_of_so_much_each_stay_as_they_are() -> None:
    words = "three curves of 1.5 km each"
    assert plan(brief_of("turn x3 len=1500", slotted(words), words)) == "turn x3 len=1500"


def test_uphill_at_nothing_is_level() -> None:
    words = "70 m straight and a left turn, longitudinal gradient 0 %"
    brief = brief_of("straight len=70; turn left | up pct=0", slotted(words), words)
    assert (brief.slope, brief.incline) == ("flat", None)
    brief = brief_of("straight up pct=0; turn left up pct=4", slotted(words), words)
    assert [(c.slope, c.incline is None) for c in brief.clauses] == [("flat", True), ("up", False)]


@pytest.mark.parametrize(
    ("words", "asks"),
    [
        ("a closed circuit of 600 m", True),
        ("Ein geschlossener Rundkurs, vier Rechtskurven", True),
        ("Circuit fermé : on repasse sur la ligne de départ", True),
        ("un circuito cerrado de 500 m", True),
        ("un circuito chiuso con sei curve", True),
        ("start and finish at the same point, four left turns", True),
        ("not a closed circuit, just three turns", False),
        ("start and finish are at the same height", False),
        ("a looping climb with a full turn of 230 degrees", False),
        ("kein Rundkurs, bitte drei Kurven", False),
        ("three turns instead of a closed loop", False),
        ("a section of a closed circuit: left, right, hairpin", False),
        ("Teil eines geschlossenen Rundkurses, drei Kurven", False),
        ("un percorso chiuso al traffico, tre curve", False),
        ("Rundkurs für den Dauerlauf, vier Linksbögen", True),
    ],
)
def test_closed_circuits_are_recognised_unless_denied(words: str, asks: bool) -> None:
    assert asks_for_a_closed_loop(words, "turn x3") is asks


def test_the_roads_of_a_map_may_be_a_closed_loop() -> None:
    assert not asks_for_a_closed_loop("a closed loop with two roads into it", "map t_junction x2 blocks=1")
