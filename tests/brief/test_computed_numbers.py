"""Figures that a text tells by other figures are written as sums and multiples of its numbers."""

import random

import pytest

from roadgpt.brief.readers.model.grammar import Evidence, PlanAutomaton
from roadgpt.brief.readers.model.slots import NumberSlot, SlottedText, slotted
from roadgpt.brief.readers.model.vocabulary import TOKENS, Compared, plan_of
from roadgpt_training.tokens import tokens_of
from tables import rows

TOLD = rows(__file__, "told")


def automaton(text: SlottedText) -> PlanAutomaton:
    return PlanAutomaton(text.slots, frozenset(word.text for word in text.words), Evidence.of(text.text))


@pytest.mark.parametrize(("text", "line", "tokens"), TOLD)
def test_a_figure_told_by_another_one_is_written_as_its_computation(
    text: str, line: str, tokens: str
) -> None:
    said = slotted(text)
    found = tokens_of(line, said.slots, Compared.of(said.text))
    assert found is not None
    assert " ".join(found[: tokens.count(" ") + 1]) == tokens
    assert plan_of(found, said.slots) == line
    state = automaton(said)
    for token in [*found, "<end>"]:
        state.push(token)


@pytest.mark.parametrize(("text", "line"), rows(__file__, "shares"))
def test_an_angle_told_in_right_angles_or_circles_is_written_in_degrees(text: str, line: str) -> None:
    """The degrees are a person's: 90 for a right angle, 360 for a circle. None is a figure of the text."""
    said = slotted(text)
    found = tokens_of(line, said.slots, Compared.of(said.text))
    assert found is not None
    state = automaton(said)
    for token in [*found, "<end>"]:
        state.push(token)
    assert plan_of(found, said.slots) == line


def test_without_words_that_compare_nothing_is_computed() -> None:
    said = slotted("a straight of 40 m, a left of 60 degrees, then a straight of 80 m")
    assert Compared.of("a left and a right") == Compared(plain=frozenset())
    assert tokens_of("straight len=20", said.slots) is None or tokens_of("straight len=20", said.slots) == [
        "straight", "len=", "20",
    ]  # fmt: skip
    state = automaton(said)
    for token in ("straight", "len=", "[1]"):
        state.push(token)
    assert "x" not in [TOKENS[index] for index in state.allowed()]


@pytest.mark.parametrize("seed", range(10))
def test_sums_and_multiples_have_the_value_of_their_parts(seed: int) -> None:
    rng = random.Random(seed)
    one, other = rng.randint(21, 120), rng.randint(21, 120)
    slots = [NumberSlot(float(one), "metres"), NumberSlot(float(other), "metres")]
    times, factor = rng.randint(2, 8), rng.choice(("2", "0.5", "3", "1.5", "0.25", "0.75"))
    for tokens, value in (
        (["[1]", "x", factor], one * float(factor)),
        (["[1]", "+", "[2]"], one + other),
        (["[2]", "+", "[1]", "x", str(times)], other + times * one),
    ):
        line = plan_of(["straight", "len=", *tokens, ";", "turn"], slots)
        assert float(line.split("len=")[1].split(";")[0]) == pytest.approx(value, abs=0.0501)


@pytest.mark.parametrize(("low", "high"), [("6", "9"), ("3", "5")])
def test_a_loss_of_height_can_be_a_range(low: str, high: str) -> None:
    said = slotted(f"two lefts, and the road loses no less than {low} m and no more than {high} m")
    line = f"turn x2 left | climb=-{high}..-{low}"
    found = tokens_of(line, said.slots)
    assert found is not None
    state = automaton(said)
    for token in [*found, "<end>"]:
        state.push(token)
    assert plan_of(found, said.slots) == line
