"""Which words a plan does not depend on, with a network whose mind is known, and the doubt they leave."""

from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from roadgpt.brief.readers.model.slots import SlottedText, slotted
from roadgpt.brief.readers.model.trained import (
    DOUBT,
    ScoredPlan,
    Trained,
    confidence,
    features,
    passes_over,
)

FILLERS = frozenset(("a", "road", "with", "and", "the"))
REASONS = {"up": {"uphill", "climbing"}, "turn": {"turns", "bends"}, "3": {"3"}}
"""The words of which one is enough for a token."""


class Mind:
    """A stand-in for the network: a token is likely if a word for it is there."""

    has_scenes = False

    def chances_of(
        self, texts: Sequence[SlottedText], tokens: Sequence[str], allowed: SlottedText
    ) -> tuple[np.ndarray, np.ndarray]:
        rows = []
        for text in texts:
            said = {word.text for word in text.words}
            rows.append([-0.1 if REASONS.get(token, said) & said else -3.0 for token in (*tokens, "<end>")])
        logs = np.array(rows)
        return logs, np.where(logs > -1, 2.0, -2.0)


def idle(words: str, *tokens: str) -> tuple[str, ...]:
    return Trained(Mind(), 0.5, {}, FILLERS).unused(slotted(words), tokens)  # type: ignore[arg-type]


def test_a_word_counts_as_used_only_if_the_reading_changes_without_it() -> None:
    assert idle("an Uphill road with three purple turns", "turn", "3", "up") == ("purple",)
    assert idle("three turns", "turn", "3") == ()


def test_of_two_words_that_say_the_same_both_count_as_used() -> None:
    assert idle("uphill, climbing, three turns", "turn", "3", "up") == ()
    assert idle("uphill, climbing, lonely, three turns", "turn", "3", "up") == ("lonely",)


def test_each_word_is_named_once_and_fillers_never() -> None:
    assert idle("purple turns and purple bends with the road", "turn") == ("purple",)


def test_a_number_that_the_plan_does_not_copy_is_named() -> None:
    words = "three turns in 60 m"
    assert idle(words, "turn", "3") == ("60 m",)
    assert idle(words, "turn", "3", "[1]") == ()


def test_a_number_that_changes_nothing_is_noticed_even_if_there_are_more_than_fit() -> None:
    assert idle("turns of 40 m", "turn") == ("40 m",)
    assert passes_over(("40 m",), slotted("turns of 40 m"))
    many = ", ".join(f"a straight of {n} m" for n in range(41, 56))
    text = slotted(many)
    found = idle(many, *(f"[{n}]" for n in range(1, len(text.slots) + 1)))
    assert [word for word in found if word[0].isdecimal()] == [
        f"{41 + n} m" for n in range(len(text.slots), 15)
    ]


@pytest.mark.parametrize(
    ("tokens", "lacked"), [("turn x 3", 2), ("turn x 3 r= [2]", 1), ("turn x 3 r= [2] | len= [1]", 0)]
)
def test_the_inputs_of_the_confidence_are_counts(tokens: str, lacked: int) -> None:
    """Counted by hand: each count is the odds, where it alone has a weight, and that is 1."""
    text = slotted("3 turns in 300 m, of 40 m radius")  # 3 turns in [1] metres , of [2] metres radius
    written = ScoredPlan((*tokens.split(),), "", 0.0, (-0.25, -1.5, -0.25))
    odds = {"words": 10, "tokens": tokens.count(" ") + 1, "numbers": 1 + lacked, "all": 2.03, "worst": 1.53}
    for name, expected in odds.items():
        sure = confidence({"bias": 0.0, name: 1.0}, features(written, text), (), text)
        assert sure == pytest.approx(expected / (1 + expected), abs=6e-4), name


@given(st.floats(-20, 20))
def test_a_measure_that_is_ignored_leaves_doubt_and_another_word_does_not(bias: float) -> None:
    text = slotted("dear Ruth, three turns, one of them 40 m long, and a tree")
    sure = confidence({"bias": bias}, {}, (), text)
    assert confidence({"bias": bias}, {}, ("Ruth", "tree"), text) == sure
    assert confidence({"bias": bias}, {}, ("Ruth", "40 m"), text) == min(DOUBT, sure)
    assert confidence({"bias": bias}, {}, ("three", "not"), text) == sure
