"""Junctions in plans: what is read, written, said and refused."""

from typing import get_args

import pytest
from hypothesis import given
from hypothesis import strategies as st

from roadgpt.brief import read, sentence
from roadgpt.brief.amount import Amount, at_least, between, exactly
from roadgpt.brief.feasible import check
from roadgpt.brief.junctions import Control, IslandSize, JunctionClause, JunctionKind, Side, Take, Way
from roadgpt.brief.model import Brief, Clause
from roadgpt.brief.plan import plan, read_plan
from roadgpt.errors import BriefError

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


@pytest.mark.parametrize(
    ("line", "told"),
    [
        ("straight // turn left // t_junction", "junction is missing between 'straight' and 'turn left'"),
        ("straight // ", "needs a junction"),
        ("turn left; t_junction left", "no clause 't_junction'"),
        ("t_junction left; straight", "no word 'left;' for a junction"),
        ("// t_junction sideways //", "no word 'sideways' for a junction"),
        ("// t_junction left right //", "gives take of a junction twice"),
        ("// roundabout exit=third //", "is not a number in a plan"),
        ("// crossroads ways=up+down //", "ways are left or right or straight"),
        ("map crossroads x3 // t_junction", "a map is no part of a route; ask for one of them"),
        ("| left_hand // t_junction", "write left_hand after ||"),
        ("| centre=dotted", "there are solid, broken, double, none"),
        ("// t_junction // || up", "only len, left_hand, map_size and beside can be asked"),
        ("// t_junction // || hurry", "no word 'hurry'"),
        ("// t_junction // straigt", "no clause 'straigt'"),
    ],
)
def test_what_is_no_plan_is_refused_in_one_sentence(line: str, told: str) -> None:
    with pytest.raises(BriefError, match=told) as caught:
        read_plan(line)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("line", "told"),
    [
        ("// y_junction straight //", "at a Y-junction one can go left or right"),
        ("// t_junction arms=4 //", "a T-junction has 3 arms, not 4"),
        ("// roundabout arms=4 exit=6 //", "has no exit 6"),
        ("// crossroads back //", "only at a roundabout"),
        ("// crossroads exit=2 //", "has no exit"),
        ("// crossroads mini //", "has no size"),
        ("// t_junction r=20 //", "has no radius"),
        ("// star skew //", "only crossroads are skew"),
        ("// t_junction right ways=left+straight //", "has none right"),
        ("// t_junction ways=left+left //", "2 different ways on"),
        ("// crossroads ways=left+left //", "1 to 3 different ways on"),
        ("crossroads left in=left", "the route goes left, where a one-way road comes towards it"),
        ("crossroads in=left out=left", "one-way in one direction only"),
        ("crossroads in=left ways=left", "is a way on and has a one-way road towards the junction"),
        ("crossroads straight ways=left+straight out=right", "name all in ways="),
        ("crossroads ways=left out=left", "one more is needed for the route"),
        ("roundabout in=left", "a roundabout with one-way roads on a side is not built"),
        ("merge in=left", "a merge has no in; leave it out"),
        (
            "t_junction angle=30",
            "angle between roads at a T-junction is 55 to 90 degrees, not 30",
        ),
        ("crossroads skew angle=90", "no crossroads has angle=90, skew at once"),
        ("crossroads left deg=60 angle=90", "no crossroads has deg=60, angle=90, 4 arms at once"),
        ("crossroads left skew deg=90", "no crossroads has deg=90, skew at once"),
        ("y_junction left deg=30 angle=120", "no Y-junction has deg=30, angle=120, 3 arms at once"),
        ("star arms=6 angle=65", "no star junction has angle=65, 6 arms at once"),
        ("junction left arms=4 deg=30", "at a junction, the route turns by 40 to 140 degrees, not 30"),
        ("roundabout deg=90", "angles are not asked of a roundabout"),
        ("junction angle=60", "the angle between roads is asked of a kind of junction"),
        ("crossroads left deg=200", "at a crossroads, the route turns by 40 to 140 degrees, not 200"),
        ("t_junction right deg=30", "at a T-junction, the route turns by 55 to 125 degrees, not 30"),
        ("crossroads straight deg=10", "straight on, the route turns by few degrees"),
        ("crossroads right out=right", "write oneway there"),
        ("t_junction in=left out=right", "at a T-junction, 2 one-way roads leave no way on"),
        ("crossroads taper=50", "a crossroads has no taper, only a merge or an exit has"),
        ("lane_drop taper=50", "a lane drop has no taper"),
        ("merge ramp taper=5", "taper of a merge is 10 to 1500 m, not 5 m"),
        ("diverge ramp len=5000", "len of a motorway exit is 10 to 1500 m, not 5000 m"),
        ("merge ramp len=30 taper=200", "the additional lane of a merge is 66 m long or longer, not 30 m"),
        ("map crossroads dead_ends=2", "all arms of the only junction of a map are dead ends, 4"),
        ("map star x2 dead_ends=50", "leave 10 dead ends at most, not 50"),
        ("map columns=2 rows=2 dead_ends=2.5", "a map has 0, 1, 2 or more dead ends, not 2.5"),
        ("map t_junction x3 dead_ends=2", "leave an odd number of dead ends, 5 at most, not 2"),
        ("map t_junction x2 dead_ends=6", "leave 4 dead ends at most, not 6"),
        ("map t_junction x2 blocks=3", "enclose at most 2 blocks, not 3"),
        ("map crossroads blocks=1", "the roads of a single junction enclose no block"),
        ("map t_junction x3 blocks=0.5", "roads enclose 0, 1, 2 or more blocks, not 0.5"),
        ("map t_junction x4 blocks=1 dead_ends=6", "6 dead ends without blocks, and each block takes two"),
        ("map columns=1 rows=1 dead_ends=0", "one block without dead ends has no junction"),
        ("map columns=2 rows=1 dead_ends=9", "6 roads at most lead out of this grid, not 9"),
        ("// roundabout mini r=30 //", "a mini roundabout is 13 to 25 m wide"),
        ("// roundabout back // straight", "ends on the road on which it came"),
        ("// roundabout back // // t_junction //", "ends on the road on which it came"),
        (
            "| lanes=2 // lane_drop // | lanes=2",
            "one lane fewer, but the road before it has 2 and the one behind",
        ),
        ("| lanes=1 // lane_gain // | lanes=1", "one lane more"),
        ("| lanes=2 // lane_change left // | lanes=3", "as many lanes"),
        ("| lanes=3 // merge main // | lanes=2", "as many lanes"),
        ("diverge ramp len=5", "28 m long or longer, not 5 m"),
        ("turn left 300 // t_junction //", "300"),
        ("straight | turns=2 // t_junction // | up flat", "twice"),
    ],
)
def test_a_junction_that_cannot_be_is_refused_with_what_to_change(line: str, told: str) -> None:
    with pytest.raises(BriefError, match=told):
        check(read_plan(line))


