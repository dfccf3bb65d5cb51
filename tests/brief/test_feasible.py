"""What is possible passes, and the limits are those of the world; what is not stands in refused.jsonl."""

import pytest

from roadgpt.brief import Brief, Clause, check, exactly, read
from roadgpt.brief.plan import read_plan
from roadgpt.brief.words import LEAST_RADIUS, STEEPEST
from roadgpt.errors import BriefError
from roadgpt.road import World
from roadgpt.road.design import MAX_INCLINE
from tables import rows


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
