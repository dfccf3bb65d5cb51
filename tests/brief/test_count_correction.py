"""Counts held against the numbers that were said."""

import pytest

from roadgpt.brief import check
from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.readers.model.count_correction import with_checked_counts
from roadgpt.brief.readers.model.slots import slotted
from roadgpt.errors import BriefError


@pytest.mark.parametrize(
    ("words", "written", "right"),
    [
        ("seven turns, the first two uphill", "turn x2 up; turn x4", "turn x2 up; turn x5"),
        ("8 left bends, the last sharp", "turn x6 left; turn left sharp", "turn x7 left; turn left sharp"),
        ("five bends, the last three go right", "turn x3; turn x3 right", "turn x2; turn x3 right"),
        ("6 turns, 2 of them to the right", "turn x6 | rights=2", "turn x6 | lefts=4 rights=2"),
        ("5 turns, 3 left", "turn x5 | lefts=3 rights=3", "turn x5 | lefts=3 rights=2"),
        ("4 turns, more of them to the left than to the right", "turn x4 | lefts=2..", "turn x4 | lefts=3.."),
        ("sette curve, la maggioranza a destra", "turn x7 | rights=2..", "turn x7 | rights=4.."),
        ("cinq virages dont deux à gauche", "turn x5 | lefts=2 rights=2", "turn x5 | lefts=2 rights=3"),
    ],
)
def test_sums_are_put_right(words: str, written: str, right: str) -> None:
    assert plan(with_checked_counts(read_plan(written), slotted(words))) == right


@pytest.mark.parametrize(
    ("words", "written"),
    [
        ("three turns", "turn x3"),
        ("turns left twice, then 3 rights", "turn x2 left; turn x3 right"),
        ("case 7: several turns", "| turns=3.."),
        ("straight: 120 m, right, radius:20", "straight len=120; turn right r=20"),
        ("4 turns and no lefts", "turn x4 | lefts=0"),
        ("6 turns, 2 or more to the left", "turn x6 | lefts=2.."),
        ("6 turns, several of them left, grade at most 5 %", "turn x6 | lefts=2.."),
        ("6 turns, some to the left and some to the right", "turn x6 | lefts=1.. rights=1.."),
        ("all of the five go left except one", "turn x5 | lefts=4 rights=1"),
        ("6 turns, twice as many lefts as rights", "turn x6 | lefts=4 rights=2"),
    ],
)
def test_what_follows_from_the_words_stays(words: str, written: str) -> None:
    assert plan(with_checked_counts(read_plan(written), slotted(words))) == written


@pytest.mark.parametrize(
    ("words", "written"),
    [
        ("five bends: two left, one right", "turn x5 | lefts=2 rights=1"),
        ("sechs Kurven, vier davon links, drei rechts", "turn x6 | lefts=4 rights=3"),
        ("ten bends, first four lefts, then seven rights", "turn x4 left; turn x7 right"),
        ("three lefts plus two rights make six bends", "turn x3 left; turn x2 right"),
        ("un gauche, deux droites, quatre virages en tout", "turn left; turn x2 right"),
    ],
)
def test_sums_that_cannot_be_are_kept_as_said_and_refused(words: str, written: str) -> None:
    with pytest.raises(BriefError, match=r"numbers agree|ask for (more|fewer)"):
        check(with_checked_counts(read_plan(written), slotted(words)))


@pytest.mark.parametrize(
    ("words", "written"),
    [
        (
            "three double bends with a straight after each",
            "s_bend; straight; s_bend; straight; s_bend; straight",
        ),
        ("six ordinary turns around one hairpin", "turn x3; hairpin; turn x3"),
        ("four curves, one left and three right", "turn left; turn x3 right"),
        ("two bends left, then two bends right", "turn x2 left; turn x2 right"),
        ("sector 3: turns right; sector 5: turns left", "turn right; turn left"),
    ],
)
def test_numbers_that_add_up_are_no_contradiction(words: str, written: str) -> None:
    assert plan(with_checked_counts(read_plan(written), slotted(words))) == written
