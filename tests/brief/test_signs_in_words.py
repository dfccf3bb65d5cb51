"""Words in five languages that count the junctions of a map with lights or signs, read by rules alone."""

import pytest

from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.readers.model.map_signs import with_counted_signs
from roadgpt.brief.readers.model.map_words import with_counted_map
from roadgpt.brief.readers.model.slots import slotted

GRID = "map columns=2 rows=2"
ONE_LIT = f"{GRID}; junction lights"
TWO_LIT = f"{GRID}; junction x2 lights"
ALL_BUT_ONE = f"{GRID} stop; junction none"


def corrected(words: str, written: str) -> str:
    return plan(with_counted_signs(read_plan(written), slotted(words)))


@pytest.mark.parametrize(
    "words",
    [
        "a grid of two by two blocks with traffic lights at one junction",
        "a grid of two by two blocks, one of the junctions has traffic lights",
        "two by two blocks, traffic lights at only one of the crossroads",
        "a 2 x 2 grid where exactly one has lights",
        "a grid of 2 by 2 blocks; just one crossing with a set of traffic lights",
        "ein Gitter aus zwei mal zwei Blöcken, an einer Kreuzung steht eine Ampel",
        "ein Raster 2 x 2 mit einer Ampel an nur einer Kreuzung",
        "zwei mal zwei Häuserblöcke, eine der Kreuzungen hat eine Ampel",
        "zwei mal zwei Blöcke, nur eine Kreuzung mit Ampel",
        "une grille de deux îlots sur deux avec des feux à un carrefour",
        "une grille de deux par deux, un seul carrefour a des feux",
        "grille de 2 sur 2, l'un des carrefours a des feux tricolores",
        "una cuadrícula de dos por dos manzanas con semáforo en un cruce",
        "cuadrícula de 2 por 2, uno de los cruces tiene semáforo",
        "cuadrícula de dos por dos con semáforos en una sola intersección",
        "una griglia di due per due isolati con il semaforo a un incrocio",
        "griglia 2 x 2, uno degli incroci ha il semaforo",
    ],
)
@pytest.mark.parametrize("written", [GRID, f"{GRID} lights"])
def test_one_junction_of_a_grid_has_lights(words: str, written: str) -> None:
    assert corrected(words, written) == ONE_LIT


@pytest.mark.parametrize(
    "words",
    [
        "a grid of two by two blocks with lights at two of the junctions",
        "two by two blocks, two of the crossings have traffic lights",
        "zwei mal zwei Blöcke, Ampeln an zwei der Kreuzungen",
        "zwei mal zwei Blöcke, Ampeln nur an zwei Kreuzungen",
        "zwei mal zwei Blöcke, an zwei Kreuzungen stehen Ampeln",
        "deux îlots sur deux, des feux à deux des carrefours",
        "dos por dos manzanas, en dos cruces hay semáforo",
        "due per due isolati, due incroci con semaforo",
    ],
)
def test_two_junctions_of_a_grid_have_lights(words: str) -> None:
    assert corrected(words, f"{GRID} lights") == TWO_LIT


@pytest.mark.parametrize(
    "words",
    [
        "a grid of two by two blocks, all crossroads but one have stop signs",
        "two by two blocks, stop signs at all junctions except one",
        "two by two blocks, all but one of the crossings have stop signs",
        "two by two blocks with stop signs everywhere except at one junction",
        "zwei mal zwei Blöcke, alle Kreuzungen bis auf eine haben Stoppschilder",
        "zwei mal zwei Blöcke, Stoppschilder an allen Kreuzungen außer einer",
        "deux îlots sur deux, tous les carrefours sauf un ont un stop",
        "dos por dos manzanas, todos los cruces menos uno tienen señal de stop",
        "due per due isolati, tutti gli incroci tranne uno hanno lo stop",
    ],
)
def test_all_junctions_of_a_grid_but_one_have_a_sign(words: str) -> None:
    assert corrected(words, f"{GRID} stop") == ALL_BUT_ONE


