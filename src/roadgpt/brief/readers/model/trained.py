"""A trained network with the settings by which its plans are judged: which of them can be read, how sure they
are, which words of the text they do not use; and the choice between two such networks.

The confidence in a reading is computed from the probability, the length and the tokens of its plan, and from
the numbers of the text that the plan lacks. To find unused words, each word in turn, except function words,
is left out, and the network computes how likely the plan is for the remaining words."""

import unicodedata
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from math import exp, log, log1p
from typing import Any, Generic, TypeVar

from roadgpt.brief.feasible import is_possible
from roadgpt.brief.languages import TABLE
from roadgpt.brief.model import Brief
from roadgpt.brief.readers.model.before import TOLD_ON_ROUTES, may_tell_a_route
from roadgpt.brief.readers.model.neural_network import NeuralNetwork
from roadgpt.brief.readers.model.ring_sizes import LEAST, diameters
from roadgpt.brief.readers.model.scenes import asked_in, may_be_of_a_scene, told_in, without_scene
from roadgpt.brief.readers.model.slots import NumberSlot, SlottedText, Word
from roadgpt.brief.readers.model.vocabulary import REFUSALS, ROUNDABOUT, SLOT_TOKENS, WISHES, change_of
from roadgpt.brief.scene import Scene
from roadgpt.brief.words import SURE
from roadgpt.errors import RoadGPTError

DOUBT = 0.5
"""The highest confidence of a reading that lacks a measured number of the text."""
HAS = "has "
"""Prefix of the names of the inputs that say whether a plan has a token."""
LEAST_UNLIKELY = 0.03
"""Added before a logarithm is taken, so that it is finite for a plan with probability 1."""
NOTICED = 0.02
"""If leaving a word out lowers the log-probability of the plan by more than this, the word counts as used,
even if the plan stays the likeliest."""
SHORTEST = 3  # letters; shorter words are function words in all five languages
MOST_WORDS = 60
"""The largest number of words that are tried."""
GUESS = 0.05
"""If the confidence in a route is lower, a single road that has a higher confidence is preferred."""
NEARLY = 0.7
"""By how much less the score of a plan may be that takes the place of one that contradicts itself."""
ANY_WORLD = (None, 0.0)
"""No limit of the map and of radii: those of a World are checked in brief.read."""
REFUSING = tuple((word,) for word in REFUSALS)
SHORT = 12
"""The largest number of words of a text that the network for routes reads only if a word may be of a route or
a scene."""
LONG = 40
"""The largest number of words of a text in which all words are looked at that its plan does not depend on."""
TOLD_BY = [(frozenset(names.split()), frozenset(words.split())) for names, words in TABLE["told_by"].items()]
"""Words that are used by a plan that has one of some tokens."""
Asked = TypeVar("Asked")


@dataclass(frozen=True, slots=True)
class ScoredPlan(Generic[Asked]):
    """A plan that a network wrote, and how likely it is."""

    tokens: tuple[str, ...]
    asks: Asked | None
    """What the plan asks for: a Brief in normal form, or changes. None: the network refuses the text, because
    it describes no road that can be built."""
    score: float
    """The length-normalised log-probability."""
    log_chances: tuple[float, ...]
    """Log-probabilities of the plan's tokens."""

    @property
    def refusal(self) -> str:
        """The name of the refusal; empty if the plan is none."""
        return "" if self.asks is not None else " ".join(self.tokens)


def scored_plans(
    network: NeuralNetwork,
    text: SlottedText,
    refuse_from: float,
    read: Callable[[Sequence[str], Sequence[NumberSlot]], Asked],
) -> tuple[ScoredPlan[Asked], ...]:
    """Returns the plans that a network writes for a description or a change request, the likeliest first.

    Args:
        network: the network that writes the plans.
        text: the text that it reads.
        refuse_from: smallest probability of a refusal, from 0 to 1, at which a refusal is allowed as a plan;
            with a value above 1, refusals are never allowed.
        read: function that reads tokens, with their numbers, into the normal form of their plan, or raises
            an error if they cannot be read. Of plans with the same normal form, the likeliest is returned."""
    found: list[ScoredPlan[Asked]] = []
    for written in network.write(network.encode(text), text, refuse_from):
        tokens, asks = written.tokens, None
        if tokens[:1] not in REFUSING:
            try:
                asks = read(tokens, text.slots)
            except RoadGPTError:
                continue  # the plan cannot be read
        if all(asks != each.asks or (asks is None and tokens != each.tokens) for each in found):
            found.append(ScoredPlan(tokens, asks, written.score, written.log_chances))
    return tuple(found)


