"""The model reader: reads descriptions in five languages with RoadGPT's own network, offline, in
milliseconds.

Rules take the numbers out of the text before the network reads it, and insert them into the plan that the
network writes. The decoding is constrained, so that the network can only write valid plans. A second network,
trained separately, reads the same words; a plan that both networks write is likely to be right. A third one
reads descriptions that mention junctions, ramps, lanes or maps. The weights and their documentation are in
``weights/``.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, Self

import numpy as np

from roadgpt.brief.model import Brief
from roadgpt.brief.normal import normal
from roadgpt.brief.plan import plan
from roadgpt.brief.readers.model.closed_loops import asks_for_a_closed_loop
from roadgpt.brief.readers.model.confidence import DOUBT, features
from roadgpt.brief.readers.model.ensemble import Ensemble, scored_by
from roadgpt.brief.readers.model.mirror import is_of_junctions
from roadgpt.brief.readers.model.negative_numbers import negative_number
from roadgpt.brief.readers.model.neural_network import NeuralNetwork
from roadgpt.brief.readers.model.numerals import plain
from roadgpt.brief.readers.model.ordinary_numbers import with_ordinary_numbers
from roadgpt.brief.readers.model.plan_choice import (
    agrees_with_numbers,
    brief_of,
    can_be_kept,
    most_plausible,
)
from roadgpt.brief.readers.model.route_words import COMPANIONS
from roadgpt.brief.readers.model.slots import SlottedText, slotted
from roadgpt.brief.readers.model.test_time_augmentation import ScoredPlan, scored_plans
from roadgpt.brief.readers.model.used_words import read_meanings
from roadgpt.brief.readers.model.vocabulary import plan_of
from roadgpt.brief.refusal import MOST_CHARACTERS, ContradictionError, TooMuchError, refused
from roadgpt.brief.words import SURE
from roadgpt.errors import BriefError, PartError
from roadgpt.reading import read_json, read_text

if TYPE_CHECKING:
    from roadgpt.brief.readers.model.change_reading import ChangeReading

WEIGHTS = Path(__file__).parent / "weights"
MEANINGS = "meanings.txt"
"""The file with the meanings of words: each line has a word and the plan tokens that it usually asks for."""
MEANINGS_OF_CHANGES = "meanings_of_changes.txt"
"""The file with the meanings of words in change requests."""
FILES = ("encoder.onnx", "decoder.onnx", "pieces.txt", "words.txt", "settings.json")
NOT_ONE_ROAD = "this could not be read as one road; use shorter sentences"
NEVER = 2.0  # a probability that no refusal reaches
CERTAIN = 0.8  # the probability of a refusal from which no other reading is taken
SECOND = "_2"
"""What follows 'encoder' and 'decoder' in the names of the second network's files."""
ROUTES = "_routes"
"""What follows 'encoder' and 'decoder' in the file names of the network that reads routes and maps."""
TOO_MUCH = "no more than 12 turns and 1500 m are sure to fit on a map of 250 m; ask for less or a larger map"

TOO_MANY_TURNS = "!impossible turns"
MANY_JUNCTIONS = (
    "no more than 8 junctions are read from words; a plan can list more, such as "
    "--plan 'crossroads left // crossroads right // ...'"
)


class UncalibratedReading(NamedTuple):
    """A plan, and the features from which the confidence in it is computed."""

    plan: str
    features: dict[str, float]


