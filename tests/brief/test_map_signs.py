"""Lights that words count on a map, and words for ramps: staying on the motorway, lengths of their lanes."""

import pytest

from roadgpt.brief import normal, read
from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.readers.model.map_signs import with_counted_signs
from roadgpt.brief.readers.model.map_words import with_counted_map
from roadgpt.brief.readers.model.slots import slotted
from roadgpt.brief.sentence import sentence
from roadgpt.errors import BriefError


def corrected(words: str, written: str) -> str:
    text = slotted(words)
    return plan(with_counted_signs(with_counted_map(read_plan(written), text), text))


@pytest.mark.parametrize(
    ("words", "written", "right"),
    [
        (
            "Twelve junctions in all, two of which are roundabouts, and four with traffic lights.",
            "map roundabout x2; crossroads x4; junction x6 lights",
            "map junction x4 lights; roundabout x2; junction x6",
        ),
        (
            "four T-junctions, one crossroads, and stop signs only at the crossroads",
            "map t_junction x4; crossroads stop",
            "map crossroads stop; t_junction x4",
        ),
        (
            "a four by one grid, stop signs at exactly two crossings, lights at exactly one of the others",
            "map columns=4 rows=1; crossroads x2 stop",
            "map columns=4 rows=1; junction lights; junction x2 stop",
        ),
        (
            "two crossroads and four T-junctions. Both crossroads have traffic lights, nothing else has.",
            "map crossroads x2; t_junction x4 lights",
            "map crossroads x2 lights; t_junction x4",
        ),
        (
            "two roundabouts, three forks, lights at one of the forks and nowhere else",
            "map y_junction x3 lights; roundabout x2; y_junction",
            "map y_junction lights; y_junction x2; roundabout x2",
        ),
        (
            "map with four dead ends and two blocks",
            "map columns=4 rows=2 dead_ends=0",
            "map columns=2 rows=1 dead_ends=4",
        ),
        ("six T-junctions, no road that just ends", "map t_junction x6", "map t_junction x6 dead_ends=0"),
        (
            "two T-junctions, a single dead end",
            "map t_junction x2; roundabout",
            "map t_junction x2; roundabout dead_ends=1",
        ),
        (
            "two T-junctions, not a single dead end",
            "map t_junction x2; roundabout",
            "map t_junction x2; roundabout",
        ),
        (
            "two roundabouts, three T-junctions and exactly one cul-de-sac",
            "map roundabout x2; t_junction x3; t_junction",
            "map roundabout x2; t_junction x3 dead_ends=1",
        ),
        (
            "three T-junctions and a T-junction",
            "map t_junction x3; t_junction",
            "map t_junction x3; t_junction",
        ),
        (
            "two roundabouts, a crossroads and three dead ends",
            "map roundabout x2; crossroads blocks=0",
            "map roundabout x2; crossroads dead_ends=3",
        ),
        (
            "two roundabouts, a crossroads and eight dead ends",
            "map roundabout x2; crossroads blocks=0",
            "map roundabout x2; crossroads blocks=0 dead_ends=8",
        ),
        ("a town with five blocks and no lights", "map columns=5 rows=5", "map columns=5 rows=1"),
        ("una ciudad de seis manzanas", "map columns=6 rows=6", "map columns=3 rows=2"),
        (
            "a town with exactly four blocks and three dead ends, lights at two of the junctions",
            "map columns=4 rows=3 dead_ends=3; junction x2 lights",
            "map columns=2 rows=2 dead_ends=3; junction x2 lights",
        ),
        (
            "a town with nine blocks, in which exactly four junctions have lights",
            "map columns=9 rows=9; junction x4 lights",
            "map columns=3 rows=3; junction x4 lights",
        ),
        (
            "trois carrefours en T, un carrefour en croix et trois impasses",
            "map t_junction x3; crossroads; t_junction x3",
            "map t_junction x3; crossroads dead_ends=3",
        ),
        ("a town five blocks wide", "map columns=5 rows=5", "map columns=5 rows=5"),
        ("a town of nine blocks", "map columns=3 rows=3", "map columns=3 rows=3"),
        (
            "a star, three T-junctions and a fork, and stop signs at two of the junctions, not more",
            "map star; t_junction x3; y_junction stop",
            "map star stop; t_junction stop; t_junction x2; y_junction",
        ),
        (
            "drei T-Einmündungen und eine Kreuzung mit Ampel. Alle Straßen sollen zusammenhängen",
            "map t_junction x3; crossroads lights",
            "map crossroads lights; t_junction x3",
        ),
        (
            "every street is 80 m long; two forks and a crossroads with a stop sign",
            "map y_junction x2; crossroads stop",
            "map crossroads stop; y_junction x2",
        ),
        (
            "two roundabouts, four T-junctions and one crossroads. Traffic lights at the crossroads only,"
            " stop signs at exactly two of the T-junctions and nowhere else.",
            "map roundabout x2 stop; t_junction x4; crossroads",
            "map t_junction x2 stop; crossroads lights; roundabout x2; t_junction x2",
        ),
        (
            "two roundabouts and four T-junctions, lights at the roundabouts only",
            "map roundabout x2; t_junction x4 lights",
            "map roundabout x2 lights; t_junction x4",
        ),
        (
            "six junctions, two of them with lights",
            "map junction x6 lights",
            "map junction x2 lights; junction x4",
        ),
        (
            "cuatro cruces, exactamente uno tiene semáforo",
            "map crossroads x4 lights",
            "map crossroads lights; crossroads x3",
        ),
        (
            "a village: three crossroads with lights and two roundabouts",
            "map crossroads x3; roundabout x2 lights",
            "map crossroads x3 lights; roundabout x2",
        ),
        (
            "un pueblo con cuatro cruces, dos con semáforo",
            "map crossroads x4 lights",
            "map crossroads x2 lights; crossroads x2",
        ),
        (
            "eine Kleinstadt mit fünf Kreuzungen, drei davon mit Ampel",
            "map crossroads x5 lights",
            "map crossroads x3 lights; crossroads x2",
        ),
        (
            "cinq carrefours, dont deux avec des feux",
            "map crossroads x5",
            "map crossroads x2 lights; crossroads x3",
        ),
        (
            "six crossroads of which two have lights",
            "map crossroads x6 lights",
            "map crossroads x2 lights; crossroads x4",
        ),
        (
            "two roundabouts plus three crossroads with lights",
            "map roundabout x2; crossroads x3 lights",
            "map crossroads x3 lights; roundabout x2",
        ),
        (
            "tres cruces con semáforo y dos rotondas",
            "map crossroads x3; roundabout x2 lights",
            "map crossroads x3 lights; roundabout x2",
        ),
        (
            "three forks with lights and two stars",
            "map y_junction x3; star x2 lights",
            "map y_junction x3 lights; star x2",
        ),
        (
            "four crossroads with lights at three of them",
            "map crossroads x4 lights",
            "map crossroads x3 lights; crossroads",
        ),
        (
            "five crossroads, only one has lights",
            "map crossroads x5 lights",
            "map crossroads lights; crossroads x4",
        ),
        (
            "eight crossings in all, two of them roundabouts",
            "map crossroads x8; roundabout x2",
            "map roundabout x2; junction x6",
        ),
        (
            "huit carrefours dont deux giratoires, aucun cul-de-sac",
            "map roundabout x2 dead_ends=0",
            "map roundabout x2; junction x6 dead_ends=0",
        ),
        (
            "cinque incroci, uno solo con il semaforo, e tre strade senza uscita",
            "map crossroads x5 dead_ends=3",
            "map junction lights; junction x4 dead_ends=3",
        ),
        (
            "four crossroads, lights at two of them",
            "map crossroads x4 lights",
            "map crossroads x2 lights; crossroads x2",
        ),
        (
            "un paese con sei incroci in tutto, due dei quali sono rotatorie, e tre vicoli ciechi",
            "map crossroads x2; roundabout x3; junction x3 dead_ends=3",
            "map roundabout x2; junction x4 dead_ends=3",
        ),
    ],
)
def test_lights_are_where_the_words_count_them(words: str, written: str, right: str) -> None:
    assert corrected(words, written) == right


