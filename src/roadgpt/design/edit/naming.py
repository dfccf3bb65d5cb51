"""Reads the names of places out of meanings: 'the second left turn', 'turns 2 to 4', 'the end'."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple, cast

from roadgpt.brief.model import Kind, Sharpness
from roadgpt.design.edit.lexing import Lexeme
from roadgpt.design.edit.request import Measure, Noun, Place, Target, Way

TURNS: dict[str, Kind | None] = {
    "turn": None,
    "hairpin": "hairpin",
    "u_turn": "u_turn",
    "s_bend": "s_bend",
    "chicane": "chicane",
}
SIDED = {"lefts": "left", "rights": "right"}
NOUNS = {*TURNS, "straight", "road", "end", "start"}
MOST: dict[str, tuple[Measure, int]] = {
    "sharpest": ("sharp", 1),
    "gentlest": ("sharp", -1),
    "longest": ("long", 1),
    "shortest": ("long", -1),
    "steepest": ("steep", 1),
    "flattest": ("steep", -1),
}
SHARPNESS = {"sharp", "gentle", "sweeping"}
WAYS = {"up", "down", "flat"}
HALVES = {"half1": 1, "half2": 2}
SLOPES = {"climb", "ascent", "rise", "descent", "montee", "descente", "subida", "bajada", "salita", "discesa"}
PLACES = {"after", "before", "between", "on"}


class Named(NamedTuple):
    """A target, and the index behind it."""

    target: Target
    stop: int


def named(row: Sequence[Lexeme], at: int) -> Named | None:
    """The target that is named from ``at`` on; None where none is."""
    return _Reader(row).read(at)


def place_at(row: Sequence[Lexeme], at: int) -> tuple[int, Place | None]:
    """A place such as 'after the second turn' and the index behind it; None where none stands there."""
    return _Reader(row).place_behind(at)


class _Reader:
    """Modifiers in any order, then a noun, then what stands behind it."""

    def __init__(self, row: Sequence[Lexeme]) -> None:
        self.row = row

    def name(self, at: int) -> str:
        return self.row[at].name if 0 <= at < len(self.row) else ""

    def read(self, at: int) -> Named | None:
        begun, found = at, dict[str, Any]()
        is_definite = False
        while True:
            name = self.name(at)
            if name in ("a", "the", "every", "of", "mid") or name in MOST or name == "ord":
                if name == "of" and at == begun:
                    return None
                if name == "ord":
                    at = self._ordinals(at, found)
                    continue
                if name == "a":
                    found["indefinite"] = True
                is_definite |= name in ("the", "every", "mid") or name in MOST
                found["every"] = found.get("every", False) or name == "every"
                found["middle"] = found.get("middle", False) or name == "mid"
                if name in MOST:
                    found["most"] = MOST[name]
                if name == "of" and self.name(at + 1) not in ("the", "every", "ord", "#"):
                    return None
            elif name == "more" and at > begun and ("count" in found or found.get("indefinite")):
                pass  # 'two more turns'
            elif name == "#" and not self.row[at].unit and not self._is_amount(at):
                found["count"] = int(self.row[at].value)
            elif name == "#" and self.row[at].unit == "deg" and self._leads_to_a_turn(at):
                found["degrees"] = self.row[at].value
            elif self._is_modifier(at, begun, is_definite, found):
                self._modify(name, found)
            else:
                break
            at += 1
        return self._noun(begun, at, found, is_definite)

    def _is_amount(self, at: int) -> bool:
        return self.name(at + 1) in ("sharper", "longer", "shorter", "steeper", "flatter", "gentler", "")

    def _leads_to_a_turn(self, at: int) -> bool:
        return any(self.name(i) in {*TURNS, "left", "right"} for i in (at + 1, at + 2)) and self.name(
            at - 1
        ) in (
            "the",
            "a",
            "ord",
        )

    def _is_modifier(self, at: int, begun: int, is_definite: bool, found: dict[str, Any]) -> bool:
        """Adjectives belong to a noun where one follows; a side also stands for a turn by itself."""
        name = self.name(at)
        if name in ("left", "right", "long", "short", "steep", *SHARPNESS, *WAYS):
            follows, is_noun = self._noun_follows(at), self._noun_stands(at)
            said = found.get("indefinite") or is_definite or found.get("numbers") or "count" in found
            if name in ("left", "right"):
                return self.name(at + 1) in NOUNS or (follows and is_noun) or bool(said)
            return follows and (is_noun or bool(said))
        return False

    def _noun_follows(self, at: int) -> bool:
        steps = ("left", "right", "long", "short", "steep", *SHARPNESS, *WAYS)
        is_sided = self.name(at) in ("left", "right")
        at += 1
        while self.name(at) in steps:
            is_sided |= self.name(at) in ("left", "right")
            at += 1
        if self.name(at) == "#" and not self.row[at].unit and self.name(at + 1) in NOUNS:
            at += 1
        if self.name(at) == "#" and self.row[at].unit == "deg" and self.name(at + 1) in NOUNS:
            at += 1
        # 'a sharp left' is one, with or without the turn
        return is_sided or self.name(at) in NOUNS or self.name(at) in SIDED

    def _noun_stands(self, at: int) -> bool:
        """Does a noun really stand behind the adjectives and numbers?"""
        adjectives = ("left", "right", "long", "short", "steep", *SHARPNESS, *WAYS)
        while self.name(at) in adjectives or self.name(at) == "#":
            at += 1
        return self.name(at) in NOUNS or self.name(at) in SIDED

    def _modify(self, name: str, found: dict[str, Any]) -> None:
        if name in ("left", "right"):
            found["side"] = name
        elif name in SHARPNESS:
            found["sharpness"] = name
        elif name in WAYS:
            found["way"] = name
        elif name in ("long", "short"):
            found["size"] = name

    def _ordinals(self, at: int, found: dict[str, Any]) -> int:
        """'second', 'first and third', 'last two', 'second to fourth'."""
        numbers = [int(self.row[at].value)]
        at += 1
        if self.name(at) == "#" and not self.row[at].unit and abs(numbers[0]) == 1:
            count, sign = int(self.row[at].value), numbers[0]
            found["numbers"] = tuple(sign * i for i in range(1, count + 1))
            return at + 1
        while True:
            step = at + 1
            if self.name(at) in ("and", "comma", "to") and self.name(step) == "and":
                step += 1
            if self.name(step) == "the":
                step += 1
            if self.name(at) not in ("and", "comma", "to") or self.name(step) != "ord":
                break
            after = int(self.row[step].value)
            if self.name(at) == "to" and 0 < numbers[-1] < after:
                numbers += range(numbers[-1] + 1, after)
            numbers.append(after)
            at = step + 1
        found["numbers"] = (*found.get("numbers", ()), *numbers)
        return at

    def _noun(self, begun: int, at: int, found: dict[str, Any], is_definite: bool) -> Named | None:
        name = self.name(at)
        noun: Noun | None
        is_said = name in NOUNS or name in SIDED
        if name in TURNS or name in SIDED:
            noun = "turn"
            found["kind"] = TURNS.get(name)
            if name in SIDED:
                found["side"], found["every"] = SIDED[name], True
            found["every"] = found.get("every", False) or self.row[at].text.endswith("s")
            at += 1
        elif name in ("straight", "road", "end", "start"):
            noun = cast(Noun, name)
            found["every"] = found.get("every", False) or self.row[at].text in (
                "straights",
                "geraden",
                "rectas",
            )
            at += 1
        elif name in HALVES and not found.get("numbers"):
            target = Target("road", half=HALVES[name], every=True, words=f"the {self.row[at].text}")
            return Named(target, at + 1)
        elif name in ("up", "down") and is_definite and self.row[at].text.lower() in SLOPES:
            noun, is_said = "straight", True  # 'the climb'
            found["way"] = name
            at += 1
        elif name == "it" and at == begun:
            return Named(Target("it", words=self.row[at].text), at + 1)
        elif at > begun and self.row[at - 1].text.lower() == "final":
            noun = "end"
            found["numbers"] = ()
        elif found.get("side") or found.get("numbers") or found.get("middle") or found.get("most"):
            noun = "turn" if found.get("side") or (found.get("most") or ("",))[0] == "sharp" else None
            if found.get("side") and not (is_definite or found.get("numbers") or found.get("indefinite")
                                          or "count" in found):  # fmt: skip
                return None
        else:
            return None
        if noun in ("turn", "straight"):
            at = self._numbers(at, found)
        return self._built(begun, at, noun, found, is_definite, is_said)

    def _numbers(self, at: int, found: dict[str, Any]) -> int:
        """'turns 2 to 4', 'turn 3', 'turns 1, 3 and 5'."""
        numbers: list[int] = []
        while (
            self.name(at) == "#" and not self.row[at].unit and self.row[at].value == int(self.row[at].value)
        ):
            value = int(self.row[at].value)
            joined = self.name(at + 1)
            step = at + 1
            if numbers and self.name(at - 1) == "to":
                numbers += range(numbers[-1] + 1, value)
            numbers.append(value)
            if joined in ("comma", "and", "to"):
                step = at + 2
                if self.name(step) == "and":
                    step += 1
                if self.name(step) == "#" and not self.row[step].unit:
                    at = step
                    continue
            at += 1
            break
        if numbers:
            found["numbers"] = (*found.get("numbers", ()), *numbers)
        return at

    def _built(
        self,
        begun: int,
        at: int,
        noun: Noun | None,
        found: dict[str, Any],
        is_definite: bool,
        is_said: bool,
    ) -> Named | None:
        indefinite = bool(found.get("indefinite")) and not is_definite and not found.get("numbers")
        words = " ".join(lexeme.text for lexeme in self.row[begun:at])
        target = Target(
            noun=noun,
            kind=found.get("kind"),
            numbers=found.get("numbers", ()),
            middle=found.get("middle", False),
            every=found.get("every", False),
            side=found.get("side"),
            sharpness=cast(Sharpness | None, found.get("sharpness")),
            way=cast(Way | None, found.get("way")),
            size=found.get("size"),
            most=found.get("most"),
            indefinite=indefinite,
            count=found.get("count"),
            degrees=found.get("degrees"),
            is_bare=noun == "turn" and not is_said,
            is_definite=is_definite or bool(found.get("numbers")) or noun not in ("turn", "straight"),
            words=words,
        )
        if indefinite:
            return Named(target, at)  # something new: where it is to be, is read by whoever adds it
        at, place = self.place_behind(at)
        if place:
            target = replace(target, place=place, words=" ".join(x.text for x in self.row[begun:at]))
        if self.name(at) == "but":
            other = self.read(at + 1)
            if other:
                target = replace(target, but=other.target, every=True)
                at = other.stop
        return Named(target, at)

    def place_behind(self, at: int) -> tuple[int, Place | None]:
        """'after the second turn', 'between the first and the second turn', where it stands here."""
        name = self.name(at)
        if name not in PLACES:
            return at, None
        first = self.read(at + 1)
        if first is None or (name == "on" and first.target.noun not in ("turn", "straight", None)):
            return at, None
        if name != "between":
            how = "after" if name == "after" else "before" if name == "before" else "on"
            return first.stop, Place(cast(Any, how), first.target)
        if self.name(first.stop) == "and":
            second = self.read(first.stop + 1)
            if second:
                one = first.target
                if one.noun is None:
                    one = replace(one, noun=second.target.noun)
                return second.stop, Place("between", one, second.target)
        if len(first.target.numbers) == 2:
            low, high = (replace(first.target, numbers=(n,), every=False) for n in first.target.numbers)
            return first.stop, Place("between", low, high)
        return first.stop, Place("between", first.target)


__all__ = ["NOUNS", "PLACES", "SHARPNESS", "SIDED", "TURNS", "WAYS", "Named", "named", "place_at"]
