"""Figures that a text tells by other figures are written as sums and multiples of its numbers."""

import random

import pytest

from roadgpt.brief import read
from roadgpt.brief.plan import plan
from roadgpt.brief.readers.model.computed_numbers import Compared
from roadgpt.brief.readers.model.plan_automaton import PlanAutomaton
from roadgpt.brief.readers.model.plan_numbers import Evidence
from roadgpt.brief.readers.model.slots import NumberSlot, SlottedText, slotted
from roadgpt.brief.readers.model.vocabulary import TOKENS, plan_of, tokens_of

TOLD = [
    (
        "Three turns, left, right, left: the first 40 degrees, the second twice as large, "
        "the third half of the first.",
        "turn left deg=40; turn right deg=80; turn left deg=20",
        "turn left deg= [1] ; turn right deg= [1] x 2 ; turn left deg= [1] x 0.5",
    ),
    (
        "five bends, the first of 30 degrees, each 15 degrees more than the one before",
        "turn deg=30; turn deg=45; turn deg=60; turn deg=75; turn deg=90",
        "turn deg= [1] ; turn deg= [1] + [2] ; turn deg= [1] + [2] x 2",
    ),
    (
        "a straight of 90 m, a bend, a straight a third as long",
        "straight len=90; turn; straight len=30",
        "straight len= [1] ; turn ; straight len= [1] x 0.333",
    ),
    (
        "a straight of 50 m, a left, a straight at most 20 m longer",
        "straight len=50; turn left; straight len=..70",
        "straight len= [1] ; turn left ; straight len= .. [1] + [2]",
    ),
    (
        "up at 5 %, a bend, up a percent steeper",
        "straight up pct=5; turn; straight up pct=6",
        "straight up pct= [1] ; turn ; straight up pct= [1] + 1",
    ),
]


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


@pytest.mark.parametrize("seed", range(40))
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


def test_places_from_the_end_are_no_differences() -> None:
    said = slotted("the last two bends wider", is_change=True)
    tokens = tokens_of("turn -2,-1: radius more", said.slots)
    assert tokens is not None
    assert "2 - 1" in " ".join(tokens)
    assert plan_of(tokens, said.slots).replace(" ", "") == "turn-2,-1:radiusmore"


@pytest.mark.parametrize(
    ("low", "high"),
    [("6", "9"), ("3", "5")],
)
def test_a_loss_of_height_can_be_a_range(low: str, high: str) -> None:
    said = slotted(f"two lefts, and the road loses no less than {low} m and no more than {high} m")
    line = f"turn x2 left | climb=-{high}..-{low}"
    found = tokens_of(line, said.slots)
    assert found is not None
    state = automaton(said)
    for token in [*found, "<end>"]:
        state.push(token)
    assert plan_of(found, said.slots) == line


def test_a_radius_without_a_unit_is_no_diameter() -> None:
    said = slotted("radius 40 for the two lefts, 20 for the right at the end")
    found = tokens_of("turn x2 left r=40; turn right r=20", said.slots)
    assert found == ["turn", "x", "2", "left", "r=", "[1]", ";", "turn", "right", "r=", "20"]


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        ("a 40 metre straight, a left turn, and then a straight three times as long",
         "straight len=40; turn left; straight len=120"),
        ("the first curve turns 40 degrees to the left, the second twice as much to the right",
         "turn left deg=40; turn right deg=80"),
        ("un rettilineo di 40 m, una curva a sinistra e un rettilineo lungo il doppio",
         "straight len=40; turn left; straight len=80"),
        ("Kurve links Radius 40 m, Kurve rechts halber Radius", "turn left r=40; turn right r=20"),
        ("a turn of 40 degrees, another of twice that, another of half that",
         "turn deg=40; turn deg=80; turn deg=20"),
        ("eine Gerade von 30 m, Kurve, dann eine Gerade, 20 m länger als die erste",
         "straight len=30; turn; straight len=50"),
        ("un virage de 60 degrés, puis un de 20 degrés de moins que le premier", "turn deg=60; turn deg=40"),
        ("una curva de radio 40 m y otra con la mitad de radio", "turn r=40; turn r=20"),
        ("a straight of 40 m, a left, then one twice as long, that is 80 m",
         "straight len=40; turn left; straight len=80"),
        ("three lefts, the first of 60 m radius, each 10 m tighter than the last",
         "turn left r=60; turn left r=50; turn left r=40"),
    ],
)  # fmt: skip
def test_the_reader_computes_what_the_words_compare(text: str, wanted: str) -> None:
    assert plan(read(text)) == wanted
