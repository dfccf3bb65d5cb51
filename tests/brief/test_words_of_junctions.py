"""What words leave no choice about, on routes and maps, corrects what the network writes."""

import pytest

from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.readers.model import ModelReader
from roadgpt.brief.readers.model.alike_junctions import with_counted_junctions
from roadgpt.brief.readers.model.map_words import with_counted_map
from roadgpt.brief.readers.model.other_roads import with_other_roads
from roadgpt.brief.readers.model.own_lane import without_own_lane
from roadgpt.brief.readers.model.plan_choice import brief_of
from roadgpt.brief.readers.model.route_words import asks_for_map
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
    ahead = "une rue avec deux carrefours, tout droit aux deux"
    assert ModelReader().read(f"Un trajet : {ahead}.").map is None
    assert ModelReader().read(f"Une carte sans itinéraire : {ahead}.").map is not None


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
        ("map t_junction x2 blocks=1", "zwei Einmündungen, zwei Blöcke", "map t_junction x2 dead_ends=0"),
        ("map t_junction x2 dead_ends=2", "zwei Einmündungen, zwei Blöcke", "map t_junction x2 dead_ends=0"),
        (
            "map t_junction x6 dead_ends=4",
            "ein Ort mit höchstens vier Sackgassen",
            "map t_junction x6 dead_ends=..4",
        ),
        ("map t_junction x6 dead_ends=6", "four to six dead ends", "map t_junction x6 dead_ends=4..6"),
        (
            "map columns=5 rows=3 dead_ends=6",
            "between 2 and 6 dead ends",
            "map columns=5 rows=3 dead_ends=2..6",
        ),
        ("map columns=3 rows=4", "ninguna calle lleva fuera", "map columns=3 rows=4 dead_ends=0"),
        ("map columns=4 rows=4", "nessuna strada porta fuori", "map columns=4 rows=4 dead_ends=0"),
        ("map t_junction x4", "deux routes mènent hors du village", "map t_junction x4 dead_ends=2"),
        ("map crossroads x6", "exactly six roads lead out of it", "map crossroads x6 dead_ends=6"),
        ("map crossroads x5", "almeno quattro strade portano fuori", "map crossroads x5 dead_ends=4.."),
        ("map crossroads x5", "vier Straßen führen aus dem Ort hinaus", "map crossroads x5 dead_ends=4"),
        ("map crossroads x5", "no street leads through it", "map crossroads x5"),
        ("map columns=4 rows=2", "four by two, blocks of 110 m", "map columns=4 rows=2 len=110"),
        ("map columns=4 rows=2 len=90", "blocks of 110 m and roads of 90 m", "map columns=4 rows=2 len=90"),
        (
            "map junction x6; roundabout",
            "sei nodi, uno dei quali è una rotatoria",
            "map roundabout; junction x5",
        ),
        (
            "map roundabout; junction x7",
            "sept jonctions, dont un seul rond-point",
            "map roundabout; junction x6",
        ),
        ("map roundabout x3", "siete nudos, tres de ellos rotondas", "map roundabout x3; junction x4"),
        (
            "map roundabout; junction x4",
            "a roundabout, and besides it four junctions of which I know nothing",
            "map roundabout; junction x4",
        ),
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
        # a comb: each dead end leaves the street at a T-junction, and the street has two ends
        (
            "map columns=3 rows=1 dead_ends=3",
            "a village with one through road and three cul-de-sacs off it",
            "map t_junction x3 dead_ends=5",
        ),
        ("map junction x2", "ein Dorf, eine Hauptstraße, zwei Sackgassen", "map t_junction x2 dead_ends=4"),
        ("map roundabout x2", "14 junctions, 2 of them roundabouts", "map roundabout x2; junction x12"),
        (
            "map roundabout x4 dead_ends=4",
            "a small town with four dead ends and two roundabouts",
            "map roundabout x2 dead_ends=4",
        ),
        ("map roundabout x3", "two roundabouts and three more roundabouts", "map roundabout x3"),
        ("map roundabout x3", "two roundabouts, no, make that three", "map roundabout x3"),
        ("map crossroads x5; t_junction", "drei Kreuzungen, eine T", "map crossroads x3; t_junction"),
        ("map roundabout x2..", "two roundabouts or more", "map roundabout x2.."),
        ("map roundabout x2", "4 Knotenpunkte, davon 2 Kreisel", "map roundabout x2; junction x2"),
        ("map roundabout x2", "4 junctions? not four, two, both roundabouts", "map roundabout x2"),
        ("map t_junction x3; crossroads", "four junctions, three Ts, one X", "map t_junction x3; crossroads"),
        (
            "map crossroads x2 dead_ends=2",
            "a main street over two crossroads, and two dead ends",
            "map crossroads x2 dead_ends=2",
        ),
        ("map t_junction x2", "a main road, five dead ends in total", "map t_junction x2 dead_ends=5"),
        (
            "map t_junction x3 dead_ends=3..",
            "a map with a main road and at least 3 dead ends",
            "map t_junction x3 dead_ends=3..",
        ),
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
        (CHANGES, "two lanes: I start off in the right one and move over to the left", ONE_CHANGE),
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


