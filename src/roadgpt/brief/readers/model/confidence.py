"""Computes the confidence in a reading from the probability, the length and the tokens of its plan, and from
the numbers of the text that the plan lacks.
"""

from collections.abc import Mapping, Sequence
from math import exp, log, log1p

from roadgpt.brief.readers.model.mirror import in_mirror_tokens
from roadgpt.brief.readers.model.neural_network import NeuralNetwork
from roadgpt.brief.readers.model.slots import SlottedText
from roadgpt.brief.readers.model.test_time_augmentation import ScoredPlan
from roadgpt.brief.readers.model.used_words import left_out, passes_over
from roadgpt.brief.readers.model.vocabulary import SLOT_TOKENS

DOUBT = 0.5
"""The highest confidence of a reading that lacks a measured number of the text, and of the reading of a
change request that says only what must not change."""
HAS = "has "
"""Prefix of the names of the inputs that say whether a plan has a token."""
LEAST_UNLIKELY = 0.03
"""Added before a logarithm is taken, so that it is finite for a plan with probability 1."""


def features(
    networks: Sequence[NeuralNetwork],
    draft: ScoredPlan,
    text: SlottedText,
    seen: tuple[SlottedText, Sequence[str]] | None = None,
) -> dict[str, float]:
    """Returns the inputs of the confidence model by name; all but ``agreement`` and ``has`` are logarithms.

    ``seen`` is a pair: the text that the networks read, and the tokens that they wrote. It is needed only if
    these differ from ``text`` and the tokens of ``draft``.

    - ``all``: how unlikely the plan is; ``worst``: how unlikely its unlikeliest token is. Both are for the
      variant of the text for which the plan scores highest.
    - ``sceptic``: how unlikely the plan is for the unvaried text, according to the network that gives it the
      lowest probability.
    - ``agreement``: the share of the variants and networks whose likeliest plan this is.
    - ``numbers``: how many numbers of the text the plan lacks.
    - ``words``, ``tokens``: how long the text and the plan are. The networks give a long plan a lower
      probability than a short plan, even if both are right equally often.
    - ``has TOKEN``: 1 for each token of the plan except slots; left and right count as the same token. The
      networks misread some tokens, such as a fall or a number of turns, more often than the probability says.
      They misread other tokens, such as a hairpin, less often.
    """
    read, tokens = seen or (text, draft.tokens)
    sceptic = max(-float(each.chances_of([read], tokens, read)[0].sum()) for each in networks)
    return {
        "all": _unlikely(-sum(draft.log_chances)),
        "worst": _unlikely(-min(draft.log_chances)),
        "sceptic": _unlikely(sceptic),
        "agreement": draft.agreement,
        "numbers": log1p(len(left_out(draft.tokens, text))),
        "words": log(max(len(text.words), 1)),
        "tokens": log(max(len(draft.tokens), 1)),
        **{f"{HAS}{token}": 1.0 for token in _kinds(draft.tokens)},
    }


def _kinds(tokens: Sequence[str]) -> list[str]:
    """Returns the tokens of a plan without slots and repetitions, with one name for each pair of sides."""
    sides = zip(tokens, in_mirror_tokens(tokens), strict=True)
    return sorted({min(pair) for pair in sides}.difference(SLOT_TOKENS))


def _unlikely(lost: float) -> float:
    """Returns the logarithm of a negative log-probability."""
    return log(LEAST_UNLIKELY + max(lost, 0.0))


def confidence(
    weights: Mapping[str, float], found: Mapping[str, float], unused: Sequence[str], text: SlottedText
) -> float:
    """Returns the estimated probability (0 to 1) that a reading with the features ``found`` is right.

    The confidence model was fitted on held-out texts. The result for a reading that ignores a measured
    number is at most ``DOUBT``. Other unused words do not lower it: on held-out texts, readings with and
    without such words were right equally often.
    """
    score = weights["bias"] + sum(weight * found.get(name, 0.0) for name, weight in weights.items())
    sure = round(1 / (1 + exp(-score)), 3)
    return min(sure, DOUBT) if passes_over(unused, text) else sure
