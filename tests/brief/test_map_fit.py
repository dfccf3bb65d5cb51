"""The real map decides what can be built: for every reader, in every language, whatever it was trained on."""

import pytest

from roadgpt.brief import exactly, read
from roadgpt.check.measures import measure
from roadgpt.design import draft
from roadgpt.design.room import world_for
from roadgpt.errors import BriefError
from roadgpt.road import World, build
from tables import rows

LONG = rows(__file__, "long")


@pytest.mark.parametrize(("words", "metres", "is_straight"), LONG)
def test_a_long_road_is_read_where_the_map_is_large(words: str, metres: float, is_straight: bool) -> None:
    brief = read(words, map_size=10_000)
    lengths = [brief.length, *(clause.length for clause in brief.clauses)]
    assert [length for length in lengths if length] == [exactly(metres)]
    assert (brief.turns == exactly(0)) == is_straight
    assert brief.words == words


@pytest.mark.parametrize(("words", "metres", "is_straight"), LONG)
@pytest.mark.parametrize("size", [100, 250])
def test_and_refused_where_it_is_small(words: str, metres: float, is_straight: bool, size: float) -> None:
    with pytest.raises(BriefError, match=f"map of {size} m"):
        read(words, map_size=size)


def test_the_tightest_turn_is_that_of_the_world() -> None:
    with pytest.raises(BriefError, match="too tight"):
        read("a turn with a radius of 8 m")
    assert read("a turn with a radius of 8 m", min_radius=5.0).clauses[0].radius == exactly(8)


@pytest.mark.parametrize("words", rows(__file__, "map_holds_refused"))
def test_what_no_map_holds_is_refused_on_every_map(words: str) -> None:
    with pytest.raises(BriefError):
        read(words, map_size=10_000)


@pytest.mark.parametrize(("words", "turns"), rows(__file__, "closed_loop_asked"))
def test_a_closed_loop_that_is_not_asked_for_does_not_matter(words: str, turns: int) -> None:
    assert [clause.count for clause in read(words).clauses] == [exactly(turns)]


@pytest.mark.parametrize("size", [300, 1000, 4000])
def test_a_single_straight_is_held_against_the_diagonal(size: float) -> None:
    fits, large = 1.2 * size, 2 * size
    read(f"straight {fits:.0f}; turn left", "plan", map_size=size)
    with pytest.raises(BriefError, match=f"map of {size} m, which is .* from corner to corner"):
        read(f"straight {large:.0f}; turn left", "plan", map_size=size)


@pytest.mark.parametrize(
    ("words", "metres", "turns"),
    [("a road 3 km long with 3 turns", 3000, 3), ("eine 2 km lange Straße mit 5 Kurven", 2000, 5)],
)
def test_a_road_too_long_for_the_usual_map_is_read_if_the_map_may_grow(
    words: str, metres: float, turns: int
) -> None:
    with pytest.raises(BriefError, match="larger map"):
        read(words, map_size=250)
    brief = read(words, map_size=250, is_map_fixed=False)
    assert brief.length == exactly(metres)
    wide = world_for(brief, World())
    assert wide.site.map_size > 250
    found = measure(build(draft(brief, wide, seed=2)).sample().points)
    assert found.length == pytest.approx(metres, rel=0.1)
    assert len(found.turns) == turns
