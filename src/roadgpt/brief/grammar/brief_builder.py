"""Builds the Brief from the phrases of a description, in the order of the phrases."""

from collections.abc import Sequence
from dataclasses import replace

from roadgpt.brief.grammar.driving_order import DrivingOrder, default_count, how_many, overlay, plural, turns
from roadgpt.brief.grammar.lowering import lower
from roadgpt.brief.grammar.modifiers import modify
from roadgpt.brief.grammar.phrase import WAVY, Phrase
from roadgpt.brief.grammar.quantities import Term
from roadgpt.brief.grammar.scope import halve, negate, select, take_some
from roadgpt.brief.grammar.slopes import slope_of
from roadgpt.brief.model import OTHER_SIDE, Amount, Brief, at_least, at_most, exactly
from roadgpt.brief.normal import STRAIGHT
from roadgpt.brief.words import HILLS, MOUNTAIN, ROAD_SIZES, SLOPES, Range
from roadgpt.errors import BriefError

SCOPED = ("with", "into", "enter", "for")


def build_brief(found: Sequence[Phrase]) -> tuple[Brief, list[Term]]:
    """Returns the Brief that the phrases describe, and the terms that could not be used in it.

    Raises:
        BriefError: a full circle is asked for, or more features than any map holds.
    """
    builder = _Builder(found)
    for at, phrase in enumerate(found):
        builder.take(at, phrase)
    return lower(builder.order, builder.road_said), builder.left_over


