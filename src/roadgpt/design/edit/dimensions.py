"""Reads from the words of one clause how angle, radius, length, slope and side change, and by how much."""

from dataclasses import dataclass, replace

from roadgpt.brief.model import Sharpness, Side
from roadgpt.design.edit.clause import RequestClause
from roadgpt.design.edit.request import MUCH, SLIGHTLY, Change, Way
from roadgpt.errors import EditError

PREPOSITIONS = {"by", "to", "at", "of", "with"}
LONG, SHORT = 70.0, 22.0  # m: what a straight is made that is to be long, or short
FROM_ABROAD = {"de", "di"}
A_FACTOR = 15.0  # percent: 'so much steeper' from here on is a share, as no road is that steep
WAYS: tuple[Way, ...] = ("up", "down", "flat")
SIDES: tuple[Side, ...] = ("left", "right")
ADJECTIVES: tuple[Sharpness, ...] = ("sharp", "gentle", "sweeping")
OF_LENGTHS = ("longer", "shorter", "long", "short", "length_noun")
OF_ANGLES = ("radius", "tighter", "wider", "sharper", "gentler", "angle_noun")
STEEPLY, GENTLY = 10.0, 3.5  # percent: inside what brief.words promises
HEIGHTS = {"raise", "lower"}  # metres of it are not of length
NEAR = 3  # words between a number and the noun that it belongs to


@dataclass(frozen=True, slots=True)
class StatedNumber:
    """A number in a request, with its unit and the words around it."""

    value: float
    unit: str
    preposition: str
    noun: str
    is_before_comparative: bool


class Dimensions:
    """Reads what a clause requires of angle, radius, length, slope and side."""

    def __init__(self, clause: RequestClause) -> None:
        self.clause, self.row, self.names = clause, clause.row, clause.names
        self.amounts = [self._amount(i) for i, x in enumerate(self.row) if x.name == "#"]
        self.dose = SLIGHTLY if "slightly" in self.names else MUCH if "much" in self.names else 1.0

    def _amount(self, at: int) -> StatedNumber:
        lexeme = self.row[at]
        before = next((x.name for x in reversed(self.row[max(at - 2, 0) : at]) if x.name in PREPOSITIONS), "")
        next_to = self.row[at - 1] if at else None
        if next_to is not None and next_to.name == "a" and not before:
            before = "to"  # 'à 50 m'
        if next_to is not None and next_to.text.lower() in FROM_ABROAD:
            before = "by"  # 'rallonge de 15 m'
        behind = [x for x in self.row[at + 1 : at + NEAR] if x.name not in ("the", "a")]  # 'half its radius'
        around = [*reversed(self.row[max(at - NEAR, 0) : at]), *behind[:1]]
        nouns = {"radius": "radius", "angle_noun": "angle", "length_noun": "length", "slope_noun": "slope"}
        noun = next((nouns[x.name] for x in around if x.name in nouns), "")
        if next_to is not None and next_to.name in nouns and not before and not self.has("more", "less"):
            before = "to"  # 'tighter, radius 18 m'
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
        return StatedNumber(lexeme.value, lexeme.unit, before, noun, after in comparatives and before != "to")

    def has(self, *names: str) -> bool:
        """Returns whether the clause has a lexeme with one of these names."""
        return any(name in self.names for name in names)

    def changes(self) -> list[Change]:
        """Returns all changes that the clause asks for."""
        out = [self._angle(), self._radius(), self._length(), self._slope(), self._side(), self._shape()]
        words = self.clause.words
        if not any(out):
            out = [self._plain()]
        return [replace(change, words=words, dose=self.dose) for change in out if change is not None]

    def _plain(self) -> Change | None:
        """'Make it 60': metres of a straight, degrees of a turn."""
        nouns = {target.noun for target in self.clause.targets}
        if len(self.amounts) != 1 or self.amounts[0].unit or len(nouns) != 1:
            return None
        noun = nouns.pop()
        if noun not in ("turn", "straight"):
            return None
        return Change("angle" if noun == "turn" else "length", to=self.amounts[0].value)

    def way(self) -> Way | None:
        """Returns up, down or flat, if the clause contains such a word; else None."""
        return next((way for way in WAYS if way in self.names), None)

    def side(self) -> Side | None:
        """Returns left or right, if the clause contains such a word; else None."""
        return next((side for side in SIDES if side in self.names), None)

    def _more(self, up: tuple[str, ...], down: tuple[str, ...], noun: str) -> int:
        if self.has(*up) and self.has(*down):
            raise EditError(f"'{self.clause.words}' asks for more and less at once; put a comma between them")
        if self.has(*up):
            return 1
        if self.has(*down):
            return -1
        if self.has(noun) or not noun:
            return self.has("more") - self.has("less")
        return 0

    def _take(self, units: tuple[str, ...], noun: str) -> StatedNumber | None:
        return next((a for a in self.amounts if a.unit in units and a.noun in (noun, "")), None)

    def _valued(self, change: Change, amount: StatedNumber | None) -> Change:
        """With the amount as 'by', 'to' or 'times'."""
        if amount is None:
            return change
        if self.has("at_most", "at_least") and amount.unit != "times":
            return replace(change, to=amount.value, more=0, bound=-1 if self.has("at_most") else 1)
        if amount.unit == "times":
            times = amount.value
            if change.more < 0 and times > 1:
                times = 1 / times
            if change.more > 0 and times < 1 and amount.preposition == "by":
                times += 1  # 'longer by half'
            if change.more < 0 and amount.value < 1 and amount.preposition == "by":
                times = 1 - amount.value  # 'shorter by a quarter'
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
        tight = self.has("tighter", "longer") - self.has("wider", "shorter")
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
        if self._take(("deg",), "angle") and not self._take(("m",), "length"):
            return None  # 'shrink the second turn to 25 degrees'
        if not more and any(a.unit == "m" and a.noun in ("", "length") for a in self.amounts):
            more = 0 if others else self.has("more") - self.has("less")  # 'reduce the straight by 10 m'
        amount = self._take(units if is_said else ("m", "times") if not others else (), "length")
        if not is_said and amount is None:
            return None
        words = {x.text.lower() for x in self.row}
        if amount and amount.unit == "m" and not is_said and (self.has("up", "down") or words & HEIGHTS):
            raise EditError(f"'{self.clause.words}' asks for metres of height; ask for a slope in percent")
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
        if amount is None and self.has("swap", "mirror") and self.has("slope_noun"):
            return Change("slope", times=-1.0)
        if amount is None:
            if way in ("up", "down") and not more and self.has("steep", "gently"):
                return replace(change, to=STEEPLY if self.has("steep") else GENTLY)
            return change
        if amount.unit == "%" and more and amount.value >= A_FACTOR and amount.preposition != "to":
            return replace(change, times=max(1 + more * amount.value / 100, 0.0), more=0)
        return self._valued(change, amount)

    def _side(self) -> Change | None:
        if self.has("slope_noun") and self.has("swap", "mirror"):
            return None  # 'reverse the slope'
        if self.has("swap", "mirror", "side_noun") and not self.has("left", "right"):
            is_asked = self.has("swap", "mirror", "make")  # 'change the direction of turn 2'
            return Change("side") if is_asked else None
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
