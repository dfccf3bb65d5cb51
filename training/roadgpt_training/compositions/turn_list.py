"""A list of turns while it is described, in five languages, and the names of places in it: "the third", "the
first two", "turns 2 and 5", "the lefts".
"""

import re
from collections.abc import Sequence
from typing import Any, NamedTuple

from roadgpt_training.compositions.voice import SIDES, DescribedTurn, Voice, clauses
from roadgpt_training.phrasebook import phrases_of

PHRASES: dict[str, dict[str, Any]] = phrases_of("lists")
"""The phrases by language. "[is|are]" stands for "is" behind one turn and for "are" behind several. {ox} is
{x} in the dative in German, and with "di" in Italian.
"""
MOST_FIGURES = 12
"""The largest count of numbers with units in a description; a network reads no more numbers."""
UNITS = {"deg": "degrees", "r": "metres", "len": "metres"}
FIGURES = {"deg": (25, 120), "r": (25, 60), "len": (25, 90)}
HALF = re.compile("half|Hälfte|moitié|mitad|metà")
ONE_OR_MANY = re.compile(r"\[([^|\]]*)\|([^\]]*)\]")


class PlaceInList(NamedTuple):
    """Some turns of the list: their name, the name's form behind a preposition, and their indices from 0."""

    name: str
    oblique: str
    at: tuple[int, ...]
    is_one: bool
    """Whether the name is singular."""


