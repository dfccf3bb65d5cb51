"""Contradictions and impossible wishes are found, and said with a way out; what is possible passes."""

import pytest

from roadgpt.brief import Brief, Clause, at_least, at_most, check, exactly, read
from roadgpt.errors import BriefError


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
    "radius wider than the map": Brief(clauses=(turns(1, radius=exactly(600)),)),
    "more than any map": Brief(turns=exactly(1000)),
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
    ("words", "reason"),
    [
        ("three turns but no turns", "no turns"),
        ("a 40 % climb", "too steep"),
        ("60 hairpins", "no room"),
        ("an uphill road that goes downhill", "uphill and downhill"),
        ("a flat road with a crest", "flat"),
        ("a 100 metre road with 20 turns", "too short for all that"),
        ("a 360 degree turn", "cross itself"),
        ("a full circle", "cross itself"),
        ("a turn with a radius of 5 metres", "too tight"),
        ("a 90 degree hairpin", "140 degrees"),
        ("-3 turns", "whole number"),
        ("2.5 turns", "whole number"),
        ("an uphill road, the first turn downhill, then two turns uphill", "downhill"),
        ("99999999999999 turns", "200"),
        ("an S-bend: left, then left", "both sides"),
    ],
)
def test_words_that_ask_for_the_impossible(words: str, reason: str) -> None:
    with pytest.raises(BriefError, match=reason):
        read(words, "grammar")
