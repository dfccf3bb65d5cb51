"""How sure a reading is: from how likely the networks find its plan, and from what the plan leaves out."""

import re
from collections.abc import Mapping, Sequence
from math import exp, log1p

from roadgpt.brief.readers.model.slots import SlottedText
from roadgpt.brief.readers.model.test_time_augmentation import ScoredPlan
from roadgpt.brief.readers.model.used_words import passes_over_a_negation
from roadgpt.brief.readers.model.vocabulary import SLOT_TOKENS

DOUBT = 0.5
"""The highest confidence of a reading that does not change without a "not"."""

DENIAL = re.compile(r"(?:please )?(?:do not|don'?t|never) [^,;:.]*[.!]*", re.IGNORECASE)
"""A change request that says only what shall not be."""


def is_denial(words: str) -> bool:
    """Returns whether a change request says only what shall not be, such as "don't make it longer"."""
    return DENIAL.fullmatch(words.strip().replace("’", "'")) is not None


def features(draft: ScoredPlan, text: SlottedText) -> dict[str, float]:
    """Returns what the confidence in a plan is computed from, by name: how likely the plan is, and how many
    numbers of the text it does not have.
    """
    return {**draft.features, "numbers": log1p(len(left_out(draft, text)))}


def left_out(draft: ScoredPlan, text: SlottedText) -> list[str]:
    """Returns the measured numbers of a text that are not in its plan."""
    return [slot for slot in SLOT_TOKENS[: len(text.slots)] if slot not in draft.tokens]


def confidence(weights: Mapping[str, float], found: Mapping[str, float], unused: Sequence[str]) -> float:
    """Returns how often readings like this one were right on held-back texts, from 0 to 1.

    A reading that passes over a negation gets DOUBT at most.

    Args:
        weights: the weights of the confidence model, and its bias.
        found: the features of the reading.
        unused: the words that the plan does not depend on.
    """
    score = weights["bias"] + sum(weight * found[name] for name, weight in weights.items() if name != "bias")
    sure = round(1 / (1 + exp(-score)), 3)
    return min(sure, DOUBT) if passes_over_a_negation(unused) else sure
