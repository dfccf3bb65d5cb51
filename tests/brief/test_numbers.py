"""Numbers as they are written: signs, decimal marks, thousands; and the limits of worlds."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from roadgpt.brief import Brief, at_least, at_most, between, check, exactly, read
from roadgpt.brief.grammar.tokens import tokens
from roadgpt.brief.model import Amount, Clause
from roadgpt.brief.readers.grammar import GrammarReader
from roadgpt.brief.words import LEAST_RADIUS, STEEPEST
from roadgpt.errors import BriefError
from roadgpt.road import World
from roadgpt.road.design import MAX_INCLINE


@pytest.mark.parametrize(
    ("words", "incline"),
    [
        ("a road with a slope of -5 %", exactly(5)),
        ("a road with a slope of -8 to -3 %", between(3, 8)),
        ("a road with a slope of at most -4 %", at_most(4)),
        ("a road with a slope of at least -4 %", at_least(4)),
    ],
)
def test_a_negative_slope_is_downhill(words: str, incline: Amount) -> None:
    brief = GrammarReader().read(words)
    assert (brief.slope, brief.incline) == ("down", incline)


@pytest.mark.parametrize(
    "words",
    ["a road with 2 turns and -2 % to 3 % slope", "a road with 2 turns and grades from -3 to 8 percent"],
)
def test_slopes_from_below_nought_to_above_are_left_over(words: str) -> None:
    brief = GrammarReader().read(words)
    assert brief.incline is None
    assert brief.slope is None
    assert any(word.startswith("-") for word in brief.unused)


def test_negative_angles_are_to_the_right_and_keep_both_bounds() -> None:
    (clause,) = GrammarReader().read("a turn of -90 to -30 degrees").clauses
    assert (clause.side, clause.degrees) == ("right", between(30, 90))
    (clause,) = GrammarReader().read("a turn of -20 to 40 degrees").clauses
    assert (clause.side, clause.degrees) == (None, None)


def test_less_than_no_turns_is_refused() -> None:
    with pytest.raises(BriefError, match="whole number"):
        GrammarReader().read("-2 combined right angle squiggly")


@pytest.mark.parametrize(
    ("words", "value"),
    [
        ("a road of 1.250 km", 1.25),
        ("a turn with a radius of 12.500 m", 12.5),
        ("a road of 1,250 m", 1250),
        ("a road of 0,250 km", 0.25),
        ("a road of 1.234.567 m", 1234567),
        ("eine Strasse von 1.250 m", 1250),
        ("eine Kurve mit 17,500 m Radius", 17.5),
        ("una carretera de 1.250 m", 1250),
        ("une route de 1,250 km", 1.25),
        ("a road of 1.25 km", 1.25),
        ("eine Strasse von 1,25 km", 1.25),
    ],
)
def test_three_digits_behind_a_mark_are_a_thousand_where_the_language_says_so(
    words: str, value: float
) -> None:
    assert [token.value for token in tokens(words) if token.sort == "number"] == [value]


@given(st.text(max_size=60))
@settings(max_examples=300)
def test_tokens_are_as_they_were_written_and_in_order(text: str) -> None:
    at = 0
    for token in tokens(text):
        at = text.index(token.raw, at)
        assert token.raw


def test_words_that_are_left_over_are_as_they_were_written() -> None:
    brief = GrammarReader().read("a road with 3 turns, Purple and Überfüßig, ÷ ＦＯＧ")
    assert [word for word in brief.unused if word in ("Purple", "Überfüßig", "ＦＯＧ")] == [
        "Purple",
        "Überfüßig",
        "ＦＯＧ",
    ]


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        ("a 200 m road with a net drop of 100 m", "cannot fall 100 m"),
        ("a 200 m road that gains 100 m of height", "cannot climb 100 m"),
    ],
)
def test_a_road_too_short_for_its_heights_is_refused_both_ways(words: str, reason: str) -> None:
    with pytest.raises(BriefError, match=reason):
        read(words, "grammar")


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
    assert read("a turn with a radius of 9 m", "grammar", min_radius=8.0).clauses == tighter.clauses
    with pytest.raises(BriefError, match="ask for 6 percent or less"):
        read("a 10 % climb", "grammar", max_grade=0.06)
    with pytest.raises(BriefError, match="ask for 15 percent or less"):
        read("a 20 % climb", "grammar", max_grade=0.3)  # designs have no more


def test_changes_of_slope_that_are_counted_hold_beside_a_crest() -> None:
    brief = GrammarReader().read(
        "a road with a left turn, then a crest, then a turn; at least 2 changes of slope"
    )
    assert brief.hills == at_least(2)
