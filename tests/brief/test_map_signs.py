"""Lights that words count on a map, and words for ramps: staying on the motorway, lengths of their lanes."""

import pytest

from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.readers.model.exit_words import with_stay_on_motorway
from roadgpt.brief.readers.model.map_signs import with_counted_lights
from roadgpt.brief.readers.model.map_words import with_counted_map
from roadgpt.brief.readers.model.own_lane import with_each_lane
from roadgpt.brief.readers.model.ramp_lengths import with_ramp_lengths
from roadgpt.brief.readers.model.slots import slotted
from roadgpt.brief.sentence import sentence
from roadgpt.errors import BriefError


def corrected(words: str, written: str) -> str:
    text = slotted(words)
    return plan(with_counted_lights(with_counted_map(read_plan(written), text), text))


@pytest.mark.parametrize(
    ("words", "written", "right"),
    [
        (
            "Twelve junctions in all, two of which are roundabouts, and four with traffic lights.",
            "map roundabout x2; crossroads x4; junction x6 lights",
            "map junction x4 lights; roundabout x2; junction x6",
        ),
        (
            "six junctions, two of them with lights",
            "map junction x6 lights",
            "map junction x2 lights; junction x4",
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
    ("words", "written"),
    [
        ("five crossroads, all five with lights", "map crossroads x5 lights"),
        ("a small town of six crossroads with traffic lights", "map crossroads x6 lights"),
        ("four crossroads with lights, no, two with lights", "map crossroads x4 lights"),
        ("a grid of three by two blocks with lights", "map columns=3 rows=2 lights"),
        ("at least three crossroads, two with lights", "map crossroads x3.. lights"),
        ("six junctions with stop signs", "map junction x6 stop"),
    ],
)
def test_other_words_leave_the_map_as_it_is(words: str, written: str) -> None:
    assert corrected(words, written) == written


@pytest.mark.parametrize(
    ("written", "said"),
    [
        ("map junction x4 lights; junction x6", "4 junctions with traffic lights and 6 junctions"),
        ("map crossroads lights; star yield", "1 crossroads with traffic lights and 1 star junction where"),
    ],
)
def test_signs_of_one_kind_are_written_and_said(written: str, said: str) -> None:
    brief = read_plan(written)
    assert plan(brief) == written
    assert said in sentence(brief)


def test_a_kind_has_one_sign() -> None:
    with pytest.raises(BriefError, match="twice"):
        read_plan("map junction lights stop; junction x2 lights yield stop")


@pytest.mark.parametrize(
    ("words", "written", "right"),
    [
        (
            "über die Rampe auf die Autobahn, und an der nächsten Ausfahrt bleibe ich auf der Autobahn",
            "merge ramp // | motorway // diverge ramp",
            "merge ramp // | motorway // diverge main",
        ),
        ("an exit, but I stay on the motorway", "diverge ramp", "diverge main"),
        ("stay on the motorway for 300 m, then leave it", "diverge ramp", "diverge ramp"),
        ("restez 500 m sur l'autoroute et ressortez", "diverge ramp", "diverge ramp"),
        ("Ne restez pas sur l'autoroute", "diverge ramp", "diverge ramp"),
        ("the exit of the motorway", "diverge ramp", "diverge ramp"),
    ],
)
def test_who_stays_on_the_motorway_takes_no_exit(words: str, written: str, right: str) -> None:
    assert plan(with_stay_on_motorway(read_plan(written), words)) == right


@pytest.mark.parametrize(
    ("words", "written", "right"),
    [
        (
            "an 80 m deceleration lane and a 30 m taper before it",
            "| len=30 // diverge ramp len=80",
            "diverge ramp len=80 taper=30",
        ),
        (
            "Einfädelspur von 120 m, dann 400 m Autobahn",
            "merge ramp // | len=400 motorway",
            "merge ramp len=120 // | len=400 motorway",
        ),
        ("carril de aceleración: 90 m", "merge ramp // | len=90", "merge ramp len=90"),
        ("a lane ends with a taper of 60 m", "merge main // lane_drop len=60", None),
        ("a deceleration lane of 80 m, no, of 90 m", "diverge ramp len=90", None),
        ("two acceleration lanes of 80 m", "merge ramp len=80 // merge ramp len=80", None),
        ("80 m before the exit", "| len=80 // diverge ramp", None),
    ],
)
def test_lengths_of_lanes_and_tapers_belong_to_the_ramp(words: str, written: str, right: str | None) -> None:
    found = with_ramp_lengths(read_plan(written), slotted(words))
    assert found == read_plan(right or written)


@pytest.mark.parametrize(
    ("written", "right"),
    [
        (
            "| lanes=2 oneway // lane_drop // | lanes=1 against=1",
            "| lanes=2 oneway // lane_drop // | lanes=1",
        ),
        ("| lanes=2 oneway // crossroads // | against=1", "| lanes=2 oneway // crossroads // | against=1"),
    ],
)
def test_a_one_way_road_stays_one_behind_a_lane_that_ends(written: str, right: str) -> None:
    assert plan(with_each_lane(read_plan(written))) == plan(read_plan(right))
