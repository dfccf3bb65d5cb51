"""Writes a change request as one short line, called a plan, and reads it back.

    turn 2: radius x0.75; end: slope down; turn all but(turn 1): side left; add hairpin right after(turn 2)

Changes are separated by ``;``. A change either consists of a place, a colon and what is to be changed there,
or it begins with ``add``. The page docs/reference/plans.md describes the language."""

import re
from collections.abc import Container, Iterator, Mapping
from dataclasses import replace
from typing import Any, Literal, cast, get_args

from roadgpt.brief.amount import figure
from roadgpt.brief.change.request import (
    HALVES,
    MUCH,
    SLIGHTLY,
    SUPERLATIVES,
    Change,
    EditRequest,
    Place,
    Steepness,
    Target,
    Way,
)
from roadgpt.brief.model import Kind, Sharpness, Side
from roadgpt.errors import EditError


def change_plan(request: EditRequest) -> str:
    """Returns the plan of a change request, without the text of the request."""
    return "; ".join(_change(change) for change in request.changes)


def _change(change: Change) -> str:
    if change.what == "add":
        return " ".join(["add", *_added(change)])
    place = _place(change.target) if change.target else "road"
    return f"{place}: {' '.join(_wish(change))}"


def _wish(change: Change) -> Iterator[str]:
    if change.what == "count":
        low, high = ("..", "") if change.bound < 0 else ("", ".." if change.bound else "")
        yield f"x{low}{figure(change.to or 0, 6)}{high}"
        return
    if change.what == "move":
        assert change.place is not None
        yield _position(change.place)
        return
    yield change.what
    if change.what == "swap" and change.like is not None:
        yield f"={_place(change.like)}"
    if change.what == "side":
        yield change.side or "other"
    if change.what == "shape":
        yield from (word for word in (change.kind, change.sharpness) if word)
    if change.way and change.what == "slope":
        yield change.slope or ""
    if change.what in MEASURES:
        yield from _value(change)


def _value(change: Change) -> Iterator[str]:
    place = _place(change.like) if change.like is not None else ""
    if place and not change.is_compared:
        yield {-1: f"..{place}", 0: f"={place}", 1: f"{place}.."}[change.bound]
    elif change.to is not None:
        number = figure(change.to, 6)
        yield {-1: f"..{number}", 0: f"={number}", 1: f"{number}.."}[change.bound]
    elif change.by is not None:
        yield f"{'+' if change.more > 0 else '-'}{figure(change.by, 6)}"
    elif change.times is not None:
        yield f"x{figure(change.times, 6)}"
    elif change.more:
        yield from (word for word, dose in DOSES.items() if dose == change.dose)
        yield "more" if change.more > 0 else "less"
    if change.is_compared:
        yield f"={place}"


def _added(change: Change) -> Iterator[str]:
    assert change.target is not None
    yield change.kind or change.target.noun or "turn"
    if change.count != 1:
        yield f"x{change.count}"
    yield from (word for word in (change.side, change.sharpness, change.slope) if word)
    for key, field in NUMBERS.items():
        if (value := getattr(change, field)) is not None:
            yield f"{key}={figure(value, 6)}"
    if change.is_whole:
        yield "whole"
    if change.place:
        yield _position(change.place)


def _position(place: Place) -> str:
    if place.target is None:
        return f"at_{place.how}"
    inner = [_place(target) for target in (place.target, place.other) if target]
    return f"{place.how}({', '.join(inner)})"


def _place(target: Target) -> str:
    """Returns the text of a target; without a noun it becomes a turn, which is how ``pointing`` reads it."""
    words: list[str] = [target.kind or target.noun or "turn"]
    if target.numbers:
        words.append(",".join(map(str, target.numbers)))
    words += ["all"] if target.every else []
    words += ["middle"] if target.middle else []
    words += [name for name, most in SUPERLATIVES.items() if most == target.most]
    words += [f"x{target.count}"] if target.count is not None else []
    words += [word for word in (target.side, target.sharpness, target.way, target.size) if word]
    for key in ("deg", "len"):
        if (value := getattr(target, NUMBERS[key])) is not None:
            words.append(f"{key}={figure(value, 6)}")
    words += [name for name, half in HALVES.items() if half == target.half]
    words += [_position(target.place)] if target.place else []
    words += [f"but({_place(target.but)})"] if target.but else []
    return " ".join(words)


def read_change_plan(line: str) -> EditRequest:
    """Returns the changes that a plan describes; raises EditError if a word or number is not part of the
    language, or is in the wrong place."""
    changes = tuple(ChangeParser(part).change() for part in line.split(";") if part.strip())
    if not changes:
        raise EditError("the plan names no change; write for example: turn 2: radius x0.75")
    return EditRequest(line, changes)