class TurnList:
    """A list of turns while it is described.

    Attributes:
        turns: the turns in driving order.
        straights: the plans of the straights before each turn and after the last turn; "" for no straight.
        room: how many more numbers with units may be said.
    """

    def __init__(self, voice: Voice, number: int) -> None:
        self.voice = voice
        self.phrases = PHRASES[voice.language]
        self.turns = [DescribedTurn() for _ in range(number)]
        self.straights = [""] * (number + 1)
        self.room = MOST_FIGURES
        self.nouns, self.noun = voice.pick(self.phrases["nouns"])
        self.units: dict[str, str] = {
            what: self.phrases["in words"][what == "degrees"]
            if voice.spells
            else voice.pick(self.phrases[what])
            for what in ("metres", "degrees")
        }
        self.ordinals: list[str] = self.phrases["ordinals"]
        if not voice.spells and voice.chance(0.2):
            self.ordinals = self.phrases["short ordinals"]
        self.and_: str = voice.pick(self.phrases["and"])

    @property
    def number(self) -> int:
        """How many turns the list has."""
        return len(self.turns)

    @property
    def plan(self) -> str:
        """The plan with every turn and straight written out."""
        parts: list[str] = []
        run: list[DescribedTurn] = []
        for turn, straight in zip([*self.turns, None], self.straights, strict=True):
            if straight:
                parts += [clauses(run)] if run else []
                parts.append(straight)
                run = []
            run += [turn] if turn else []
        return "; ".join(parts + ([clauses(run)] if run else []))

    def say(self, key: str, is_one: bool = False, like: str = "", /, **named: str) -> str:
        """Returns a random phrase that matches the pattern ``like``, with its placeholders filled in."""
        phrase = self.voice.pick([each for each in self.phrases[key] if re.search(like, each)])
        phrase = ONE_OR_MANY.sub(lambda ways: ways[1] if is_one else ways[2], phrase)
        return str(phrase.format(n=self.voice.number(self.number), noun=self.nouns, noun1=self.noun, **named))

    def measure(self, value: int, what: str) -> str:
        """Returns a number with its unit, "metres" or "degrees"."""
        return f"{self.voice.number(value)}{self.units[what]}"

    def draw(self, key: str, number: int = 1) -> list[int]:
        """Returns random angles ("deg"), radii ("r") or lengths ("len"), no two alike, and subtracts
        their number from ``room``.
        """
        low, high = FIGURES[key]
        if self.voice.spells:
            high = min(high, 95)  # "the next three hundred" would be another number
        self.room -= number
        steps = self.voice.rng.permutation((high - low) // 5 + 1)[:number]
        return [low + 5 * int(step) for step in steps]

    def give(self, key: str, value: int | str, at: Sequence[int]) -> None:
        """Gives the turns with these indices a property."""
        for index in at:
            self.turns[index].mods[key] = f"{key}={value}" if key in UNITS else str(value)

    def joined(self, names: Sequence[str]) -> str:
        """Returns the names as a list with "and" before the last one."""
        and_ = self.and_ if len(names) > 2 else self.and_.lstrip(",")
        return names[0] if len(names) == 1 else f"{', '.join(names[:-1])}{and_}{names[-1]}"

    def pool(self, key: str) -> list[int]:
        """Returns two to six values to choose from, so that some numbers of a row are equal."""
        room = self.room
        values = self.draw(key, self.voice.whole(2, 6))
        self.room = room
        return values

    def straight(self, value: int) -> dict[str, str]:
        """Returns the words for a straight of this length, and the length alone."""
        length = self.measure(value, "metres")
        return {"gap": self.say("gap", L=length), "L": length}

    def neighbours(self, at: int) -> dict[str, str]:
        """Returns the names of the turns ``at - 1`` and ``at``, before and after a straight."""
        if self.voice.chance(0.25):
            way = self.voice.pick(self.phrases["numbered"])
            names = [way.format(noun1=self.noun, k=self.voice.number(index + 1)) for index in (at - 1, at)]
        else:
            names = [self.ordinal(index, self.number, is_bare=True) for index in (at - 1, at)]
        return self._named("xy", names)

    def ends(self) -> dict[str, str]:
        """Returns the names of the first and the last turn."""
        return self._named("xz", [self.ordinals[0], self.phrases["last"][0]])

    def _named(self, keys: str, names: Sequence[str]) -> dict[str, str]:
        found: dict[str, str] = {}
        for key, name in zip(keys, names, strict=True):
            place = self.place(name, [0])
            found |= {key: place.name, f"o{key}": place.oblique}
        return found

    def of_side(self, side: str) -> list[int]:
        """Returns the indices of the turns to one side."""
        return [at for at, turn in enumerate(self.turns) if turn.mods.get("side") == side]

    def place(self, name: str, at: Sequence[int]) -> PlaceInList:
        """Returns a place; the form of the name behind a preposition is derived from ``name``."""
        other = name
        for pattern, new in self.phrases["oblique"]:
            other = re.sub(pattern, new, other)
        return PlaceInList(name, other, tuple(at), len(at) == 1 or HALF.search(name) is not None)

    def ordinal(self, at: int, of: int, is_bare: bool = False) -> str:
        """Returns "the third", "the last", for an index from 0 among ``of`` things."""
        if at == of - 1 and self.voice.chance(0.55):
            return str(self.phrases["last"][0] if is_bare else self.voice.pick(self.phrases["last"]))
        name = self.ordinals[at]
        return name if is_bare else self.say("short", i=name)

    def one(self, at: int) -> PlaceInList:
        """Returns a name for one turn: by ordinal, by number, or by ordinal among the turns to its side."""
        side = self.turns[at].mods.get("side")
        if side and self.voice.chance(0.2):
            its = self.of_side(side)
            if len(its) == 1:
                return self.place(self.voice.pick(self.phrases["sided one"])[SIDES.index(side)], [at])
            ways = self.voice.pick(self.phrases["nth of"])
            name = self.ordinal(its.index(at), len(its), is_bare=True)
            return self.place(ways[SIDES.index(side)].format(i=name, k=self.voice.number(len(its))), [at])
        if self.voice.chance(0.25) and (at or not self.voice.spells):  # "turn 1: twenty" looks like a ratio
            return self.place(self.say("numbered", k=self.voice.number(at + 1)), [at])
        name = self.ordinal(at, self.number)
        return self.place(name.replace(" one", "") if name == self.ordinals[at] else name, [at])

    def some(self, at: Sequence[int]) -> PlaceInList:
        """Returns a name for one or more turns."""
        if len(at) == 1:
            return self.one(at[0])
        if self.voice.chance(0.3):
            numbers = [self.voice.number(index + 1) for index in at]
            return self.place(self.say("numbered many", nouns=self.nouns, list=self.joined(numbers)), at)
        places = [
            self.place(self.ordinal(index, self.number, is_bare=self.voice.chance(0.8)), [index])
            for index in at
        ]
        return PlaceInList(
            self.joined([place.name for place in places]),
            self.joined([place.oblique for place in places]),
            tuple(at),
            False,
        )

    def odd_and_even(self) -> list[PlaceInList]:
        """Returns names for the first, third, ... and for the second, fourth, ... turn."""
        names = self.voice.pick(self.phrases["odd"])
        return [
            self.place(name.format(noun=self.nouns), range(first, self.number, 2))
            for first, name in enumerate(names)
        ]

    def chosen(self, most: int) -> PlaceInList:
        """Returns up to ``most`` random turns, and fewer than all."""
        number = min(self.voice.whole(1, most), self.number - 1)
        return self.some(sorted(int(at) for at in self.voice.rng.permutation(self.number)[:number]))

    def others(self, at: Sequence[int]) -> PlaceInList:
        """Returns the turns other than those with these indices, as 'the others'."""
        rest = [index for index in range(self.number) if index not in at]
        return self.place(self.say("rest" if len(rest) > 1 else "rest one"), rest)

    def row(self, values: Sequence[int], key: str) -> str:
        """Returns numbers in a row, with their unit once, after each of them, or not at all."""
        voice, unit = self.voice, self.units[UNITS[key]]
        if voice.spells:
            return self.joined([self.voice.number(value) for value in values]) + unit
        way = voice.rng.random()
        if way < 0.45:
            return self.joined([str(value) for value in values]) + unit
        if way < 0.65:
            return "/".join(str(value) for value in values) + voice.pick(("", unit))
        if way < 0.8:
            mark = "°" if key == "deg" else " m"
            return voice.pick((" ", ", ")).join(f"{value}{mark}" for value in values)
        return ", ".join(str(value) for value in values) + voice.pick(("", unit))

    def sided(self, side: str) -> PlaceInList:
        """Returns a name for all turns to one side."""
        its = self.of_side(side)
        names = self.voice.pick(self.phrases["sided" if len(its) > 1 else "sided one"])
        return self.place(names[SIDES.index(side)], its)

    def groups(self, are_short: bool = False) -> list[PlaceInList]:
        """Returns the list cut into two or three parts of consecutive turns, with names for them.

        Names that are singular, or that cannot be followed by a verb, are used only if ``are_short``.
        """
        parts = 3 if self.number > 4 and self.voice.chance(0.5) else 2
        cuts = sorted(1 + int(at) for at in self.voice.rng.permutation(self.number - 1)[: parts - 1])
        if are_short and parts == 2 and self.number % 2 == 0 and self.voice.chance(0.3):
            half = self.number // 2
            names = [
                name.format(k=self.voice.number(half), noun=self.nouns)
                for name in self.voice.pick(self.phrases["halves"])
            ]
            return [self.place(names[0], range(half)), self.place(names[1], range(half, self.number))]
        ends = [0, *cuts, self.number]
        return [self._group(ends[part], ends[part + 1], part, are_short) for part in range(parts)]

    def _group(self, start: int, end: int, part: int, is_short: bool) -> PlaceInList:
        at, size = range(start, end), end - start
        is_last = end == self.number
        if size == 1:
            if part and not is_last:
                return self.place(self.say("next one"), at)
            if part and self.voice.chance(0.15):
                return self.place(self.say("rest one"), at)
            return self.place(self.ordinals[0] if not part else self.say("last"), at)
        if size > 2 and self.voice.chance(0.12):
            ends = {"i": self.voice.number(start + 1), "j": self.voice.number(end)}
            return self.place(self.say("range", nouns=self.nouns, **ends), at)
        if is_last and self.voice.chance(0.35):
            if is_short and self.voice.chance(0.5):
                name = self.place(self.ordinals[start], at)
                return self.place(self.say("from on", x=name.name, ox=name.oblique), at)
            return self.place(self.say("rest"), at)
        way = "final" if is_last and self.voice.chance(0.7) else "next" if part else "first"
        return self.place(self.say(way, k=self.voice.number(size)), at)
