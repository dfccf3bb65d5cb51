"""The model reader: reads descriptions in five languages with RoadGPT's own networks, offline, in
milliseconds.

Rules take the numbers out of the text before a network reads it, and insert them into the plan that the
network writes. The decoding is constrained, so that the network can only write valid plans. One network reads
descriptions of single roads and change requests, another one descriptions that mention junctions, ramps,
lanes or maps. The weights and their documentation are in ``weights/``."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple, Self

import numpy as np

from roadgpt.brief.feasible import is_possible
from roadgpt.brief.languages import TABLE, pattern_of
from roadgpt.brief.model import Brief
from roadgpt.brief.plan import SCENE, plan
from roadgpt.brief.ranges import Range
from roadgpt.brief.readers.model.before import (
    COMPANIONS,
    asks_for_a_closed_loop,
    negative_number,
    other_script,
    without_asides,
)
from roadgpt.brief.readers.model.mentions import unused_in, with_kinds, with_kinds_changed, with_known_words
from roadgpt.brief.readers.model.neural_network import NeuralNetwork
from roadgpt.brief.readers.model.number_words import COUNTED, plain
from roadgpt.brief.readers.model.ring_sizes import with_diameters
from roadgpt.brief.readers.model.scenes import (
    asked_in,
    may_be_of_a_scene,
    with_named,
    with_origin,
    with_told,
    without_untold,
)
from roadgpt.brief.readers.model.slots import SlottedText, Word, slot_name, slotted
from roadgpt.brief.readers.model.trained import (
    ANY_WORLD,
    DOUBT,
    ScoredPlan,
    Trained,
    changes_in,
    chosen,
    confidence,
    features,
    lost,
    most_plausible,
    scored_plans,
)
from roadgpt.brief.refusal import MOST_CHARACTERS, AnotherRoadError, TooMuchError, refused
from roadgpt.brief.scene import Scene
from roadgpt.brief.words import SURE, unaccented
from roadgpt.errors import BriefError, PartError
from roadgpt.reading import read_json, read_text

WEIGHTS = Path(__file__).parent / "weights"
FILES = ("encoder.onnx", "decoder.onnx", "pieces.txt", "words.txt", "settings.json")
NOT_ONE_ROAD = "this could not be read as one road; use shorter sentences"
READABLE = "descriptions in English, German, French, Spanish and Italian are read"
NEVER = 2.0  # a probability that no refusal reaches
LIKELY = 2.5  # difference of score to another plan of changes that may be meant
CERTAIN = 0.8  # the probability of a refusal from which no other reading is taken
MARKS = frozenset({"[unused21]", "[unused22]", "[unused23]"})
"""Tokens that follow a measure that is too large, too small, or rather small."""
MOST_TURNS = 12
"""The largest number of turns that the network was trained to write."""
STAND_INS = ("9", "11", "7", "10", "8", "12")
"""Counts that replace larger ones in the text; the network reads them as ordinary."""
BEFORE_NOUN = 3
"""The largest number of words between a number and the noun it counts: "40 very sharp turns"."""
ROUTES = "_routes"
"""What follows 'encoder' and 'decoder' in the file names of the network that reads routes and maps."""
CAUSES = {name: pattern_of(name, "causes") for name in TABLE["causes"]}
ALLOWED = {
    "grade": ("percent", Range(0, 15)),
    "radius": ("metres", Range(15)),
    "degrees": ("degrees", Range(0, 240)),
    "length": ("metres", Range(0, 1500)),
}
"""The numbers of a unit of which none is the cause of a refusal."""
TOO_MUCH = "no more than 12 turns and 1500 m are sure to fit on a map of 250 m; ask for less or a larger map"
TOO_MANY_TURNS = "!impossible turns"
MANY_JUNCTIONS = (
    "no more than 8 junctions are read from words; a plan can list more, such as "
    "--plan 'crossroads left // crossroads right // ...'"
)


class ChangeReading(NamedTuple):
    """The reading of a change request."""

    plan: str
    """A plan of changes, or a refusal."""
    confidence: float
    unused: tuple[str, ...]
    """Words that the plan does not depend on."""
    others: tuple[str, ...] = ()
    """Other plans that are likely and no refusals, the likeliest first."""


class ModelReader:
    """Reads descriptions with trained networks; reports its confidence and the words that it did not use."""

    def __init__(self, folder: Path = WEIGHTS) -> None:
        self.folder = folder

    @classmethod
    def from_folder(cls, folder: str) -> Self:
        """Returns a reader that uses the weights in a folder written by a training.

        Raises:
            PartError: a file is missing in the folder."""
        missing = next((name for name in FILES if not (Path(folder) / name).is_file()), None)
        if missing:
            raise PartError(f"there is no {missing} in '{folder}'; give a folder that training wrote")
        return cls(Path(folder))

    def read(self, words: str) -> Brief:
        """Returns the Brief of a description; raises TooMuchError, with the Brief, if the road is too large
        for the usual map of 250 m, and BriefError if the description cannot be read."""
        written, (words, instead) = words, with_known_words(without_asides(words))
        text = _text(words)
        trained, found = chosen(self.roads, self.routes, words, text)
        if not found:
            raise BriefError(NOT_ONE_ROAD)
        draft = most_plausible(found)
        if draft.asks is not None and draft.asks.map is None and asks_for_a_closed_loop(words):
            raise refused("!impossible loop")

        def named(brief: Brief) -> Brief:
            unused = tuple(instead.get(word, word) for word in brief.unused)
            brief = with_kinds(brief.model_copy(update={"words": written, "unused": unused}), written)
            unused = tuple(dict.fromkeys((*brief.unused, *unused_in(brief, written))))
            return brief.model_copy(update={"unused": unused})

        try:
            brief = named(self._brief(words, text, draft, trained))
        except TooMuchError as error:
            raise TooMuchError(str(error), named(error.brief)) from error
        except AnotherRoadError as error:
            other = named(error.brief)
            raise AnotherRoadError(error.offer, plan(other), other) from error
        is_sure = brief.confidence >= SURE
        return brief if is_sure else brief.model_copy(update={"other": _other(found, brief, words, text)})

    def read_change(self, words: str, key: Callable[[str], str]) -> ChangeReading:
        """Returns what a change request asks for, as a plan; raises BriefError if the network wrote none that
        can be read. ``key`` returns the normal form of a plan of changes, or raises an error for an invalid
        one."""
        written, (words, _) = words, with_known_words(words)
        text = slotted(words, is_change=True)
        trained, weights = self.roads, self._settings["changes"]
        found = scored_plans(trained.network, text, trained.refuse_from, changes_in(key))
        routes, refusal = self.routes, found[0].refusal if found else ""
        if routes and routes.network.has_scenes and may_be_of_a_scene(text, refusal):
            of_scene = scored_plans(routes.network, text, routes.refuse_from, changes_in(key))
            if of_scene and SCENE in of_scene[0].tokens:
                trained, found = routes, of_scene
                weights = self._settings.get("scene_changes", {"bias": 0.0})
        if not found:
            raise BriefError("this could not be read as changes; use shorter sentences")
        draft, *rest = found
        near = (each.asks for each in rest if each.asks and each.score >= draft.score - LIKELY)
        others = tuple(with_kinds_changed(asks, written) for asks in near)
        unused = trained.unused(text, draft.tokens) if draft.asks else ()
        sure = confidence(weights, features(draft, text), unused, text)
        found_plan = with_kinds_changed(draft.asks, written) if draft.asks else draft.refusal
        return ChangeReading(found_plan, sure, unused, others)

    def alternatives(
        self, words: str, number: int = 3, temperature: float = 1.0, seed: int = 0
    ) -> tuple[Brief, ...]:
        """Returns up to ``number`` different readings: first the likeliest, then sampled ones. For the
        arguments see ``brief.alternatives``."""
        written, first = words, self.read(words)
        words, _ = with_known_words(without_asides(words))
        text = _text(words)
        trained, _ = chosen(self.roads, self.routes, words, text)
        across = trained.network.encode(text)
        rng = np.random.default_rng(seed)
        found: dict[tuple[str, ...], Brief] = {}
        for _ in range(4 * number):
            drawn = trained.network.drawn(across, text, rng, temperature)
            asks = asked_in(drawn.tokens, text.slots)
            draft = ScoredPlan(drawn.tokens, asks, drawn.score, drawn.log_chances)
            found.setdefault(drawn.tokens, with_kinds(self._brief(words, text, draft, trained), written))
        others = sorted(found.values(), key=lambda brief: -brief.confidence)
        same = first.model_copy(update={"confidence": 1.0})
        return (first, *(b for b in others if b.model_copy(update={"confidence": 1.0}) != same))[:number]

    def _brief(self, words: str, text: SlottedText, draft: ScoredPlan[Brief], trained: Trained) -> Brief:
        if draft.asks is not None:
            return _with_confidence(draft.asks, words, text, draft, trained)
        why = draft.refusal
        if why.startswith("!contradiction"):
            return self._brief_in_spite_of(why, words, text, trained)
        brief = self._for_the_usual_map(words, text, trained) if why.startswith("!impossible") else None
        if brief is None and why == TOO_MANY_TURNS and trained is self.routes:
            raise BriefError(MANY_JUNCTIONS)
        raise TooMuchError(TOO_MUCH, brief) if brief else _refused(why, words, text)

    def _brief_in_spite_of(self, why: str, words: str, text: SlottedText, trained: Trained) -> Brief:
        """Returns the Brief of the likeliest plan that is no refusal, with a low confidence, if the plan
        leaves out no number of the words and the network is not certain of the contradiction.

        Raises:
            AnotherRoadError: the description contradicts itself; the error has the Brief.
            BriefError: the same, but no plan without a contradiction is likely."""
        found = trained.plans(text, NEVER)
        best = most_plausible(found) if found else None
        if best is None or best.asks is None or not is_possible(best.asks, *ANY_WORLD):
            raise _refused(why, words, text)
        brief = _with_confidence(best.asks, words, text, best, trained)
        if trained.network.refusal(text) >= CERTAIN or lost(best.tokens, text):
            raise AnotherRoadError(f"{_refused(why, words, text)}; or is this meant", plan(brief), brief)
        return brief.model_copy(update={"confidence": min(brief.confidence, DOUBT)})

    def _for_the_usual_map(self, words: str, text: SlottedText, trained: Trained) -> Brief | None:
        """Returns the Brief that the network reads if large numbers are replaced by ordinary ones first.

        The network was trained for one map of 250 m and refuses roads that do not fit on it, but other maps
        may hold such a road. The Brief has the original numbers, which are later checked against the actual
        map. None if the numbers are ordinary already, or if the description is refused with ordinary numbers
        too ("with a roundabout")."""
        usual, counts = _with_ordinary_numbers(text)
        if usual == text:
            return None
        found = trained.plans(usual)
        if not found or found[0].refusal:
            return None
        tokens = tuple(counts.get(token, token) for token in found[0].tokens)
        try:
            asks = asked_in(tokens, text.slots)
        except BriefError:
            return None
        draft, unused = replace(found[0], tokens=tokens), trained.unused(usual, found[0].tokens)
        return _with_confidence(asks, words, text, draft, trained, unused)

    @cached_property
    def roads(self) -> Trained:
        """The network that reads every change request, and descriptions of single roads."""
        return self._trained("", self._settings, self._fillers)

    @cached_property
    def routes(self) -> Trained | None:
        """The network that reads descriptions of routes and maps; None if the folder has none."""
        if not (self.folder / f"encoder{ROUTES}.onnx").is_file():
            return None
        fillers = self._fillers | set(map(plain, COMPANIONS))
        return self._trained(ROUTES, self._settings.get("routes", {}), fillers)

    def _trained(self, name: str, settings: dict[str, Any], fillers: frozenset[str]) -> Trained:
        weights = settings.get("confidence", {"bias": 0.0})
        return Trained(NeuralNetwork(self.folder, name), settings.get("refuse_from", 0.5), weights, fillers)

    @cached_property
    def _fillers(self) -> frozenset[str]:
        return frozenset(read_text(self.folder / "words.txt").split("\n"))

    @cached_property
    def _settings(self) -> dict[str, Any]:
        settings: dict[str, Any] = read_json(self.folder / "settings.json")
        return settings


def _refused(why: str, words: str, text: SlottedText) -> BriefError:
    """Returns the error for a refusal with those of its causes that the words, and their numbers, tell."""
    said, is_impossible = unaccented(words), why.startswith("!impossible")

    def is_told(cause: str) -> bool:
        unit, allowed = ALLOWED.get(cause if is_impossible else "", ("", Range()))
        values = [slot.value for slot in text.slots if slot.unit == unit]
        is_beyond = not unit or not values or any(value not in allowed for value in values)
        return cause not in CAUSES or (is_beyond and CAUSES[cause].search(said) is not None)

    kind, *causes = why.split()
    return refused(" ".join([kind, *filter(is_told, causes)]))


def _with_confidence(
    asks: Brief,
    words: str,
    text: SlottedText,
    draft: ScoredPlan[Brief],
    trained: Trained,
    unused: tuple[str, ...] | None = None,
) -> Brief:
    """Returns what a plan asks for with the words and the confidence; ``unused`` are the words that are not
    used, if that is known."""
    unused = trained.unused(text, draft.tokens) if unused is None else unused
    kept = (name for name in asks.beside if name != "loop" or asks.map is None)
    found = {
        "words": words,
        "unused": unused,
        "confidence": trained.confidence(draft, text, unused),
        # of a road without junctions and a scene, brief.read decides by the words whether it is one
        "motorway": asks.motorway and asks.scene != Scene(),
        "beside": tuple(dict.fromkeys(kept)),  # the roads of a map may be closed loops
    }
    made = with_named(with_origin(with_diameters(asks, draft.tokens, text).model_copy(update=found), text))
    return with_told(without_untold(made, words), words)


def _other(found: Sequence[ScoredPlan[Brief]], brief: Brief, words: str, text: SlottedText) -> str:
    """Returns the likeliest plan that asks for something other than the Brief; empty if there is none."""
    free = {"words": "", "other": "", "unused": (), "confidence": 1.0, "beside": (), "motorway": False}
    said = brief.model_copy(update=free)
    for draft in found:
        if draft.asks is not None and is_possible(draft.asks, *ANY_WORLD):
            other = with_named(with_diameters(draft.asks, draft.tokens, text))
            other = without_untold(with_told(other, words), words).model_copy(update=free)
            if other != said:
                return plan(other)
    return ""


def _text(words: str) -> SlottedText:
    if not words.strip():
        raise BriefError(
            "the description is empty; say what the road should be like, such as 'two sharp turns'"
        )
    if len(words) > MOST_CHARACTERS:
        letters = f"the description has {len(words)} letters"
        raise BriefError(f"{letters}; at most {MOST_CHARACTERS} are read, so shorten it")
    script = other_script(words)
    if script:
        raise BriefError(f"this is written in {script} letters; {READABLE}")
    text = slotted(words)
    below = negative_number(text)
    if below:
        raise BriefError(f"a road cannot have '{below}'; ask for a number above 0")
    return text


def _with_ordinary_numbers(text: SlottedText) -> tuple[SlottedText, dict[str, str]]:
    """Returns the description with small counts of turns in place of unusually large ones, and without marks
    of unusual measures; and the original of each small count."""
    free = [number for number in STAND_INS if all(word.text != number for word in text.words)]
    counts: dict[str, str] = {}
    out: list[Word] = []
    for at, word in enumerate(text.words):
        count = _large_count(text, at)
        if count and free:
            counts[free[0]] = count
            out.append(Word(free.pop(0), word.written))
        elif word.text not in MARKS or word.written:
            out.append(word)
    return SlottedText(tuple(out), text.slots), counts


def _large_count(text: SlottedText, at: int) -> str:
    """Returns the number in a word as text if it counts more than MOST_TURNS turns; otherwise empty."""
    word = text.words[at].text
    values = {slot_name(i): slot.value for i, slot in enumerate(text.slots) if not slot.unit}
    value = float(word) if word.isdecimal() else values.get(word, 0.0)
    follow = {later.text for later in text.words[at + 1 : at + 2 + BEFORE_NOUN]}
    return f"{value:g}" if value > MOST_TURNS and value == int(value) and follow & COUNTED else ""
