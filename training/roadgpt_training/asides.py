"""Adds to change requests what people say beside their wish: who writes and why, and what is to stay."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from roadgpt_training.mentions import followed, preceded
from roadgpt_training.pair import Pair
from roadgpt_training.phrasebook import one_of, phrases_of

ASIDES: Mapping[str, Mapping[str, Any]] = phrases_of("asides")
"""By language: sentences to put "before" or "after" a request, and under "keep" sentences that say that one
property stays as it is, by property."""
LONGEST = 460  # letters of a request with asides: the networks read 128 word pieces
OF_PROPERTY: Mapping[str, Sequence[str]] = {
    "angle": ("angle",),
    "radius": ("radius",),
    "length": ("length",),
    "slope": ("slope", "climb"),
    "side": ("side",),
    "count": (),
}
"""For each property, the words of plans that change it."""
VALUE = re.compile(r"[^:]+: (angle|radius|length|slope|climb|side) .+")


def with_asides(pair: Pair, rng: np.random.Generator) -> Pair:
    """Returns a change request with sentences before it, after it, or both; its plan stays the same.

    The request is returned as it is if its language has no sentences, or if it would be too long.
    """
    said = ASIDES.get(pair.lang)
    if said is None:
        return pair
    before, after = list[str](), list[str]()
    if rng.random() < 0.6:
        before.append(one_of(said["before"], rng))
    if rng.random() < 0.5:
        after.append(one_of(said["after"], rng))
    staying = unchanged(pair.plan)
    if staying and rng.random() < 0.5:
        kept = one_of(said["keep"][one_of(staying, rng)], rng)
        if rng.random() < 0.5:
            before.append(kept)
        else:
            after.insert(0, kept)
    text = pair.text
    for phrase in after:
        text = followed(text, phrase)
    for phrase in reversed(before):
        text = preceded(phrase, text, pair.lang)
    return replace(pair, text=text) if len(text) <= LONGEST else pair


def unchanged(plan: str) -> list[str]:
    """Returns the properties that a plan leaves alone.

    The list is empty for a refusal, and for a plan with a wish that is not about the value of one property.
    """
    wishes = [VALUE.fullmatch(wish.strip()) for wish in plan.split(";")]
    changed = {wish[1] for wish in wishes if wish}
    if not all(wishes):
        return []
    return [name for name, words in OF_PROPERTY.items() if changed.isdisjoint(words)]
