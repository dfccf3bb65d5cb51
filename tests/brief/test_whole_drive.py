"""What words say of a whole route reaches every road of it, and nothing is added where a place is said."""

import pytest

from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.readers.model.whole_drive import with_whole_drive

ROUTE = "turn left // crossroads straight // | up"


@pytest.mark.parametrize(
    ("words", "line"),
    [
        ("a left bend, straight over the crossroads, uphill, no overtaking", "solid"),
        ("Linkskurve, Kreuzung geradeaus, Steigung. Überholverbot.", "solid"),
        ("virage à gauche, croisement, montée, double ligne", "double"),
        ("curva, cruce, subida, sin marcas", "none"),
        ("curva, incrocio, salita, linea tratteggiata", "broken"),
    ],
)
def test_a_centre_line_that_the_network_left_out_is_on_every_road(words: str, line: str) -> None:
    found = with_whole_drive(read_plan(ROUTE), words)
    assert [road.centre for road in found.stretches] == [line, line]


@pytest.mark.parametrize(
    ("asked", "words", "line"),
    [
        (
            "| lanes=2 against=2 // t_junction left // | up",
            "All roads have two lanes each way. Left at the T-junction, uphill",
            "| lanes=2 against=2 // t_junction left // | up lanes=2 against=2",
        ),
        (
            "// crossroads left // | len=90 centre=solid // t_junction right //",
            "al cruce a la izquierda, 90 m, en la T a la derecha; en todo el recorrido prohibido adelantar",
            "| centre=solid // crossroads left // | len=90 centre=solid // t_junction right // "
            "| centre=solid",
        ),
        (
            "// crossroads // | divided lanes=2 against=2",
            "Kreuzung, durchgehend zwei Spuren je Richtung mit Mittelstreifen",
            "| divided lanes=2 against=2 // crossroads // | divided lanes=2 against=2",
        ),
    ],
)
def test_what_holds_all_the_way_is_on_every_road(asked: str, words: str, line: str) -> None:
    assert with_whole_drive(read_plan(asked), words) == read_plan(line)


@pytest.mark.parametrize(
    ("asked", "words", "line"),
    [
        (
            "| len=400 // diverge ramp side=left || left_hand",
            "traffic on the left; leave the dual carriageway after 400 m",
            "| divided len=400 // diverge ramp side=left || left_hand",
        ),
        ("| // roundabout", "una doble calzada hasta la rotonda", "| divided // roundabout"),
        ("// crossroads straight", "crossing the dual carriageway", "// crossroads straight"),
        (
            "// crossroads left // | lanes=2",
            "left onto a dual carriageway",
            "// crossroads left // | lanes=2",
        ),
        ("// crossroads left", "not a dual carriageway, a crossroads, left", "// crossroads left"),
        ("// t_junction left", "an undivided road, at the T left", "// t_junction left"),
        (
            "| lanes=2 // roundabout // | divided",
            "two lanes, a roundabout, a dual carriageway",
            "| lanes=2 // roundabout // | divided",
        ),
    ],
)
def test_a_dual_carriageway_at_the_start_has_a_median(asked: str, words: str, line: str) -> None:
    assert with_whole_drive(read_plan(asked), words) == read_plan(line)


@pytest.mark.parametrize(
    ("asked", "words"),
    [
        (ROUTE, "a left bend, straight over the crossroads, uphill"),
        (ROUTE, "no overtaking until the crossroads"),
        (ROUTE, "a solid line, and a dashed line as well"),
        ("| centre=broken // crossroads straight", "no overtaking, dashed line before the crossroads"),
        ("| oneway // crossroads straight // | divided", "no overtaking"),
        ("turn x2", "two bends, no overtaking, traffic on the left"),
        ("| lanes=2 // crossroads", "all the way to the second crossroads two lanes"),
        ("| lanes=2 // crossroads // | lanes=3", "lanes all the way: two, then three"),
        ("| lanes=2 // crossroads", "two lanes for the whole 200 m before the crossroads"),
        ("| lanes=2 // crossroads // | up", "two lanes, a crossroads, uphill throughout"),
        (
            "| lanes=3 oneway // diverge ramp // | up",
            "three lanes of motorway all the way, the exit",
        ),
        ("| lanes=3 // lane_drop //", "three lanes all the way, one ends"),
        ("| lanes=2 // crossroads // | up", "a small road with two lanes, the crossroads, uphill"),
        ("| lanes=2 // crossroads // | up", "not two lanes everywhere, only before the crossroads"),
        ("| lanes=2 // crossroads //", "zwei Spuren mit durchgehender Linie, dann die Kreuzung"),
        ("| oneway // crossroads // | up", "a one-way street, a crossroads, uphill, narrow lanes everywhere"),
    ],
)
def test_nothing_is_added_where_words_leave_a_choice(asked: str, words: str) -> None:
    brief = read_plan(asked)
    assert with_whole_drive(brief, words) == brief


