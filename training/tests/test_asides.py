"""Sentences that are added to change requests: no figure, no wish, and only of what really stays."""

import re

import numpy as np
import pytest

from roadgpt_training.asides import ASIDES, LONGEST, OF_PROPERTY, unchanged, with_asides
from roadgpt_training.pair import Pair

LANGUAGES = {"en", "de", "fr", "es", "it"}


def test_five_languages_have_sentences_of_every_kind_and_without_figures() -> None:
    assert {*ASIDES} == LANGUAGES
    for said in ASIDES.values():
        assert said["keep"].keys() == OF_PROPERTY.keys()
        every = [*said["before"], *said["after"], *(each for kept in said["keep"].values() for each in kept)]
        assert len(every) == len({*every})
        assert not [each for each in every if re.search(r"\d|[{}]", each)]


@pytest.mark.parametrize(
    ("plan", "stays"),
    [
        ("turn 2: radius less", {"angle", "length", "slope", "side", "count"}),
        ("turn 2: angle +20; straight -1: length x2", {"radius", "slope", "side", "count"}),
        ("road: climb =8", {"angle", "radius", "length", "side", "count"}),
        ("turn all but(turn 1): side left", {"angle", "radius", "length", "slope", "count"}),
        ("turn 2: remove", set()),
        ("turn 1: radius =20; turn 3: shape hairpin", set()),
        ("!unclear", set()),
    ],
)
def test_only_what_a_plan_leaves_alone_is_said_to_stay(plan: str, stays: set[str]) -> None:
    assert {*unchanged(plan)} == stays


def test_the_request_stays_whole_and_its_plan_as_it_was() -> None:
    rng = np.random.default_rng(7)
    pair = Pair("widen turn 2", "turn 2: radius more", "f", "en", is_change=True)
    made = [with_asides(pair, rng) for _ in range(400)]
    assert all(each.plan == pair.plan for each in made)
    assert all("widen turn 2" in each.text.lower() for each in made)
    assert all(len(each.text) <= LONGEST for each in made)
    longer = [each for each in made if each.text != pair.text]
    assert len({each.text for each in longer}) > 250
    radius = ASIDES["en"]["keep"]["radius"]
    assert not [each for each in longer if any(kept in each.text for kept in radius)]


def test_a_long_request_and_one_in_another_language_stay_as_they_are() -> None:
    rng = np.random.default_rng(7)
    for text, language in (("x" * LONGEST, "en"), ("vyrovnej zatáčku", "cs")):
        pair = Pair(text, "turn 2: radius more", "f", language, is_change=True)
        assert {with_asides(pair, rng).text for _ in range(20)} == {text}