@pytest.mark.parametrize(
    ("words", "written", "right"),
    [
        (
            "two by two blocks, at least three of the junctions have lights",
            f"{GRID} lights",
            f"{GRID}; junction x3.. lights",
        ),
        (
            "zwei mal zwei Blöcke, höchstens zwei Kreuzungen haben Ampeln",
            f"{GRID} lights",
            f"{GRID}; junction x..2 lights",
        ),
        (
            "two by two blocks; two T-junctions have stop signs, one crossroads has traffic lights",
            f"{GRID} lights",
            f"{GRID}; junction lights; t_junction x2 stop",
        ),
        (
            "two by two blocks; one junction has traffic lights, the others have stop signs",
            f"{GRID} stop",
            f"{GRID} stop; junction lights",
        ),
        (
            "two by two blocks; all junctions but one have give-way signs, the other one has lights",
            f"{GRID} yield",
            f"{GRID} yield; junction lights",
        ),
        ("two by two blocks, lights at each of the junctions", f"{GRID} lights", f"{GRID} lights"),
        ("two by two blocks with traffic lights", f"{GRID} lights", f"{GRID} lights"),
        ("deux îlots sur deux avec des stops partout", f"{GRID} stop", f"{GRID} stop"),
        ("due isolati per due con lo stop a ogni incrocio", f"{GRID} stop", f"{GRID} stop"),
        (
            "six junctions, two of them with lights",
            "map junction x6 stop",
            "map junction x2 lights; junction x4",
        ),
        (
            "six junctions, all but two with lights",
            "map junction x6 lights",
            "map junction x4 lights; junction x2",
        ),
        (
            "six junctions, at least two with lights",
            "map junction x6 lights",
            "map junction x2 lights; junction x4",
        ),
        (
            "sechs Kreuzungen, höchstens zwei mit Ampeln",
            "map crossroads x6 lights",
            "map crossroads x2 lights; crossroads x4",
        ),
        (
            "a village with three crossroads, one of them with lights",
            "map crossroads x3 lights",
            "map crossroads lights; crossroads x2",
        ),
        (
            "a village with four crossroads; all crossroads but one have stop signs",
            "map crossroads x4 stop",
            "map crossroads x3 stop; crossroads",
        ),
        (
            "ein Dorf mit fünf Kreuzungen; zwei haben Stoppschilder, eine Kreuzung hat eine Ampel",
            "map crossroads x5 stop",
            "map crossroads lights; crossroads x2 stop; crossroads x2",
        ),
        (
            "three crossroads, two with traffic lights, the other has a stop sign",
            "map crossroads x3 lights",
            "map crossroads x2 lights; crossroads stop",
        ),
        (
            "six junctions with stop signs, but one of them has lights",
            "map junction x6 stop",
            "map junction lights; junction x5 stop",
        ),
        (
            "a village with a crossroads with lights and two roundabouts",
            "map crossroads; roundabout x2 lights",
            "map crossroads lights; roundabout x2",
        ),
        (
            "two crossroads and three T-junctions, three of them with lights",
            "map crossroads x2; t_junction x3 lights",
            "map crossroads x2 lights; t_junction lights; t_junction x2",
        ),
        (
            "two T-junctions with stop signs, one crossroads with lights",
            "map t_junction x2 stop",
            "map t_junction x2 stop",
        ),
        (
            "five crossroads, not one of them has lights",
            "map crossroads x5",
            "map crossroads x5",
        ),
        (
            "every one of the five crossroads has lights",
            "map crossroads x5 lights",
            "map crossroads x5 lights",
        ),
    ],
)
def test_signs_are_where_the_words_count_them(words: str, written: str, right: str) -> None:
    assert corrected(words, written) == right


def test_more_than_one_block_is_not_one_block() -> None:
    words = "More than one block, please, in a suburb of three crossroads and four T-junctions"
    written = "map crossroads x3; t_junction x4 blocks=2.."
    assert with_counted_map(read_plan(written), slotted(words)) == read_plan(written)


def test_what_is_found_is_read_back_from_its_own_plan() -> None:
    for line in (
        ONE_LIT,
        TWO_LIT,
        ALL_BUT_ONE,
        f"{GRID} stop route=left; t_junction x..2 none; junction x2 lights",
    ):
        assert plan(read_plan(line)) == line
