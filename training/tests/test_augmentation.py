"""Hand-written pairs made more: every change of the text is one of the plan, too."""

import numpy as np

from roadgpt.brief.readers.model.slots import slotted
from roadgpt_training.augmentation import joined, recounted
from roadgpt_training.mirror import mirrored
from roadgpt_training.pair import Pair
from roadgpt_training.tokens import tokens_of


def test_hardly_any_generated_plan_has_a_number_that_its_text_has_not(generated: tuple[Pair, ...]) -> None:
    lost = 0
    for pair in generated:
        if not pair.plan.startswith("!"):
            lost += tokens_of(pair.plan, slotted(pair.text).slots) is None  # a number word hidden by a slip
    assert lost < 0.03 * len(generated)


def test_a_mirror_swaps_sides_in_text_and_plan() -> None:
    assert mirrored("Left, then two rights", "turn left; turn x2 right") == (
        "Right, then two lefts",
        "turn right; turn x2 left",
    )
    assert mirrored("una curva a la izquierda", "turn left") == ("una curva a la derecha", "turn right")
    assert mirrored("a right angle to the left", "turn left deg=90") is None
    assert mirrored("a hairpin", "hairpin") is None


def test_another_number_changes_text_and_plan() -> None:
    pair = Pair("gimme two hairpins", "hairpin x2", "f", "en")
    new = [recounted(pair, np.random.default_rng(seed)) for seed in range(5)]
    five = Pair("gimme five hairpins", "hairpin x5", "f", "en")
    assert five in new or all(n and n.plan != "turn" for n in new)
    assert (
        recounted(
            Pair("four turns, the first two uphill", "turn x2 up; turn x2", "f", "en"),
            np.random.default_rng(0),
        )
        is None
    )


def test_two_descriptions_are_joined_in_order() -> None:
    both = joined(
        Pair("a left", "turn left", "f", "en"),
        Pair("A hairpin", "hairpin", "f", "en"),
        np.random.default_rng(1),
    )
    assert both is not None
    assert both.plan == "turn left; hairpin"
    assert both.text.startswith("a left")
    assert both.text.endswith("a hairpin")


def test_pairs_in_a_language_without_phrases_are_not_joined() -> None:
    one = Pair("een bocht naar links", "turn left", "own", "nl")
    other = Pair("rechtdoor", "straight", "own", "nl")
    assert joined(one, other, np.random.default_rng(1)) is None