def changes_in(key: Callable[[str], str]) -> Callable[[Sequence[str], Sequence[NumberSlot]], str]:
    """Returns the function that reads the tokens of changes, as ``scored_plans`` needs it; ``key`` returns
    the normal form of a plan of changes."""
    return lambda tokens, slots: key(change_of(tokens, slots))


def most_plausible(found: Sequence[ScoredPlan[Brief]]) -> ScoredPlan[Brief]:
    """Returns the likeliest plan; one that contradicts itself is passed over if another one is nearly as
    likely. If none is, the description contradicts itself, not the reading."""
    near = (each for each in found if found[0].asks and each.score > found[0].score - NEARLY)
    return next((each for each in near if each.asks and is_possible(each.asks, *ANY_WORLD)), found[0])


def left_out(tokens: Sequence[str], text: SlottedText) -> list[int]:
    """Returns the indices of those numbers (slots) of a text that its plan does not use."""
    return [index for index in range(len(text.slots)) if SLOT_TOKENS[index] not in tokens]


def lost(tokens: Sequence[str], text: SlottedText) -> set[int]:
    """Returns the indices of the numbers of a text that its plan uses neither as numbers nor as the size of a
    roundabout."""
    across = diameters(tokens, text) if ROUNDABOUT in tokens else ()
    return {*left_out(tokens, text)}.difference(n for n in across if text.slots[n].value >= LEAST)


def passes_over(unused: Sequence[str], text: SlottedText) -> bool:
    """Returns whether one of the unused words is a measured number of the text, such as "40 m".

    Counts and words such as "not" are no sign of a wrong reading: another word often says the same ("five
    turns: left, left, ..."), and readings that ignore such a word were right as often as others."""
    numbers = {w.written for w in text.words if w.text.startswith("[unused")}
    return any(word in numbers for word in unused)


def _is_content(word: Word, fillers: frozenset[str]) -> bool:
    if not word.written or word.text in fillers or word.text.startswith("["):
        return False
    is_long = len(word.text) >= SHORTEST or not word.text.isascii()  # a single Chinese character is a word
    return word.text.isdecimal() or (word.text.isalpha() and is_long)


def _is_latin(word: str) -> bool:
    return all(not letter.isalpha() or unicodedata.name(letter, "").startswith("LATIN") for letter in word)


def features(draft: ScoredPlan[Any], text: SlottedText) -> dict[str, float]:
    """Returns the inputs of the confidence model by name; all but ``has`` are logarithms.

    - ``all``: how unlikely the plan is; ``worst``: how unlikely its unlikeliest token is.
    - ``numbers``: how many numbers of the text the plan lacks.
    - ``words``, ``tokens``: how long the text and the plan are. The networks give a long plan a lower
      probability than a short plan, even if both are right equally often.
    - ``has TOKEN``: 1 for each token of the plan except slots; left and right count as the same token. The
      networks misread some tokens, such as a fall or a number of turns, more often than the probability says.
      They misread other tokens, such as a hairpin, less often."""
    return {
        "all": _unlikely(-sum(draft.log_chances)),
        "worst": _unlikely(-min(draft.log_chances)),
        "numbers": log1p(len(left_out(draft.tokens, text))),
        "words": log(max(len(text.words), 1)),
        "tokens": log(max(len(draft.tokens), 1)),
        **{f"{HAS}{token}": 1.0 for token in _kinds(draft.tokens)},
    }


def _kinds(tokens: Sequence[str]) -> list[str]:
    """Returns the tokens of a plan without slots and repetitions, with one name for each pair of sides."""
    return sorted({token.replace("right", "left") for token in tokens}.difference(SLOT_TOKENS))


