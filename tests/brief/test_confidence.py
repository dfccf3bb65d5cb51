"""The confidence of a reading: a logistic model of features, and doubt where a measured number is ignored."""

from math import log

import pytest
from hypothesis import given
from hypothesis import strategies as st

from roadgpt.brief import Brief
from roadgpt.brief.readers.model.slots import slotted
from roadgpt.brief.readers.model.trained import DOUBT, ScoredPlan, confidence, features, left_out


def draft(*tokens: str) -> ScoredPlan[Brief]:
    return ScoredPlan(tokens, Brief(), 0.0, (-0.1, -0.2))


def test_numbers_that_the_plan_does_not_have_are_counted() -> None:
    text = slotted("a left of 90 degrees with a radius of 30 m, then 45 m of straight")
    turn = ("turn", "left", "deg=", "[1]", "r=", "[2]")
    assert left_out(turn, text) == [2]
    assert left_out((*turn, ";", "straight", "len=", "[3]"), text) == []
    found = features(draft("turn"), text)
    assert found["numbers"] == pytest.approx(log(4))


@given(st.floats(-20, 20))
def test_a_measure_that_is_ignored_leaves_doubt_and_another_word_does_not(bias: float) -> None:
    text = slotted("dear Ruth, three turns, one of them 40 m long, and a tree")
    sure = confidence({"bias": bias}, {}, (), text)
    assert confidence({"bias": bias}, {}, ("Ruth", "tree"), text) == sure
    assert confidence({"bias": bias}, {}, ("Ruth", "40 m"), text) == min(DOUBT, sure)
    assert confidence({"bias": bias}, {}, ("three", "not"), text) == sure
