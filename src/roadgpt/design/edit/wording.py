"""From one clause to the changes that it asks for: words of angles, radii, lengths, slopes and sides."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Protocol, cast

from roadgpt.brief.model import Sharpness, Side
from roadgpt.design.edit.lexing import Lexeme
from roadgpt.design.edit.request import Change, Place, Target, Way
from roadgpt.errors import EditError

PREPOSITIONS = {"by", "to", "at", "of", "with"}
ABROAD = {"gauche", "droite", "izquierda", "derecha", "sinistra", "destra"}  # sides stand behind their noun
LONG, SHORT = 70.0, 22.0  # m: what a straight is made that is to be long, or short
FROM_ABROAD = {"de", "di"}
VERBS = {"remove", "swap", "mirror", "straighten", "sharper", "gentler", "tighter", "wider", "longer",
         "shorter", "steeper", "flatter", "more", "less"}  # fmt: skip
"""Of what is there already."""
A_FACTOR = 15.0  # percent: 'so much steeper' from here on is a share, as no road is that steep
WAYS: tuple[Way, ...] = ("up", "down", "flat")
SIDES: tuple[Side, ...] = ("left", "right")
ADJECTIVES: tuple[Sharpness, ...] = ("sharp", "gentle", "sweeping")
OF_LENGTHS = ("longer", "shorter", "long", "short", "length_noun")
OF_ANGLES = ("radius", "tighter", "wider", "sharper", "gentler", "angle_noun")
STEEPLY, GENTLY = 10.0, 3.5  # percent: inside what brief.words promises
SLIGHTLY, MUCH = 0.5, 1.8
NEAR = 3  # words between a number and the noun that it belongs to


class Clause(Protocol):
    """What was found in one clause."""

    targets: list[Target]
    new: list[Target]
    places: list[Place]
    row: list[Lexeme]
    words: str

    @property
    def names(self) -> set[str]:
        """Of all meanings that are left."""
        ...


@dataclass(frozen=True, slots=True)
class Amount:
    """A number with what stands around it."""

    value: float
    unit: str
    preposition: str
    noun: str
    is_before_comparative: bool


def wanted(clause: Clause, before: tuple[Target, ...]) -> list[Change]:
    """The changes of one clause; empty where nothing was said that is known.

    Args:
        clause: places, new things and the words that are left.
        before: what the clause before spoke of.

    Raises:
        EditError: something is left open that cannot be guessed.
    """
    names = clause.names
    if "mirror" in names and not any(t.noun in ("turn", "straight") for t in clause.targets):
        return [Change("mirror", words=clause.words)]
    is_new = bool(clause.new) and not clause.targets and not _speaks_of_it(clause, before)
    if "add" in names or (is_new and not names & VERBS):
        return [_added(clause, before)]
    if is_new and "remove" not in names:
        raise EditError(f"which one is meant in '{clause.words}' is not said; say: the second turn")
    targets = _targets(clause, before)
    if "remove" in names and any(x.name == "#" and x.unit for x in clause.row):
        clause.row = [replace(x, name="shorter") if x.name == "remove" else x for x in clause.row]
        names = clause.names  # 'cut the last straight in half'
    if "remove" in names:
        return _removed(clause, targets)
    if "straighten" in names or _into_a_straight(clause):
        return [Change("straighten", target, words=clause.words) for target in targets]
    found = _Dimensions(clause).changes()
    if not found and "make" in names:  # 'make the third left'
        found = [Change("side", side=t.side, words=clause.words) for t in targets if t.is_bare][:1]
    out = []
    some: list[Target | None] = [*targets]
    for target in some or [None]:
        out += [_on(target, change, found, clause) for change in found]
    return [change for change in out if change is not None]


def _speaks_of_it(clause: Clause, before: tuple[Target, ...]) -> bool:
    """'Make it a hairpin' and 'turn it into a left turn' change what was named before."""
    return bool(before) and "make" in clause.names


def _targets(clause: Clause, before: tuple[Target, ...]) -> list[Target]:
    out: list[Target] = []
    for target in clause.targets:
        if target.noun == "it":
            out += before or (Target("road", words="the road"),)
        else:
            out.append(_without_it(target, before))
    if len(out) > 1 and out[-1].noun == "road":
        out = [target for target in out if target.noun != "road"]  # 'the second turn of the road'
    places = clause.places
    if places and (not out or out[0].noun == "road"):
        ends = [p for p in places if p.how in ("start", "end")]
        if ends:
            return [Target("end" if ends[0].how == "end" else "start", words=f"the {ends[0].how}")]
        if places[0].how == "on" and places[0].target:
            return [places[0].target]
        return [Target("road", place=places[0], words=clause.words)]
    return out or list(before)


def _without_it(target: Target, before: tuple[Target, ...]) -> Target:
    """'The turn after it': with what was spoken of before in its place."""
    place = target.place
    if place and place.target and place.target.noun == "it" and before:
        return replace(target, place=replace(place, target=before[0]))
    return target


def _into_a_straight(clause: Clause) -> bool:
    turns = any(t.noun in ("turn", None) for t in clause.targets)
    straight = any(t.noun == "straight" for t in clause.new) or (
        len(clause.targets) > 1 and clause.targets[-1].words == "straight"
    )
    if turns and straight:
        clause.targets[:] = [t for t in clause.targets if t.words != "straight"]
        return True
    return False


def _removed(clause: Clause, targets: Sequence[Target]) -> list[Change]:
    if clause.new and not targets:
        raise EditError(
            f"which one is to be removed in '{clause.words}' is not said; say: remove the second turn"
        )
    if not targets or any(t.noun == "road" and t.place is None for t in targets):
        raise EditError(f"'{clause.words}' would leave no road; say which turn or straight is to be removed")
    return [Change("remove", target, words=clause.words) for target in targets]


def _added(clause: Clause, before: tuple[Target, ...]) -> Change:
    things = clause.new or [t for t in clause.targets if t.noun in ("turn", "straight")]
    if not things:
        raise EditError(
            f"what is to be added in '{clause.words}' is not said; say: add a left turn at the end"
        )
    thing, dims = things[0], _Dimensions(clause)
    place = clause.places[0] if clause.places else _at(clause)
    if place.target and place.target.noun == "it" and before:
        place = replace(place, target=before[0])
    amounts = dims.amounts
    grade = next((a.value for a in amounts if a.unit == "%"), None)
    metres = next((a.value for a in amounts if a.unit == "m" and a.noun != "radius"), None)
    way = thing.way or dims.way()
    side: Any = thing.side or dims.side()
    if grade is not None and way == "down":
        grade = -abs(grade)
    length = metres if thing.noun == "straight" else None
    if thing.noun == "straight" and length is None:
        length = {"long": LONG, "short": SHORT}.get(thing.size or "")
    adjective = thing.sharpness or next((n for n in ADJECTIVES if n in clause.names), None)
    return Change(
        "add",
        target=Target(thing.noun, indefinite=True, words=thing.words),
        side=side,
        kind=thing.kind,
        sharpness=adjective,
        count=thing.count or 1,
        way=way,
        place=place,
        degrees=thing.degrees or next((a.value for a in amounts if a.unit == "deg"), None),
        radius=next((a.value for a in amounts if a.unit in ("m", "") and a.noun == "radius"), None),
        length=length,
        grade=grade,
        words=clause.words,
    )


def _at(clause: Clause) -> Place:
    """Where it is to be added: also 'to the start', which reads like a target."""
    for target in clause.targets:
        if target.noun in ("start", "end"):
            return Place(cast(Any, target.noun))
    return Place("end")


def _on(target: Target | None, change: Change, found: Sequence[Change], clause: Clause) -> Change | None:
    """The change for one target; where none was named, for what such changes are usually meant."""
    if target is not None and target.is_bare and target.side and all(c.what == "side" for c in found):
        change = replace(change, side=target.side)  # 'the second turn left and the third right'
        target = replace(target, side=None)
    if change.what == "side" and change.side and target is not None and _is_filter(found, clause):
        return None
    if target is not None and _is_filter(found, clause) and target.noun in ("turn", None):
        side = next((c.side for c in found if c.what == "side"), None)
        target = replace(target, side=target.side or side)
    if target is None:
        is_of_turns = change.what in ("angle", "radius", "shape", "side")
        target = Target("turn" if is_of_turns else "road", every=True, words="every turn")
        if change.what == "side" and change.side is None:
            return Change("mirror", words=change.words)
    if target.noun == "road" and change.what in ("angle", "radius", "shape"):
        target = replace(target, noun="turn", every=True)
    if target.noun == "road" and change.what == "side" and target.place is None:
        return Change("mirror", words=change.words)
    return replace(change, target=target)


def _is_filter(found: Sequence[Change], clause: Clause) -> bool:
    """'Le virage à gauche plus serré': the side says which turn, as something else is to be changed."""
    abroad = any(x.name in ("left", "right") and set(x.text.lower().split()) & ABROAD for x in clause.row)
    return abroad and any(c.what != "side" for c in found)


class _Dimensions:
    """What a clause says of angle, radius, length, slope and side."""

    def __init__(self, clause: Clause) -> None:
        self.clause, self.row, self.names = clause, clause.row, clause.names
        self.amounts = [self._amount(i) for i, x in enumerate(self.row) if x.name == "#"]
        self.dose = SLIGHTLY if "slightly" in self.names else MUCH if "much" in self.names else 1.0

    def _amount(self, at: int) -> Amount:
        lexeme = self.row[at]
        before = next((x.name for x in reversed(self.row[max(at - 2, 0) : at]) if x.name in PREPOSITIONS), "")
        next_to = self.row[at - 1] if at else None
        if next_to is not None and next_to.name == "a" and not before:
            before = "to"  # 'à 50 m'
        if next_to is not None and next_to.text.lower() in FROM_ABROAD:
            before = "by"  # 'rallonge de 15 m'
        around = [*reversed(self.row[max(at - NEAR, 0) : at]), *self.row[at + 1 : at + 2]]
        nouns = {"radius": "radius", "angle_noun": "angle", "length_noun": "length", "slope_noun": "slope"}
        noun = next((nouns[x.name] for x in around if x.name in nouns), "")
        after = self.row[at + 1].name if at + 1 < len(self.row) else ""
        comparatives = (
            "sharper",
            "gentler",
            "tighter",
            "wider",
            "longer",
            "shorter",
            "steeper",
            "flatter",
            "more",
            "less",
        )
        return Amount(lexeme.value, lexeme.unit, before, noun, after in comparatives and before != "to")

    def has(self, *names: str) -> bool:
        """Is one of these words there?"""
        return any(name in self.names for name in names)

    def changes(self) -> list[Change]:
        """All of them."""
        out = [self._angle(), self._radius(), self._length(), self._slope(), self._side(), self._shape()]
        words = self.clause.words
        return [replace(change, words=words, dose=self.dose) for change in out if change is not None]

    def way(self) -> Way | None:
        """Up, down or flat, where one of these words is there."""
        return next((way for way in WAYS if way in self.names), None)

    def side(self) -> Side | None:
        """Left or right, where one of these words is there."""
        return next((side for side in SIDES if side in self.names), None)

    def _more(self, up: tuple[str, ...], down: tuple[str, ...], noun: str) -> int:
        if self.has(*up):
            return 1
        if self.has(*down):
            return -1
        if self.has(noun) or not noun:
            return self.has("more") - self.has("less")
        return 0

    def _take(self, units: tuple[str, ...], noun: str) -> Amount | None:
        return next((a for a in self.amounts if a.unit in units and a.noun in (noun, "")), None)

    def _valued(self, change: Change, amount: Amount | None) -> Change:
        """With the amount as 'by', 'to' or 'times'."""
        if amount is None:
            return change
        if amount.unit == "times":
            times = amount.value
            if change.more < 0 and times > 1:
                times = 1 / times
            return replace(change, times=times, more=0)
        if amount.unit == "%" and change.what != "slope":
            sign = -1 if change.more < 0 else 1
            return replace(change, times=max(1 + sign * amount.value / 100, 0.05), more=0)
        is_step = amount.preposition in ("by", "") or amount.is_before_comparative
        if is_step and change.more:
            return replace(change, by=amount.value)
        return replace(change, to=amount.value)

    def _angle(self) -> Change | None:
        more = self._more(("sharper",), ("gentler",), "angle_noun")
        if not more and any(a.unit == "deg" for a in self.amounts):
            more = self.has("more") - self.has("less")  # '30 degrees more'
        tight = self.has("tighter") - self.has("wider")
        amount = self._take(("deg",), "angle")
        is_angular = self.has("sharper", "gentler", "angle_noun")
        if amount is None and is_angular and not self._take(("m",), "radius"):
            amount = self._take(("times", "%", ""), "angle") if not self._is_slope() else None
        if amount is None and self.has("sharp", "gentle") and any(a.unit == "times" for a in self.amounts):
            amount = self._take(("times",), "angle")
            if amount and self.has("gentle"):
                amount = replace(amount, value=1 / amount.value)
        if amount is None and (not more or self._take(("m",), "radius")):
            return None
        return self._valued(Change("angle", more=more or tight), amount)

    def _radius(self) -> Change | None:
        more = self._more(("wider",), ("tighter",), "radius")
        if not (more or self.has("radius")) and not (
            self.has("sharper", "gentler") and self._take(("m",), "radius")
        ):
            return None
        if self._take(("deg",), "angle") and not self.has("radius"):
            return None  # 'tighter by 20 degrees' is said of the angle
        amount = (
            self._take(("m", "times", "%", ""), "radius")
            if not self._is_slope()
            else self._take(("m",), "radius")
        )
        if self.has("tighter", "wider") and amount and amount.noun == "" and amount.unit == "times":
            amount = replace(amount, value=amount.value if more > 0 else 1 / amount.value)
            return replace(Change("radius"), times=amount.value)
        if not more and amount is None:
            return None
        return self._valued(Change("radius", more=more), amount)

    def _length(self) -> Change | None:
        more = self._more(("longer",), ("shorter",), "length_noun")
        is_said = more or self.has("long", "short", "length_noun")
        others = self.has(*OF_ANGLES, "sharp", "gentle", "steep", "steeper", "flatter", "slope_noun")
        units = ("m",) if self._is_slope() else ("m", "times", "%", "")
        amount = self._take(units if is_said else ("m", "times") if not others else (), "length")
        if not is_said and amount is None:
            return None
        if amount is None and not more:
            if self.has("length_noun"):
                return None
            return Change("length", to=LONG if self.has("long") else SHORT)
        return self._valued(Change("length", more=more), amount)

    def _is_slope(self) -> bool:
        return self.has("steeper", "flatter", "slope_noun", "up", "down", "flat", "steep")

    def _slope(self) -> Change | None:
        more, way = self._more(("steeper",), ("flatter",), "slope_noun"), self.way()
        if self.has("more", "less") and way in ("up", "down"):
            more = self.has("more") - self.has("less")
        if self.has("less") and self.has("steep"):
            more = -1
        is_said = self._is_slope()
        lengths = self.has(*OF_LENGTHS, *OF_ANGLES)
        units = ("%", "times", "") if is_said and not lengths else ("%",)
        amount = self._take(units, "slope") if is_said or not lengths else None
        if not is_said and amount is None:
            return None
        if amount and amount.value < 0:
            way, amount = "down", replace(amount, value=-amount.value)
        change = Change("slope", more=more, way=way)
        if amount is None:
            if way in ("up", "down") and not more and self.has("steep", "gently"):
                return replace(change, to=STEEPLY if self.has("steep") else GENTLY)
            return change
        if amount.unit == "%" and more and amount.value >= A_FACTOR and amount.preposition != "to":
            return replace(change, times=max(1 + more * amount.value / 100, 0.0), more=0)
        return self._valued(change, amount)

    def _side(self) -> Change | None:
        if self.has("swap", "mirror", "side_noun") and not self.has("left", "right"):
            return Change("side") if self.has("swap", "mirror") else None
        side = self.side() or next((t.side for t in self.clause.new if t.side), None)
        return Change("side", side=side) if side else None

    def _shape(self) -> Change | None:
        new = self.clause.new[0] if self.clause.new else None
        times = any(a.unit == "times" for a in self.amounts)
        adjective = next((n for n in ADJECTIVES if n in self.names and not times), None)
        adjective = (new.sharpness if new else None) or adjective
        kind = new.kind if new else None
        if self.has("less", "more") and adjective:
            more = (1 if self.has("more") else -1) * (1 if adjective == "sharp" else -1)
            return Change("angle", more=more)
        if new and new.degrees:
            return Change("angle", to=new.degrees)
        if kind is None and adjective is None:
            return None
        return Change("shape", kind=kind, sharpness=adjective)