def _unlikely(lost: float) -> float:
    return log(LEAST_UNLIKELY + max(lost, 0.0))


def confidence(
    weights: Mapping[str, float], found: Mapping[str, float], unused: Sequence[str], text: SlottedText
) -> float:
    """Returns the estimated probability (0 to 1) that a reading with the features ``found`` is right.

    The confidence model was fitted on held-out texts. The result for a reading that ignores a measured
    number is at most ``DOUBT``. Other unused words do not lower it: on held-out texts, readings with and
    without such words were right equally often."""
    score = weights["bias"] + sum(weight * found.get(name, 0.0) for name, weight in weights.items())
    sure = round(1 / (1 + exp(-score)), 3)
    return min(sure, DOUBT) if passes_over(unused, text) else sure


@dataclass(frozen=True, slots=True)
class Trained:
    """A neural network that reads one kind of description, and the settings for judging its plans."""

    network: NeuralNetwork
    refuse_from: float
    """The smallest probability of a refusal, from 0 to 1, at which a refusal is allowed as a plan."""
    weights: Mapping[str, float]
    """The weights of the confidence model, and its bias."""
    fillers: frozenset[str]
    """Words that are never reported as unused."""

    def plans(self, text: SlottedText, refuse_from: float | None = None) -> tuple[ScoredPlan[Brief], ...]:
        """Returns plans for a description, the likeliest first; for the arguments see ``scored_plans``."""
        least = self.refuse_from if refuse_from is None else refuse_from
        return scored_plans(self.network, text, least, asked_in)

    def unused(self, text: SlottedText, tokens: Sequence[str]) -> tuple[str, ...]:
        """Returns the words that a plan does not depend on, and the numbers that it lacks: spelled as in the
        text, each once, in the order of the text. Words for other road users, weather and light always count
        as unused if the plan has nothing of the kind; other words are not looked at where the plan tells more
        than a road, or the text is long and the network can write scenes. Longer texts of testers are full of
        numbers that are no measures, so those without a unit are not named there."""
        told = Brief() if text.is_change else told_in(tokens, text.slots)
        is_story = told != Brief() or (self.network.has_scenes and len(text.words) > LONG)
        idle = frozenset[int]() if is_story else self._idle(text, tokens)
        named = set[str]() if text.is_change else {*without_scene(text, told, tokens)}
        out: list[str] = []
        missing, slot = lost(tokens, text), 0
        is_long = self.network.has_scenes and len(text.words) > SHORT
        for place, word in enumerate(text.words):
            if word.text.startswith("[unused") and word.written:
                is_measure = slot >= len(text.slots) or not is_long or bool(text.slots[slot].unit)
                if is_measure and (slot in missing or slot >= len(text.slots)):
                    out.append(word.written)
                slot += 1
            elif word.written in named:
                out.append(word.written)
            elif place in idle:
                is_short = [each.text for each in text.words[place + 1 : place + 3]] == ["'", "t"]
                out.append(f"{word.written}'t" if is_short else word.written)
        return tuple(dict.fromkeys(out))

    def _idle(self, text: SlottedText, tokens: Sequence[str]) -> frozenset[int]:
        """Returns the places of the words that the plan does not depend on.

        A word for what the plan has is used (``TOLD_BY``). If two words mean the same ("uphill, climbing all
        the way"), each of them can be left out, but not both. If the plan changes when all such words are
        left out, a word that alone restores the plan counts as used. A word in letters of another script than
        Latin is in none of the languages that are read: it never counts as used, even if the plan happens to
        be less likely without it."""
        told = {*tokens}.union(*(words for names, words in TOLD_BY if not names.isdisjoint(tokens)))
        content = [place for place, word in enumerate(text.words) if _is_content(word, self.fillers)]
        content = [place for place in content if text.words[place].text not in told]
        foreign = frozenset(place for place in content if not _is_latin(text.words[place].text))
        tried = [place for place in content if place not in foreign][:MOST_WORDS]
        kept = self._are_kept(text, tokens, [{place} for place in tried])
        idle = [place for place, is_kept in zip(tried, kept, strict=True) if is_kept]
        if len(idle) < 2 or all(self._are_kept(text, tokens, [{*idle}])):
            return frozenset(idle) | foreign
        restored = self._are_kept(text, tokens, [{*idle} - {place} for place in idle])
        return foreign.union(place for place, is_back in zip(idle, restored, strict=True) if not is_back)

    def _are_kept(
        self, text: SlottedText, tokens: Sequence[str], left_out: Sequence[Collection[int]]
    ) -> list[bool]:
        if not left_out:
            return []
        texts = [
            SlottedText(tuple(w for place, w in enumerate(text.words) if place not in places), text.slots)
            for places in left_out
        ]
        logs, leads = self.network.chances_of([text, *texts], tokens, text)
        lost = logs[0].sum() - logs[1:].sum(axis=1)
        return [bool(one) for one in (leads[1:] >= 0).all(axis=1) & (lost <= NOTICED)]

    def confidence(self, draft: ScoredPlan[Any], text: SlottedText, unused: Sequence[str]) -> float:
        """Returns the fraction (0 to 1) of readings like this one that were right on held-out texts."""
        return confidence(self.weights, features(draft, text), unused, text)


