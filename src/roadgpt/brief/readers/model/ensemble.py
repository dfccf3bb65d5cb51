"""Combines neural networks that read the same kind of description: single roads, or routes and maps."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from roadgpt.brief.readers.model.confidence import confidence, features
from roadgpt.brief.readers.model.mirror import is_of_junctions
from roadgpt.brief.readers.model.neural_network import NeuralNetwork
from roadgpt.brief.readers.model.route_words import TOLD_ON_ROUTES, asks_for_map, may_tell_a_route
from roadgpt.brief.readers.model.slots import SlottedText, slotted
from roadgpt.brief.readers.model.test_time_augmentation import ScoredPlan, scored_plans
from roadgpt.brief.readers.model.used_words import unused_words
from roadgpt.brief.words import SURE

GUESS = 0.05
"""If the confidence in a route is lower, a single road that has a higher confidence is preferred."""


@dataclass(frozen=True, slots=True)
class Ensemble:
    """One or two neural networks that read the same texts, and the settings for judging their plans."""

    networks: tuple[NeuralNetwork, ...]
    refuse_from: float
    """The smallest probability of a refusal, from 0 to 1, at which a refusal is allowed as a plan."""
    weights: Mapping[str, float]
    """The weights of the confidence model, and its bias."""
    fillers: frozenset[str]
    """Words that are never reported as unused."""
    meanings: Mapping[str, Sequence[str]]
    """The tokens that words of descriptions usually ask for, the most usual one first."""
    meanings_of_changes: Mapping[str, Sequence[str]]
    """The same for words of change requests."""

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

    def refusal(self, text: SlottedText) -> float:
        """Returns the mean of the networks' probabilities (0 to 1) that a text describes no road that can be
        built.
        """
        return sum(network.refusal(text) for network in self.networks) / len(self.networks)

    def unused(self, text: SlottedText, tokens: Sequence[str]) -> tuple[str, ...]:
        """Returns the words that a plan does not depend on, each once, in the order of the text."""
        meanings = self.meanings_of_changes if text.is_change else self.meanings
        return unused_words(self.networks[0], text, tokens, self.fillers, meanings)

    def confidence(
        self,
        draft: ScoredPlan,
        text: SlottedText,
        unused: Sequence[str],
        seen: tuple[SlottedText, Sequence[str]] | None = None,
    ) -> float:
        """Returns the fraction (0 to 1) of readings like this one that were right on held-out texts; for
        ``seen`` see ``features``.
        """
        return confidence(self.weights, features(self.networks, draft, text, seen), unused, text)


def scored_by(
    roads: Ensemble, routes: Ensemble | None, words: str, refuse_from: float | None
) -> tuple[Ensemble, tuple[ScoredPlan, ...]]:
    """Returns the networks chosen for a description, and the plans that they wrote, the likeliest first.

    ``routes`` reads the description if a word may mention a junction, ramp, lane or map. A network plan is a
    route, a map, or a plan with words that ``roads`` does not know. ``routes`` is chosen in these cases:

    - It writes a network plan with a confidence of at least ``GUESS``. The confidence of ``roads`` is then
      ignored, because ``roads`` may be sure that "crossroads, sharp left" is a bend.
    - It writes a network plan, and the text asks for a map, or has a noun that can only mean a junction.
    - It writes a network plan, and ``roads`` has no plan of higher confidence.
    - It refuses the description, and the confidence of ``roads`` in a plan is less than ``SURE``.
    - ``roads`` names a junction or the like beside the road, or as the cause of a refusal. ``routes`` then
      reads the description whatever its words are.

    Otherwise ``roads`` is chosen.

    ``refuse_from`` is the smallest probability of a refusal at which a refusal is allowed as a plan; None
    takes the value that was fitted to the networks.
    """
    text = slotted(words)
    read = routes.scored(words, refuse_from) if routes and may_tell_a_route(words) else ()
    is_route = bool(read) and _is_route(read[0], roads)
    sure = _confidence(routes, read, text) if routes and is_route else 0.0
    if routes and is_route and (sure >= GUESS or (_says_network(text) and not read[0].is_refusal)):
        return routes, read
    found = roads.scored(words, refuse_from)
    if routes and found and not TOLD_ON_ROUTES.isdisjoint(found[0].tokens):
        return routes, read or routes.scored(words, refuse_from)
    if routes is None or not read:
        return roads, found
    against = _confidence(roads, found, text)
    if read[0].is_refusal:
        return (routes, read) if against < SURE else (roads, found)
    return (routes, read) if is_route and sure >= against else (roads, found)


def _is_route(draft: ScoredPlan, roads: Ensemble) -> bool:
    """Returns whether a plan is one of a route or a map, or has words that ``roads`` does not know."""
    # brief.read takes from the words whether a single road is a motorway
    tokens = [each for each in draft.tokens if each != "motorway"]
    return is_of_junctions(draft.line) or not roads.knows(tokens)


def _says_network(text: SlottedText) -> bool:
    """Returns whether a text asks for a map, or has a noun that can only mean a junction."""
    from roadgpt.brief.readers.model.junction_nouns import names_a_junction  # only for networks

    return names_a_junction(text.text) or asks_for_map(text)


def _confidence(ensemble: Ensemble, found: Sequence[ScoredPlan], text: SlottedText) -> float:
    """Returns the confidence in the likeliest plan; 0 if there is none, or if it is a refusal."""
    is_plan = bool(found) and not found[0].is_refusal
    return ensemble.confidence(found[0], text, ()) if is_plan else 0.0
