"""Reads places from lexemes: 'the second left turn', 'turns 2 to 4', 'the end'."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple, cast

from roadgpt.brief.model import Kind
from roadgpt.design.edit.counting import CountedRow
from roadgpt.design.edit.lexing import RequestLexeme
from roadgpt.design.edit.request import HALVES, SUPERLATIVES, Noun, Place, Target

TURNS: dict[str, Kind | None] = {
    "turn": None,
    "hairpin": "hairpin",
    "u_turn": "u_turn",
    "s_bend": "s_bend",
    "chicane": "chicane",
}
SIDED = {"lefts": "left", "rights": "right"}
NOUNS = {*TURNS, "straight", "road", "end", "start"}
SHARPNESS = {"sharp", "gentle", "sweeping"}
WAYS = {"up", "down", "flat"}
SLOPES = {"climb", "ascent", "rise", "descent", "montee", "descente", "subida", "bajada", "salita", "discesa"}
STRAIGHTS = {"straights", "geraden", "rectas"}  # several of them
DEMONSTRATIVES = {"this", "that", "these", "those"}
PLACES = {"after", "before", "between", "on"}


class NamedTarget(NamedTuple):
    """A target that was read from a row of lexemes, and the index of the first lexeme after it."""

    target: Target
    stop: int


def named(row: Sequence[RequestLexeme], at: int) -> NamedTarget | None:
    """Returns the target that the lexemes name from index ``at``, such as 'the second left turn', or None."""
    return _TargetReader(row).read(at)


def place_at(row: Sequence[RequestLexeme], at: int) -> tuple[int, Place | None]:
    """Reads a place such as 'after the second turn' from the lexemes at index ``at``.

    Returns the index of the next lexeme, and the place, or None if the lexemes name no place.
    """
    return _TargetReader(row).place_behind(at)


class _TargetReader(CountedRow):
    """Modifiers in any order, then a noun, then what stands behind it."""

    def read(self, at: int) -> NamedTarget | None:
        begun, found = at, dict[str, Any]()
        is_definite = False
        while True:
            name = self.name(at)
            if name in ("a", "the", "every", "of", "mid") or name in SUPERLATIVES or name == "ord":
                if name == "of" and at == begun:
                    return None
                if name == "ord":
                    at = self.ordinals(at, found)
                    continue
                if name == "a":
                    found["indefinite"] = True
                is_definite |= name in ("the", "every", "mid") or name in SUPERLATIVES
                found["every"] = found.get("every", False) or name == "every"
                found["middle"] = found.get("middle", False) or name == "mid"
                if name in SUPERLATIVES:
                    found["most"] = SUPERLATIVES[name]
                if name == "of" and self.name(at + 1) not in ("the", "every", "ord", "#"):
                    return None
            elif name == "more" and at > begun and ("count" in found or found.get("indefinite")):
                pass  # 'two more turns'
            elif name == "#" and not self.row[at].unit and not self._is_amount(at):
                found["count"] = int(self.row[at].value)
            elif name == "#" and self.row[at].unit == "deg" and self._leads_to_a_turn(at):
                found["degrees"] = self.row[at].value
            elif name == "#" and self.row[at].unit == "m" and (stop := self._straight_behind(at, begun)):
                found["length"] = self.row[at].value
                found["indefinite"] = found.get("indefinite", at == begun)
                at = stop
                continue
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

    def _straight_behind(self, at: int, begun: int) -> int:
        """Of 'a 40 m straight' and '40 m of straight road': where the noun stands; 0 where none does."""
        has_of = self.name(at + 1) == "of"
        stop = at + 1 + has_of
        leads = has_of if at == begun else self.name(at - 1) in ("the", "a", "ord")
        return stop if leads and self.name(stop) == "straight" else 0

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

    def _noun(self, begun: int, at: int, found: dict[str, Any], is_definite: bool) -> NamedTarget | None:
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
            found["every"] = found.get("every", False) or self.row[at].text in STRAIGHTS
            at += 1
        elif name in HALVES and not found.get("numbers"):
            target = Target("road", half=HALVES[name], every=True, words=f"the {self.row[at].text}")
            return NamedTarget(target, at + 1)
        elif name in ("up", "down") and is_definite and self.row[at].text.lower() in SLOPES:
            noun, is_said = "straight", True  # 'the climb'
            found["way"] = name
            at += 1
        elif name == "it" and at == begun:
            return self._that(at) or NamedTarget(Target("it", words=self.row[at].text), at + 1)
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
            at = self.numbers(at, found)
        return self._built(begun, at, noun, found, is_definite, is_said)

    def _that(self, at: int) -> NamedTarget | None:
        """'that turn'; not 'make that straight'."""
        noun = self.name(at + 1)
        leads = noun in TURNS or (noun == "straight" and bool(self.name(at + 2)))
        found = self.read(at + 1) if leads and self.row[at].text.lower() in DEMONSTRATIVES else None
        if found is None:
            return None
        words = f"{self.row[at].text} {found.target.words}"
        is_that = not found.target.numbers
        return NamedTarget(replace(found.target, is_that=is_that, is_definite=True, words=words), found.stop)

    def _built(
        self,
        begun: int,
        at: int,
        noun: Noun | None,
        found: dict[str, Any],
        is_definite: bool,
        is_said: bool,
    ) -> NamedTarget | None:
        indefinite = bool(found.get("indefinite")) and not is_definite and not found.get("numbers")
        words = " ".join(lexeme.text for lexeme in self.row[begun:at])
        target = Target(
            noun=noun,
            **(found | {"indefinite": indefinite}),
            is_bare=noun == "turn" and not is_said,
            is_definite=is_definite or bool(found.get("numbers")) or noun not in ("turn", "straight"),
            words=words,
        )
        if indefinite:
            return NamedTarget(target, at)  # something new: where it is to be, is read by whoever adds it
        at, place = self.place_behind(at)
        if place:
            target = replace(target, place=place, words=" ".join(x.text for x in self.row[begun:at]))
        if self.name(at) == "but":
            other = self.read(at + 1)
            if other:
                target = replace(target, but=other.target, every=True)
                at = other.stop
        return NamedTarget(target, at)

    def place_behind(self, at: int) -> tuple[int, Place | None]:
        """Returns a place such as 'after the second turn', where the row has one at this index."""
        name = self.name(at)
        if name not in PLACES:
            return at, None
        first = self.read(at + 1)
        if first is None and name == "between":  # 'the straight in between'
            return at + 1, Place("between", Target("turn", numbers=(1,)), Target("turn", numbers=(-1,)))
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
        if first.target.every and not first.target.numbers:  # 'between the two lefts', 'between the turns'
            one, last = (replace(first.target, numbers=(n,), every=False, count=None) for n in (1, -1))
            return first.stop, Place("between", one, last)
        if len(first.target.numbers) == 2:
            low, high = (replace(first.target, numbers=(n,), every=False) for n in first.target.numbers)
            return first.stop, Place("between", low, high)
        return first.stop, Place("between", first.target)
