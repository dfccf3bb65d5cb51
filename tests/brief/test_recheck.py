"""Counts held against the numbers that were said."""

import pytest

from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.readers.model.recheck import rechecked
from roadgpt.brief.readers.model.slots import slotted


@pytest.mark.parametrize(
    ("words", "written", "right"),
    [
        ("seven turns, the first two uphill", "turn x2 up; turn x4", "turn x2 up; turn x5"),
        ("8 left bends, the last sharp", "turn x6 left; turn left sharp", "turn x7 left; turn left sharp"),
        ("five bends, the last three go right", "turn x3; turn x3 right", "turn x2; turn x3 right"),
        ("6 turns, 2 of them to the right", "turn x6 | rights=2", "turn x6 | lefts=4 rights=2"),
        ("5 turns, 3 left", "turn x5 | lefts=3 rights=3", "turn x5 | lefts=3 rights=2"),
        ("cinq virages dont deux à gauche", "turn x5 | lefts=3 rights=2", "turn x5 | lefts=2 rights=3"),
    ],
)
def test_sums_are_put_right(words: str, written: str, right: str) -> None:
    assert plan(rechecked(read_plan(written), slotted(words))) == right


@pytest.mark.parametrize(
    ("words", "written"),
    [
        ("three turns", "turn x3"),
        ("turns left twice, then 3 rights", "turn x2 left; turn x3 right"),
        ("case 7: several turns", "| turns=3.."),
        ("straight: 120 m, right, radius:20", "straight len=120; turn right r=20"),
        ("4 turns and no lefts", "turn x4 | lefts=0"),
        ("6 turns, twice as many lefts as rights", "turn x6 | lefts=4 rights=2"),
    ],
)
def test_what_follows_from_the_words_stays(words: str, written: str) -> None:
    assert plan(rechecked(read_plan(written), slotted(words))) == written
