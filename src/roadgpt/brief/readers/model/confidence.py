"""Computes the confidence in a reading from the probability of its plan and from the numbers of the text that
the plan lacks.
"""

import re
from collections.abc import Mapping, Sequence
from math import exp, log1p

from roadgpt.brief.readers.model.slots import SlottedText
from roadgpt.brief.readers.model.test_time_augmentation import ScoredPlan
from roadgpt.brief.readers.model.used_words import left_out, passes_over_a_negation

DOUBT = 0.5
"""The highest confidence of a reading that would stay the same if a word such as "not" were left out, and of
the reading of a change request that says only what must not change."""

DENIAL = re.compile(
    r"(?:please )?(?:do not|don'?t|never) [^,;:.]*[.!]*"
    r"|(?:bitte )?mach\w* [^,;:.]*\bnicht \w+er[.!]*"
    r"|ne (?:fais|rends|mets|change)[^,;:.]* pas [^,;:.]*[.!]*"
    r"|no (?:hagas|pongas|cambies) [^,;:.]*[.!]*"
    r"|non (?:fare|rendere|cambiare|mettere) [^,;:.]*[.!]*",
    re.IGNORECASE,
)
"""Matches a change request that says only what must not change."""


def is_denial(words: str) -> bool:
    """Returns whether a change request says only what must not change, such as "don't make it longer"."""
    return DENIAL.fullmatch(words.strip().replace("’", "'")) is not None


def features(draft: ScoredPlan, text: SlottedText) -> dict[str, float]:
    """Returns the inputs of the confidence model by name: how likely the plan is, and how many numbers of the
    text the plan lacks.
    """
    return {**draft.features, "numbers": log1p(len(left_out(draft.tokens, text)))}


def confidence(weights: Mapping[str, float], found: Mapping[str, float], unused: Sequence[str]) -> float:
    """Returns the estimated probability (0 to 1) that a reading is right.

    The confidence model was fitted on held-out texts. The result for a reading that ignores a
    negation is at most ``DOUBT``.

    Args:
        weights: the weights of the confidence model by the names of the features, and its "bias".
        found: the features of the reading, as ``features`` returns them.
        unused: the words that the plan does not depend on.
    """
    score = weights["bias"] + sum(weight * found[name] for name, weight in weights.items() if name != "bias")
    sure = round(1 / (1 + exp(-score)), 3)
    return min(sure, DOUBT) if passes_over_a_negation(unused) else sure
