"""Numbers as the grammar reads them: signs, ranges, what is left over."""

import pytest

from roadgpt.brief import at_least, at_most, between, exactly
from roadgpt.brief.model import Amount
from roadgpt.brief.readers.grammar import GrammarReader
from roadgpt.errors import BriefError


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


def test_words_that_are_left_over_are_as_they_were_written() -> None:
    brief = GrammarReader().read("a road with 3 turns, Purple and Überfüßig, ÷ ＦＯＧ")
    assert [word for word in brief.unused if word in ("Purple", "Überfüßig", "ＦＯＧ")] == [
        "Purple",
        "Überfüßig",
        "ＦＯＧ",
    ]


def test_changes_of_slope_that_are_counted_hold_beside_a_crest() -> None:
    brief = GrammarReader().read(
        "a road with a left turn, then a crest, then a turn; at least 2 changes of slope"
    )
    assert brief.hills == at_least(2)