TOKEN = re.compile(r"\s*(?:(half[12]|[a-z_]+)|(-?\d+(?:\.\d+)?)|(\.\.|[;:,()=+%-]))")
SPACES = re.compile(r" (?=[(),=])|(?<=[(=]) ")
"""Spaces between tokens that are removed from the text of a place."""
KINDS = frozenset(get_args(Kind)) - {"straight", "turn"}
NOUNS = ("turn", "straight", "start", "end", "road")
OF_TURNS: dict[str, tuple[str, Any]] = {
    **{word: ("side", word) for word in get_args(Side)},
    **{word: ("sharpness", word) for word in get_args(Sharpness)},
}
"""Words that describe turns, each with the field that it sets and its value."""
OF_TARGETS = {
    **OF_TURNS,
    **{word: ("way", word) for word in get_args(Way)},
    **{word: ("size", word) for word in ("long", "short")},
    **{word: ("most", most) for word, most in SUPERLATIVES.items()},
    **{word: ("half", half) for word, half in HALVES.items()},
    "all": ("every", True),
    "middle": ("middle", True),
}
"""Words that describe places, each with the field that it sets and its value."""
OF_NEW = {**OF_TURNS, "whole": ("is_whole", True)}
"""Words that describe what is added, each with the field that it sets and its value."""
NUMBERS = {"deg": "degrees", "len": "length", "r": "radius", "pct": "grade"}
NEXT_TO = ("after", "before", "between", "on")
"""Positions, relative to other elements, at which a new element can be added."""
POSITIONS = (*NEXT_TO, "from", "up_to")
ENDS: dict[str, Literal["start", "end", "middle"]] = {
    "at_start": "start",
    "at_end": "end",
    "at_middle": "middle",
}
MEASURES = ("angle", "radius", "length", "slope", "climb")
MOVES = ("after", "before", "between", *ENDS)
"""Positions to which a turn can be moved."""
ALONE = ("straighten", "remove", "mirror", "reverse", "swap", "alternate")
OF_ROAD = ("mirror", "reverse")
"""Changes that can concern the whole road."""
WAYS = (*get_args(Way), *(f"{how}_{way}" for how in get_args(Steepness) for way in ("up", "down")))
DOSES = {"slightly": SLIGHTLY, "much": MUCH}
PAGE = "the page 'Plans' of the reference describes the language"


