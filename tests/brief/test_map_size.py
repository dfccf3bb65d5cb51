"""The size of the map, in words."""

import pytest

from roadgpt.brief import read
from roadgpt.brief.expressions import said_map_size
from roadgpt.brief.plan import plan, read_plan
from roadgpt.design import draft
from roadgpt.design.room import world_for, world_remarks
from roadgpt.errors import BriefError
from roadgpt.road import Site, World


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
    other = read(bare[1], is_map_fixed=False)
    assert brief.words == words
    assert plan(brief) == plan(other.model_copy(update={"map_size": 400.0}))
    assert world_for(brief, World()).site.map_size == 400
    assert world_for(brief, World(site=Site(map_size=300))).site.map_size == 300


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