class ModelReader:
    """Reads descriptions with a trained network; reports its confidence and the words that it did not use."""

    def __init__(self, folder: Path = WEIGHTS) -> None:
        self.folder = folder

    @classmethod
    def from_folder(cls, folder: str) -> Self:
        """Returns a reader that uses the weights in a folder written by ``roadgpt learn export``.

        Raises:
            PartError: a file is missing in the folder.
        """
        missing = next((name for name in FILES if not (Path(folder) / name).is_file()), None)
        if missing:
            raise PartError(f"there is no {missing} in '{folder}'; make it with 'roadgpt learn export'")
        return cls(Path(folder))

    def read(self, words: str) -> Brief:
        """Returns the Brief of a description.

        Raises:
            TooMuchError: the road is too large for the usual map of 250 m; the error carries the Brief.
            BriefError: the description is empty, too long, not about a road, contradicts itself, or asks for
                something impossible.
        """
        text = _text(words)
        ensemble, found = self.scored(words)
        if not found:
            raise BriefError(NOT_ONE_ROAD)
        draft = most_plausible(found, text)
        if not draft.is_refusal and asks_for_a_closed_loop(words, draft.line):
            raise refused("!impossible loop")
        brief = self._brief(words, text, draft, ensemble)
        is_unclear = is_of_junctions(draft.line) and not can_be_kept(found[0].line)
        if brief.map is not None:
            from roadgpt.brief.readers.model.map_signs import has_unlimited_signs  # only for maps

            is_unclear = is_unclear or has_unlimited_signs(brief, text)
        if is_unclear:
            brief = brief.model_copy(update={"confidence": min(brief.confidence, DOUBT)})
        return brief if brief.confidence >= SURE else brief.model_copy(update={"other": _other(found, brief)})

    def read_change(self, words: str, key: Callable[[str], str]) -> "ChangeReading":
        """Returns what a change request asks for, as a plan.

        Args:
            words: the change request, up to 2,000 characters.
            key: function that returns the normal form of a plan of changes, or raises an error for an invalid
                plan.

        Raises:
            BriefError: the network wrote no plan that can be read.
        """
        from roadgpt.brief.readers.model.change_reading import read_change  # only for changes

        return read_change(self.roads, self._settings["changes"], words, key)

    def uncalibrated(self, words: str, refuse_from: float) -> UncalibratedReading | None:
        """Returns the likeliest plan of a description as an UncalibratedReading; None if no plan could be
        read.
        """
        text = slotted(words)
        ensemble, found = self.scored(words, refuse_from)
        draft = most_plausible(found, text) if found else None
        if draft is None:
            return None
        if draft.is_refusal:
            return UncalibratedReading(draft.line, {})
        try:
            brief = brief_of(draft.line, text, words)
        except BriefError:
            return None
        return UncalibratedReading(plan(normal(brief)), features(ensemble.networks, draft, text))

    def uncalibrated_change(self, words: str, key: Callable[[str], str]) -> UncalibratedReading | None:
        """Returns the likeliest plan of a change request, in normal form, as an UncalibratedReading; None if
        no plan could be read.

        For ``key`` see ``read_change``.
        """
        found = scored_plans(self.roads.networks, words, NEVER, key=key)
        if not found:
            return None
        text = slotted(words, is_change=True)
        return UncalibratedReading(key(found[0].line), features(self.roads.networks, found[0], text))

    def alternatives(
        self, words: str, number: int = 3, temperature: float = 1.0, seed: int = 0
    ) -> tuple[Brief, ...]:
        """Returns up to ``number`` different readings: first the likeliest, then sampled ones.

        Args:
            words: the description.
            number: the largest number of readings.
            temperature: how freely the readings after the first are sampled; 1 samples from the network's own
                distribution, lower values stay closer to the likeliest reading.
            seed: seed of the sampling.

        Raises:
            BriefError: as in ``read``.
        """
        first = self.read(words)
        text = _text(words)
        ensemble, _ = self.scored(words)
        network = ensemble.networks[0]
        across = network.encode(text)
        rng = np.random.default_rng(seed)
        found: dict[str, Brief] = {}
        for _ in range(4 * number):
            written = network.drawn(across, text, rng, temperature)
            line = plan_of(written.tokens, text.slots)
            draft = ScoredPlan(written.tokens, line, written.score, written.log_chances, agreement=0.0)
            found.setdefault(line, self._brief(words, text, draft, ensemble))
        others = sorted(found.values(), key=lambda brief: -brief.confidence)
        same = first.model_copy(update={"confidence": 1.0})
        return (first, *(b for b in others if b.model_copy(update={"confidence": 1.0}) != same))[:number]

    def scored(self, words: str, refuse_from: float | None = None) -> tuple[Ensemble, tuple[ScoredPlan, ...]]:
        """Returns the networks that read a description, and the plans that they wrote; see ``scored_by``."""
        return scored_by(self.roads, self.routes, words, refuse_from)

    def _brief(self, words: str, text: SlottedText, draft: ScoredPlan, ensemble: Ensemble) -> Brief:
        if not draft.is_refusal:
            return self._as_brief(words, text, draft, ensemble)
        why = draft.line
        if why.startswith("!contradiction"):
            return self._brief_in_spite_of(why, words, text, ensemble)
        if why == TOO_MANY_TURNS:
            from roadgpt.brief.readers.model.junction_nouns import names_a_junction  # only for refusals

            if names_a_junction(text.text):
                raise BriefError(MANY_JUNCTIONS)
        brief = self._for_the_usual_map(words, text, ensemble) if why.startswith("!impossible") else None
        raise TooMuchError(TOO_MUCH, brief) if brief else refused(why)

    def _brief_in_spite_of(self, why: str, words: str, text: SlottedText, ensemble: Ensemble) -> Brief:
        """Returns the Brief of the likeliest plan that is no refusal, with a low confidence, if the plan
        agrees with every number in the words and the networks are not certain of the contradiction.

        Raises:
            ContradictionError: the description contradicts itself; the error has the Brief.
            BriefError: the same, but no plan without a contradiction is likely.
        """
        found = ensemble.scored(words, NEVER)
        best = most_plausible(found, text) if found else None
        if best is None or not can_be_kept(best.line):
            raise refused(why)
        try:
            brief = self._as_brief(words, text, best, ensemble)
        except BriefError:
            raise refused(why) from None
        if ensemble.refusal(text) >= CERTAIN or not agrees_with_numbers(best, text):
            raise ContradictionError(f"{refused(why)}; or is this meant", plan(brief), brief)
        return brief.model_copy(update={"confidence": min(brief.confidence, DOUBT)})

    def _for_the_usual_map(self, words: str, text: SlottedText, ensemble: Ensemble) -> Brief | None:
        """Returns the Brief that the network reads if large numbers are replaced by ordinary ones first.

        The Brief has the original numbers. None if the numbers are ordinary already, or if the description is
        refused with ordinary numbers too.
        """
        usual, counts = with_ordinary_numbers(text)
        if usual == text:
            return None
        found = ensemble.scored(words, shown=lambda seen: with_ordinary_numbers(seen).text)
        if not found or found[0].is_refusal:
            return None
        tokens = tuple(counts.get(token, token) for token in found[0].tokens)
        draft = replace(found[0], tokens=tokens, line=plan_of(tokens, text.slots))
        try:
            return self._as_brief(words, text, draft, ensemble, seen=(usual, found[0].tokens))
        except BriefError:
            return None

    def _as_brief(
        self,
        words: str,
        text: SlottedText,
        draft: ScoredPlan,
        ensemble: Ensemble,
        seen: tuple[SlottedText, Sequence[str]] | None = None,
    ) -> Brief:
        """Returns the Brief of a plan; ``seen`` is the text that the network read and the tokens that it
        wrote, if they differ from ``text`` and from the tokens of ``draft``.
        """
        try:
            brief = brief_of(draft.line, text, words)
        except BriefError as error:
            raise BriefError(NOT_ONE_ROAD) from error
        unused = ensemble.unused(*(seen or (text, draft.tokens)))
        sure = ensemble.confidence(draft, text, unused, seen)
        kept = (name for name in brief.beside if name != "loop" or brief.map is None)
        found = {
            "words": words,
            "unused": unused,
            "confidence": sure,
            "motorway": False,  # brief.read decides by the words whether a road without junctions is one
            "beside": tuple(dict.fromkeys(kept)),  # the roads of a map may be closed loops
        }
        return _with_diameters(brief, draft.tokens, text).model_copy(update=found)

    @cached_property
    def roads(self) -> Ensemble:
        """The one or two networks that read every change request, and descriptions of single roads."""
        return self._ensemble(("", SECOND), self._settings, self._fillers)

    @cached_property
    def routes(self) -> Ensemble | None:
        """The network that reads descriptions of routes and maps; None if the folder has none."""
        fillers = self._fillers | set(map(plain, COMPANIONS))
        found = self._ensemble((ROUTES,), self._settings.get("routes", {}), fillers)
        return found if found.networks else None

    def _ensemble(
        self, names: Sequence[str], settings: Mapping[str, Any], fillers: frozenset[str]
    ) -> Ensemble:
        there = [name for name in names if (self.folder / f"encoder{name}.onnx").is_file()]
        networks = tuple(NeuralNetwork(self.folder, name) for name in there)
        weights = settings.get("confidence", {"bias": 0.0})
        meanings, of_changes = (read_meanings(self.folder / name) for name in (MEANINGS, MEANINGS_OF_CHANGES))
        return Ensemble(networks, settings.get("refuse_from", 0.5), weights, fillers, meanings, of_changes)

    @cached_property
    def _fillers(self) -> frozenset[str]:
        return frozenset(read_text(self.folder / "words.txt").split("\n"))

    @cached_property
    def _settings(self) -> dict[str, Any]:
        settings: dict[str, Any] = read_json(self.folder / "settings.json")
        return settings


