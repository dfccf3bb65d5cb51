"""Lists ways to change grades: of one turn or straight, of many elements at once, or for a crest or a dip."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf
from typing import NamedTuple

import numpy as np

from roadgpt.brief.change.request import HILLS, Change, Steepness, Way
from roadgpt.brief.ranges import Range
from roadgpt.brief.words import PERCENT_SLACK
from roadgpt.check.measures import Measures, way
from roadgpt.design.edit.places import (
    LEAST_FOR_HILL,
    PlacedChange,
    RoadStretch,
    pieces,
    too_short_for_hill,
    within,
)
from roadgpt.design.edit.steps import OFF_STEEPEST, Adjust, EditCandidate, EditStep, Wanted
from roadgpt.design.road_elements import RoadElement, RoadElements, with_inclines, with_stations
from roadgpt.errors import EditError
from roadgpt.road import World

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
        if self.only is not None:
            changes = tuple(
                there and way(incline) == self.only for there, incline in zip(changes, before, strict=True)
            )
        return element.with_segments(with_inclines(segments, np.where(changes, after, before)))


def slope_candidates(
    change: Change, elements: Sequence[RoadElement], is_of_parts: bool, world: World
) -> tuple[EditCandidate, ...]:
    """Returns the candidates that change the slopes of many elements at once. If ``is_of_parts``, only
    segments with the slope that the target names (climbing, falling or level) change."""
    is_bounded = bool(change.bound and elements)
    steps = [_bounded(change, elements)] if is_bounded else _slopes(change, elements, world)
    if is_of_parts:
        steps = [_only_parts(change, step) for step in steps]
    return tuple((step,) for step in steps)


def _only_parts(change: Change, step: SlopeOfAll) -> SlopeOfAll:
    """Returns the step for segments that climb, fall or are level, as the target says; they continue to do
    so, unless the change names another direction."""
    assert change.target is not None
    sign = step.sign
    if change.way is None and change.target.way != "flat":
        sign = 1 if change.target.way == "up" else -1
    return replace(step, only=change.target.way, sign=sign)


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
    """Returns the edit step that makes every element at most, or at least, as steep as the change asks."""
    names, bound = frozenset(element.name for element in elements), change.to or 0.0
    if change.bound < 0:
        return SlopeOfAll(names, least=0, most=bound)
    up = sum(element.incline * element.length for element in elements) >= 0
    return SlopeOfAll(names, least=bound, most=inf, sign=1 if up else -1)


def slope_steps(change: Change, element: RoadElement, found: Measures, world: World) -> list[EditStep]:
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
        raise EditError(
            f"{round(grade, 1):g} % is steeper than the {limit:g} % that the rules allow; ask for less"
        )


def _graded(element: RoadElement, sign: int, aim: float, *rooms: Range) -> list[EditStep]:
    """Returns a step per range of grades in percent, all with the same aim; downhill if ``sign`` is -1."""
    own = (room if sign > 0 else room.negative for room in rooms)
    return [Adjust(element, grade=Wanted(sign * aim, room)) for room in own]


def _slopes(change: Change, elements: Sequence[RoadElement], world: World) -> list[SlopeOfAll]:
    """Returns alternative steps that change the grades of many elements; none if they are as requested."""
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
