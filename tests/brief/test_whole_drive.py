"""What words say of a whole route reaches every road of it, and nothing is added where a place is said."""

import pytest

from roadgpt.brief import normal, read
from roadgpt.brief.plan import plan, read_plan


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (
            "Linkskurve, Kreuzung geradeaus, Steigung. Überholverbot.",
            "turn left | centre=solid // crossroads straight // | up centre=solid",
        ),
        (
            "al cruce a la izquierda, 90 m, en la T a la derecha; en todo el recorrido prohibido adelantar",
            "| centre=solid // crossroads left // | len=90 centre=solid // t_junction right // "
            "| centre=solid",
        ),
        (
            "Kreuzung, durchgehend zwei Spuren je Richtung mit Mittelstreifen",
            "| divided lanes=2 against=2 // crossroads // | divided lanes=2 against=2",
        ),
        (
            "overtaking is forbidden everywhere: straight over a crossroads, then uphill",
            "| centre=solid // crossroads straight // | up centre=solid",
        ),
        ("two bends, no overtaking, traffic on the left", "turn x2 | centre=solid || left_hand"),
    ],
)
def test_what_holds_all_the_way_is_on_every_road(words: str, line: str) -> None:
    assert plan(normal(read(words))) == plan(normal(read_plan(line)))


@pytest.mark.parametrize(
    ("words", "line"),
    [
        ("a left bend, straight over the crossroads, uphill", "turn left // crossroads straight // | up"),
        ("no overtaking until the crossroads", "| centre=solid // crossroads"),
        ("two lanes for the whole 200 m before the crossroads", "| lanes=2 len=200 // crossroads"),
        ("Drei Fahrstreifen je Richtung, an der Kreuzung links", "| lanes=3 against=3 // crossroads left"),
        (
            "left at a T-junction, then a road with two lanes each way",
            "t_junction left // | lanes=2 against=2",
        ),
    ],
)
def test_a_line_or_lanes_at_a_place_are_on_its_road_alone(words: str, line: str) -> None:
    assert plan(normal(read(words))) == plan(normal(read_plan(line)))


@pytest.mark.parametrize(
    ("words", "line"),
    [
        ("una doble calzada hasta la rotonda", "| divided // roundabout"),
        ("left onto a dual carriageway", "junction left // | divided"),
        ("not a dual carriageway, a crossroads, left", "crossroads left"),
        ("two lanes, a roundabout, a dual carriageway", "| lanes=2 // roundabout // | divided"),
    ],
)
def test_a_dual_carriageway_has_a_median_where_it_is(words: str, line: str) -> None:
    assert plan(normal(read(words))) == plan(normal(read_plan(line)))


@pytest.mark.parametrize(
    ("words", "line"),
    [
        ("out of a side street, stop, right", "t_junction right stop"),
        ("left at the junction into a side street", "t_junction left ways=left+straight"),
        ("from the side road, stop, right at the crossroads", "crossroads right stop"),
        (
            "a cross street that is one-way from left to right; right, uphill",
            "crossroads right in=left // | up oneway",
        ),
    ],
)
def test_side_roads_and_cross_streets_are_read_with_their_signs(words: str, line: str) -> None:
    assert plan(normal(read(words))) == plan(normal(read_plan(line)))


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (
            "an der Kreuzung links, hier gilt Rechts vor links, dann die Gabelung",
            "crossroads left none // y_junction",
        ),
        ("carrefour à gauche, priorité à droite, puis la fourche", "crossroads left none // y_junction"),
        (
            "cruce a la izquierda con prioridad a la derecha, luego bifurcación",
            "crossroads left none // y_junction",
        ),
        (
            "all'incrocio, precedenza a destra, vado a sinistra, poi il bivio",
            "crossroads left none // y_junction",
        ),
        ("junction left, then a crossroads with right before left", "junction left // crossroads none"),
        (
            "two crossroads, all straight over; right before left at the second",
            "crossroads straight // crossroads straight none",
        ),
    ],
)
def test_cars_from_the_right_go_first_where_no_sign_is(words: str, line: str) -> None:
    assert plan(normal(read(words))) == plan(normal(read_plan(line)))


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (
            "nach 90 m geradeaus über eine Kreuzung, auf der ich Vorfahrt habe",
            "| len=90 // crossroads straight priority",
        ),
        ("straight over the crossroads, and we have priority", "crossroads straight priority"),
        ("j'ai la priorité au croisement", "crossroads priority"),
    ],
)
def test_who_has_priority_gives_no_way(words: str, line: str) -> None:
    assert plan(normal(read(words))) == plan(normal(read_plan(line)))
