"""Arranges the phrases of a description as features in driving order, and merges phrases about the same
feature.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

from roadgpt.brief.grammar.phrase import WAVY, Phrase
from roadgpt.brief.model import Amount, Clause, Sharpness, Side, Slope, at_least, exactly
from roadgpt.brief.normal import STRAIGHT
from roadgpt.brief.words import KINDS
from roadgpt.errors import BriefError

MOST = 200
"""The largest count accepted for any feature; no map holds more."""


@dataclass(slots=True)
class RoadWishes:
    """The requirements of a description for the road as a whole; each field means the same as the field of
    that name in Brief.
    """

    turns: Amount | None = None
    left: Amount | None = None
    right: Amount | None = None
    alternating: bool = False
    sharpness: Sharpness | None = None
    degrees: Amount | None = None
    radius: Amount | None = None
    turning: Amount | None = None
    slope: Slope | None = None
    incline: Amount | None = None
    steepest: Amount | None = None
    climb: Amount | None = None
    hills: Amount | None = None
    length: Amount | None = None
    starts: Clause | None = None
    ends: Clause | None = None
    hard: bool = False


@dataclass(slots=True)
class DrivingOrder:
    """The features of a road in driving order.

    A slope that is mentioned without a turn or a straight ('uphill, then ...') is also an entry; its ``kind``
    is None.
    """

    things: list[Phrase] = field(default_factory=list)
    wishes: RoadWishes = field(default_factory=RoadWishes)
    mostly: Side | None = None
    """The direction in 'mostly left turns'; the number of these turns is computed when the whole
    description has been read.
    """
    hills_are_counted: bool = False
    """True if the description gives a number of slopes ('at least 2 changes of slope'), False if it only
    says 'hilly'.
    """
    lists: list[tuple[Phrase, int]] = field(default_factory=list)
    """Groups whose members are listed after them ('three turns: left, right, left'), each with the number of
    features that come before the list.
    """

    @property
    def last(self) -> Phrase | None:
        """The most recently mentioned feature."""
        return self.things[-1] if self.things else None

    @property
    def last_turn(self) -> Phrase | None:
        """The most recently mentioned turn or group of turns."""
        return next((thing for thing in reversed(self.things) if turns(thing)), None)

    def add(self, thing: Phrase, leading: bool) -> None:
        """Inserts a feature at its place in driving order, or merges it with the feature that it refers to.

        Args:
            thing: the feature, with its count if the description gives one.
            leading: True for the X of 'after X, Y', which comes first in the text and on the road.
        """
        if self._joins(thing):
            return
        last = self.last
        if last and last.same_hand and thing.kind is None and thing.side and thing.joint == ",":
            last.side, last.same_hand = thing.side, False  # 'in the same direction, to the right'
            return
        if last and thing.kind is None and thing.side and thing.count is None:
            self._begin_sides(last, thing)
        if (
            last
            and last.kind is None
            and last.side
            and last.count is None
            and thing.many
            and not thing.counted
        ):
            thing.count = None  # 'left, right and left turns' are three
        if self._refers(thing):
            return
        if thing.joint == "after" and not leading and self.things:
            self.things.insert(len(self.things) - 1, thing)
        elif thing.joint == "between" and self._is_flanked(thing):
            self._surround(thing)
        elif (thing.in_between or thing.joint == "between") and thing.kind in STRAIGHT and self.last_turn:
            self._weave(thing, lambda other: turns(other))
        elif thing.joint == "between" and turns(thing) and self.last and self._is_between(thing, self.last):
            self._surround(thing)
        elif self.last and "middle" in (thing.place, self.last.place) and self._in_the_straight(thing):
            return
        elif self.last and self.last.joint == "ahead" and thing.joint in ("", ",", "with"):
            self.things.insert(len(self.things) - 1, thing)
        elif thing.place in ("top", "bottom") and self.things:
            self._insert_at_height(thing)
        elif thing.place == "start" and self.things:
            self.things.insert(0, thing)
        elif thing.place == "middle" and self.things:
            self._insert_in_the_middle(thing)
        else:
            self._note_list(thing)
            self.things.append(thing)

    def _begin_sides(self, heading: Phrase, side: Phrase) -> None:
        """Handles 'turns left, right' and 'turns: left, right', which are two; 'turns' itself is no
        further one.
        """
        if not heading.many or heading.counted:
            return
        if heading.side and side.joint == ",":
            heading.count, heading.many = None, False
        elif side.joint == "colon" and not (heading.side or heading.sharpness or heading.degrees):
            self.things.pop()

    def _is_between(self, thing: Phrase, middle: Phrase) -> bool:
        """True for 'a hairpin between two bends'; but in 'two bends separated by a hairpin' there is one."""
        return middle.kind in STRAIGHT or (turns(middle) and not plural(middle) and how_many(thing) > 1)

    def _is_flanked(self, thing: Phrase) -> bool:
        """True for 'a hairpin between two straights'."""
        alone = len(self.things) == 1 and not plural(self.things[0])
        return alone and thing.kind in STRAIGHT and thing.count == exactly(2)

    def _refers(self, thing: Phrase) -> bool:
        """True for 'with a left turn after the crest', if a crest was named before."""
        if thing.joint != "after" or thing.kind not in ("crest", "dip") or thing.article or thing.count:
            return False
        at = next((i for i, other in enumerate(self.things[:-1]) if other.kind == thing.kind), None)
        if at is not None:
            self.things.insert(at + 1, self.things.pop())
        return at is not None

    def _joins(self, thing: Phrase) -> bool:
        """True if it says more about the feature before rather than name another: 'a serpentine with 6
        turns'.
        """
        last = self.last
        if last is None or not turns(last) or not turns(thing):
            return False
        if thing.joint == "start" and (last.alternating or last.kind in WAVY) and thing.side:
            last.side = thing.side
            return True
        of_it = thing.joint in ("with", "for", "into", "(")
        of_it |= thing.joint == "" and not thing.fresh and thing.count is not None and thing.kind == "turn"
        if of_it and last.count is None and last.kind in WAVY:
            _specify(last, thing)
            return True
        if thing.joint == "with" and last.kind in ("s_bend", "chicane") and thing.kind == "turn":
            _detail(last, thing)
            return True
        if thing.kind in WAVY and thing.count is None and thing.joint in ("", ",") and plural(last):
            last.alternating |= thing.kind != "winding"
            overlay(last, thing)
            return True
        return False

    def _note_list(self, thing: Phrase) -> None:
        last = self.last
        if last is None or last.kind is None or last.side or not turns(last) or not turns(thing):
            return
        spelled = thing.joint in ("colon", "(", "start") or (thing.kind is None and thing.joint in (",", ""))
        if spelled and (plural(last) or last.kind in ("s_bend", "chicane") or thing.kind is None):
            self.lists.append((last, len(self.things)))

    def _weave(self, thing: Phrase, chosen: Callable[[Phrase], bool]) -> None:
        """Puts a feature between every two that are chosen."""
        self.expand()
        woven = list[Phrase]()
        for at, other in enumerate(self.things):
            if at and chosen(other) and chosen(self.things[at - 1]):
                woven.append(replace(thing, joint="then"))
            woven.append(other)
        if len(woven) == len(self.things):
            woven.append(replace(thing, joint="then"))
        self.things = woven

    def _surround(self, thing: Phrase) -> None:
        """Handles 'a straight between two hairpins' and 'two straights joined by a hairpin'."""
        middle = self.things.pop()
        if plural(middle) and not plural(thing):
            self.things += [replace(middle, count=None), replace(thing, joint="then")]
            self.things.append(replace(middle, count=None, joint="then"))
            return
        number = how_many(thing)
        self.things.append(replace(thing, count=exactly(max(number // 2, 1)), joint=middle.joint))
        middle.joint = "then"
        self.things.append(middle)
        if number > 1:
            self.things.append(replace(thing, count=exactly(number - number // 2), joint="then"))

    def _in_the_straight(self, thing: Phrase) -> bool:
        """Handles 'a straight with a chicane in the middle' and 'a chicane in the middle of a straight'."""
        last = self.things[-1]
        middle, straight = (last, thing) if last.place == "middle" else (thing, last)
        if straight.kind != "straight" or not turns(middle) or len(self.things) > 1:
            return False
        half = straight.length
        if half is not None:
            half = Amount(
                lo=None if half.lo is None else half.lo / 2, hi=None if half.hi is None else half.hi / 2
            )
        behind = replace(straight, length=half, joint="then", road=False)
        self.things = [
            replace(straight, length=half, place=""),
            replace(middle, place="", joint="then"),
            behind,
        ]
        return True

    def _insert_at_height(self, thing: Phrase) -> None:
        """Handles 'up and down a hill, with a left turn at the top': it follows the last feature that
        climbs.
        """
        slope = "up" if thing.place == "top" else "down"
        places = [at for at, other in enumerate(self.things) if other.slope == slope]
        at = places[-1] + 1 if places else len(self.things)
        self.things.insert(
            at, replace(thing, joint="then" if at < len(self.things) or places else thing.joint)
        )

    def _insert_in_the_middle(self, thing: Phrase) -> None:
        self.expand()
        self.things.insert(len(self.things) // 2, replace(thing, joint="then"))

    def expand(self) -> None:
        """Splits features with a count into single features: '3 turns' becomes three features of one turn."""
        out = list[Phrase]()
        for thing in self.things:
            if (
                turns(thing)
                and thing.count
                and thing.count.exact
                and how_many(thing) > 1
                and self._can_be_told_apart(thing)
            ):
                first = replace(thing, count=exactly(1), alternating=False)
                first.kind = "turn" if thing.kind in WAVY else thing.kind
                out += [first] + [replace(first, joint="and") for _ in range(how_many(thing) - 1)]
            else:
                out.append(thing)
        self.things = out

    def _can_be_told_apart(self, thing: Phrase) -> bool:
        """True if its turns can be split; alternating ones can if they are all the turns: the road then
        alternates.
        """
        alternates = thing.alternating or (thing.kind is not None and KINDS[thing.kind].alternating)
        if thing.kind in ("s_bend", "chicane") or not alternates:
            return not thing.alternating
        alone = [other for other in self.things if turns(other)] == [thing] and thing.side is None
        self.wishes.alternating |= alone
        return alone


def turns(thing: Phrase) -> bool:
    """Returns True if the phrase is a turn, or only a direction that stands for one, as in 'first left,
    then right'.
    """
    return thing.turning or (thing.kind is None and thing.side is not None)


def plural(thing: Phrase) -> bool:
    """Returns True if the phrase stands for more than one feature."""
    return thing.count is not None and thing.count != exactly(1)


def how_many(thing: Phrase) -> int:
    """Returns the smallest number of features that a phrase allows.

    Raises:
        BriefError: the description asks for more features than any map holds.
    """
    number = thing.count.lo if thing.count and thing.count.lo is not None else 1
    if number > MOST:
        raise BriefError(f"{number:,.0f} of one kind do not fit on any map; ask for {MOST} or fewer")
    return max(int(number), 0)


def default_count(thing: Phrase) -> None:
    """Sets the count that a plural implies if the description gives no number: 'turns' means two or more."""
    if thing.times and thing.times.lo and thing.times.exact:
        lo = how_many(thing) * thing.times.lo
        thing.count = exactly(lo)
    if thing.count == exactly(0) and thing.kind is not None:
        thing.count, thing.negated = None, True
    if thing.count is None and thing.many and thing.kind not in WAVY and thing.kind not in STRAIGHT:
        thing.count, thing.counted = at_least(2), False
    if thing.count and thing.count.lo is not None and thing.count.lo > MOST:
        how_many(thing)


def overlay(under: Phrase, over: Phrase) -> None:
    """Copies values from ``over`` to those fields of ``under`` that are empty."""
    for name in ("side", "sharpness", "size", "degrees", "radius", "length", "incline"):
        if getattr(under, name) is None:
            setattr(under, name, getattr(over, name))
    under.alternating |= over.alternating
    if not under.slope:
        under.slope, under.climbs = over.slope, over.climbs
        under.steep |= over.steep
        under.mild |= over.mild
        under.nearly |= over.nearly
    under.both_sides |= over.both_sides


def _specify(wavy: Phrase, thing: Phrase) -> None:
    """Handles 'a winding road with 5 hairpins' (five hairpins) and 'a serpentine with 6 turns'."""
    own = KINDS[wavy.kind].turns if wavy.kind else None
    if thing.kind not in ("turn", None):
        wavy.alternating |= wavy.kind != "winding"
        wavy.kind = thing.kind
    if thing.count == at_least(2) and not thing.counted and own:  # 'a winding road with hairpins'
        wavy.count = at_least(own.lo) if wavy.kind not in WAVY else None
    elif thing.counted or wavy.kind not in WAVY:
        wavy.count = thing.count
    overlay(wavy, thing)


def _detail(compound: Phrase, thing: Phrase) -> None:
    """Handles 'a chicane with 3 turns' and 'an S-bend with sharp turns'."""
    if thing.count and thing.counted and compound.count is None and (thing.count.lo or 0) > 2:
        compound.kind, compound.count, compound.alternating = "turn", thing.count, True
        compound.sharpness = compound.sharpness or "sharp"
    overlay(compound, thing)
