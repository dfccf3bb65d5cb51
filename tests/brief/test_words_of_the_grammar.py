"""The rows of the page of words that only the grammar knows: what it says is what is read."""

import pytest

from roadgpt.brief.model import Amount, between
from roadgpt.brief.readers.grammar import GrammarReader
from roadgpt.brief.words import OTHER_TURNS


def number_of_turns(words: str) -> Amount | None:
    brief = GrammarReader().read(words)
    assert brief.unused == ()
    return brief.turns or brief.clauses[0].count


@pytest.mark.parametrize("row", OTHER_TURNS[3:], ids=[row[0] for row in OTHER_TURNS[3:]])
def test_numbers(row: tuple[str, ...]) -> None:
    low, _, high = row[1].partition(" ")
    for word in row[0].split(", "):
        amount = number_of_turns(f"a road with {word} turns")
        assert amount is not None
        assert amount.lo == float(low)
        assert amount.hi == {"": float(low), "or more": None, "to 5": 5.0}[high]


def test_kink_and_dogleg() -> None:
    (kink,) = GrammarReader().read("a kink").clauses
    assert (kink.degrees, kink.sharpness) == (between(15, 30), "gentle")
    (dogleg,) = GrammarReader().read("a dogleg").clauses
    assert dogleg.degrees == between(60, 120)


def test_spiral() -> None:
    (left,) = GrammarReader().read("a spiral").clauses
    (right,) = GrammarReader().read("a spiral to the right").clauses
    assert (left.count, left.side) == (Amount(lo=3), "left")
    assert (right.count, right.side) == (Amount(lo=3), "right")
