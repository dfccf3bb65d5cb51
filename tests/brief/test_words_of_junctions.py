"""What words leave no choice about, on routes and maps, corrects what the network writes."""

import pytest

from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.readers.model import ModelReader
from roadgpt.brief.readers.model.map_words import asks_for_map, with_counted_map
from roadgpt.brief.readers.model.other_roads import with_other_roads
from roadgpt.brief.readers.model.own_lane import without_own_lane
from roadgpt.brief.readers.model.slots import slotted


@pytest.mark.parametrize(
    ("words", "is_map"),
    [
        ("Map only, no route: two crossroads", True),
        ("Nur eine Karte, keine Route", True),
        ("Une carte sans itinéraire", True),
        ("un mapa sin recorrido", True),
        ("mappa senza percorso", True),
        ("a route over two crossroads", False),
        ("Through the village, no route signs, left at the crossroads.", False),
        ("Un tramo plano sin curvas hasta el cruce", False),
        ("Un réseau sans feux: tout droit au carrefour", False),
        ("a town with two crossroads", False),
        ("not just a map, but a route over two crossroads", False),
        ("nicht nur eine Karte", False),
    ],
)
def test_a_map_without_a_route_is_heard(words: str, is_map: bool) -> None:
    assert asks_for_map(slotted(words)) is is_map


def test_the_network_writes_a_map_where_the_words_ask_for_one() -> None:
    route = "two parallel streets, joined by three streets, one at each end and one in the middle"
    assert ModelReader().read(f"Map only: {route}.").map is not None
    without = (
        "deux rues parallèles, reliées entre elles par trois rues, une à chaque extrémité et une au milieu"
    )
    assert ModelReader().read(f"Une carte sans itinéraire : {without}.").map is not None
    assert ModelReader().read(f"Un trajet : {without}.").map is None


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
        (
            "map roundabout x3 dead_ends=0",
            "three of them, not a single dead end",
            "map roundabout x3 dead_ends=0",
        ),
        ("map t_junction x3 dead_ends=5", "side streets, none a dead end", "map t_junction x3 dead_ends=5"),
        (
            "map t_junction x4 dead_ends=4",
            "four T-junctions around one block, a side street at each that is a dead end",
            "map t_junction x4 dead_ends=4",
        ),
        ("map columns=2 rows=3", "two rows with three blocks in a row each", "map columns=2 rows=3"),
        ("map columns=4 rows=3", "four columns, three rows, 2x2 lanes", "map columns=4 rows=3"),
        ("map columns=3.. rows=2..", "at least three by two blocks", "map columns=3.. rows=2.."),
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
        ("crossroads straight priority", "I have priority and no stop sign", "crossroads straight priority"),
        ("crossroads straight priority", "priority, then a bus stop", "crossroads straight priority"),
        ("crossroads straight priority", "j'ai priorité, aucun panneau stop", "crossroads straight priority"),
        ("crossroads straight priority", "there isn't a stop sign", "crossroads straight priority"),
        ("crossroads straight priority", "there isn’t a stop sign", "crossroads straight priority"),
        (
            "| oneway // crossroads right",
            "One-way streets only, right at the crossroads.",
            "| oneway // crossroads right in=left out=straight // | oneway",
        ),
        (
            "| oneway // crossroads right",
            "Not all roads are one-way, only mine",
            "| oneway // crossroads right",
        ),
        (
            "| oneway // crossroads straight // | oneway",
            "a one-way street crossroads, straight on, one-way behind it",
            "| oneway // crossroads straight // | oneway",
        ),
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


CHANGES = "lane_change right // lane_change left // crossroads left"
ONE_CHANGE = "lane_change left // crossroads left"


@pytest.mark.parametrize(
    ("asked", "words", "line"),
    [
        (f"| lanes=2 // {CHANGES}", "start in the right lane, change left", f"| lanes=2 // {ONE_CHANGE}"),
        (CHANGES, "wir beginnen auf dem rechten Fahrstreifen und wechseln nach links", ONE_CHANGE),
        (
            "| lanes=2 // lane_change right // | len=200 // lane_change left",
            "start in the right lane, after 200 m change to the left lane",
            "| lanes=2 len=200 // lane_change left",
        ),
        (CHANGES, "change into the right lane and back to the left", CHANGES),
        (CHANGES, "be in the right lane after 100 m, then back", CHANGES),
        (CHANGES, "start in the left lane, change right, change left", CHANGES),
    ],
)
def test_the_lane_at_the_start_is_no_change(asked: str, words: str, line: str) -> None:
    assert plan(without_own_lane(read_plan(asked), words)) == line
