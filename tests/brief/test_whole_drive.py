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
    ("asked", "words"),
    [
        (ROUTE, "a left bend, straight over the crossroads, uphill"),
        (ROUTE, "no overtaking until the crossroads"),
        (ROUTE, "a solid line, and a dashed line as well"),
        ("| centre=broken // crossroads straight", "no overtaking, dashed line before the crossroads"),
        ("| oneway // crossroads straight // | divided", "no overtaking"),
        ("turn x2", "two bends, no overtaking, traffic on the left"),
    ],
)
def test_nothing_is_added_where_words_leave_a_choice(asked: str, words: str) -> None:
    brief = read_plan(asked)
    assert with_whole_drive(brief, words) == brief


def test_traffic_on_the_left_holds_for_routes_and_maps() -> None:
    for asked in (ROUTE, "map crossroads x3"):
        found = with_whole_drive(read_plan(asked), "we drive on the left")
        assert found.left_hand
        assert read_plan(plan(found)) == found
