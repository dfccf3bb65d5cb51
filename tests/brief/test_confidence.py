"""The confidence of a reading: a logistic model of features, and doubt where a measured number is ignored."""

from collections.abc import Sequence
from math import log

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from roadgpt.brief.readers.model.change_reading import is_denial
from roadgpt.brief.readers.model.confidence import DOUBT, confidence, features
from roadgpt.brief.readers.model.slots import SlottedText, slotted
from roadgpt.brief.readers.model.test_time_augmentation import ScoredPlan
from roadgpt.brief.readers.model.used_words import left_out

HALF = {"bias": 0.0, "numbers": 0.0}
PLAIN = slotted("a road")


class EvenNetwork:
    """A stand-in for a network that gives each token of every plan the same log-probability."""

    def __init__(self, log_chance: float) -> None:
        self.log_chance = log_chance

    def chances_of(
        self, texts: Sequence[SlottedText], tokens: Sequence[str], allowed: SlottedText
    ) -> tuple[np.ndarray, np.ndarray]:
        logs = np.full((len(texts), len(tokens) + 1), self.log_chance)
        return logs, np.ones_like(logs)


def draft(*tokens: str) -> ScoredPlan:
    return ScoredPlan(tokens, " ".join(tokens), 0.0, (-0.1, -0.2), 1.0)


def test_numbers_that_the_plan_does_not_have_are_counted() -> None:
    text = slotted("a left of 90 degrees with a radius of 30 m, then 45 m of straight")
    turn = ("turn", "left", "deg=", "[1]", "r=", "[2]")
    assert left_out(turn, text) == [2]
    assert left_out((*turn, ";", "straight", "len=", "[3]"), text) == []
    found = features([EvenNetwork(-0.1)], draft("turn"), text)  # type: ignore[list-item]
    assert found["numbers"] == pytest.approx(log(4))


def test_equal_odds_are_one_half_and_threefold_odds_three_quarters() -> None:
    assert confidence(HALF, {"numbers": 5.0}, (), PLAIN) == 0.5
    assert confidence({"bias": log(3)}, {}, (), PLAIN) == 0.75
    assert confidence({"bias": 0.0, "numbers": -log(3)}, {"numbers": 1.0}, (), PLAIN) == 0.25


def test_tokens_of_the_plan_weigh_once_each_and_slots_do_not() -> None:
    plan = draft("turn", "left", "deg=", "[1]", ";", "turn", "left", "deg=", "[2]")
    found = features([EvenNetwork(-0.1)], plan, PLAIN)  # type: ignore[list-item]
    tokens = {name: value for name, value in found.items() if name.startswith("has ")}
    assert tokens == {"has turn": 1.0, "has left": 1.0, "has deg=": 1.0, "has ;": 1.0}
    assert confidence({"bias": 0.0, "has left": log(3), "has crest": 9.0}, found, (), PLAIN) == 0.75


def test_left_and_right_are_trusted_alike() -> None:
    left, right = (
        features([EvenNetwork(-0.1)], draft("turn", side, "|", f"{side}s=", "2"), PLAIN)  # type: ignore[list-item]
        for side in ("left", "right")
    )
    assert left == right


@given(st.floats(-20, 20))
def test_a_measure_that_is_ignored_leaves_doubt_and_another_word_does_not(bias: float) -> None:
    text = slotted("dear Ruth, three turns, one of them 40 m long, and a tree")
    sure = confidence({"bias": bias}, {}, (), text)
    assert confidence({"bias": bias}, {}, ("Ruth", "tree"), text) == sure
    assert confidence({"bias": bias}, {}, ("Ruth", "40 m"), text) == min(DOUBT, sure)
    assert confidence({"bias": bias}, {}, ("three", "not"), text) == sure


def test_the_network_that_doubts_a_plan_most_is_heard() -> None:
    minds = [EvenNetwork(-0.01), EvenNetwork(-2.0), EvenNetwork(-0.5)]
    found = features(minds, draft("turn", "left"), PLAIN)  # type: ignore[arg-type]
    assert found["sceptic"] == pytest.approx(log(0.03 + 3 * 2.0))
    assert found["all"] == pytest.approx(log(0.03 + 0.3))
    assert found["worst"] == pytest.approx(log(0.03 + 0.2))


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
