"""Junctions in plans: what is read, written, said and refused."""

from typing import get_args

import pytest
from hypothesis import given
from hypothesis import strategies as st

from roadgpt.brief.amount import at_least, between, exactly
from roadgpt.brief.junctions import JunctionClause
from roadgpt.brief.model import Brief, Clause
from roadgpt.brief.plan import plan, read_plan
from roadgpt.language.names import Control, IslandSize, JunctionKind, Side, Take, Way
from tables import rows

AMOUNTS = st.one_of(
    st.integers(1, 6).map(exactly),
    st.integers(1, 6).map(at_least),
    st.tuples(st.integers(1, 3), st.integers(4, 6)).map(lambda pair: between(*pair)),
)
WAYS = st.lists(st.sampled_from(get_args(Way)), max_size=3).map(tuple)
JUNCTIONS = st.builds(
    JunctionClause,
    kind=st.sampled_from(get_args(JunctionKind)),
    take=st.none() | st.sampled_from(get_args(Take)),
    exit=st.none() | AMOUNTS,
    arms=st.none() | AMOUNTS,
    ways=WAYS,
    only_in=WAYS,
    only_out=WAYS,
    degrees=st.none() | AMOUNTS,
    angle=st.none() | AMOUNTS,
    control=st.none() | st.sampled_from(get_args(Control)),
    skew=st.booleans(),
    size=st.none() | st.sampled_from(get_args(IslandSize)),
    radius=st.none() | AMOUNTS,
    lanes=st.none() | AMOUNTS,
    side=st.none() | st.sampled_from(get_args(Side)),
    length=st.none() | AMOUNTS,
    taper=st.none() | AMOUNTS,
    all_way=st.booleans(),
    others_stop=st.booleans(),
    crosswalk=st.booleans(),
    turn_lanes=WAYS,
    turn_length=st.none() | AMOUNTS,
)
ROADS = st.sampled_from(
    [
        Brief(),
        Brief(slope="up"),
        Brief(clauses=(Clause(kind="turn", side="left", degrees=exactly(90)), Clause(kind="straight"))),
        Brief(turns=exactly(3), length=exactly(120)),
        Brief(lanes=exactly(2), against=exactly(0)),
        Brief(lanes=at_least(2), against=exactly(2), divided=True, centre="double", motorway=True),
    ]
)


@st.composite
def routes(draw: st.DrawFn) -> Brief:
    junctions = draw(st.lists(JUNCTIONS, min_size=1, max_size=4))
    stretches = draw(st.lists(ROADS, min_size=len(junctions) + 1, max_size=len(junctions) + 1))
    length, left_hand = draw(st.none() | AMOUNTS), draw(st.booleans())
    return Brief(junctions=tuple(junctions), stretches=tuple(stretches), length=length, left_hand=left_hand)


@given(routes())
def test_a_plan_with_junctions_reads_back_as_the_same_brief(brief: Brief) -> None:
    assert read_plan(plan(brief)) == brief


def test_junctions_and_roads_alternate() -> None:
    brief = read_plan("straight 80 // crossroads left lights // | up // roundabout exit=3 arms=4 r=16 //")
    assert brief.junctions == (
        JunctionClause(kind="crossroads", take="left", control="lights"),
        JunctionClause(kind="roundabout", exit=exactly(3), arms=exactly(4), radius=exactly(16)),
    )


def test_the_roads_of_a_route_are_plans_of_their_own() -> None:
    brief = read_plan(
        "straight 80 // crossroads left // turn x2 right | up // t_junction //|| len=300 beside(wet)"
    )
    assert brief.stretches == (
        Brief(clauses=(Clause(kind="straight", length=exactly(80)),)),
        Brief(clauses=(Clause(kind="turn", count=exactly(2), side="right"),), slope="up"),
        Brief(),
    )
    assert brief.length == exactly(300)
    assert brief.beside == ("wet",)
    assert brief.friction == 0.6


@pytest.mark.parametrize(("short", "full"), rows(__file__, "road_nothing_asked"))
def test_a_road_of_which_nothing_is_asked_may_be_left_out(short: str, full: str) -> None:
    assert read_plan(short) == read_plan(full)
    assert "// //" not in plan(read_plan(full))