def test_a_road_of_a_route_is_not_bound_by_the_map_alone() -> None:
    check(read_plan("| len=400 // t_junction //"), map_size=250)


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("// t_junction right stop //", "At a T-junction with a stop sign for the route turn right."),
        (
            "straight 80 // crossroads left lights // | up",
            "A road with a straight of 80 metres; no turns, then at a crossroads with traffic lights turn "
            "left, then an uphill road.",
        ),
        (
            "// roundabout mini arms=3 exit=2 // || len=300",
            "At a mini roundabout with 3 arms take the second exit; 300 metres in all.",
        ),
        ("// crossroads skew //", "At a skew crossroads go on somewhere."),
        (
            "crossroads left in=straight out=right deg=60 angle=60",
            "At a crossroads with a one-way road that comes from straight ahead with a one-way road that "
            "leads to the right whose closest roads are 60 degrees apart turn left by 60 degrees.",
        ),
        (
            "crossroads straight in=left+right",
            "At a crossroads with one-way roads that come from the left and from the right go straight on.",
        ),
        ("star deg=60", "At a star junction turn by 60 degrees."),
        ("merge ramp len=150 taper=50", "At a merge 150 metres long with a taper of 50 metres use the ramp."),
        ("map t_junction x3 dead_ends=1", "A map with 3 T-junctions; 1 dead end."),
        ("map t_junction x4 blocks=0", "A map with 4 T-junctions; 0 blocks."),
        (
            "// t_junction straight ways=left+straight priority //",
            "At a T-junction with ways on to the left and straight on where the route has priority go "
            "straight on.",
        ),
        (
            "// roundabout exit=2..3 r=16 //",
            "At a roundabout whose island has a radius of 16 metres take exit 2 to 3.",
        ),
    ],
)
def test_a_route_is_said_in_driving_order(line: str, said: str) -> None:
    assert sentence(read_plan(line)) == said


def test_a_plan_with_junctions_is_read_by_the_plan_reader() -> None:
    brief = read("// t_junction right //", reader="plan")
    assert brief.junctions == (JunctionClause(kind="t_junction", take="right"),)
    assert brief.words == "// t_junction right //"


def test_a_route_needs_one_road_more_than_junctions() -> None:
    with pytest.raises(ValueError, match="divide a route into 2 roads, and 1 are given"):
        Brief(junctions=(JunctionClause(kind="star"),), stretches=(Brief(),))
    with pytest.raises(ValueError, match="only a route with junctions has stretches"):
        Brief(stretches=(Brief(),))


def test_an_amount_of_arms_may_be_open() -> None:
    check(read_plan("// roundabout arms=3..4 exit=2 //"))
    check(read_plan("// star arms=5.. //"))
    assert read_plan("// star arms=5.. //").junctions[0].arms == Amount(lo=5)


@pytest.mark.parametrize(
    ("short", "full"),
    [
        ("roundabout exit=2", "// roundabout exit=2 //"),
        (
            "t_junction left // crossroads right // straight 60",
            "// t_junction left // // crossroads right // straight 60",
        ),
        ("turn left // star || len=300", "turn left // star // || len=300"),
    ],
)
def test_a_road_of_which_nothing_is_asked_may_be_left_out(short: str, full: str) -> None:
    assert read_plan(short) == read_plan(full)
    assert "// //" not in plan(read_plan(full))


def test_a_grid_has_no_blocks_besides_its_columns_and_rows() -> None:
    with pytest.raises(BriefError, match="leave blocks= out of the plan"):
        read_plan("map columns=2 rows=2 blocks=4")
