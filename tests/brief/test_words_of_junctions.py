"""What words say of maps, of the roads that a route does not take, and of junctions that are all alike."""

import pytest

from roadgpt.brief import normal, read
from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.readers.model import ModelReader
from roadgpt.brief.readers.model.map_words import with_counted_map
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
    ("words", "line"),
    [
        ("one crossroads and four T-junctions make four blocks", "map crossroads; t_junction x4 dead_ends=0"),
        ("four by two, blocks of 110 m", "map columns=4 rows=2 len=110"),
        (
            "a village with a roundabout, and besides it four junctions of which I know nothing",
            "map roundabout; junction x4",
        ),
        (
            "una strada con quattro strade laterali a fondo cieco: sono vicoli ciechi",
            "map t_junction x4 dead_ends=6",
        ),
        ("4 crossroads (8 dead ends)", "map crossroads x4 dead_ends=8"),
        ("four blocks in a two by two grid", "map columns=2 rows=2"),
        ("drei Blöcke in einer Reihe", "map columns=3 rows=1"),
        ("four blocks wide and three deep", "map columns=4 rows=3"),
        (
            "four T-junctions around one block, a side street at each that is a dead end",
            "map t_junction x4 dead_ends=4",
        ),
        ("two rows with three blocks in a row each", "map columns=3 rows=2"),
        ("a village with one through road and three cul-de-sacs off it", "map t_junction x3 dead_ends=5"),
        ("ein Dorf, eine Hauptstraße, zwei Sackgassen", "map t_junction x2 dead_ends=4"),
        ("a small town with four dead ends and two roundabouts", "map roundabout x2 dead_ends=4"),
    ],
)
def test_maps_are_read_with_their_blocks_and_dead_ends(words: str, line: str) -> None:
    assert plan(normal(read(words))) == plan(normal(read_plan(line)))


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (
            "straight over a crossroads where I have priority, the crossing road has stop signs",
            "crossroads straight priority others_stop",
        ),
        ("out of a one-way street, right at the crossroads", "| oneway // crossroads right"),
        (
            "a one-way street crossroads, straight on, one-way behind it",
            "| oneway // crossroads straight // | oneway",
        ),
    ],
)
def test_signs_and_directions_of_other_roads_are_those_of_the_words(words: str, line: str) -> None:
    assert plan(normal(read(words))) == plan(normal(read_plan(line)))


def test_a_change_into_a_lane_and_back_is_two_changes() -> None:
    words = "change into the right lane and back to the left"
    line = "lane_change right // lane_change left"
    assert plan(normal(read(words))) == plan(normal(read_plan(line)))


@pytest.mark.parametrize(
    ("words", "line"),
    [
        ("five crossroads, straight over all of them", " // ".join(5 * ["crossroads straight"])),
        ("two T-junctions, left at both", "t_junction left // t_junction left"),
        ("three roundabouts", "roundabout // roundabout // roundabout"),
        ("five crossroads, no, make that two", "crossroads // crossroads"),
        ("una rotonda, y luego otras dos rotondas", "roundabout // roundabout // roundabout"),
        (
            "two crossroads and then three more crossroads",
            "crossroads // crossroads // crossroads // crossroads // crossroads",
        ),
        ("three crossroads, left first", "crossroads left // crossroads // crossroads"),
        ("a road with 3 bends and roundabouts at both ends", "roundabout // turn x3 // roundabout"),
        (
            "four crossroads, 100 m apart",
            "crossroads // | len=100 // crossroads // | len=100 // crossroads // | len=100 // crossroads",
        ),
    ],
)
def test_junctions_that_are_all_alike_are_counted(words: str, line: str) -> None:
    assert plan(normal(read(words))) == plan(normal(read_plan(line)))
