"""Writes a change request as one short line, called a plan, and reads it back.

    turn 2: radius x0.75; end: slope down; turn all but(turn 1): side left; add hairpin right after(turn 2)

Changes are separated by ``;``. A change either consists of a place, a colon and what is to be changed there,
or it begins with ``add``. Behind ``&&`` stand changes of the scene, such as
``truck: brake more``. The page docs/reference/plans.md describes the language."""

import re
from collections.abc import Container, Iterator, Mapping
from dataclasses import replace
from typing import Any, Literal, TypeVar, cast

from roadgpt.brief.amount import Frozen, figure
from roadgpt.brief.change.request import (
    MUCH,
    SLIGHTLY,
    Change,
    EditRequest,
    Place,
    SceneChange,
    Steepness,
    Target,
    Things,
    Value,
    Way,
)
from roadgpt.brief.plan import (
    AN_ACTOR,
    CONDITIONS,
    SCENE,
    WORKS,
    Language,
    action_plan,
    language,
    read_action,
    scene_fields,
    scene_plan,
    written,
)
from roadgpt.brief.scene import Action, Land, Roadworks, Role, Scene, SlipperyPlace
from roadgpt.errors import BriefError, EditError
from roadgpt.language.names import Kind, Sharpness, Side
from roadgpt.language.table import (
    COUNTED,
    CUES,
    FLOWS,
    LANDFORMS,
    MANEUVERS,
    PARTS,
    ROAD_USERS,
    ROADS,
    SCENES,
    WEATHER,
    named_in,
)
from roadgpt.language.table import NUMBERS as OF_SCENES

ACTORS, LANDS = (*ROAD_USERS, "actor"), (*LANDFORMS, "landscape")
LISTS: Mapping[str, tuple[str, type[Frozen]]] = {
    **dict.fromkeys(ACTORS, ("actors", Role)),
    **dict.fromkeys(LANDS, ("landscape", Land)),
    "slippery": ("slippery", SlipperyPlace),
    WORKS: (WORKS, Roadworks),
}
"""The parts of which a scene can have several, each with the field that holds them, and their type."""
SINGLE: Mapping[str, tuple[str, ...]] = {
    **{name: tuple(row["fields"]) for name, row in SCENES["single"].items()},
    **{str(name): (name,) for name in WEATHER},
    **{name: (field,) for name, (field, _) in CONDITIONS.items() if field != "flow"},
    "scene": tuple(name for name in (*Scene.model_fields, *WEATHER) if name != "weather"),
}
"""The other parts of a scene, each with the fields that make it."""
OF_SINGLE = {name: row["number"] for name, row in SCENES["single"].items() if "number" in row}
OF_SINGLE |= {str(name): name for name in WEATHER}
"""The field of the one number or level that such a part has."""
LEVELS = ("flow", "oncoming", "land")
KEYS = {number.key: field for field, number in OF_SCENES.items()} | {str(kind): kind for kind in WEATHER}
Valued = TypeVar("Valued", bound=Value)


def change_plan(request: EditRequest) -> str:
    """Returns the plan of a change request, without the text of the request."""
    line = "; ".join(_change(change) for change in request.changes)
    scene = "; ".join(map(_scene_change, request.scene))
    return f"{line} {SCENE} {scene}".strip() if scene else line


def _change(change: Change) -> str:
    if change.what == "add":
        return " ".join(["add", *_added(change)])
    place = _place(change.target) if change.target else "road"
    return f"{place}: {' '.join(_wish(change))}"


def _wish(change: Change) -> Iterator[str]:
    if change.what == "count":
        yield f"x{_bounded(change)}"
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


def _scene_change(change: SceneChange) -> str:
    if change.target is None:
        return f"add {scene_plan(cast(Scene, change.new))}"
    return f"{_things(change.target)}: {' '.join(_scene_wish(change))}"


def _things(things: Things) -> str:
    numbers = ",".join(map(str, things.numbers))
    return " ".join(filter(None, [things.name, numbers, *written(things, THINGS)]))


def _scene_wish(change: SceneChange) -> Iterator[str]:
    if change.doing:
        yield change.doing
    if change.what == "number":
        if change.key != _usual_key(change):
            yield OF_SCENES[change.key].key
        yield from _value(change)
    elif change.what == "count":
        yield f"x{_bounded(change)}"
    else:
        yield change.what
    if change.form is not None:
        yield _things(change.form)
    if isinstance(change.new, Action):
        yield action_plan(change.new)


