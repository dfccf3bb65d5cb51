"""Test-time augmentation: reads variants of a description and combines the plans that the network writes.

The variants are the description itself, its mirror image (left and right swapped), and the description with
or without its full stop. A plan that the network writes for every variant is correct more often than one that
it writes for the original alone. If the plan for the original is nearly certain, the other variants are
skipped to save time.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from roadgpt.brief.normal import normal
from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.readers.model.bounds import bounded
from roadgpt.brief.readers.model.mirror import in_mirror, in_mirror_tokens
from roadgpt.brief.readers.model.network import Network, WrittenPlan
from roadgpt.brief.readers.model.slots import SlottedText, slotted
from roadgpt.brief.readers.model.vocabulary import REFUSALS, plan_of
from roadgpt.errors import BriefError

UNSEEN = 1.5
"""The score of a plan for a variant that did not produce this plan is the variant's lowest score minus
UNSEEN."""
ENDS = " .!"
SURE = -0.1
"""Log-probability of a whole plan above which the other variants are skipped. Of 943 descriptions held back
from training, 781 reached it, and the other variants changed none of them."""
UNDECIDED = (0.03, 0.97)
"""If the probability of a refusal lies between these values, the other variants are read as well."""


@dataclass(frozen=True, slots=True)
class ScoredPlan:
    """A plan and its combined score over all variants."""

    tokens: tuple[str, ...]
    line: str
    """The plan with the values of its slots filled in, or the name of a refusal."""
    score: float
    """Mean over the variants of the length-normalised log-probability."""
    log_chances: tuple[float, ...]
    """Log-probabilities of the plan's tokens, for the variant in which the plan scores highest."""
    agreement: float
    """Share of the variants, from 0 to 1, in which this plan has the highest score."""

    @property
    def is_refusal(self) -> bool:
        """True if the network refuses the description, because it describes no road that can be built."""
        return self.tokens[0] in REFUSALS

    @property
    def features(self) -> dict[str, float]:
        """The inputs of the confidence model, by name."""
        return {"all": sum(self.log_chances), "worst": min(self.log_chances), "agreement": self.agreement}


@dataclass(frozen=True, slots=True)
class VariantPlans:
    """The plans that the network wrote for one variant: in normal form, with their scores."""

    plans: dict[str, tuple[float, WrittenPlan]]
    refusal: float
    """The probability that the description does not ask for a road that can be built."""

    @property
    def least(self) -> float:
        """The lowest score among the plans of this variant."""
        return min(score for score, _ in self.plans.values())

    @property
    def is_clear(self) -> bool:
        """True if the network is nearly certain whether to refuse the description and which plan is right."""
        if not self.plans or UNDECIDED[0] < self.refusal < UNDECIDED[1]:
            return False
        _, best = max(self.plans.values(), key=lambda plan: plan[0])
        return sum(best.log_chances) > SURE


def scored_plans(
    network: Network,
    words: str,
    refuse_from: float,
    shown: Callable[[SlottedText], SlottedText] = lambda text: text,
) -> tuple[ScoredPlan, ...]:
    """Returns plans for a description, the likeliest first.

    Args:
        network: writes the plans.
        words: the description.
        refuse_from: smallest probability of a refusal, from 0 to 1, at which a refusal is allowed as a plan;
            with a value above 1, refusals are never allowed.
        shown: function that is applied to the text before the network reads it, for example to replace
            unusual numbers.
    """
    text = shown(slotted(words))
    variants = [_plans_of_variant(network, text, refuse_from, False)]
    for other, is_mirrored in [] if variants[0].is_clear else _others(words):
        variants.append(_plans_of_variant(network, shown(slotted(other)), refuse_from, is_mirrored))
    variants = [variant for variant in variants if variant.plans]
    keys = dict.fromkeys(key for variant in variants for key in variant.plans)
    found = [_scored(key, variants, text) for key in keys]
    return tuple(sorted(found, key=lambda draft: -draft.score))


def refusal(network: Network, words: str) -> float:
    """Returns the mean probability of a refusal over all variants."""
    chances = [_plans_of_variant(network, slotted(words), 2.0, False).refusal]
    chances += [_plans_of_variant(network, slotted(other), 2.0, way).refusal for other, way in _others(words)]
    return sum(chances) / len(chances)


def _others(words: str) -> list[tuple[str, bool]]:
    """Returns the other variants of a description, each with whether left and right are swapped in it."""
    bare = words.rstrip(ENDS)
    out = [(bare if bare != words else f"{words}.", False)] if bare else []
    swapped = in_mirror(words)
    return [*out, (swapped, True)] if swapped else out


def _plans_of_variant(
    network: Network, text: SlottedText, refuse_from: float, is_mirrored: bool
) -> VariantPlans:
    plans: dict[str, tuple[float, WrittenPlan]] = {}
    chance = 0.0
    for written in network.write(network.encode(text), text, refuse_from):
        chance = written.refusal
        tokens = in_mirror_tokens(written.tokens) if is_mirrored else written.tokens
        seen = WrittenPlan(bounded(tokens, text), written.log_chances, written.refusal)
        key = _key(seen.tokens, text)
        if key and (key not in plans or plans[key][0] < written.score):
            plans[key] = (written.score, seen)
    return VariantPlans(plans, chance)


def _key(tokens: Sequence[str], text: SlottedText) -> str:
    """Returns the plan in normal form; empty if it cannot be read."""
    if tokens[0] in REFUSALS:
        return tokens[0]
    try:
        return plan(normal(read_plan(plan_of(tokens, text.slots))))
    except BriefError:
        return ""


def _scored(key: str, variants: Sequence[VariantPlans], text: SlottedText) -> ScoredPlan:
    scores = [each.plans[key][0] if key in each.plans else each.least - UNSEEN for each in variants]
    _, best = max((each.plans[key] for each in variants if key in each.plans), key=lambda found: found[0])
    preferred = sum(max(each.plans, key=lambda other: each.plans[other][0]) == key for each in variants)
    line = best.tokens[0] if best.tokens[0] in REFUSALS else plan_of(best.tokens, text.slots)
    number = len(variants)
    return ScoredPlan(best.tokens, line, sum(scores) / number, best.log_chances, preferred / number)
