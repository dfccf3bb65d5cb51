"""What is possible passes; the limits are those of the World; the real map decides for every
reader and language; and words and plans give its size.
"""

import pytest

from grids import diagonal
from roadgpt.brief import Brief, Clause, check, exactly, read
from roadgpt.brief.expressions import said_map_size
from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.words import LEAST_RADIUS, STEEPEST
from roadgpt.check.measures import measure
from roadgpt.design import draft
from roadgpt.design.room import world_for, world_remarks
from roadgpt.errors import BriefError
from roadgpt.road import Site, World, build
from roadgpt.road.design import MAX_INCLINE
from tables import rows

LONG = rows(__file__, "long")


@pytest.mark.parametrize(("words", "metres", "is_straight"), LONG)
def test_a_long_road_is_read_where_the_map_is_large(words: str, metres: float, is_straight: bool) -> None:
    brief = read(words, map_size=10_000)
    lengths = [brief.length, *(clause.length for clause in brief.clauses)]
    assert [length for length in lengths if length] == [exactly(metres)]
    assert (brief.turns == exactly(0)) == is_straight
    assert brief.words == words


@pytest.mark.parametrize(("row", "size"), diagonal(LONG, [100, 250]))
def test_and_refused_where_it_is_small(row: tuple[str, float, bool], size: float) -> None:
    with pytest.raises(BriefError, match=f"map of {size} m"):
        read(row[0], map_size=size)


def test_the_tightest_turn_is_that_of_the_world() -> None:
    with pytest.raises(BriefError, match="too tight"):
        read("a turn with a radius of 8 m")
    assert read("a turn with a radius of 8 m", min_radius=5.0).clauses[0].radius == exactly(8)


@pytest.mark.parametrize("forks", range(4))
@pytest.mark.parametrize("crossings", range(4))
def test_dead_ends_are_possible_as_euler_has_it(forks: int, crossings: int) -> None:
    """Each road has two ends, so arms and dead ends together are even; a tree of junctions has the most."""
    junctions, arms = forks + crossings, 3 * forks + 4 * crossings
    named = [f"{kind} x{n}" for kind, n in (("t_junction", forks), ("crossroads", crossings)) if n]
    for ends in range(arms + 2) if junctions else ():
        fits = (arms + ends) % 2 == 0 and ends <= arms - 2 * (junctions - 1)
        brief = read_plan(f"map {'; '.join(named)} dead_ends={ends}")
        if fits and (junctions > 1 or ends == arms):  # no road leads back to its own junction
            check(brief)
        else:
            with pytest.raises(BriefError, match="can be built as"):
                check(brief)


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


@pytest.mark.parametrize("line", rows(__file__, "possible"))
def test_what_can_be_passes(line: str) -> None:
    check(read_plan(line))


def test_a_larger_map_holds_more() -> None:
    many = Brief(clauses=(Clause(kind="hairpin", count=exactly(40)),))
    with pytest.raises(BriefError, match="larger map"):
        check(many, map_size=250)
    check(many, map_size=600)
    check(many, map_size=None)


def test_limits_are_those_of_the_world() -> None:
    world = World()
    assert (world.limits.min_radius, world.limits.max_grade, MAX_INCLINE) == (
        LEAST_RADIUS,
        STEEPEST / 100,
        STEEPEST,
    )


def test_the_limits_of_another_world_count() -> None:
    tight = Brief(clauses=(Clause(kind="turn", radius=exactly(20)),))
    check(tight)
    with pytest.raises(BriefError, match="ask for 30 m or more"):
        check(tight, min_radius=30.0)
    tighter = Brief(clauses=(Clause(kind="turn", radius=exactly(9)),))
    with pytest.raises(BriefError, match="too tight"):
        check(tighter)
    check(tighter, min_radius=8.0)
    assert read("turn r=9", "plan", min_radius=8.0).clauses == tighter.clauses
    with pytest.raises(BriefError, match="ask for 6 percent or less"):
        read("| up turns=1.. pct=10", "plan", max_grade=0.06)
    with pytest.raises(BriefError, match="ask for 15 percent or less"):
        read("| up turns=1.. pct=20", "plan", max_grade=0.3)  # designs have no more