def _other(found: Sequence[ScoredPlan], brief: Brief) -> str:
    """Returns the likeliest plan that asks for something other than the Brief; empty if there is none."""
    said = normal(brief).model_copy(update={"beside": ()})
    for draft in found:
        if draft.is_refusal or not can_be_kept(draft.line):
            continue
        text = slotted(brief.words)
        other = _with_diameters(brief_of(draft.line, text, brief.words), draft.tokens, text)
        line = plan(normal(other).model_copy(update={"beside": ()}))
        if line != plan(said):
            return line
    return ""


def _with_diameters(brief: Brief, tokens: Sequence[str], text: SlottedText) -> Brief:
    if not brief.junctions:
        return brief
    from roadgpt.brief.readers.model.ring_sizes import with_diameters  # only for networks

    return with_diameters(brief, tokens, text)


def _text(words: str) -> SlottedText:
    if not words.strip():
        raise BriefError(
            "the description is empty; say what the road should be like, such as 'two sharp turns'"
        )
    if len(words) > MOST_CHARACTERS:
        letters = f"the description has {len(words)} letters"
        raise BriefError(f"{letters}; at most {MOST_CHARACTERS} are read, so shorten it")
    text = slotted(words)
    below = negative_number(text)
    if below:
        raise BriefError(f"a road cannot have '{below}'; ask for a number above 0")
    return text
