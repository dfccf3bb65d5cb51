"""Contradictions and impossible wishes are found, and said with a way out; what is possible passes."""

import pytest

from roadgpt.brief import Brief, Clause, at_least, at_most, check, exactly, read
from roadgpt.brief.words import LEAST_RADIUS, STEEPEST
from roadgpt.errors import BriefError
from roadgpt.road import World
from roadgpt.road.design import MAX_INCLINE


def turns(number: int, **more: object) -> Clause:
    return Clause.model_validate({"kind": "turn", "count": exactly(number), **more})


IMPOSSIBLE = {
    "turns and no turns": Brief(clauses=(turns(3),), turns=exactly(0)),
    "numbers do not agree": Brief(clauses=(turns(3),), turns=exactly(2)),
    "more left turns than allowed": Brief(clauses=(turns(3, side="left"),), left=at_most(1)),
    "more sides than turns": Brief(turns=exactly(2), left=at_least(3)),
    "neither left nor right": Brief(clauses=(turns(2),), left=exactly(0), right=exactly(0)),
    "serpentine to one side": Brief(clauses=(Clause(kind="serpentine"),), left=exactly(0)),
    "no turns, but an end that turns": Brief(turns=exactly(0), ends=Clause(kind="hairpin")),
    "too steep": Brief(slope="up", incline=exactly(40)),
    "one place too steep": Brief(steepest=at_least(20)),
    "flat with a number": Brief(slope="flat", incline=exactly(6)),
    "uphill with a downhill turn": Brief(clauses=(turns(1), turns(1, slope="down")), slope="up"),
    "flat with an uphill turn": Brief(clauses=(turns(1), turns(1, slope="up")), slope="flat"),
    "flat with a crest": Brief(clauses=(Clause(kind="crest"),), slope="flat"),
    "uphill and hilly": Brief(slope="up", hills=at_least(3)),
    "uphill to a lower end": Brief(slope="up", climb=exactly(-5)),
    "uphill, and never steep enough": Brief(slope="steeply_up", steepest=at_most(4)),
    "too short for its turns": Brief(clauses=(turns(20),), length=exactly(150)),
    "too short for its straight": Brief(
        clauses=(Clause(kind="straight", length=exactly(200)),), length=exactly(90)
    ),
    "too short for its height": Brief(length=exactly(50), climb=exactly(20)),
    "no road": Brief(length=exactly(8)),
    "too tight": Brief(clauses=(turns(1, radius=exactly(5)),)),
    "gentle and tight": Brief(clauses=(turns(1, sharpness="gentle", radius=exactly(20)),)),
    "gentle chicane": Brief(clauses=(Clause(kind="chicane", sharpness="gentle"),)),
    "wide hairpin": Brief(clauses=(Clause(kind="hairpin", radius=exactly(60)),)),
    "half a hairpin": Brief(clauses=(Clause(kind="hairpin", degrees=exactly(90)),)),
    "full circle": Brief(clauses=(turns(1, degrees=exactly(360)),)),
    "hardly a turn": Brief(clauses=(turns(1, degrees=exactly(4)),)),
    "half a turn": Brief(turns=exactly(2.5)),
    "less than no turn": Brief(clauses=(Clause(kind="turn", count=exactly(-2)),)),
    "too many for a map": Brief(clauses=(Clause(kind="hairpin", count=exactly(60)),)),
    "straight longer than the map": Brief(clauses=(Clause(kind="straight", length=exactly(900)),)),
    "radius too wide for the map": Brief(clauses=(turns(1, radius=exactly(3000)),)),
    "more than any map": Brief(turns=exactly(1000)),
    "tighter than every turn may be": Brief(clauses=(turns(1, radius=exactly(18)),), radius=at_least(40)),
    "wider than every turn may be": Brief(clauses=(turns(1, radius=exactly(60)),), radius=at_most(45)),
    "further than every turn may be": Brief(clauses=(turns(2, degrees=exactly(90)),), degrees=at_most(60)),
    "sharp, and nothing tight": Brief(clauses=(turns(2, sharpness="sharp"),), radius=at_least(50)),
    "a hairpin, and no turn beyond a right angle": Brief(
        clauses=(Clause(kind="hairpin"),), degrees=at_most(90)
    ),
    "steeper than the steepest place": Brief(
        clauses=(Clause(kind="straight", slope="up", incline=exactly(6)),), steepest=at_most(4)
    ),
}
POSSIBLE = {
    "anything": Brief(),
    "an hilly road with a rise": Brief(hills=at_least(3), climb=exactly(5)),
    "uphill with a flat straight": Brief(
        clauses=(turns(1), Clause(kind="straight", slope="flat")), slope="up"
    ),
    "tight hairpin": Brief(clauses=(Clause(kind="hairpin", sharpness="sharp"),)),
    "long enough": Brief(clauses=(turns(6),), length=exactly(300)),
    "a U-turn with a number": Brief(clauses=(Clause(kind="u_turn", degrees=exactly(180)),)),
    "switchbacks": Brief(clauses=(Clause(kind="switchback", count=exactly(4)),), slope="down"),
    "counts that agree": Brief(
        clauses=(turns(3, side="left"),), left=exactly(3), right=exactly(0), turns=exactly(3)
    ),
    "wider than the least radius": Brief(
        clauses=(turns(1, radius=exactly(60)), turns(1)), radius=at_least(40)
    ),
    "one turn with its own figure": Brief(clauses=(turns(1, radius=exactly(20)),), radius=exactly(40)),
    "ten hairpins": Brief(clauses=(Clause(kind="hairpin", count=exactly(10)),)),
    "a serpentine with a few to the left": Brief(
        clauses=(Clause(kind="serpentine", count=exactly(5)),), left=at_least(2)
    ),
}


