"""What words leave no choice about, on routes and maps, corrects what the network writes."""

import pytest

from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.readers.model import ModelReader
from roadgpt.brief.readers.model.junction_number import number_of, number_said
from roadgpt.brief.readers.model.map_words import asks_for_map, with_counted_map
from roadgpt.brief.readers.model.other_roads import with_other_roads
from roadgpt.brief.readers.model.own_lane import without_own_lane
from roadgpt.brief.readers.model.second_look import condition_missed
from roadgpt.brief.readers.model.slots import slotted


@pytest.mark.parametrize(
    ("words", "number"),
    [
        ("three crossroads, straight over all of them", 3),
        ("a four-way crossroads, turn left", 1),
        ("a crossroads with four arms", 1),
        ("two T-junctions, left at both", 2),
        ("à deux ronds-points tout droit", 2),
        ("cinque incroci: un bivio, due rotatorie e due incroci", 5),
        ("Fünf Knotenpunkte, davon zwei Kreisverkehre und drei Einmündungen", 5),
        ("two crossroads and a roundabout", None),  # no total
        ("a crossroads, then left at the next", None),
        ("straight over the crossroads, then left at the T", None),
        ("several junctions", None),
        ("a winding road", None),
    ],
)
def test_the_number_of_junctions_is_taken_from_their_nouns(words: str, number: int | None) -> None:
    assert number_said(slotted(words)) == number


@pytest.mark.parametrize(
    ("tokens", "number"),
    [
        (("crossroads", "left", "//", "|", "up", "//", "roundabout", "exit=", "2"), 2),
        (("|", "up", "//", "t_junction"), 1),
        (("lane_change", "left", "//", "crossroads"), None),
        (("turn", "x", "3", "|", "beside(", "roundabout", ")"), None),
    ],
)
def test_junctions_of_a_plan_are_counted_where_they_stand(
    tokens: tuple[str, ...], number: int | None
) -> None:
    assert number_of(tokens) == number


def test_a_plan_with_a_junction_too_many_is_written_again() -> None:
    text = slotted("three crossroads, straight over all of them")
    right = ("crossroads", "straight", *("//", "crossroads", "straight") * 2)
    assert condition_missed(text, right) is None
    missed = condition_missed(text, (*right, "//", "crossroads", "straight"))
    assert missed is not None
    assert missed.holds(right)
    assert "<end>" in missed.barred(right[:4])
    assert "crossroads" in missed.barred((*right, "//"))
    assert not missed.barred(right)


def test_the_reader_writes_the_number_of_junctions_that_is_said() -> None:
    words = "Double ligne sur tout le trajet. Trois carrefours en croix avec des feux, tout droit aux trois."
    assert len(ModelReader().read(words).junctions) == 3


@pytest.mark.parametrize(
    ("words", "is_map"),
    [
        ("Map only, no route: two crossroads", True),
        ("Nur eine Karte, keine Route", True),
        ("Une carte sans itinéraire", True),
        ("un mapa sin recorrido", True),
        ("mappa senza percorso", True),
        ("a route over two crossroads", False),
        ("no route, no grid, a straight road", False),
        ("a town with two crossroads", False),
    ],
)
def test_a_map_without_a_route_is_heard(words: str, is_map: bool) -> None:
    assert asks_for_map(slotted(words)) is is_map


@pytest.mark.parametrize(
    ("asked", "words", "line"),
    [
        # drawn on paper: a square with a stub at each corner; a square with a cross in it; a ladder; a comb
        (
            "map t_junction x4",
            "a single block with a T-junction at each corner",
            "map t_junction x4 dead_ends=4",
        ),
        (
            "map crossroads; t_junction x4",
            "one crossroads and four T-junctions make four blocks",
            "map crossroads; t_junction x4 dead_ends=0",
        ),
        ("map t_junction x2 dead_ends=2", "zwei Einmündungen, zwei Blöcke", "map t_junction x2 dead_ends=0"),
        (
            "map t_junction x4 dead_ends=4",
            "una strada con quattro strade laterali a fondo cieco: sono vicoli ciechi",
            "map t_junction x4 dead_ends=6",
        ),
        ("map crossroads x4", "4 crossroads (8 dead ends)", "map crossroads x4 dead_ends=8"),
        ("map roundabout x2", "deux giratoires, aucune impasse", "map roundabout x2 dead_ends=0"),
        ("map columns=4 rows=2", "four blocks in a two by two grid", "map columns=2 rows=2"),
        ("map columns=3 rows=2", "drei Blöcke in einer Reihe", "map columns=3 rows=1"),
        ("map columns=2 rows=3", "a grid of three by two blocks", "map columns=2 rows=3"),  # turned
        ("map columns=4 rows=3", "four blocks wide and three deep", "map columns=4 rows=3"),
        ("map t_junction x3 dead_ends=3..", "at least three dead ends", "map t_junction x3 dead_ends=3.."),
        ("map star x2", "two stars around one block", "map star x2"),  # of five arms or six
    ],
)
def test_blocks_and_dead_ends_of_maps_follow_from_the_words(asked: str, words: str, line: str) -> None:
    assert plan(with_counted_map(read_plan(asked), slotted(words))) == line


@pytest.mark.parametrize(
    ("asked", "words", "line"),
    [
        (
            "crossroads straight priority",
            "I have priority, the crossing road has stop signs",
            "crossroads straight priority others_stop",
        ),
        ("crossroads straight priority", "I have priority and do not stop", "crossroads straight priority"),
        (
            "crossroads straight priority // crossroads left priority",
            "priority at two crossroads, one has stop signs for the others",
            "crossroads straight priority // crossroads left priority",
        ),
        (
            "crossroads straight priority // t_junction stop",
            "priority, then a stop sign at the T",
            "crossroads straight priority // t_junction stop",
        ),
        (
            "| oneway // crossroads right // | oneway",
            "one-way streets only, right at the crossroads",
            "| oneway // crossroads right in=left out=straight // | oneway",
        ),
        (
            "| oneway // crossroads straight // | oneway",
            "lauter Einbahnstraßen, über die Kreuzung",
            "| oneway // crossroads straight in=left out=right // | oneway",
        ),
        (
            "| oneway // t_junction left ways=left+straight // | oneway",
            "all roads are one-way: left off the main street",
            "| oneway // t_junction left ways=left+straight out=straight // | oneway",
        ),
        (
            "| oneway // crossroads right",
            "out of a one-way street, right at the crossroads",
            "| oneway // crossroads right",
        ),
    ],
)
def test_roads_that_the_route_does_not_take_are_as_the_words_say(asked: str, words: str, line: str) -> None:
    assert plan(with_other_roads(read_plan(asked), words)) == line


@pytest.mark.parametrize(
    ("words", "changes"),
    [
        ("start in the right lane, change to the left one", 1),
        ("wir beginnen auf dem rechten Fahrstreifen und wechseln nach links", 1),
        ("sur la voie de droite, puis à gauche", 1),
        ("change into the right lane and back to the left", 2),
        ("start in the left lane, change right, change left", 2),
    ],
)
def test_the_lane_at_the_start_is_no_change(words: str, changes: int) -> None:
    asked = read_plan("| lanes=2 // lane_change right // lane_change left // crossroads left")
    found = without_own_lane(asked, words)
    assert [each.kind for each in found.junctions] == ["lane_change"] * changes + ["crossroads"]
    assert len(found.stretches) == changes + 2
    assert plan(found).startswith("| lanes=2 // lane_change")
