"""Networks that were trained for the same texts and read them together."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from roadgpt.brief.readers.model.confidence import confidence, features
from roadgpt.brief.readers.model.neural_network import NeuralNetwork
from roadgpt.brief.readers.model.slots import SlottedText
from roadgpt.brief.readers.model.test_time_augmentation import ScoredPlan, scored_plans


@dataclass(frozen=True, slots=True)
class Ensemble:
    """One or two networks, with what was fitted to their readings of texts that they were not trained on."""

    networks: tuple[NeuralNetwork, ...]
    refuse_from: float
    """The smallest probability of a refusal, from 0 to 1, at which a refusal is allowed as a plan."""
    weights: Mapping[str, float]
    """The weights of the confidence model, and its bias."""

    @property
    def first(self) -> NeuralNetwork:
        """The network that finds the unused words and draws other readings."""
        return self.networks[0]

    def scored(
        self,
        words: str,
        refuse_from: float | None = None,
        shown: Callable[[SlottedText], SlottedText] = lambda text: text,
    ) -> tuple[ScoredPlan, ...]:
        """Returns plans for a description, the likeliest first; for the arguments see ``scored_plans``."""
        least = self.refuse_from if refuse_from is None else refuse_from
        return scored_plans(self.networks, words, least, shown)

    def knows(self, tokens: Sequence[str]) -> bool:
        """Returns whether all networks were trained with all these tokens."""
        return all(network.knows(tokens) for network in self.networks)

    def confidence(self, draft: ScoredPlan, text: SlottedText, unused: Sequence[str]) -> float:
        """Returns the fraction (0 to 1) of readings like this one that were right on held-out texts."""
        return confidence(self.weights, features(draft, text), unused)