def _usual_key(change: SceneChange) -> str:
    """Returns the field of the number that stands without a key; "" if there is none."""
    if change.doing:
        return next(iter(MANEUVERS[change.doing].numbers), "")
    name = change.target.name if change.target else ""
    return "" if name == "ego" else OF_SINGLE.get(name, "")


def _bounded(change: Value) -> str:
    number = figure(change.to or 0, 6)
    return {-1: f"..{number}", 0: number, 1: f"{number}.."}[change.bound]


def _value(change: Value) -> Iterator[str]:
    place = _place(change.like) if change.like is not None else ""
    if place and not change.is_compared:
        yield {-1: f"..{place}", 0: f"={place}", 1: f"{place}.."}[change.bound]
    elif change.to is not None:
        yield _bounded(change) if change.bound else f"={figure(change.to, 6)}"
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
    yield from written(change, NEW)
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
    words += [",".join(map(str, target.numbers))] if target.numbers else []
    words += written(target, PLACE)
    words += [_position(target.place)] if target.place else []
    words += [f"but({_place(target.but)})"] if target.but else []
    return " ".join(words)


def read_change_plan(line: str) -> EditRequest:
    """Returns the changes that a plan describes; raises EditError if a word or number is not part of the
    language, or is in the wrong place."""
    road, _, behind = line.partition(SCENE)
    changes = tuple(ChangeParser(part).change() for part in road.split(";") if part.strip())
    try:
        scene = tuple(SceneChangeParser(part).scene_change() for part in behind.split(";") if part.strip())
    except BriefError as error:
        raise EditError(str(error)) from error
    if not changes and not scene:
        raise EditError("the plan names no change; write for example: turn 2: radius x0.75")
    return EditRequest(line, changes, scene=scene)


TOKEN = re.compile(r"\s*(?:(half[12]|[a-z_]+)|(-?\d+(?:\.\d+)?)|(\.\.|[;:,()=+%-]))")
SPACES = re.compile(r" (?=[(),=])|(?<=[(=]) ")
"""Spaces between tokens that are removed from the text of a place."""
KINDS = frozenset(named_in("features")) - {"straight", "turn"}
NOUNS, ENDS = named_in("nouns"), cast("Mapping[str, Literal['start', 'end', 'middle']]", ROADS["ends"])
PLACE, NEW = language(PARTS["place"]), language(PARTS["new"])
SIDES = AN_ACTOR.parts["side"]._replace(words={**AN_ACTOR.parts["side"].words, "other": "other"})
THINGS = language({"every": PARTS["place"]["every"], "where": AN_ACTOR.parts["where"], "side": SIDES})
POSITIONS: Mapping[str, Mapping[str, bool]] = ROADS["positions"]
NEXT_TO, MOVES = ([name for name in POSITIONS if POSITIONS[name].get(how)] for how in ("new", "moved"))
"""Where an element can be added, relative to others, and where a turn can be moved."""
MEASURES = named_in("measures")
ALONE = named_in("wishes")
OF_ROAD = ("mirror", "reverse")
"""Changes that can concern the whole road."""
WAYS = PARTS["new"]["slope"].words
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
            return self._counted(Change("count", target))
        if what in (*MOVES, *ENDS):
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
            if side not in (*named_in("sides"), "other"):
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
            elif word in named_in("sharpness") and change.sharpness is None:
                change = replace(change, sharpness=cast(Sharpness, word))
            else:
                raise self._error(word)
            self.at += 1
        if not (change.kind or change.sharpness):
            raise self._error("")
        return change

    def _counted(self, change: Valued) -> Valued:
        is_most = self._take("..")
        number = self._whole()
        return replace(change, to=number, bound=-1 if is_most else 1 if self._take("..") else 0)

    def _valued(self, change: Valued) -> Valued:
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

    def _of(self, change: Valued) -> Valued:
        """Returns the change with the place of whose value its factor or difference is, if one is given."""
        return replace(change, like=self._target()) if change.takes_places and self._take("=") else change

    def _to(self, change: Valued) -> Valued:
        if self._next() in (*NOUNS, *KINDS) and change.takes_places:
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
                self._set(fields, *self._described(NEW, NEXT_TO))
        return Change("add", Target(noun, words=kind), kind=own, **fields)

    def _described(self, has: Language, places: Container[str]) -> tuple[str, Any]:
        """Returns the field that the next word sets, and its value, which may stand behind the word."""
        word = self._word()
        if word in has.words:
            return has.words[word]
        if word == COUNTED and "count" in has.parts:
            return "count", self._whole()
        if word in has.keys:
            self._need("=")
            return has.keys[word][0], self._figure()
        if word in places or (places and word in ENDS):
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
        self._name(fields, PLACE, POSITIONS)
        words = SPACES.sub("", " ".join(self.tokens[begun : self.at]))
        return Target(cast(Any, "turn" if noun in KINDS else noun), words=words, **fields)

    def _name(self, fields: dict[str, Any], has: Language, places: Container[str] = ()) -> None:
        """Sets the fields that name which places or parts of a scene are meant."""
        while (word := self._next()) not in ("", ":", ")", ",", ".."):
            if _is_number(word) and "every" in has.parts:
                self._set(fields, "numbers", self._list())
            elif places and self._take("but"):
                self._need("(")
                self._set(fields, "but", self._target())
                self._need(")")
            else:
                self._set(fields, *self._described(has, places))

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