class _Builder:
    def __init__(self, found: Sequence[Phrase]) -> None:
        self.found = found
        self.order = DrivingOrder()
        self.road_said = False
        self.left_over = list[Term]()
        self.before: Phrase | None = None

    def take(self, at: int, phrase: Phrase) -> None:
        after = self.found[at + 1] if at + 1 < len(self.found) else None
        self.left_over += phrase.ignored
        default_count(phrase)
        self._flags(phrase)
        if phrase.pick and phrase.length and not phrase.turning:  # 'the first 100 m are flat'
            phrase.joint, phrase.place = ("start", "") if phrase.pick[0] == 0 else (phrase.joint, "end")
            phrase.pick = None
        if phrase.scope and len(phrase.items) == 1 and after and after.joint == "with" and not after.turning:
            after.scope, after.joint = phrase.scope, ""  # 'all with a radius of 20 m'
        elif not self._take(phrase, after):
            self.left_over += [item for item in phrase.items if item.name not in _UNCOUNTED]
            self.left_over += phrase.exception
        self.before = phrase

    def _take(self, phrase: Phrase, after: Phrase | None) -> bool:
        """Finds the place of a phrase; returns False if it has none."""
        if phrase.exception or (phrase.relative and self.before and self.before.exception):
            return self._except(phrase)
        if phrase.negated:
            return negate(self.order, phrase)
        if phrase.only and phrase.side:
            setattr(self.order.wishes, "right" if phrase.side == "left" else "left", exactly(0))
            if phrase.kind is None or phrase.count in (None, at_least(2)):
                return True
        if _is_pick(phrase) and after and after.joint == "" and (after.kind or after.article):
            after.pick, after.kind = phrase.pick, after.kind or phrase.kind  # 'the last turn is | a hairpin'
            return True
        if phrase.mostly and phrase.side:
            return self._mostly(phrase)
        if phrase.half in (1, 2) and phrase.slope:
            return halve(self.order, phrase)
        if phrase.of_them:
            return take_some(self.order, phrase)
        if phrase.pick is not None or phrase.scope:
            return select(self.order, phrase, after)
        if phrase.total and phrase.count and not phrase.degrees and phrase.kind in (None, "turn"):
            return self._total(phrase)
        if phrase.road and not self._road(phrase, after):
            return True
        if phrase.kind is not None or phrase.side is not None:
            self._thing(phrase, after)
            return True
        if phrase.both_sides:
            return self._both_sides(phrase)
        if phrase.slope:
            return self._slope(phrase, after)
        return modify(self.order, phrase, self.before, after)

    def _flags(self, phrase: Phrase) -> None:
        wishes = self.order.wishes
        if phrase.loop and not phrase.negated:
            raise BriefError(
                "a road that comes back to its start would cross itself; ask for a U-turn instead"
            )
        if phrase.free_turns:
            wishes.turns = at_least(0)
        wishes.hard |= phrase.hard and not phrase.negated
        if phrase.hilly and not phrase.negated:
            if phrase.times or not wishes.hills:
                wishes.hills = at_least(_changes(phrase.times))
            phrase.times = None
        if phrase.climbs_said and not phrase.negated:
            if phrase.mild:
                wishes.steepest = wishes.steepest or at_most((SLOPES["gently_up"].grade or Range(2, 5)).hi)
            else:
                wishes.hills = wishes.hills or at_least(1)
        if phrase.more:
            self._more(phrase.more)
        if phrase.changes and not phrase.negated:
            wishes.hills, phrase.count = phrase.count or at_least(1), None
            self.order.hills_are_counted = True
        if phrase.mountain and not phrase.negated:
            wishes.steepest = wishes.steepest or at_least(MOUNTAIN.lo)
        if phrase.highway:
            wishes.sharpness = wishes.sharpness or "sweeping"
        if phrase.highest and phrase.incline:
            wishes.steepest, phrase.incline = phrase.incline, None
        elif phrase.steep and phrase.incline and not phrase.slope and not phrase.kind and not phrase.road:
            wishes.steepest, phrase.incline, phrase.steep = phrase.incline, None, False  # 'at most 6 % steep'
        elif phrase.steep and not phrase.slope and not phrase.negated and not phrase.slope_noun:
            steep = at_least((SLOPES["steeply_up"].grade or Range(8)).lo)
            mountain = wishes.steepest == at_least(MOUNTAIN.lo)
            wishes.steepest = steep if mountain else wishes.steepest or steep
        if phrase.turned:
            wishes.turning = phrase.turned
        if phrase.height is not None:
            self._climb(phrase, phrase.height)

    def _climb(self, phrase: Phrase, height: Amount) -> None:
        down = phrase.height_said == "loss" or phrase.slope == "down"
        ends = (height.lo, height.hi) if not down else (_minus(height.hi), _minus(height.lo))
        climb, before = Amount(lo=ends[0], hi=ends[1]), self.order.wishes.climb
        if before and before.exact and climb.exact:  # 'gains 10 m, then loses 4 m'
            climb = exactly((before.lo or 0) + (climb.lo or 0))
            if climb == exactly(0):  # the two heights cancel, so nothing is required
                self.left_over += [item for said in self.found for item in said.items if item.name == "m"]
        self.order.wishes.climb = climb

    def _total(self, phrase: Phrase) -> bool:
        wishes, last = self.order.wishes, self.order.last_turn
        if phrase.kind is None and phrase.side is None and last and last.kind == "turn" and _open(last):
            last.count = phrase.count  # 'a left turn every now and then, four in total'
        elif phrase.side == "left":
            wishes.left = phrase.count
        elif phrase.side == "right":
            wishes.right = phrase.count
        else:
            wishes.turns = phrase.count
        return True

    def _more(self, side: str) -> None:
        """Reads 'more left than right turns'; with the same number of both, it is half of the turns, or
        two.
        """
        wishes, last = self.order.wishes, self.order.last_turn
        if side == "same":
            half = exactly(max(how_many(last) // 2, 1) if last and plural(last) else 2)
            wishes.left, wishes.right = half, half
        else:
            number = how_many(last) // 2 + 1 if last else 2
            setattr(wishes, side, at_least(number))
            setattr(wishes, "right" if side == "left" else "left", at_most(number - 1))

    def _mostly(self, phrase: Phrase) -> bool:
        """Reads '5 turns, mostly to the right'."""
        self.order.mostly = phrase.side
        if phrase.kind:
            self.order.add(replace(phrase, side=None), leading=False)
        return True

    def _road(self, phrase: Phrase, after: Phrase | None) -> bool:
        """Reads what was said about the road itself; True if it is also a feature, as 'a winding road' is."""
        self.road_said = True
        wishes = self.order.wishes
        leg = phrase.after_road and phrase.slope and not phrase.length_said  # 'goes up for 100 m'
        if phrase.length is not None and not wishes.length and not leg:
            wishes.length, phrase.length = phrase.length, None
        elif phrase.size and phrase.kind is None:
            size = ROAD_SIZES[phrase.size]
            wishes.length = wishes.length or (
                at_least(size.lo) if phrase.size == "long" else at_most(size.hi)
            )
        if phrase.kind is None:
            wishes.sharpness = phrase.sharpness or wishes.sharpness
            wishes.degrees = phrase.degrees or wishes.degrees
            wishes.radius = phrase.radius or wishes.radius
            wishes.alternating |= phrase.alternating
        if not phrase.slope and (phrase.slope_noun or phrase.incline):
            phrase.slope = "up"
        if phrase.slope and phrase.kind is None and after and after.joint == "then":
            phrase.after_road = True  # 'a flat road, then a climb': its first part
        if phrase.slope and not phrase.after_road:
            wishes.slope, wishes.incline = slope_of(phrase), phrase.incline
            phrase.slope = ""
        elif phrase.slope and phrase.kind is None:
            self.order.things.append(phrase)
        if phrase.kind is None:
            return False
        if phrase.kind == "turn" and phrase.count is None:
            phrase.count = at_least(1)
        return True

    def _thing(self, phrase: Phrase, after: Phrase | None) -> None:
        if phrase.total and phrase.length and phrase.kind in WAVY:
            self.order.wishes.length, phrase.length = phrase.length, None
        if not phrase.slope and phrase.kind in STRAIGHT and (phrase.incline or phrase.slope_noun):
            phrase.slope = "up"
        if phrase.whole and phrase.slope:
            self._whole_slope(phrase)
        if (
            phrase.total and phrase.degrees and phrase.degrees.exact and plural(phrase)
        ):  # 'totalling 360 degrees'
            phrase.degrees = exactly(round((phrase.degrees.lo or 0) / max(how_many(phrase), 1), 2))
        elif phrase.total and phrase.degrees:  # of how many turns, nobody said
            self.left_over += [item for item in phrase.items if item.name in ("deg", "total")]
            phrase.degrees, phrase.count = None, phrase.count or at_least(1)
        if phrase.kind is None and not phrase.counted:  # 'a series of left, right, left'
            phrase.count, phrase.article = None, False
        if phrase.both_sides and not phrase.alternating:
            self._both_sides(phrase)
        if phrase.same_hand:
            phrase.side = phrase.side or "left"
        if phrase.spiral:
            phrase.count = phrase.count or at_least(3)
            phrase.side = phrase.side or "left"
        if self._fills_in(phrase) or self._is_part(phrase):
            return
        if phrase.each_side:
            self.order.add(replace(phrase, side="left"), leading=False)
            phrase = replace(phrase, side="right", joint="and")
        self.order.add(phrase, leading=phrase.fresh and after is not None)

    def _fills_in(self, phrase: Phrase) -> bool:
        """Reads 'turns: all left' and the like, which say more about the feature before."""
        last = self.order.last_turn
        if (
            phrase.kind is None
            and last
            and last.side is None
            and phrase.joint in ("with", "for")
            and not phrase.count
        ):
            overlay(last, phrase)
            return True
        return False

    def _is_part(self, phrase: Phrase) -> bool:
        """Reads '5 turns, at least 3 to the left' as part of the five."""
        last, count = self.order.last_turn, phrase.count
        if phrase.kind or not phrase.side or not count or count.exact or not last or last.side:
            return False
        if phrase.joint == "then" or not plural(last) or (count.lo or 0) > how_many(last):
            return False
        setattr(self.order.wishes, phrase.side, count)
        return True

    def _except(self, phrase: Phrase) -> bool:
        """Reads '5 turns, all left except the third'; False if nothing says what the exception is like."""
        before, turn = self.before, self.order.last_turn
        if not (phrase.exception and before and before.scope == "all" and before.side and turn):
            return False
        if not _is_pick(phrase) or sum(how_many(t) for t in self.order.things if turns(t)) < 2:
            return False
        return select(self.order, replace(phrase, side=OTHER_SIDE[before.side]), None)

    def _both_sides(self, phrase: Phrase) -> bool:
        last, wishes = self.order.last_turn, self.order.wishes
        alternating = phrase.alternating or (self.before is not None and self.before.alternating)
        if last is not None and (last.alternating or alternating):
            last.alternating = True
        elif alternating:
            wishes.alternating = True
        else:
            wishes.left, wishes.right = wishes.left or at_least(1), wishes.right or at_least(1)
        return True

    def _slope(self, phrase: Phrase, after: Phrase | None) -> bool:
        if phrase.whole and not phrase.stretch:
            self._whole_slope(phrase)
            return True
        scoped = after is not None and after.joint in SCOPED and turns(after)
        last = self.order.last
        described = (
            phrase.joint == "with"
            and (phrase.slope_noun or phrase.incline is not None)
            and not phrase.stretch
        )
        if described and last and last.kind and self.before is last and not scoped:
            overlay(last, phrase)
            return True
        if phrase.height is not None and phrase.height_said in ("gain", "loss") and not phrase.climbs:
            return True
        bare = not (phrase.article or phrase.stretch or phrase.length or phrase.climbs or phrase.count)
        if phrase.joint == "and" and bare and last and last is self.before and _takes_a_slope(last):
            overlay(last, phrase)  # 'straight and flat'
            return True
        if not scoped and (phrase.stretch or phrase.length or phrase.size) and not phrase.whole:
            phrase.kind = "straight"
            self.order.add(phrase, leading=False)
            return True
        self.order.things.append(phrase)
        return True

    def _whole_slope(self, phrase: Phrase) -> None:
        wishes = self.order.wishes
        wishes.slope, wishes.incline = slope_of(phrase), phrase.incline or wishes.incline
        phrase.slope, phrase.incline = "", None


def _is_pick(phrase: Phrase) -> bool:
    """True for 'the last turn' with nothing said about it yet."""
    said = (
        phrase.side,
        phrase.sharpness,
        phrase.degrees,
        phrase.radius,
        phrase.slope,
        phrase.incline,
        phrase.length,
    )
    return phrase.pick is not None and not any(said) and phrase.kind in (None, "turn")


def _open(thing: Phrase) -> bool:
    """True if no number was said."""
    return not plural(thing) or (thing.count == at_least(2) and not thing.counted)


def _takes_a_slope(thing: Phrase) -> bool:
    return thing.kind in WAVY | {"straight"} and not thing.slope


def _minus(number: float | None) -> float | None:
    return None if number is None else -number


_UNCOUNTED = frozenset(
    {"a", "stretch", "again", "all", "each", "both", "whole", "total", "only", "too", "place"}
)


def _changes(times: Amount | None) -> float:
    """Returns the changes of slope of a road that goes up and down so many times; the usual number if
    none is said.
    """
    return max(2 * times.lo - 1, 1) if times and times.lo else HILLS
