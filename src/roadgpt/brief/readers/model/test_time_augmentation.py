"""Test-time augmentation: reads variants of a description and combines the plans that the network writes.

The variants are the description itself, its mirror image (left and right swapped), and the description with
or without its full stop. A plan that the network writes for every variant is correct more often than one that
it writes for the original alone. If the plan for the original is nearly certain, the other variants are
skipped to save time.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from roadgpt.brief.junctions import MAP
from roadgpt.brief.normal import normal
from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.readers.model.mirror import in_mirror, in_mirror_tokens
from roadgpt.brief.readers.model.neural_network import NeuralNetwork, WrittenPlan
from roadgpt.brief.readers.model.route_words import asks_for_map
from roadgpt.brief.readers.model.slots import SlottedText, slotted
from roadgpt.brief.readers.model.vocabulary import REFUSALS, ROUNDABOUT, TOKENS, plan_of
from roadgpt.errors import RoadGPTError

UNSEEN = 1.5
"""If a variant did not produce a plan, the score of the plan for this variant is the lowest score of the
variant's own plans, minus UNSEEN."""
ENDS = " .!"
SURE = -0.1
"""If the log-probability of a whole plan is above this, the other variants are skipped. Of 943 descriptions
held out from training, 781 got such a plan, and the other variants changed none of their readings."""
NOT_A_MAP = tuple(token for token in TOKENS if token != MAP)
"""All tokens but the one with which plans of maps begin."""
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


@dataclass(frozen=True, slots=True)
class VariantPlans:
    """The plans that the network wrote for one variant, by their normal forms."""

    plans: dict[str, WrittenPlan]
    refusal: float
    """The probability that the description does not ask for a road that can be built."""

    @property
    def best(self) -> str:
        """The normal form of the likeliest plan."""
        return max(self.plans, key=lambda key: self.plans[key].score)

    @property
    def is_clear(self) -> bool:
        """True if the network is nearly certain whether to refuse the description and which plan is right."""
        if not self.plans or UNDECIDED[0] < self.refusal < UNDECIDED[1]:
            return False
        return sum(self.plans[self.best].log_chances) > SURE

    def score(self, key: str) -> float:
        """Returns the score of a plan, also of a plan that was not written for this variant."""
        scores = {key: plan.score for key, plan in self.plans.items()}
        return scores[key] if key in scores else min(scores.values()) - UNSEEN


def scored_plans(
    networks: Sequence[NeuralNetwork],
    words: str,
    refuse_from: float,
    shown: Callable[[SlottedText], SlottedText] = lambda text: text,
    key: Callable[[str], str] | None = None,
) -> tuple[ScoredPlan, ...]:
    """Returns plans for a description or a change request, the likeliest first.

    Args:
        networks: the networks that write the plans.
        words: the description, or the change request if ``key`` is given.
        refuse_from: smallest probability of a refusal, from 0 to 1, at which a refusal is allowed as a plan;
            with a value above 1, refusals are never allowed.
        shown: function that is applied to the text before the network reads it, for example to replace
            unusual numbers.
        key: function that returns the normal form of a plan of changes, or raises an error for an invalid
            plan.
    """
    is_change = key is not None

    def looks(words: str, is_mirrored: bool, barred: Sequence[str] = ()) -> list[VariantPlans]:
        text = shown(slotted(words, is_change))
        return [
            _plans_of_variant(each, text, refuse_from, is_mirrored, key or _normal_form, barred)
            for each in networks
        ]

    text = shown(slotted(words, is_change))
    variants, others = looks(words, False), list[tuple[str, bool]]()
    if not (all(variant.is_clear for variant in variants) and len({each.best for each in variants}) == 1):
        others = _others(words)
        variants += [look for other in others for look in looks(*other)]
    found = _best_first(variants, text)
    wants_map = not is_change and asks_for_map(text) and all(each.knows([MAP]) for each in networks)
    if not found or not wants_map or found[0].tokens[0] in (MAP, *REFUSALS):
        return found
    again = [look for other in ((words, False), *others) for look in looks(*other, barred=NOT_A_MAP)]
    return _best_first(again, text) or found


def _best_first(variants: Sequence[VariantPlans], text: SlottedText) -> tuple[ScoredPlan, ...]:
    """Returns all plans that were written for the variants, with their scores, the likeliest first."""
    variants = [variant for variant in variants if variant.plans]
    keys = dict.fromkeys(key for variant in variants for key in variant.plans)
    found = [_scored(key, variants, text) for key in keys]
    return tuple(sorted(found, key=lambda draft: -draft.score))


def refusal(networks: Sequence[NeuralNetwork], words: str) -> float:
    """Returns the mean probability of a refusal over all networks and variants."""
    texts = [slotted(variant) for variant in (words, *(other for other, _ in _others(words)))]
    return sum(network.refusal(text) for network in networks for text in texts) / len(networks) / len(texts)


def _others(words: str) -> list[tuple[str, bool]]:
    """Returns the other variants of a description, each with whether left and right are swapped in it."""
    bare = words.rstrip(ENDS)
    out = [(bare if bare != words else f"{words}.", False)] if bare else []
    swapped = in_mirror(words)
    return [*out, (swapped, True)] if swapped else out


def _plans_of_variant(
    network: NeuralNetwork,
    text: SlottedText,
    refuse_from: float,
    is_mirrored: bool,
    normal_form: Callable[[str], str],
    barred: Sequence[str],
) -> VariantPlans:
    plans: dict[str, WrittenPlan] = {}
    found, chance = network.write(network.encode(text), text, refuse_from, barred)
    for written in found:
        tokens = in_mirror_tokens(written.tokens) if is_mirrored else written.tokens
        if ROUNDABOUT in tokens and not text.is_change:
            from roadgpt.brief.readers.model.ring_sizes import with_ring_sizes  # only for networks

            tokens = with_ring_sizes(tokens, text)
        try:
            line = _line(tokens, text)
            key = line if tokens[0] in REFUSALS else normal_form(line)
        except RoadGPTError:
            continue  # the plan cannot be read
        if key and (key not in plans or plans[key].score < written.score):
            plans[key] = replace(written, tokens=tokens)
    return VariantPlans(plans, chance)


def _line(tokens: Sequence[str], text: SlottedText) -> str:
    """Returns the plan with the values of its slots filled in, or the name of a refusal."""
    return " ".join(tokens) if tokens[0] in REFUSALS else plan_of(tokens, text.slots)


def _normal_form(line: str) -> str:
    return plan(normal(read_plan(line)))


def _scored(key: str, variants: Sequence[VariantPlans], text: SlottedText) -> ScoredPlan:
    """Returns a plan that was written for at least one of the variants, with its scores."""
    best = max((each.plans[key] for each in variants if key in each.plans), key=lambda plan: plan.score)
    score = sum(each.score(key) for each in variants) / len(variants)
    agreement = sum(each.best == key for each in variants) / len(variants)
    return ScoredPlan(best.tokens, _line(best.tokens, text), score, best.log_chances, agreement)