class SceneChangeParser(ChangeParser):
    """Reads one change of a scene from its tokens. What is added stands in the language of scenes."""

    def scene_change(self) -> SceneChange:
        """Returns the change."""
        is_condition = ":" not in self.tokens and self._next() in (*CONDITIONS, *WEATHER)
        if is_condition or self._take("add"):
            text = self.text if is_condition else self.text.removeprefix("add")
            fields = scene_fields(text)
            if not any(fields.values()):
                raise self._error("")
            return SceneChange("add", new=Scene().model_copy(update=fields))
        name = self._word()
        if name not in (*LISTS, *SINGLE):
            raise self._error(name)
        target = self._things(name)
        self._need(":")
        found = self._scene_wish(target)
        if self._next():
            raise self._error(self._next())
        return found

    def _things(self, name: str) -> Things:
        has = {"every": name in LISTS, "where": name in (*ACTORS, "")}
        has["side"] = name in (*ACTORS, *LANDS, WORKS, "parked", "")
        fields: dict[str, Any] = {}
        self._name(fields, language({field: part for field, part in THINGS.parts.items() if has[field]}))
        return Things(name, **fields)

    def _scene_wish(self, target: Things) -> SceneChange:
        is_actor, name = target.name in ACTORS, target.name
        if is_actor and self._take("add"):
            new = read_action(self.text.partition(":")[2].strip().removeprefix("add"))
            self.at = len(self.tokens)
            return SceneChange("add", target, new=new)
        if is_actor and self._take("as"):
            kind = self._word() if self._next() in ROAD_USERS else ""
            form = self._things(kind)
            if form == Things("") or form.numbers or form.every:
                raise self._error("")
            return SceneChange("as", target, form=form)
        if name in ("traffic", "oncoming") and self._next() in (*FLOWS, "none"):
            level = self._word()
            if name == "traffic" and level == "none":
                return SceneChange("remove", target)
            return SceneChange("add", new=Scene().model_copy(update={OF_SINGLE[name]: level}))
        doing = next((each for each in MANEUVERS if is_actor and each == self._next()), None)
        self.at += doing is not None
        if self._take("remove"):
            return SceneChange("remove", target, doing=doing)
        if name in (*ACTORS, *LANDS) and doing is None and self._take("x"):
            return self._counted(SceneChange("count", target))
        return self._with_number(SceneChange("number", target, doing=doing))

    def _with_number(self, change: SceneChange) -> SceneChange:
        assert change.target is not None
        key, name = KEYS.get(self._next(), ""), change.target.name
        self.at += bool(key)
        key = key or _usual_key(change)
        if change.doing:
            has = (*MANEUVERS[change.doing].numbers, *CUES)
        else:
            has = tuple(LISTS[name][1].model_fields) if name in LISTS else (OF_SINGLE.get(name, ""),)
        if not key or key not in has:
            raise self._error(self.tokens[self.at - 1] if key else self._next())
        change = self._valued(replace(change, key=key))
        if key in LEVELS and (not change.more or change.by is not None):
            raise EditError(
                f"'{self.text[:60]}' is no level of {name}; write more or less, or add for"
                f" example {'hilly' if key == 'land' else 'dense'}"
            )
        return change


def _is_number(word: str) -> bool:
    return bool(re.fullmatch(r"-?\d+(?:\.\d+)?", word))