@pytest.mark.parametrize(
    ("words", "written", "right"),
    [
        ("two by two blocks, traffic lights at the middle crossroads only",
         "map columns=2 rows=2; crossroads x2 lights", "map columns=2 rows=2; crossroads lights"),
        ("a grid of 2 by 2 blocks, lights only at the junction in the middle",
         "map columns=2 rows=2; junction x2 lights", "map columns=2 rows=2; crossroads lights"),
        ("a 3 by 3 grid, lights at the inner junctions only", "map columns=3 rows=3 lights",
         "map columns=3 rows=3; crossroads x4 lights"),
        ("ein Gitter aus 3 mal 2 Blöcken, nur die inneren Kreuzungen haben Stoppschilder",
         "map columns=3 rows=2 stop", "map columns=3 rows=2; crossroads x2 stop"),
        ("una trama de 2 por 2 con semáforo solo en el cruce del centro", "map columns=2 rows=2 lights",
         "map columns=2 rows=2; crossroads lights"),
        ("a 3 by 3 grid with lights at the junction in the middle",
         "map columns=3 rows=3; junction lights", None),
        ("a 2 by 2 grid in the middle of the town, all with lights", "map columns=2 rows=2 lights", None),
        ("a two by two grid in the town centre with traffic lights", "map columns=2 rows=2 lights", None),
        ("a 2 by 2 grid, traffic lights as in the city centre", "map columns=2 rows=2 lights", None),
        ("a 3 by 1 grid, lights in the middle", "map columns=3 rows=1 lights", None),
    ],
)  # fmt: skip
def test_signs_within_a_grid_stand_at_its_inner_crossroads(
    words: str, written: str, right: str | None
) -> None:
    found = with_counted_signs(read_plan(written), slotted(words))
    assert plan(found) == plan(read_plan(right or written))