def chosen(
    roads: Trained, routes: Trained | None, words: str, text: SlottedText, refuse_from: float | None = None
) -> tuple[Trained, tuple[ScoredPlan[Brief], ...]]:
    """Returns the network chosen for a description, and the plans that it wrote, the likeliest first.

    ``routes`` reads the description if a word may mention a junction, ramp, lane or map; one that can write
    scenes also if a word may be of a scene, or the text has more than ``SHORT`` words. A network plan is a
    route, a map, or a plan with words that ``roads`` does not know. ``routes`` is chosen in these cases:

    - It writes a network plan with a confidence of at least ``GUESS``, or one with a scene for a text that
      may be of one. The confidence of ``roads`` is then ignored, because ``roads`` may be sure that
      "crossroads, sharp left" is a bend, and knows no scenes.
    - It writes a network plan, and ``roads`` has no plan of higher confidence.
    - It refuses the description, and the confidence of ``roads`` in a plan is less than ``SURE``.
    - ``roads`` names a junction or the like beside the road, or as the cause of a refusal. ``routes`` then
      reads the description whatever its words are.

    Otherwise ``roads`` is chosen.

    ``refuse_from`` is the smallest probability of a refusal at which a refusal is allowed as a plan; None
    takes the value that was fitted to each network."""
    is_of_scene = may_be_of_a_scene(text)
    is_story = len(text.words) > SHORT or is_of_scene
    is_asked = may_tell_a_route(words) or (routes is not None and routes.network.has_scenes and is_story)
    read = routes.plans(text, refuse_from) if routes and is_asked else ()
    is_route = bool(read) and _is_route(read[0], roads)
    sure = _confidence(routes, read, text) if routes and is_route else 0.0
    tells_scene = is_of_scene and bool(read) and read[0].asks is not None and read[0].asks.scene != Scene()
    if routes and ((is_route and sure >= GUESS) or tells_scene):
        return routes, read
    found = roads.plans(text, refuse_from)
    if routes and found and not TOLD_ON_ROUTES.isdisjoint(found[0].tokens):
        return routes, read or routes.plans(text, refuse_from)
    if routes is None or not read:
        return roads, found
    against = _confidence(roads, found, text)
    if read[0].refusal:
        return (routes, read) if against < SURE else (roads, found)
    return (routes, read) if is_route and sure >= against else (roads, found)


def _is_route(draft: ScoredPlan[Brief], roads: Trained) -> bool:
    """Returns whether a plan is one of a route or a map, or has words that ``roads`` does not know."""
    # brief.read takes from the words whether a single road is a motorway
    tokens = [each for each in draft.tokens if each not in ("motorway", WISHES)]
    asks = draft.asks
    is_network = asks is not None and (bool(asks.junctions) or asks.map is not None)
    return is_network or not roads.network.knows(tokens)


def _confidence(trained: Trained, found: Sequence[ScoredPlan[Brief]], text: SlottedText) -> float:
    is_plan = bool(found) and not found[0].refusal
    return trained.confidence(found[0], text, ()) if is_plan else 0.0