@pytest.mark.parametrize(
    ("asked", "words", "line"),
    [
        ("junction right stop", "out of a side street, stop, right", "t_junction right stop"),
        ("junction left yield", "aus einer Seitenstraße nach links", "t_junction left yield"),
        ("junction left", "left at the junction into a side street", "junction left"),
        ("crossroads right stop", "from the side road, stop, right", "crossroads right stop"),
        ("junction straight", "out of a side street, straight on", "junction straight"),
    ],
)
def test_a_side_street_ends_at_a_t_junction(asked: str, words: str, line: str) -> None:
    assert with_whole_drive(read_plan(asked), words) == read_plan(line)


def test_a_line_is_on_the_roads_that_can_have_it() -> None:
    asked = read_plan("| centre=solid // crossroads straight // | oneway // crossroads left // | up")
    found = with_whole_drive(asked, "overtaking is forbidden everywhere")
    assert [road.centre for road in found.stretches] == ["solid", None, "solid"]


def test_a_one_way_road_that_the_route_takes_is_the_road_behind() -> None:
    asked = read_plan("crossroads right in=left out=right // | up")
    found = with_whole_drive(asked, "a cross street that is one-way from left to right; right, uphill")
    assert found == read_plan("crossroads right in=left // | up oneway")


def test_traffic_on_the_left_holds_for_routes_and_maps() -> None:
    for asked in (ROUTE, "map crossroads x3"):
        found = with_whole_drive(read_plan(asked), "we drive on the left")
        assert found.left_hand
        assert read_plan(plan(found)) == found


@pytest.mark.parametrize(
    "words",
    [
        "crossroads left with priority to the right, then straight over a fork",
        "an der Kreuzung links, hier gilt Rechts vor links, dann die Gabelung",
        "carrefour à gauche, priorité à droite, puis la fourche",
        "cruce a la izquierda con prioridad a la derecha, luego bifurcación",
        "all'incrocio, precedenza a destra, vado a sinistra, poi il bivio",
    ],
)
def test_cars_from_the_right_go_first_where_no_sign_is(words: str) -> None:
    found = with_whole_drive(read_plan("crossroads left yield // y_junction"), words)
    assert plan(found) == "crossroads left none // y_junction"


@pytest.mark.parametrize(
    ("asked", "words"),
    [
        ("crossroads left yield // junction yield", "right before left at the one, give way at the other"),
        ("crossroads left yield", "crossroads left; it isn't priority to the right there, there is a sign"),
        ("crossroads left yield", "Kreuzung, links, ohne Rechts vor Links"),
        ("junction left lights // roundabout yield", "rechts vor links ist hier nirgends"),
        ("junction left // crossroads", "junction left, then a crossroads with right before left"),
        (
            "crossroads straight // crossroads straight none",
            "two crossroads, all straight over; right before left at the second",
        ),
        ("merge ramp // crossroads none", "join, then a crossroads, right before left everywhere"),
    ],
)
def test_signs_that_the_words_tell_of_stay(asked: str, words: str) -> None:
    assert with_whole_drive(read_plan(asked), words) == read_plan(asked)


def test_cars_from_the_right_go_first_at_every_junction_of_which_that_is_said() -> None:
    said = "right before left at every one of them"
    asked = "crossroads // junction left lights // roundabout // t_junction right yield"
    found = with_whole_drive(read_plan(asked), said)
    assert plan(found) == "crossroads none // junction left lights // roundabout // t_junction right none"
    for map_asked in ("map crossroads x3", "map crossroads x3 yield"):
        assert plan(with_whole_drive(read_plan(map_asked), said)) == "map crossroads x3 none"


@pytest.mark.parametrize(
    ("words", "asked", "line"),
    [
        (
            "nach 90 m geradeaus über eine Kreuzung, auf der ich Vorfahrt habe",
            "| len=90 // crossroads straight yield",
            "| len=90 // crossroads straight priority",
        ),
        ("straight over, and we have priority", "crossroads straight yield", "crossroads straight priority"),
        ("we give way, at the next we have priority", "crossroads yield // crossroads yield", None),
        ("straight over, we do not have priority", "crossroads straight yield", None),
        ("j'ai la priorité au croisement", "crossroads stop", None),
    ],
)
def test_who_has_priority_gives_no_way(words: str, asked: str, line: str | None) -> None:
    assert plan(with_whole_drive(read_plan(asked), words)) == (line or asked)


@pytest.mark.parametrize(
    ("words", "asked", "line"),
    [
        (
            "the main street, two lanes per direction, past a side street",
            "t_junction straight",
            "| lanes=2 against=2 // t_junction straight",
        ),
        (
            "Drei Fahrstreifen je Richtung, an der Kreuzung links",
            "crossroads left",
            "| lanes=3 against=3 // crossroads left",
        ),
        ("left at a T-junction, then a road with two lanes each way", "t_junction left", None),
        ("two lanes each way, left", "t_junction left // | lanes=2 against=2", None),
        ("a T-junction. I go straight on. It has two lanes each way", "t_junction straight", None),
    ],
)
def test_lanes_of_both_directions_at_the_start_are_those_of_the_first_road(
    words: str, asked: str, line: str | None
) -> None:
    assert plan(with_whole_drive(read_plan(asked), words)) == (line or asked)