@pytest.mark.parametrize(
    ("asked", "words", "line"),
    [
        (
            4 * ["crossroads straight"],
            "five crossroads, straight over all of them",
            5 * ["crossroads straight"],
        ),
        (5 * ["roundabout exit=2"], "sechs Kreisverkehre, jeweils Ausfahrt 2", 6 * ["roundabout exit=2"]),
        (3 * ["t_junction left"], "two T-junctions, left at both", 2 * ["t_junction left"]),
        (3 * ["roundabout"], "three roundabouts", 3 * ["roundabout"]),
        (2 * ["crossroads left"], "five crossroads, no, make that two", 2 * ["crossroads left"]),
        (3 * ["roundabout"], "una rotonda, y luego otras dos rotondas", 3 * ["roundabout"]),
        (3 * ["crossroads"], "two crossroads and then three more crossroads", 3 * ["crossroads"]),
        (
            ["crossroads left", "crossroads"],
            "three crossroads, left first",
            ["crossroads left", "crossroads"],
        ),
        (2 * ["roundabout"], "a road with 3 bends and roundabouts at both ends", 2 * ["roundabout"]),
        (2 * ["merge main"], "four junctions of a motorway", 2 * ["merge main"]),
    ],
)
def test_junctions_that_are_all_alike_are_counted(asked: list[str], words: str, line: list[str]) -> None:
    brief = with_counted_junctions(read_plan(" // ".join(asked)), slotted(words))
    assert plan(brief) == " // ".join(line)


def test_roads_between_alike_junctions_are_alike_too() -> None:
    asked = "crossroads // | len=100 // crossroads // | len=100 // crossroads"
    brief = with_counted_junctions(read_plan(asked), slotted("four crossroads, 100 m apart"))
    assert [each.length.lo for each in brief.stretches if each.length] == [100, 100, 100]
    uneven = read_plan("crossroads // | len=100 // crossroads // | len=50 // crossroads")
    assert with_counted_junctions(uneven, slotted("four crossroads, 100 m and 50 m apart")) == uneven


@pytest.mark.parametrize(
    ("asked", "line"),
    [
        (
            "straight up; straight down; straight up | turns=0 hills=3.. // crossroads",
            "straight up; straight down; straight up | turns=0 // crossroads",
        ),
        ("straight up; straight down | turns=0 hills=2..", "straight up; straight down | turns=0"),
        ("straight up; straight down | turns=0 hills=1..", "straight up; straight down | turns=0 hills=1.."),
        ("straight up; straight down | turns=0 hills=3", "straight up; straight down | turns=0 hills=3"),
        ("straight up; straight | turns=0 hills=3..", "straight up; straight | turns=0 hills=3.."),
        ("straight up; turn; straight down | hills=3..", "straight up; turn; straight down | hills=3.."),
    ],
)
def test_hilly_means_the_slopes_that_are_listed(asked: str, line: str) -> None:
    words = "a hilly road, up and down"
    assert plan(brief_of(asked, slotted(words), words)) == line