@pytest.mark.parametrize("brief", IMPOSSIBLE.values(), ids=IMPOSSIBLE)
def test_impossible_briefs(brief: Brief) -> None:
    with pytest.raises(BriefError) as error:
        check(brief)
    advice = str(error.value)
    assert 20 < len(advice) < 200
    assert "\n" not in advice
    assert any(word in advice for word in ("ask for", "leave", "make", "say", "allow"))


@pytest.mark.parametrize("brief", POSSIBLE.values(), ids=POSSIBLE)
def test_possible_briefs(brief: Brief) -> None:
    check(brief)


def test_a_larger_map_holds_more() -> None:
    many = Brief(clauses=(Clause(kind="hairpin", count=exactly(40)),))
    with pytest.raises(BriefError, match="larger map"):
        check(many, map_size=250)
    check(many, map_size=600)
    check(many, map_size=None)


@pytest.mark.parametrize(
    ("line", "reason"),
    [
        ("turn x3 | turns=0", "no turns"),
        ("| up turns=1.. pct=40", "too steep"),
        ("hairpin x60", "no room"),
        ("crest | flat", "flat"),
        ("turn x20 | len=100", "too short for all that"),
        ("turn 360", "cross itself"),
        ("turn r5", "too tight"),
        ("hairpin 90", "140 degrees"),
        ("turn x2.5", "whole number"),
        ("turn down; turn x2 up | up", "downhill"),
        ("turn x99999999999999", "400"),
    ],
)
def test_plans_that_ask_for_the_impossible(line: str, reason: str) -> None:
    with pytest.raises(BriefError, match=reason):
        read(line, "plan")


@pytest.mark.parametrize(
    ("line", "reason"),
    [
        ("| turns=1.. len=200 climb=-100", "cannot fall 100 m"),
        ("| up turns=1.. len=200 climb=100", "cannot climb 100 m"),
    ],
)
def test_a_road_too_short_for_its_heights_is_refused_both_ways(line: str, reason: str) -> None:
    with pytest.raises(BriefError, match=reason):
        read(line, "plan")


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
