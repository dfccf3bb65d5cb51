"""The confidence of a reading: a logistic model of features, and doubt where a "not" changed nothing."""

from math import log

import pytest
from hypothesis import given
from hypothesis import strategies as st

from roadgpt.brief.readers.model.confidence import DOUBT, confidence, features, is_denial
from roadgpt.brief.readers.model.slots import slotted
from roadgpt.brief.readers.model.test_time_augmentation import ScoredPlan
from roadgpt.brief.readers.model.used_words import left_out

HALF = {"bias": 0.0, "numbers": 0.0}


def draft(*tokens: str) -> ScoredPlan:
    return ScoredPlan(tokens, " ".join(tokens), 0.0, (-0.1, -0.2), 1.0)


def test_numbers_that_the_plan_does_not_have_are_counted() -> None:
    text = slotted("a left of 90 degrees with a radius of 30 m, then 45 m of straight")
    turn = ("turn", "left", "deg=", "[1]", "r=", "[2]")
    assert left_out(turn, text) == [2]
    assert left_out((*turn, ";", "straight", "len=", "[3]"), text) == []
    found = features(draft("turn"), text)
    assert found["numbers"] == pytest.approx(log(4))


def test_equal_odds_are_one_half_and_threefold_odds_three_quarters() -> None:
    assert confidence(HALF, {"numbers": 5.0}, ()) == 0.5
    assert confidence({"bias": log(3)}, {}, ()) == 0.75
    assert confidence({"bias": 0.0, "numbers": -log(3)}, {"numbers": 1.0}, ()) == 0.25


@given(st.floats(-20, 20), st.sampled_from(["not", "keine", "sans", "nicht", "only"]))
def test_a_negation_without_effect_leaves_doubt(bias: float, word: str) -> None:
    sure = confidence({"bias": bias}, {}, ("tree", word))
    assert sure <= DOUBT
    assert sure == min(DOUBT, confidence({"bias": bias}, {}, ("tree",)))


@pytest.mark.parametrize(
    ("words", "denies"),
    [
        ("don't make the second turn sharper", True),
        ("Please do not touch the hairpin.", True),
        ("don’t lengthen the last straight!", True),
        ("mach die zweite Kurve nicht schärfer", True),
        ("ne rends pas le virage 2 plus serré", True),
        ("no hagas más larga la recta", True),
        ("non rendere la curva più stretta", True),
        ("mach die zweite Kurve nicht schärfer, sondern weiter", False),
        ("die zweite Kurve nicht so scharf", False),
        ("don't make it longer, make it steeper", False),
        ("make it longer but don't touch the turns", False),
    ],
)
def test_what_only_denies_is_told_from_what_also_asks(words: str, denies: bool) -> None:
    assert is_denial(words) == denies
