"""Defines the steps of an edit, and lists ways to change grades and to add or remove turns and straights.

A step sets the desired values of elements, and stores in ``RoadElement.asked`` the ranges in which the
measured values must lie. ``fit`` then adjusts the elements that have a requirement, if the road would
violate a rule, or if measured values lie outside these ranges."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import accumulate, product
from math import inf, radians
from typing import Literal, NamedTuple, Protocol

import numpy as np

from roadgpt.brief.change.request import HILLS, Change, Steepness, Way
from roadgpt.brief.model import OTHER_SIDE, Side
from roadgpt.brief.outline import Feature, both
from roadgpt.brief.ranges import Range
from roadgpt.brief.words import KINDS, PERCENT_SLACK, SHARPNESS, SLOPES
from roadgpt.check.measures import RoadMeasures, way
from roadgpt.design.elements import straight, turn_segments
from roadgpt.errors import EditError, UsageError
from roadgpt.road import Segment, World
from roadgpt.road.design import MAX_TURN
from roadgpt_edit.places import LEAST_FOR_HILL, PlacedChange, RoadStretch, pieces, too_short_for_hill, within
from roadgpt_edit.road_elements import (
    FREE_STRAIGHT,
    MILLIMETRE,
    RoadElement,
    RoadElements,
    gap,
    joined,
    with_inclines,
    with_stations,
)

SEPARATE = 18.0  # m between turns to the same side, so that they are seen as two
HIDDEN = 9.0  # m between turns to the same side at which they are measured as two, without a straight
WIDEST = 250.0  # m: a turn of a larger radius is hardly seen as one
OFF_STEEPEST = 0.2  # percentage points from a new incline to the steepest that the rules allow
CLEARLY, FURTHER = 0.45, 1.6  # least and greatest accepted share of a change without a number ('sharper')


class EditStep(Protocol):
    """One change to the elements of a road."""

    def apply(self, elements: RoadElements, world: World) -> RoadElements:
        """Returns the elements after the change."""
        ...


EditCandidate = tuple[EditStep, ...]
"""Steps that together make one change."""


class Wanted(NamedTuple):
    """A value to aim at, and the range in which the measured value may lie."""

    aim: float
    room: Range

    def nearer_to(self, now: float) -> "Wanted":
        """Returns the same range with a new aim: halfway between the old aim and the value in the range that
        is nearest to ``now``."""
        return Wanted((self.aim + min(max(now, self.room.lo), self.room.hi)) / 2, self.room)

    @classmethod
    def near(cls, aim: float, slack: float) -> "Wanted":
        """Returns a value to aim at, with a tolerance of ``slack`` in both directions."""
        return cls(aim, Range(aim - slack, aim + slack))

    @classmethod
    def towards(cls, now: float, aim: float) -> "Wanted":
        """Returns ``aim`` with a range from 0.45 to 1.6 times the change from ``now`` to ``aim``."""
        ends = now + CLEARLY * (aim - now), now + FURTHER * (aim - now)
        return cls(aim, Range(min(ends), max(ends)))

    @classmethod
    def not_away(cls, now: float, aim: float) -> "Wanted":
        """Returns ``aim`` with a range from no change to 1.6 times the change from ``now`` to ``aim``."""
        ends = now, now + FURTHER * (aim - now)
        return cls(aim, Range(0.99 * min(ends), 1.01 * max(ends)))


@dataclass(frozen=True, slots=True)
class Adjust:
    """Gives one element new values. The ranges of these values become the requirement of the element. A field
    that is None leaves its value unchanged."""

    element: RoadElement
    degrees: Wanted | None = None
    radius: Wanted | None = None
    length: Wanted | None = None
    grade: Wanted | None = None  # the mean grade in percent

    def milder(self) -> "Adjust":
        """Returns the same step with aims nearer to the present measurements of the element. The aim of the
        grade and all ranges stay the same."""
        seen = self.element.seen
        if seen is None:
            return self
        return replace(
            self,
            degrees=self.degrees and self.degrees.nearer_to(seen.degrees),
            radius=self.radius and self.radius.nearer_to(seen.radius),
            length=self.length and self.length.nearer_to(seen.length),
        )

    def apply(self, elements: RoadElements, world: World) -> RoadElements:
        """Returns the elements, with new values for ``self.element``."""
        name = self.element.name
        return tuple(self._applied(each, world) if each.name == name else each for each in elements)

    def _applied(self, now: RoadElement, world: World) -> RoadElement:
        if self.element.is_turn and not self.element.degrees:  # a spline bends before and behind its turns
            raise UsageError(f"{self.element.name} is made by no segment of the road, but by its spline")
        if now.is_turn != self.element.is_turn:
            raise UsageError(f"{self.element.name} is to go and to be changed at once")
        if self.grade:
            now = now.with_grade(self.grade.aim, 100 * world.limits.max_grade - OFF_STEEPEST)
        if self.element.is_turn:
            now = self._bent(now)
        elif self.length:
            seen = self.element.seen
            more = self.length.aim - (seen.length if seen else self.element.length)
            now = now.lengthened(self.element.length + more - now.length)
        wanted = (self.degrees, self.radius, self.length, self.grade)
        degrees, radius, length, grade = (each and each.room for each in wanted)
        kind: Literal["turn", "straight"] = "turn" if self.element.is_turn else "straight"
        asked = Feature(kind, kind, None, degrees, radius, length, grade)
        return replace(now, asked=both(now.asked, asked) if now.asked else asked)

    def _bent(self, now: RoadElement) -> RoadElement:
        """Returns the turn with scaled angles, lengths and radii, split into more segments if one would turn
        by more than 70 degrees."""
        before, seen = self.element, self.element.seen
        assert seen is not None
        turn = abs(now.degrees)
        more = (abs(before.degrees) + self.degrees.aim - seen.degrees) / turn if self.degrees else 1.0
        already = (now.length / turn) / (before.length / abs(before.degrees))  # by another change
        wide = self.radius.aim / seen.radius if self.radius else already
        if self.length:
            wide *= self.length.aim / seen.length
        wider = wide / already
        if abs(more - 1) < 1e-9 and abs(wider - 1) < 1e-9:
            return now
        most = max((abs(s.turn_degrees) for s in now.segments), default=0.0)
        if most * more > MAX_TURN >= most:
            return now.rewritten(turn * more, seen.radius * wide)
        return now.scaled(more, wider)


@dataclass(frozen=True, slots=True)
class RoadLength:
    """Requires the length of the whole road, in metres, to lie in a range; other steps decide which elements
    may change for this."""

    room: Range

    def apply(self, elements: RoadElements, world: World) -> RoadElements:
        """Returns the elements unchanged."""
        return elements


@dataclass(frozen=True, slots=True)
class Mirror:
    """Mirrors some elements, or the whole road."""

    names: frozenset[str] | None = None  # names of the elements to mirror; None for all elements

    def apply(self, elements: RoadElements, world: World) -> RoadElements:
        """Returns the elements, with the named ones mirrored."""
        return tuple(e.mirrored() if self.names is None or e.name in self.names else e for e in elements)


@dataclass(frozen=True, slots=True)
class Become:
    """Replaces an element by a gap (an element that is no turn) with these segments; without segments,
    removes the element."""

    element: RoadElement
    segments: Sequence[Segment] = ()

    def apply(self, elements: RoadElements, world: World) -> RoadElements:
        """Returns the elements with a gap in place of ``self.element``."""
        gap = replace(self.element, side=None, seen=None, segments=tuple(self.segments), asked=FREE_STRAIGHT)
        return tuple(gap if element.name == gap.name else element for element in elements)


STEEPER, FLATTER = 1.5, 0.5  # shares of a grade
STEEPER_BY = 2.0  # percentage points that 'steeper' adds at least
LEVEL, CLEARLY_LEVEL = 1.0, 0.8  # percent
STEEP_FROM = 4.0  # percent: the grade to which 'steeper' changes a level place
LONGEST_HALF = 60.0  # m, from the beginning of a crest or a dip to its middle
HILL_GRADES = (5.0, 3.5)  # percent of both slopes; the second value is tried if the first cannot be built


class SlopeAim(NamedTuple):
    """The grade in percent at which a new slope aims, and the ranges in which it may lie."""

    grade: float
    room: Range
    wide_room: Range
    least: tuple[float, float]
    """Two least grades for the segments of a longer stretch; the second is tried if the first fails."""
    most: float


AIMS: dict[Steepness | None, SlopeAim] = {
    None: SlopeAim(5.0, Range(3.0, 12.0), Range(1.3, 13.0), (4.0, 3.0), 12.0),
    "gently": SlopeAim(3.0, Range(2.0, 5.0), Range(1.3, 5.5), (2.5, 2.0), 4.5),
    "steeply": SlopeAim(9.5, Range(8.0, 15.0), Range(6.5, 15.0), (9.0, 8.0), 14.0),
}
"""Aims of "uphill", "gently uphill" and "steeply uphill", inside the meanings in ``brief.words``."""


@dataclass(frozen=True, slots=True)
class SlopeOfAll:
    """Changes the incline of each segment of several elements; no incline exceeds what the rules allow. The
    size of an incline i becomes |i| * ``times`` + ``more`` percent, limited by ``least`` and ``most``."""

    names: frozenset[str]
    times: float = 1.0
    more: float = 0.0
    least: float = -inf  # lower limit of the size of the new incline
    most: float = inf  # upper limit of the size of the new incline
    sign: int = 0  # 1 for uphill, -1 for downhill, 0 if each segment keeps its sign
    only: Way | None = None
    """The slope that segments must have before the step in order to change; None: all segments change."""
    stretch: RoadStretch | None = None
    """The stretch of the road in which segments change; None for the whole road."""

    def apply(self, elements: RoadElements, world: World) -> RoadElements:
        """Returns the elements with the new inclines."""
        return tuple(
            self._applied(element, at, world) if element.name in self.names else element
            for element, at in with_stations(elements)
        )

    def _applied(self, element: RoadElement, at: float, world: World) -> RoadElement:
        limit = 100 * world.limits.max_grade - OFF_STEEPEST
        segments, changes = element.segments, (True,) * len(element.segments)
        if self.stretch is not None:
            segments, changes = pieces(element, at, self.stretch)
        before = np.array([segment.incline for segment in segments])
        size = np.clip(np.abs(before) * self.times + self.more, self.least, self.most)
        signs = self.sign or np.where(before >= 0, 1, -1)
        after = np.clip(signs * size, -limit, limit) + 0.0  # no -0.0
        is_so = [self.only in (None, way(incline)) for incline in before]
        found = np.where(np.logical_and(changes, is_so), after, before)
        return element.with_segments(with_inclines(segments, found))


def slope_candidates(
    change: Change, elements: Sequence[RoadElement], is_of_parts: bool, world: World
) -> tuple[EditCandidate, ...]:
    """Returns the candidates that change the slopes of many elements at once. If ``is_of_parts``, only
    segments with the slope that the target names (climbing, falling or level) change."""
    is_bounded = bool(change.bound and elements)
    steps = [_bounded(change, elements)] if is_bounded else _slopes(change, elements, world)
    if is_of_parts:
        assert change.target is not None
        only = change.target.way
        own = {"up": 1, "down": -1}.get(only or "") if change.way is None else None
        steps = [replace(step, only=only, sign=own or step.sign) for step in steps]
    return tuple((step,) for step in steps)


def stretch_candidates(
    change: Change, elements: RoadElements, stretch: RoadStretch, world: World
) -> tuple[EditCandidate, ...]:
    """Returns the candidates that change the grades or the climb of one stretch of the road."""
    parts = within(elements, stretch)
    if change.what == "climb":
        steps = [climb_step(change, parts, world)]
    elif change.bound:
        inclines = (segment.incline for element in parts for segment in element.segments)
        is_beyond = any(change.is_outside(abs(incline)) for incline in inclines)
        steps = [_bounded(change, parts)] if is_beyond else []
    else:
        steps = _slopes(change, parts, world)
    return tuple((replace(step, stretch=stretch),) for step in steps)


def _bounded(change: Change, elements: Sequence[RoadElement]) -> SlopeOfAll:
    names, bound = frozenset(element.name for element in elements), change.to or 0.0
    if change.bound < 0:
        return SlopeOfAll(names, least=0, most=bound)
    up = sum(element.incline * element.length for element in elements) >= 0
    return SlopeOfAll(names, least=bound, most=inf, sign=1 if up else -1)


def slope_steps(change: Change, element: RoadElement, found: RoadMeasures, world: World) -> list[EditStep]:
    """Returns alternative steps, each of which gives one turn or straight another grade; none if the element
    already has this grade. Raises EditError if the grade is steeper than the rules allow, or cannot become
    steeper."""
    now = element.seen.grade if element.seen else element.incline
    limit = 100 * world.limits.max_grade
    sign = change.sign or (1 if now >= LEVEL else -1 if now <= -LEVEL else 0)
    sign = sign or (-1 if found.grade <= -LEVEL else 1)
    aim: float | None = None
    if change.to is not None and change.way != "flat":
        aim = sign * change.to
    elif change.by is not None:
        aim = sign * max(abs(now) + (change.more or 1) * change.by, 0.0)
    if aim is not None:
        _refuse_too_steep(abs(aim), limit)
    elif change.times is not None:
        aim = now * change.times
    if aim is not None:
        slacks = 0.5, PERCENT_SLACK
        return _graded(element, 1, aim, *(Range(aim - slack, aim + slack) for slack in slacks))
    if change.way == "flat":
        if abs(now) < CLEARLY_LEVEL and all(abs(s.incline) < LEVEL for s in element.segments):
            return []
        return _graded(element, 1, 0.0, Range(-0.5, 0.5), Range(-CLEARLY_LEVEL, CLEARLY_LEVEL))
    if change.way and not change.more:
        aim_at = AIMS[change.steepness]
        is_so = way(now) == change.way and (not change.steepness or abs(now) in aim_at.room)
        return [] if is_so else _graded(element, sign, aim_at.grade, aim_at.room, aim_at.wide_room)
    if change.more > 0 and change.way and way(now) != change.way:
        return _graded(element, sign, 6.0, Range(3.0, 12.0))
    if change.more < 0:
        room = Range(min(0.1 * now, 0.9 * now), max(0.1 * now, 0.9 * now))
        return [] if abs(now) < LEVEL else _graded(element, 1, FLATTER * now, room)
    steep = max(abs(now) * (1 + (STEEPER - 1) * change.dose), abs(now) + STEEPER_BY * change.dose)
    steep = min(steep if abs(now) >= LEVEL else STEEP_FROM, limit - 0.3)
    if steep <= abs(now) + 0.4:
        raise EditError(f"it is as steep as the rules allow there: {now:.1f} % of {limit:g} %")
    return _graded(element, sign, steep, Range(min(abs(now) + 0.4, steep - 0.2), min(steep + 1.5, limit)))


def _refuse_too_steep(grade: float, limit: float) -> None:
    if grade > limit:
        told = f"{round(grade, 1):g} % is steeper than the {limit:g} % that the rules allow"
        raise EditError(f"{told}; ask for less")


def _graded(element: RoadElement, sign: int, aim: float, *rooms: Range) -> list[EditStep]:
    own = (room if sign > 0 else room.negative for room in rooms)
    return [Adjust(element, grade=Wanted(sign * aim, room)) for room in own]


def _slopes(change: Change, elements: Sequence[RoadElement], world: World) -> list[SlopeOfAll]:
    names = frozenset(element.name for element in elements)
    limit = 100 * world.limits.max_grade
    sign = change.sign
    _refuse_too_steep(change.to or 0.0, limit)
    inclines = [segment.incline for element in elements for segment in element.segments]
    if change.way == "flat" or change.to == 0:
        return [SlopeOfAll(names, least=0, most=0)]
    if change.to is not None:
        falls = sum(element.incline * element.length for element in elements) < 0
        return [SlopeOfAll(names, least=change.to, most=change.to, sign=sign or (-1 if falls else 1))]
    if change.by is not None:
        return [SlopeOfAll(names, more=(change.more or 1) * change.by)]
    if change.times is not None:
        return [SlopeOfAll(names, times=change.times)]
    if sign and not change.more:
        aim_at = AIMS[change.steepness]
        room = aim_at.room if change.steepness else Range(1.5)
        if inclines and all(incline * sign in room for incline in inclines):
            return []
        return [SlopeOfAll(names, least=low, most=aim_at.most, sign=sign) for low in aim_at.least]
    is_level = all(abs(incline) < LEVEL for incline in inclines)
    if change.more < 0:
        return [SlopeOfAll(names, times=times) for times in (FLATTER, 0.75) if not is_level]
    if is_level:
        return [SlopeOfAll(names, least=STEEP_FROM, most=limit, sign=sign or 1)]
    shares = (1 + (times - 1) * change.dose for times in (STEEPER, 1.3, 1.15))
    return [SlopeOfAll(names, times=times) for times in shares]


def climb_step(change: Change, elements: Sequence[RoadElement], world: World) -> SlopeOfAll:
    """Returns the step that changes how many metres some elements climb in total. The grades are scaled if
    all segments already climb (or fall) as required and none becomes too steep. Otherwise the grades become
    equal."""
    length = sum(element.length for element in elements)
    if not length:  # a spline bends before and behind its turns
        raise EditError(f"'{change.words}' names a part that has no length of its own; name another one")
    rises = [segment.incline * segment.distance / 100 for each in elements for segment in each.segments]
    now = sum(rises)
    aim = change.aim(now)
    if change.bound or aim is None:
        raise EditError(f"'{change.words}' gives no climb in metres; write for example: road: climb =5")
    grade = 100 * aim / length
    limit = 100 * world.limits.max_grade - OFF_STEEPEST
    _refuse_too_steep(abs(grade), limit)
    names = frozenset(element.name for element in elements)
    steepest = max(abs(segment.incline) for each in elements for segment in each.segments)
    if aim and all(rise * aim > 0 for rise in rises) and steepest * aim / now <= limit:
        return SlopeOfAll(names, times=aim / now)
    return SlopeOfAll(names, least=abs(grade), most=abs(grade), sign=1 if aim >= 0 else -1)


def hill_candidates(placed: PlacedChange, elements: RoadElements) -> tuple[EditCandidate, ...]:
    """Returns the candidates that put one crest or dip on the straight that a change refers to; the road's
    length and its plan stay the same."""
    (where,) = placed.elements
    if where.length < LEAST_FOR_HILL or any(segment.turn_degrees for segment in where.segments):
        raise EditError(too_short_for_hill(placed.change, f"; there are {where.length:.0f} m"))
    middle, half = _hill_of(placed, elements)
    names, sign = frozenset(element.name for element in placed.elements), HILLS[placed.change.kind or ""]
    sides = (RoadStretch(middle - half, middle), sign), (RoadStretch(middle, middle + half), -sign)
    return tuple(
        tuple(SlopeOfAll(names, least=grade, most=grade, sign=side, stretch=part) for part, side in sides)
        for grade in HILL_GRADES
    )


def hill_sentence(placed: PlacedChange, elements: RoadElements) -> str:
    """Returns a sentence on a new crest or dip, and on where it is."""
    middle, half = _hill_of(placed, elements)
    return f"a {placed.change.kind} of {2 * half:.0f} m is new, its middle at {middle:.0f} m"


def _hill_of(placed: PlacedChange, elements: RoadElements) -> tuple[float, float]:
    """Returns the station of the middle of a new crest or dip, and the metres from its beginning to its
    middle. It lies in the middle of the straight or, if the change asks
    for the middle of the road, as near to that as the straight allows."""
    (where,), place = placed.elements, placed.change.place
    start = sum(element.length for element in elements[: elements.index(where)])
    middle = start + where.length / 2
    if place and place.how == "middle":
        whole = sum(element.length for element in elements)
        middle = min(max(whole / 2, start + LEAST_FOR_HILL / 2), start + where.length - LEAST_FOR_HILL / 2)
    return middle, min(LONGEST_HALF, middle - start, start + where.length - middle)


JOINT = 8.0  # m between turns to opposite sides
LEAD = 17.0  # m before the first turn and behind the last
NEW_STRAIGHT = 40.0  # m, length of a new straight if the request gives none
SPARE = (0.0, 20.0)
"""Additional metres of straight road before and after a new turn; the second value is tried if the first does
not lead to a valid road, for example because the road would meet itself."""
TRANSITION_SHARE = 0.22  # of the arc
PREFERRED = {
    "": (60.0, 25.0),
    "hairpin": (168.0, 18.0),
    "u_turn": (178.0, 18.0),
    "s_bend": (50.0, 25.0),
    "chicane": (45.0, 20.0),
    "sharp": (80.0, 20.0),
    "gentle": (40.0, 55.0),
    "sweeping": (40.0, 75.0),
}
"""Angle in degrees and radius in metres of a new turn if the request does not give them."""
NEW = "new "
"""Prefix of the names of new elements."""
TAIL, STRAIGHT = "tail", "straight"
"""Last words of the names of new elements: a straight behind a new turn, and one that the request adds."""
FADE = 2.0  # m by which a straight between two turns is measured shorter than it is written
MOST_NEW = 12
HALVED = 0  # in place of a number of segments: the longest segment is split in half
FILLERS = (0.0, SEPARATE)  # m of straight road in the place of a removed turn


@dataclass(frozen=True, slots=True)
class Insert:
    """Inserts new elements before the element named ``before``, or at the end if the name is empty."""

    before: str
    elements: RoadElements
    split: int | None = None
    """Number of segments of the element ``before`` that stay in front of the new elements. ``HALVED`` splits
    the longest segment in half; None does not split the element."""

    def apply(self, elements: RoadElements, world: World) -> RoadElements:
        """Returns the elements in driving order, with the new ones inserted."""
        names = [element.name for element in elements]
        at = names.index(self.before) if self.before else len(elements)
        if self.split is None:
            return (*elements[:at], *self.elements, *elements[at:])
        own, count = list(elements[at].segments), self.split
        if count == HALVED:
            longest = max(own, key=lambda segment: segment.distance)
            half = round(longest.distance / 2 * MILLIMETRE) / MILLIMETRE
            rest = round((longest.distance - half) * MILLIMETRE) / MILLIMETRE
            count = own.index(longest) + 1
            own[count - 1 : count] = [longest.model_copy(update={"distance": each}) for each in (half, rest)]
        first = elements[at].with_segments(own[:count])
        second = replace(first, name=f"{first.name} rest", seen=None, segments=tuple(own[count:]))
        return (*elements[:at], first, *self.elements, second, *elements[at + 1 :])


def insertion_candidates(
    placed: PlacedChange, elements: RoadElements, world: World, number: int, sides: Sequence[Side | None]
) -> tuple[EditCandidate, ...]:
    """Returns all candidates that add what a change asks for. ``number`` is that of the change in the
    request; the names of new elements contain it. ``sides`` are the sides of the elements once other changes
    of the request have turned some of them."""
    change = placed.change
    if change.count > MOST_NEW:
        raise EditError(f"{change.count} turns at once are too many to add; add {MOST_NEW} or fewer")
    if change.kind is not None and change.kind not in PREFERRED:
        raise EditError(f"'{change.kind}' cannot be added; add turns or straights in its place")
    at, splits = _place(placed, elements)
    if change.target is not None and change.target.noun == "straight":
        return _straight_ways(change, elements, at, splits, number)
    elements = tuple(e if e.side == side else e.mirrored() for e, side in zip(elements, sides, strict=True))
    shape, incline, name = _shape(change, world), _incline(elements, at), _name(elements, at)
    out = []
    for spare, row, split in product(SPARE, _sides(change, elements[:at]), splits):
        lead, tail = (metres + spare for metres in _missing(elements, at, split, row))
        new = _new_turns(change, shape, row, (lead, tail), incline, number)
        out.append((Insert(name, new, split),))
    return tuple(out)


def _place(placed: PlacedChange, elements: RoadElements) -> tuple[int, list[int | None]]:
    """Returns the index of the element before which to insert, and the ways to split it, as in
    ``Insert.split``; at the end of the road, the index is the number of elements."""
    place, mark, stop = placed.change.place, placed.marks, placed.stop
    how = place.how if place else "end"
    if how == "end":
        return len(elements), [None]
    if how == "start":
        return 0, [None]
    if how == "middle" or place is None or place.target is None:
        at, count = _middle(elements)
        return at, [count]
    if how == "on" and mark[0].is_turn:
        raise EditError("a turn cannot be added within a turn; say: after the second turn")
    if how in ("on", "before"):
        return elements.index(mark[0]), [0 if how == "on" else None]
    at = elements.index(mark[-1])
    if how != "between":
        return at + 1, [None]
    if stop is not None:
        end = elements.index(stop)
        if end < at:
            raise EditError("the two places stand the other way round on the road; name the first one first")
        if end == at:
            raise EditError("between a turn and itself is no place; name two turns")
        is_same = place.other is not None and place.other.words == place.target.words
        if is_same and any(element.is_turn for element in elements[at + 1 : end]):
            raise EditError(f"between '{place.target.words}' are several places; name two turns")
    splits: list[int | None] = []
    for between in elements[at + 1 : at + 2]:
        for count in range(1, len(between.segments)):
            left = sum(segment.distance for segment in between.segments[:count])
            if min(left, between.length - left) >= SEPARATE:
                splits.append(count)
    return at + 1, [*splits[:1], None]


def _middle(elements: RoadElements) -> tuple[int, int]:
    """Returns the index of the gap nearest to the road's middle, and where to split it, as in
    ``Insert.split``."""
    whole, places = sum(element.length for element in elements), list[tuple[float, int, int]]()
    for number, (element, at) in enumerate(with_stations(elements)):
        if not element.is_turn and element.segments:
            joints = accumulate((segment.distance for segment in element.segments[:-1]), initial=at)
            places += [(joint, number, count) for count, joint in enumerate(joints) if count]
            places.append((at + element.length / 2, number, 0))
    _, number, count = min(places, key=lambda place: abs(place[0] - whole / 2), default=(0.0, 0, 0))
    return number, count


def refuse_too_tight(radius: float, said: str, world: World) -> None:
    """Raises EditError if a radius in metres, which is ``said`` so, is tighter than the rules allow."""
    if radius < world.limits.min_radius:
        raise EditError(
            f"a radius of {said} m is tighter than the {world.limits.min_radius:.1f} m that the rules allow; "
            f"ask for {world.limits.design_radius:.0f} m or more"
        )


def _shape(change: Change, world: World) -> tuple[Wanted, Wanted]:
    least = world.limits.design_radius
    if change.radius is not None:
        refuse_too_tight(change.radius, f"{change.radius:g}", world)
    if change.degrees is not None and not 11 <= change.degrees <= 240:
        raise EditError(f"a turn of {change.degrees:g} degrees cannot be added; ask for 15 to 210 degrees")
    word: str = change.sharpness or ""
    meant = SHARPNESS[change.sharpness] if change.sharpness else KINDS["turn"]
    if change.kind:
        word, meant = change.kind, KINDS[change.kind]
    aim, radius = PREFERRED[word]
    angles, radii = meant.degrees or Range(), meant.radius or Range(0, 35.0 if word else 45.0)
    degrees = Wanted(aim, Range(angles.lo + 2, angles.hi - 5))
    if change.degrees is not None:
        degrees = Wanted.near(change.degrees, 1.5)
    radius = max(radius, least)
    if change.radius is not None:
        return degrees, Wanted.near(max(change.radius, least), 0.05 * change.radius)
    room = Range(max(1.03 * radii.lo, 0.98 * least), max(0.97 * radii.hi, radius))
    return degrees, Wanted(radius, room)


def _sides(change: Change, before: RoadElements) -> list[list[Side]]:
    count = change.count * (2 if change.kind in ("s_bend", "chicane") else 1)
    alternates = change.kind in ("s_bend", "chicane") or (count > 1 and change.side is None)
    last: Side = next((element.side for element in reversed(before) if element.side), "right")
    firsts: list[Side] = [change.side] if change.side else [OTHER_SIDE[last], last]
    return [[OTHER_SIDE[side] if alternates and i % 2 else side for i in range(count)] for side in firsts]


def _missing(
    elements: RoadElements, at: int, split: int | None, sides: Sequence[Side]
) -> tuple[float, float]:
    before, turn_before = _behind(elements[:at])
    after, turn_after = _behind(elements[at:][::-1])
    if split is not None:
        own = elements[at]
        first = sum(segment.distance for segment in own.segments[:split]) if split else own.length / 2
        before, after = before + first, after - first
    return _lead(turn_before, sides[0], before), _lead(turn_after, sides[-1], after)


def _new_turns(
    change: Change,
    shape: tuple[Wanted, Wanted],
    sides: Sequence[Side],
    around: tuple[float, float],
    incline: float,
    number: int,
) -> RoadElements:
    (degrees, angles), (radius, radii), (lead, tail) = *shape, around
    grade = SLOPES[change.slope].grade if change.slope else None
    if change.grade is not None:
        grade = Range(change.grade - 0.6, change.grade + 0.6)
    asked = Feature("turn", "turn", None, angles, radii, None, grade)
    transition = min(max(TRANSITION_SHARE * radius * radians(degrees), 3.0), 12.0)
    slope = _incline_asked(change, incline)
    new = [gap(f"{NEW}{number} lead", lead, incline)] if lead else []
    for i, side in enumerate(sides):
        if i:
            new.append(gap(f"{NEW}{number} gap {i}", SEPARATE if side == sides[i - 1] else JOINT, incline))
        segments = turn_segments(degrees, 1 if side == "left" else -1, radius, transition, slope)
        new.append(RoadElement(f"{NEW}{number} turn {i + 1}", segments, side, asked=asked))
    if tail:
        new.append(gap(f"{NEW}{number} {TAIL}", tail, incline))
    return tuple(new)


def without_spare_tail(elements: RoadElements) -> RoadElements:
    """Returns the elements without the straight behind a new turn at the end of the road, if the same request
    adds a straight there; that one is then measured by itself, between the turn and the end."""
    if len(elements) < 2:
        return elements
    *front, tail, last = elements
    if not (tail.name.endswith(f" {TAIL}") and last.name.endswith(f" {STRAIGHT}")):
        return elements
    room = Range(last.length - 2.0, last.length + 2.0)
    alone = replace(last.lengthened(FADE), asked=replace(FREE_STRAIGHT, length=room))
    return (*front, alone)


def _name(elements: RoadElements, at: int) -> str:
    return elements[at].name if at < len(elements) else ""


def _incline_asked(change: Change, incline: float) -> float:
    if change.grade is not None:
        return change.grade
    return change.sign * AIMS[change.steepness].grade if change.way else incline


def _behind(elements: RoadElements) -> tuple[float, RoadElement | None]:
    metres = 0.0
    for element in reversed(elements):
        if element.is_turn:
            return metres, element
        metres += element.length
    return metres, None


def _lead(turn: RoadElement | None, side: Side, gap: float) -> float:
    needed = LEAD if turn is None else SEPARATE if turn.side == side else JOINT
    return round(needed - gap, 1) if gap < needed - 0.5 else 0.0


def _incline(elements: RoadElements, at: int) -> float:
    """Returns the incline in percent of the segment before a place, or after it at the start of the road."""
    before = joined(elements[:at])
    return before[-1].incline if before else joined(elements)[0].incline


def _straight_ways(
    change: Change, elements: RoadElements, at: int, splits: Sequence[int | None], number: int
) -> tuple[EditCandidate, ...]:
    lengths = [change.length] if change.length is not None else [NEW_STRAIGHT, 30.0, 60.0, 22.0]
    if lengths[0] < 10:
        raise EditError(f"a straight of {lengths[0]:g} m is not seen as one; ask for 10 m or more")
    incline = _incline_asked(change, _incline(elements, at))
    beside = elements[at] if at < len(elements) and not elements[at].is_turn else elements[at - 1]
    if change.is_whole and change.length is not None and not beside.is_turn and beside.seen is not None:
        return ((Adjust(beside, length=Wanted.near(change.length, 1.0)),),)
    is_alone = not beside.is_turn and beside.seen is None  # then the new straight is seen by itself
    new = [gap(f"{NEW}{number} {STRAIGHT}", each + (FADE if is_alone else 0.0), incline) for each in lengths]
    for n, length in enumerate(lengths):
        if is_alone:
            new[n] = replace(new[n], asked=replace(FREE_STRAIGHT, length=Range(length - 2.0, length + 2.0)))
        elif change.length is not None:  # then it stays as long as the words say
            new[n] = replace(new[n], asked=None)
    return tuple((Insert(_name(elements, at), (each,), split),) for split in splits for each in new)


def removal_candidates(gone: Sequence[RoadElement], elements: RoadElements) -> tuple[EditCandidate, ...]:
    """Returns all candidates that remove the elements ``gone``; one of them leaves short straights in the
    places of removed turns."""
    if len(gone) == len([b for b in elements if b.segments]):
        raise EditError("then no road would be left; remove fewer")
    return tuple(tuple(_without(element, elements, filler) for element in gone) for filler in FILLERS)


def _without(element: RoadElement, elements: RoadElements, filler: float) -> EditStep:
    at = elements.index(element)
    if not element.is_turn:
        sides = [beside.side for beside in elements[max(at - 1, 0) : at + 2] if beside.is_turn]
        if len(sides) == 2 and sides[0] == sides[1]:
            return Adjust(element, length=Wanted.near(HIDDEN, 0.6))
        return Become(element, tuple(segment for segment in element.segments if segment.turn_degrees))
    return Become(element, (straight(filler, element.incline),) if filler else ())
