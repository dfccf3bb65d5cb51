"""Counts that follow from the numbers in a description, and counts that contradict each other."""

import pytest

from roadgpt.brief import read
from roadgpt.brief.normal import normal
from roadgpt.brief.plan import plan, read_plan
from roadgpt.errors import BriefError


@pytest.mark.parametrize(
    ("words", "wanted"),
    [
        ("seven turns, the first two uphill", "turn x2 up; turn x5"),
        ("8 left bends, the last sharp", "turn x7 left; turn left sharp"),
        ("five bends, the last three go right", "turn x2; turn x3 right"),
        ("6 turns, 2 of them to the right", "turn x6 | lefts=4 rights=2"),
        ("5 turns, 3 left", "turn x5 | lefts=3 rights=2"),
        ("4 turns, more of them to the left than to the right", "turn x4 | lefts=3.."),
        ("sette curve, la maggioranza a destra", "turn x7 | rights=4.."),
        ("cinq virages dont deux à gauche", "turn x5 | lefts=2 rights=3"),
        ("all of the five go left except one", "turn x5 | lefts=4 rights=1"),
        ("6 turns, twice as many lefts as rights", "turn x6 | lefts=4 rights=2"),
    ],
)
def test_a_count_that_is_not_in_the_words_is_worked_out(words: str, wanted: str) -> None:
    assert plan(normal(read(words))) == plan(normal(read_plan(wanted)))


@pytest.mark.parametrize(
    ("words", "wanted"),
    [
        ("three turns", "turn x3"),
        ("turns left twice, then 3 rights", "turn x2 left; turn x3 right"),
        ("two bends left, then two bends right", "turn x2 left; turn x2 right"),
        ("case 7: several turns", "| turns=3.."),
        ("straight: 120 m, right, radius:20", "straight len=120; turn right r=20"),
        ("4 turns and no lefts", "turn x4 | lefts=0"),
        ("6 turns, 2 or more to the left", "turn x6 | lefts=2.."),
        ("6 turns, some to the left and some to the right", "turn x6 | lefts=1.. rights=1.."),
    ],
)
def test_counts_in_the_words_are_read_as_they_are(words: str, wanted: str) -> None:
    assert plan(normal(read(words))) == plan(normal(read_plan(wanted)))


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        ("five bends: two left, one right", "contradicts itself about the number of turns"),
        ("sechs Kurven, vier davon links, drei rechts", "7 left and right turns are more than the 6"),
    ],
)
def test_counts_that_do_not_add_up_are_refused(words: str, reason: str) -> None:
    with pytest.raises(BriefError, match=reason):
        read(words)
