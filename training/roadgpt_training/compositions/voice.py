"""Tools for compositions: choose phrases at random, write numbers as digits or words, and combine turns into
a plan.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from itertools import groupby
from typing import NamedTuple

import numpy as np

from roadgpt_training.phrasebook import Thing, one_of, phrases_of
from roadgpt_training.spelling import spell

PHRASES: dict[str, list[str]] = phrases_of("compositions")
ORDINALS = ("first", "second", "third", "fourth", "fifth", "sixth", "seventh", "eighth", "ninth", "tenth")
NOUNS = ("turns", "bends", "curves", "corners")
SIDES = ("left", "right")
OTHER = {"left": "right", "right": "left"}
SHARPNESS = (("sharp", "sharp"), ("tight", "sharp"), ("gentle", "gentle"), ("easy", "gentle"))
BEGIN = frozenset(
    ["put", "repeat", "do", "finish", "end", "it", "start", "between", "before", "after", "prior", "once"]
    + ["first", "at", "twice", "total", "overall", "length"]
)
"""Words that can begin a sentence without one of the standard openings."""


class Composition(NamedTuple):
    """A description and its plan."""

    text: str
    plan: str


@dataclass
class DescribedTurn:
    """One turn of a road: its kind, and the words that describe it in a plan."""

    kind: str = "turn"
    mods: dict[str, str] = field(default_factory=dict)
    """The plan's words for the turn, keyed by 'side', 'sharpness', 'slope', 'deg' or 'r':
    {'deg': 'deg=90'}.
    """

    @property
    def clause(self) -> str:
        """The clause of the turn in a plan, without a count."""
        order = ("side", "sharpness", "slope", "deg", "r")
        return " ".join([self.kind, *(self.mods[key] for key in order if key in self.mods)])


def give(turns: Iterable[DescribedTurn], key: str, word: str) -> None:
    """Gives turns a word of the plan; ``key`` is one of the keys of ``DescribedTurn.mods``."""
    for turn in turns:
        turn.mods[key] = word


def clauses(turns: Sequence[DescribedTurn]) -> str:
    """Returns the clauses of consecutive turns as part of a plan; equal turns in a row become one clause with
    a count.
    """
    out = []
    for clause, same in groupby(turn.clause for turn in turns):
        number = len([*same])
        kind, _, mods = clause.partition(" ")
        out.append(f"{kind} x{number} {mods}".strip() if number > 1 else clause)
    return "; ".join(out)


class Voice:
    """Chooses phrases at random; each voice writes all its numbers as digits, or all of them as words."""

    def __init__(self, rng: np.random.Generator, language: str = "en") -> None:
        self.rng = rng
        self.language = language
        self.spells = rng.random() < 0.45

    def pick(self, ways: Sequence[Thing]) -> Thing:
        """Returns one of the alternatives, chosen at random."""
        return one_of(ways, self.rng)

    def say(self, way: str, *parts: str, **named: str) -> str:
        """Returns a random phrase from ``PHRASES[way]``, with its placeholders filled in."""
        return self.pick(PHRASES[way]).format(*parts, **named)

    def chance(self, share: float) -> bool:
        """Returns True with probability ``share`` (0 to 1)."""
        return bool(self.rng.random() < share)

    def whole(self, low: int, high: int) -> int:
        """Returns a random whole number from ``low`` to ``high``, both included."""
        return int(self.rng.integers(low, high + 1))

    def number(self, value: int) -> str:
        """Returns the number as digits or as words, depending on the voice."""
        return spell(value, self.language) if self.spells else str(value)

    def metres(self, low: int = 15, high: int = 80) -> tuple[str, int]:
        """Returns a random length from ``low`` to ``high`` metres in steps of 5, as text and as a number."""
        value = 5 * self.whole(low // 5, high // 5)
        units = (" metres", " meters") if self.spells else (" m", " m", "m", " metres", " meters")
        return f"{self.number(value)}{self.pick(units)}", value

    def angle(self, low: int = 20, high: int = 120) -> tuple[str, int]:
        """Returns a random angle from ``low`` to ``high`` degrees in steps of 5, as text and as a number."""
        value = 5 * self.whole(low // 5, high // 5)
        return f"{self.number(value)}{self.pick((' degrees', ' degrees', ' deg', '°'))}", value

    def percent(self, low: int = 3, high: int = 12) -> tuple[str, int]:
        """Returns a random grade from ``low`` to ``high`` percent, as text and as a number."""
        value = self.whole(low, high)
        return f"{self.number(value)}{self.pick((' %', ' percent', '%', ' per cent'))}", value

    def turns(self, number: int) -> str:
        """Returns the words for this number of turns, such as '3 bends'."""
        return f"{self.number(number)} {self.pick(NOUNS)}"

    def ordinal(self, at: int, total: int) -> str:
        """Returns the ordinal of a turn, such as 'third' or 'last'; ``at`` counts from 0."""
        if at == total - 1 and self.chance(0.6):
            return self.pick(("last", "final", "last"))
        if self.chance(0.25):
            return f"{at + 1}{('st', 'nd', 'rd')[at] if at < 3 else 'th'}"
        return ORDINALS[at]

    def listed(self, names: Sequence[str]) -> str:
        """Returns the names joined into one text: 'a, b and c'."""
        if len(names) == 1:
            return names[0]
        return f"{', '.join(names[:-1])}{self.pick((' and ', ' and ', ', and ', ' & '))}{names[-1]}"

    def framed(self, text: str, plan: str, may_slope: bool = True) -> Composition:
        """Returns text and plan as a composition, often with an opening such as 'give me' before the text,
        and sometimes with a purpose or a requirement for the whole road. ``may_slope`` allows
        requirements about slope.
        """
        if text.split()[0].strip(":;,").lower() not in BEGIN:
            text = self.say("openings") + text
        wishes: list[str] = []
        if may_slope and self.chance(0.3):
            wishes.append(self.pick(("up", "down", "flat")))
            text += self.say(wishes[0])
        if self.chance(0.15):
            is_hard = self.chance(0.3)
            wishes += ["hard"] if is_hard else []
            text = self.say("hard" if is_hard else "purposes") + text
        if wishes:
            plan += (" " if "|" in plan else " | ") + " ".join(wishes)
        return Composition(text, plan)