class ChangeParser:
    """Reads one change from its tokens, from left to right."""

    def __init__(self, text: str) -> None:
        self.text = " ".join(text.split())
        self.tokens: list[str] = []
        at = 0
        while at < len(self.text):
            match = TOKEN.match(self.text, at)
            if match is None:
                raise self._error(self.text[at:].split()[0])
            self.tokens.append(match[0].strip())
            at = match.end()
        self.at = 0

    def change(self) -> Change:
        """Returns the change."""
        if self._take("add"):
            found = self._new()
        else:
            target = self._target()
            if not self._take(":"):
                raise EditError(
                    f"the change '{self.text[:60]}' does not say what is wanted; "
                    "write the place, a colon and the wish"
                )
            found = self._wish(target)
        if self._next():
            raise self._error(self._next())
        return replace(found, words=self.text)

    def _wish(self, target: Target) -> Change:
        what = self._word()
        if what == "x":
            is_most = self._take("..")
            number = self._whole()
            return Change("count", target, to=number, bound=-1 if is_most else 1 if self._take("..") else 0)
        if what in MOVES:
            return Change("move", target, place=self._position(what))
        if what in ALONE:
            if what == "reverse" and target != Target("road", words="road"):
                raise EditError("only the whole road can be reversed; write: road: reverse")
            if what == "mirror" and target.noun == "road" and target != Target("road", words="road"):
                raise EditError("only the whole road, or turns, can be mirrored; write: road: mirror")
            whole = what in OF_ROAD and target.noun == "road"
            other = self._target() if what == "swap" and self._take("=") else None
            return Change(cast(Any, what), None if whole else target, like=other)
        if what == "side":
            side = self._word()
            if side not in (*get_args(Side), "other"):
                raise self._error(side)
            return Change("side", target, side=None if side == "other" else cast(Side, side))
        if what == "shape":
            return self._shape(Change("shape", target))
        if what not in MEASURES:
            raise self._error(what)
        if what == "climb" and target.noun in ("start", "end") and target.length is None:
            raise EditError(
                f"'{self.text[:60]}' does not say which part climbs; write road, a straight, a turn, or "
                "for example: end len=50"
            )
        change = Change(cast(Any, what), target)
        if what == "slope" and self._next() in WAYS:
            steepness, _, way = self._word().rpartition("_")
            change = replace(
                change, way=cast(Way, way), steepness=cast(Steepness, steepness) if steepness else None
            )
            if not self._next() or steepness or way == "flat":
                return change
        return self._valued(change)

    def _shape(self, change: Change) -> Change:
        while word := self._next():
            if word in KINDS and change.kind is None:
                change = replace(change, kind=cast(Kind, word))
            elif word in get_args(Sharpness) and change.sharpness is None:
                change = replace(change, sharpness=cast(Sharpness, word))
            else:
                raise self._error(word)
            self.at += 1
        if not (change.kind or change.sharpness):
            raise self._error("")
        return change

    def _valued(self, change: Change) -> Change:
        if self._take("="):
            return self._to(change)
        if self._take(".."):
            return self._to(replace(change, bound=-1))
        if self._take("+"):
            return self._of(replace(change, more=1, by=self._figure()))
        if self._take("-"):
            return self._of(replace(change, more=-1, by=self._figure()))
        if self._take("x"):
            factor = self._figure()
            return self._of(replace(change, times=factor / 100 if self._take("%") else factor))
        if self._next() in (*NOUNS, *KINDS):
            change = self._to(replace(change, bound=1))
            self._need("..")
            return change
        if _is_number(self._next()):
            number = self._figure()
            if number < 0 and self._next() in ("", "="):  # the sign belongs to the difference: -20
                return self._of(replace(change, more=-1, by=-number))
            if not self._take(".."):
                raise self._error(self._next())
            return replace(change, to=number, bound=1)
        dose = DOSES.get(self._next(), 1.0)
        self.at += dose != 1.0
        word = self._word()
        if word not in ("more", "less"):
            raise self._error(word)
        return replace(change, more=1 if word == "more" else -1, dose=dose)

    def _of(self, change: Change) -> Change:
        """Returns the change with the place of whose value its factor or difference is, if one is given."""
        return replace(change, like=self._target()) if change.what != "climb" and self._take("=") else change

    def _to(self, change: Change) -> Change:
        if self._next() in (*NOUNS, *KINDS) and change.what != "climb":
            return replace(change, like=self._target())
        return replace(change, to=self._figure())

    def _new(self) -> Change:
        kind = self._word()
        if kind not in KINDS | {"turn", "straight"}:
            raise self._error(kind)
        noun: Any = "straight" if kind == "straight" else "turn"
        own = cast(Kind, kind) if kind in KINDS else None
        fields: dict[str, Any] = {}
        while word := self._next():
            if word in WAYS:
                self.at += 1
                steepness, _, way = word.rpartition("_")
                self._set(fields, "way", way)
                fields["steepness"] = steepness or None
            else:
                self._set(fields, *self._described(OF_NEW, NUMBERS, NEXT_TO))
        return Change("add", Target(noun, words=kind), kind=own, **fields)

    def _described(
        self, fixed: Mapping[str, tuple[str, Any]], keys: Container[str], places: Container[str]
    ) -> tuple[str, Any]:
        """Returns the field that the next word sets, and its value, which may stand behind the word."""
        word = self._word()
        if word in fixed:
            return fixed[word]
        if word == "x":
            return "count", self._whole()
        if word in keys:
            self._need("=")
            return NUMBERS[word], self._figure()
        if word in places or word in ENDS:
            return "place", self._position(word)
        raise self._error(word)

    def _position(self, word: str) -> Place:
        if word in ENDS:
            return Place(ENDS[word])
        self._need("(")
        target = self._target()
        other = None
        if word == "between":
            self._need(",")
            other = self._target()
        self._need(")")
        return Place(cast(Any, word), target, other)

    def _target(self) -> Target:
        begun = self.at
        noun = self._word()
        if noun not in (*NOUNS, *KINDS):
            raise self._error(noun)
        fields: dict[str, Any] = {"kind": noun} if noun in KINDS else {}
        while (word := self._next()) not in ("", ":", ")", ",", ".."):
            if _is_number(word):
                self._set(fields, "numbers", self._list())
            elif self._take("but"):
                self._need("(")
                self._set(fields, "but", self._target())
                self._need(")")
            else:
                self._set(fields, *self._described(OF_TARGETS, ("deg", "len"), POSITIONS))
        words = SPACES.sub("", " ".join(self.tokens[begun : self.at]))
        return Target(cast(Any, "turn" if noun in KINDS else noun), words=words, **fields)

    def _list(self) -> tuple[int, ...]:
        numbers = [self._whole()]
        while self._next() == "," and _is_number(self._next(1)):
            self.at += 1
            numbers.append(self._whole())
        return tuple(numbers)

    def _set(self, fields: dict[str, Any], name: str, value: Any) -> None:
        if name in fields:
            raise EditError(f"the change '{self.text[:60]}' gives its {name} twice; give it once")
        fields[name] = value

    def _figure(self) -> float:
        word = self._word()
        if not _is_number(word):
            raise self._error(word)
        return float(word)

    def _whole(self) -> int:
        number = self._figure()
        if not number.is_integer() or not number:
            raise self._error(f"{number:g}")
        return int(number)

    def _need(self, sign: str) -> None:
        if not self._take(sign):
            raise self._error(self._next())

    def _take(self, word: str) -> bool:
        is_next = self._next() == word
        self.at += is_next
        return is_next

    def _word(self) -> str:
        self.at += 1
        return self.tokens[self.at - 1] if self.at <= len(self.tokens) else ""

    def _next(self, further: int = 0) -> str:
        place = self.at + further
        return self.tokens[place] if place < len(self.tokens) else ""

    def _error(self, word: str) -> EditError:
        where = f"'{word[:40]}' is not expected in" if word else "something is missing at the end of"
        return EditError(f"{where} the change '{self.text[:60]}'; {PAGE}")


def _is_number(word: str) -> bool:
    return bool(re.fullmatch(r"-?\d+(?:\.\d+)?", word))
