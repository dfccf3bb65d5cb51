"""Takes phrases one after another, and makes the Brief."""

from collections.abc import Sequence
from dataclasses import replace

from roadgpt.brief.grammar.finish import finish
from roadgpt.brief.grammar.phrases import ROAD_LIKE, STRAIGHT, WAVY, Phrase
from roadgpt.brief.grammar.quantities import Item
from roadgpt.brief.grammar.scope import negate, select, take_some
from roadgpt.brief.grammar.slopes import slope_of
from roadgpt.brief.grammar.units import Units, default_count, overlay, plural, turns
from roadgpt.brief.model import Amount, Brief, at_least, at_most, exactly
from roadgpt.brief.words import HILLS, MOUNTAIN, ROAD_SIZES, SLOPES, Range
from roadgpt.errors import BriefError

SCOPED = ("with", "into", "for")


def promises(found: Sequence[Phrase]) -> tuple[Brief, list[Item]]:
    """The Brief that the phrases make, and the items that had no place in it.

    Raises:
        BriefError: a full circle, or more things than any map holds.
    """
    builder = _Builder(found)
    for at, phrase in enumerate(found):
        builder.take(at, phrase)
    return finish(builder.units, builder.road_said), builder.left_over


class _Builder:
    def __init__(self, found: Sequence[Phrase]) -> None:
        self.found = found
        self.units = Units()
        self.road_said = False
        self.left_over = list[Item]()
        self.before: Phrase | None = None

    def take(self, at: int, phrase: Phrase) -> None:
        after = self.found[at + 1] if at + 1 < len(self.found) else None
        self.left_over += phrase.ignored
        default_count(phrase)
        self._flags(phrase)
        if not self._take(phrase, after):
            self.left_over += [item for item in phrase.items if item.name not in _UNCOUNTED]
        self.before = phrase

    def _take(self, phrase: Phrase, after: Phrase | None) -> bool:
        """Finds the phrase its place; False where it has none."""
        if phrase.negated:
            return negate(self.units, phrase)
        if phrase.only and phrase.side:
            setattr(self.units.wishes, "right" if phrase.side == "left" else "left", exactly(0))
            if phrase.count in (None, at_least(2)) and self.units.last_turn is None:
                return True
        if _is_pick(phrase) and after and after.joint == "" and (after.kind or after.article):
            after.pick, after.kind = phrase.pick, after.kind or phrase.kind  # 'the last turn is | a hairpin'
            return True
        if phrase.of_them:
            return take_some(self.units, phrase)
        if phrase.pick is not None or phrase.scope:
            return select(self.units, phrase, after)
        if phrase.total and phrase.count and (phrase.kind in (None, "turn")):
            return self._total(phrase)
        if phrase.road and not self._road(phrase):
            return True
        if phrase.kind is not None or phrase.side is not None:
            self._thing(phrase, after)
            return True
        if phrase.both_sides:
            return self._both_sides(phrase)
        if phrase.slope:
            return self._slope(phrase, after)
        return self._modifiers(phrase, after)

    def _flags(self, phrase: Phrase) -> None:
        wishes = self.units.wishes
        if phrase.loop and not phrase.negated:
            raise BriefError(
                "a full circle would cross itself; ask for a U-turn of at most 210 degrees instead"
            )
        wishes.hard |= phrase.hard and not phrase.negated
        if phrase.hilly and not phrase.negated:
            wishes.hills = wishes.hills or at_least(HILLS)
        if phrase.changes and not phrase.negated:
            wishes.hills, phrase.count = phrase.count or at_least(1), None
        if phrase.mountain and not phrase.negated:
            wishes.steepest = wishes.steepest or at_least(MOUNTAIN.lo)
        if phrase.highway:
            wishes.sharpness = wishes.sharpness or "sweeping"
        if phrase.highest and phrase.incline:
            wishes.steepest, phrase.incline = phrase.incline, None
        elif phrase.steep and not phrase.slope and not phrase.negated and not phrase.slope_noun:
            wishes.steepest = wishes.steepest or at_least((SLOPES["steeply_up"].grade or Range(8)).lo)
        if phrase.height is not None:
            self._climb(phrase, phrase.height)

    def _climb(self, phrase: Phrase, height: Amount) -> None:
        down = phrase.height_said == "loss" or phrase.slope == "down"
        ends = (height.lo, height.hi) if not down else (_minus(height.hi), _minus(height.lo))
        self.units.wishes.climb = Amount(lo=ends[0], hi=ends[1])

    def _total(self, phrase: Phrase) -> bool:
        wishes = self.units.wishes
        if phrase.side == "left":
            wishes.left = phrase.count
        elif phrase.side == "right":
            wishes.right = phrase.count
        else:
            wishes.turns = phrase.count
        return True

    def _road(self, phrase: Phrase) -> bool:
        """What was said of the road itself; True where it is also a thing, as 'a winding road' is."""
        self.road_said = True
        wishes = self.units.wishes
        if phrase.length is not None and (not wishes.length):
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
        if phrase.slope and not phrase.after_road:
            wishes.slope, wishes.incline = slope_of(phrase), phrase.incline
            phrase.slope = ""
        elif phrase.slope and phrase.kind is None:
            self.units.things.append(phrase)
        if phrase.kind is None:
            return False
        if phrase.kind == "turn" and phrase.count is None:
            phrase.count = at_least(1)
        return True

    def _thing(self, phrase: Phrase, after: Phrase | None) -> None:
        if phrase.total and phrase.length and phrase.kind in WAVY:
            self.units.wishes.length, phrase.length = phrase.length, None
        if not phrase.slope and phrase.kind in STRAIGHT and (phrase.incline or phrase.slope_noun):
            phrase.slope = "up"
        if phrase.whole and phrase.slope:
            self._whole_slope(phrase)
        if phrase.spiral:
            phrase.count = phrase.count or at_least(3)
            phrase.side = phrase.side or "left"
        if self._fills_in(phrase):
            return
        self.units.add(phrase, leading=phrase.fresh and after is not None)

    def _fills_in(self, phrase: Phrase) -> bool:
        """'turns: all left', 'number of turns: 5', 'then another': more about the thing before."""
        last = self.units.last_turn
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

    def _both_sides(self, phrase: Phrase) -> bool:
        last, wishes = self.units.last_turn, self.units.wishes
        if (last is not None and (last.alternating or phrase.alternating)) or (last is not None and self.before is not None and self.before.alternating):
            last.alternating = True
        elif phrase.alternating or (self.before is not None and self.before.alternating):
            wishes.alternating = True
        else:
            wishes.left, wishes.right = wishes.left or at_least(1), wishes.right or at_least(1)
        return True

    def _slope(self, phrase: Phrase, after: Phrase | None) -> bool:
        if phrase.whole and not phrase.stretch:
            self._whole_slope(phrase)
            return True
        scoped = after is not None and after.joint in SCOPED and turns(after)
        last = self.units.last
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
        if not scoped and (phrase.stretch or phrase.length or phrase.size) and not phrase.whole:
            phrase.kind = "straight"
            self.units.add(phrase, leading=False)
            return True
        self.units.things.append(phrase)
        return True

    def _whole_slope(self, phrase: Phrase) -> None:
        wishes = self.units.wishes
        wishes.slope, wishes.incline = slope_of(phrase), phrase.incline or wishes.incline
        phrase.slope, phrase.incline = "", None

    def _modifiers(self, phrase: Phrase, after: Phrase | None) -> bool:
        """A phrase that names no thing: it tells more about the one before, or about the road."""
        last, turn, wishes = self.units.last, self.units.last_turn, self.units.wishes
        used = phrase.height is not None or phrase.hilly or phrase.mountain or phrase.hard or phrase.highest or phrase.changes
        if phrase.length is not None:
            used |= self._length(phrase, after)
        if phrase.incline is not None or phrase.slope_noun:
            used |= self._incline(phrase)
        on_turn = turn is not None and (self.before is turn or phrase.joint in ("with", "", "(", ","))
        for name in ("degrees", "radius", "sharpness"):
            value = getattr(phrase, name)
            if value is not None:
                target = turn if on_turn and turn is not None else wishes
                setattr(target, name, getattr(target, name) or value)
                used = True
        if phrase.alternating:
            used = True
            if turn is not None and plural(turn):
                turn.alternating = True
            else:
                wishes.alternating = True
        if phrase.size and last is not None and last.kind in STRAIGHT and last.size is None:
            last.size, used = phrase.size, True
        if phrase.count and turn is not None and turn.many and turn.count == at_least(2):
            turn.count, used = phrase.count, True
        if (phrase.times or phrase.repeat) and self.units.things:
            self._repeat(phrase)
            used = True
        if phrase.again and last is not None and last.kind and phrase.joint in ("then", "and"):
            self.units.things.append(replace(last, joint="then", count=phrase.count))
            used = True
        return used or phrase.steep or phrase.only or not (phrase.count or phrase.length or phrase.degrees)

    def _length(self, phrase: Phrase, after: Phrase | None) -> bool:
        last, wishes = self.units.last, self.units.wishes
        leads = phrase.joint in ("after", "then") or (
            phrase.fresh and after is not None and after.joint == "then"
        )
        if leads and not phrase.length_said:
            self.units.things.append(replace(phrase, kind="straight", joint="then"))
            return True
        on_thing = last is not None and last is self.before and not phrase.total and last.length is None
        if on_thing and last is not None and (last.kind in STRAIGHT or (last.kind is None and last.slope)):
            if not (last.kind is None and last.after_road and phrase.length_said):
                last.length = phrase.length
                return True
        if wishes.length is None:
            wishes.length = phrase.length
            return True
        return False

    def _incline(self, phrase: Phrase) -> bool:
        last, wishes = self.units.last, self.units.wishes
        if last is not None and self.before is last:
            last.incline = last.incline or phrase.incline
            last.slope = last.slope or ("" if wishes.slope else "up")
            last.steep |= phrase.steep
            last.mild |= phrase.mild
        else:
            wishes.incline = wishes.incline or phrase.incline
            phrase.slope = "up"
            wishes.slope = wishes.slope or slope_of(phrase)
        return True

    def _repeat(self, phrase: Phrase) -> None:
        times = phrase.times or phrase.count or exactly(2)
        number = int(times.lo or times.hi or 2)
        if number * len(self.units.things) > 100:
            raise BriefError("so many repetitions fit on no map; ask for fewer")
        last = self.units.last
        if len(self.units.things) == 1 and last is not None and last.count is None and turns(last):
            last.count = exactly(number)
            return
        once = list(self.units.things)
        for _ in range(number - 1):
            self.units.things += [replace(thing, joint="then") for thing in once]


def _is_pick(phrase: Phrase) -> bool:
    """'the last turn', with nothing said about it yet."""
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


def _minus(number: float | None) -> float | None:
    return None if number is None else -number


_UNCOUNTED = frozenset(
    {"a", "stretch", "again", "all", "each", "both", "whole", "total", "only", "too", "place"}
)
__all__ = ["ROAD_LIKE", "promises"]
