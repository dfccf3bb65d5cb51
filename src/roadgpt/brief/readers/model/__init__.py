"""Reads descriptions with our own trained network: five languages, offline, in milliseconds.

Numbers are taken out of the text by rules and put into the plan that the network writes; the network writes
only plans that can be read. Weights and their card lie in ``weights/``.
"""

import json
from collections.abc import Sequence
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from roadgpt.brief.feasible import check
from roadgpt.brief.model import Brief
from roadgpt.brief.normal import normal, total
from roadgpt.brief.plan import read_plan
from roadgpt.brief.readers.grammar import GrammarReader
from roadgpt.brief.readers.model.coverage import Coverage
from roadgpt.brief.readers.model.network import Network, Written
from roadgpt.brief.readers.model.recheck import rechecked
from roadgpt.brief.readers.model.slots import Slotted, slotted
from roadgpt.brief.readers.model.vocabulary import REFUSALS, plan_of
from roadgpt.errors import BriefError

WEIGHTS = Path(__file__).parent / "weights"
MOST_LETTERS = 2000
ALMOST = 4.0  # difference of log-chances
NO_ROAD = "does not describe a road"
MAP_SIZE = 250.0  # metres, of the usual map
ADVICE = {
    "!nonsense": "this does not describe a road; say how it should be, such as 'uphill with three turns'",
    "!contradiction": "these wishes contradict each other; leave one out, or say for which part each is",
    "!impossible": "no such road can be built here: at most 12 turns and 1500 m, radius 15 m or more,"
    " grades of 15 percent or less, and no junctions or loops; ask for less",
}


class ModelReader:
    """Our own trained network reads; it says how sure it is and which words it did not use."""

    def __init__(self, folder: Path = WEIGHTS) -> None:
        self.folder = folder

    def read(self, words: str) -> Brief:
        """The Brief of a description.

        Raises:
            BriefError: the words are empty, too many, no road, contradictory or ask for the impossible.
        """
        text = _text(words)
        drafts = self._network.write(self._network.encode(text), text, self._settings["refuse_from"])
        return self._brief(words, text, _consistent(drafts, text))

    def alternatives(
        self, words: str, number: int = 3, temperature: float = 1.0, seed: int = 0
    ) -> tuple[Brief, ...]:
        """Up to ``number`` different readings, the likeliest first, others drawn by chance.

        Raises:
            BriefError: as ``read``.
        """
        first = self.read(words)
        text = _text(words)
        across = self._network.encode(text)
        rng = np.random.default_rng(seed)
        found: dict[str, Brief] = {}
        for _ in range(4 * number):
            written = self._network.drawn(across, text, rng, temperature)
            brief = self._brief(words, text, written)
            found.setdefault(" ".join(written.tokens), brief)
        others = sorted(found.values(), key=lambda brief: -brief.confidence)
        same = first.model_copy(update={"confidence": 1.0})
        return (first, *(b for b in others if b.model_copy(update={"confidence": 1.0}) != same))[:number]

    def _brief(self, words: str, text: Slotted, written: Written) -> Brief:
        if written.tokens[0] in REFUSALS:
            kind = written.tokens[0]
            raise BriefError((kind != "!nonsense" and _reason(words)) or ADVICE[kind])
        try:
            brief = rechecked(read_plan(plan_of(written.tokens, text.slots)), text)
        except BriefError as error:
            raise BriefError("this could not be read as one road; say it in shorter sentences") from error
        unused = self._coverage.unused(text, written.tokens)
        sure = self._confidence(written, len(unused))
        return brief.model_copy(update={"words": words, "unused": unused, "confidence": sure})

    def _confidence(self, written: Written, unused: int) -> float:
        """How often a reading like this one was right on descriptions held back from training."""
        weights = self._settings["confidence"]
        score = weights["bias"] + weights["all"] * sum(written.log_chances)
        score += weights["worst"] * min(written.log_chances) + weights["unused"] * unused
        return round(float(1 / (1 + np.exp(-score))), 3)

    @cached_property
    def _network(self) -> Network:
        return Network(self.folder)

    @cached_property
    def _coverage(self) -> Coverage:
        return Coverage.read(self.folder / "words.txt")

    @cached_property
    def _settings(self) -> dict[str, Any]:
        settings: dict[str, Any] = json.loads((self.folder / "settings.json").read_text(encoding="utf-8"))
        return settings


def _consistent(drafts: Sequence[Written], text: Slotted) -> Written:
    """The likeliest draft; or one almost as likely, where that contradicts itself and this one does not."""
    first = drafts[0]
    for draft in drafts:
        if sum(draft.log_chances) < sum(first.log_chances) - ALMOST:
            continue
        if draft.tokens[0] in REFUSALS or _can_be_kept(plan_of(draft.tokens, text.slots)):
            return draft
    return first


def _reason(words: str) -> str:
    """What rules have against the words, where they understand all of them; the network cannot say why."""
    try:
        brief = GrammarReader().read(words)
        if not brief.unused:
            check(brief, MAP_SIZE)
    except BriefError as error:
        return "" if NO_ROAD in str(error) else str(error)
    return ""


def _can_be_kept(line: str) -> bool:
    try:
        brief = read_plan(line)
        check(brief, map_size=None)
    except BriefError:
        return False
    return _sides_add_up(normal(brief))


def _sides_add_up(brief: Brief) -> bool:
    """Can so many lefts and rights be so many turns?"""
    turns = brief.turns or total(brief.clauses)
    sides = (brief.left, brief.right)
    least = sum(side.lo or 0 for side in sides if side)
    if turns.hi is not None and least > turns.hi:
        return False
    most = [side.hi if side else None for side in sides]
    return None in most or turns.lo is None or sum(number or 0 for number in most) >= turns.lo


def _text(words: str) -> Slotted:
    if not words.strip():
        raise BriefError("the description is empty; say how it should be, such as 'two sharp turns'")
    if len(words) > MOST_LETTERS:
        raise BriefError(
            f"the description has {len(words)} letters; {MOST_LETTERS} are the most, so say it shorter"
        )
    return slotted(words)