@pytest.mark.parametrize(
    ("words", "written"),
    [
        ("five crossroads, all five with lights", "map crossroads x5 lights"),
        (
            "two forks and a crossroads, all with lights; all roads are level",
            "map y_junction x2; crossroads lights",
        ),
        ("a small town of six crossroads with traffic lights", "map crossroads x6 lights"),
        ("four crossroads with lights, no, two with lights", "map crossroads x4 lights"),
        ("a grid of three by two blocks with lights", "map columns=3 rows=2 lights"),
        ("at least three crossroads, two with lights", "map crossroads x3.. lights"),
        ("five crossroads and three dead ends", "map crossroads x5 dead_ends=3"),
        ("three junctions and two roundabouts", "map junction x3; roundabout x2"),
        ("two roundabouts and three intersections", "map roundabout x2; crossroads x3"),
        ("six junctions, two have no lights", "map junction x6"),
        ("sechs Kreuzungen, zwei haben keine Ampel", "map crossroads x6"),
        ("sei incroci, 2 non hanno semafori", "map crossroads x6"),
        ("four junctions and two dead ends with lights", "map junction x4 dead_ends=2 lights"),
        ("five crossroads on roads of two lanes with lights", "map crossroads x5 lights"),
        ("six junctions, traffic lights on 2 arms each", "map junction x6 lights"),
        ("five crossroads, every one of them with traffic lights", "map crossroads x5 lights"),
        ("five crossroads, two with lights", "map crossroads x2 lights; crossroads x3"),
        ("four forks and three crossroads", "map y_junction x4; crossroads x3"),
    ],
)
def test_other_words_leave_the_map_as_it_is(words: str, written: str) -> None:
    assert corrected(words, written) == written


@pytest.mark.parametrize(
    ("written", "said"),
    [
        ("map junction x4 lights; junction x6", "4 junctions with traffic lights and 6 junctions"),
        (
            "map crossroads lights; star yield",
            "1 crossroads with traffic lights and 1 star junction with give-way signs",
        ),
    ],
)
def test_signs_of_one_kind_are_written_and_said(written: str, said: str) -> None:
    brief = read_plan(written)
    assert plan(brief) == written
    assert said in sentence(brief)


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("map junction lights stop; junction", "two signs: 'stop'"),
        ("map junction x2 lights; junction yield stop", "control of a map twice: 'stop'"),
    ],
)
def test_a_kind_has_one_sign(line: str, said: str) -> None:
    with pytest.raises(BriefError, match=said):
        read_plan(line)


def test_signs_behind_the_last_kind_are_those_of_the_map() -> None:
    plain = read_plan("map crossroads x3 lights len=100")
    assert (
        plain
        == read_plan("map crossroads x3 lights; len=100")
        == read_plan("map crossroads x3; len=100 lights")
    )
    assert plain.map is not None
    assert (plain.map.control, plain.map.junctions[0].control) == ("lights", None)


def test_exits_before_the_numbered_one_are_passed() -> None:
    words = "we leave the motorway at the second exit"
    line = "| motorway // diverge main // | motorway // diverge ramp"
    assert plan(normal(read(words))) == plan(normal(read_plan(line)))


@pytest.mark.parametrize(
    ("words", "line"),
    [
        ("an 80 m deceleration lane and a 30 m taper before it", "diverge ramp len=80 taper=30"),
        ("Einfädelspur von 120 m, dann 400 m Autobahn", "merge ramp len=120 // | len=400 motorway"),
        (
            "The acceleration lane is 250 m long at full width and then tapers out over another 60 m.",
            "merge ramp len=250 taper=60",
        ),
        ("carril de aceleración: 90 m", "merge ramp len=90"),
        ("a lane ends with a taper of 60 m", "lane_drop len=60"),
        ("zwei Spuren, eine endet, Verziehung 60 m", "| lanes=2 // lane_drop len=60"),
        ("acceleration lane of 60 m, taper 60 m", "merge ramp len=60 taper=60"),
        ("a deceleration lane of 80 m, no, of 90 m", "diverge ramp len=90"),
        ("a deceleration lane of 80 to 100 m", "diverge ramp len=80..100"),
        ("at least 80 m of deceleration lane", "diverge ramp len=80.."),
        ("after 300 m a deceleration lane begins", "| len=300 // diverge ramp"),
        ("acceleration lane of 100 m, then 100 m of motorway", "merge ramp len=100 // | len=100 motorway"),
    ],
)
def test_lengths_of_lanes_and_tapers_belong_to_the_ramp(words: str, line: str) -> None:
    assert plan(normal(read(words))) == plan(normal(read_plan(line)))
