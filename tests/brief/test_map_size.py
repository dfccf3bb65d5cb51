"""The size of the map, in words."""

import pytest

from roadgpt.brief import read
from roadgpt.brief.expressions import said_map_size
from roadgpt.brief.plan import plan, read_plan
from roadgpt.design import draft
from roadgpt.design.room import world_for, world_remarks
from roadgpt.errors import BriefError
from roadgpt.road import Site, World


@pytest.mark.parametrize(
    ("words", "metres", "rest"),
    [
        ("four turns on a map of 500 m by 500 m", 500, "four turns"),
        ("on a 400 m by 400 m map: a crossroads, left", 400, "a crossroads, left"),
        ("a 500 m road on a 300 m map", 300, "a 500 m road"),
        ("drei Kurven auf einer Karte von 500 m mal 500 m", 500, "drei Kurven"),
        ("auf einer 500 m x 500 m großen Karte: zwei Kreuzungen", 500, "zwei Kreuzungen"),
        ("une route sinueuse sur une carte de 400 m sur 400 m", 400, "une route sinueuse"),
        ("en un mapa de 1 km por 1 km, tres cruces", 1000, "tres cruces"),
        ("su una mappa di 0,5 km per 0,5 km due incroci", 500, "due incroci"),
        ("a map of 500 m by 500 m with three crossroads", 500, "a map with three crossroads"),
        ("The map is 600 m wide. Two bends.", 600, "Two bends."),
        ("three turns, map size 300 m", 300, "three turns"),
        ("on a map of 600 m by 300 m, five bends", 300, "five bends"),  # maps are square: both sides hold it
        ("within an area 300 metres square, five bends", 300, "five bends"),
        ("Five bends, on a 1 KM square map.", 1000, "Five bends."),
    ],
)
def test_the_size_of_the_map_is_taken_out(words: str, metres: float, rest: str) -> None:
    assert said_map_size(words) == (metres, rest)


@pytest.mark.parametrize(
    "words",
    [
        "a grid of 3 by 2 blocks of 100 m by 80 m",
        "a map of 3 by 2 blocks",
        "a map of 2 km of streets",
        "a map of roads, 500 m in all",
        "a road of 500 m across a map of nothing",
        "a map of 500 m by 500 m",  # nothing else is said
    ],
)
def test_other_lengths_stay(words: str) -> None:
    found = said_map_size(words)
    assert found is None or found.rest == "a map"


def test_a_map_is_neither_tiny_nor_huge() -> None:
    with pytest.raises(BriefError, match="a map of 5 m by 5 m cannot be made; ask for one of 50 to 40000 m"):
        read("three crossroads on a map of 5 m")
    with pytest.raises(BriefError, match="this gives only the size of the map; say what the road should be"):
        read("on a map of 500 m")
    with pytest.raises(BriefError, match="a map of 50000 m by 50000 m"):
        read("three crossroads on a map of 50 km")


@pytest.mark.parametrize(
    "words",
    ["a road with 4 turns on a 400 m by 400 m map", "auf einer Karte von 400 m: zwei Kreuzungen, links"],
)
def test_words_set_the_map_and_nothing_else(words: str) -> None:
    brief = read(words, is_map_fixed=False)
    bare = said_map_size(words)
    assert bare is not None
    other = read(bare.rest, is_map_fixed=False)
    assert brief.words == words
    assert plan(brief) == plan(other.model_copy(update={"map_size": 400.0}))
    assert world_for(brief, World()).site.map_size == 400
    assert world_for(brief, World(site=Site(map_size=300))).site.map_size == 300


def test_the_other_reading_is_on_the_same_map() -> None:
    brief = read("seven crossroads, left at each, on a map of 500 m", is_map_fixed=False)
    assert brief.other
    assert read_plan(brief.other).map_size == 500


def test_remarks_say_which_map_is_used() -> None:
    brief = read("two bends on a map of 500 m", is_map_fixed=False)
    said = [
        world_remarks(brief, world, world_for(brief, world))
        for world in (World(), World(site=Site(map_size=300)))
    ]
    assert said == [
        ("the words ask for a map of 500 m; --map-size gives another",),
        ("the words ask for a map of 500 m; but one of 300 m is set and used",),
    ]


def test_what_does_not_fit_on_that_map_is_refused() -> None:
    with pytest.raises(BriefError, match="a map of 250 m has no room for 1800 m"):
        read("2 km of road with ten turns on a map of 250 m by 250 m", is_map_fixed=False)


@pytest.mark.parametrize(
    "line",
    ["turn x3 | map_size=400", "crossroads left || map_size=400", "map columns=2 rows=2 || map_size=400"],
)
def test_plans_give_the_size_of_the_map(line: str) -> None:
    brief = read_plan(line)
    assert (brief.map_size, plan(brief)) == (400, line)
    world = world_for(brief, World())
    assert draft(brief, world, seed=1) is not None
    assert world.site.map_size == 400


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("turn | map_size=300..400", "a map has one size"),
        ("turn | map_size=20", "a map is 50 to 40000 m wide, not 20; write for example map_size=500"),
        ("| map_size=300 // crossroads", "a route lies on one map; write map_size= after"),
        ("turn | map_size=300 map_size=400", "map_size twice"),
    ],
)
def test_sizes_that_no_map_has_are_refused(line: str, message: str) -> None:
    with pytest.raises(BriefError, match=message):
        read_plan(line)
