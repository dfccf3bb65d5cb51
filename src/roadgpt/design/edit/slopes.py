"""Lists ways to change grades: of one turn or straight, or of many elements at once."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf
from typing import NamedTuple

import numpy as np

from roadgpt.brief.change.request import Change, Steepness, Way
from roadgpt.brief.ranges import Range
from roadgpt.brief.words import PERCENT_SLACK
from roadgpt.check.measures import Measures, way
from roadgpt.design.edit.steps import Adjust, EditCandidate, EditStep, Wanted
from roadgpt.design.edit.stretches import RoadStretch, pieces, within
from roadgpt.design.road_elements import RoadElement, RoadElements, with_inclines
from roadgpt.errors import EditError
from roadgpt.road import World

STEEPER, FLATTER = 1.5, 0.5  # shares of a grade
STEEPER_BY = 2.0  # percentage points that 'steeper' adds at least
LEVEL, CLEARLY_LEVEL = 1.0, 0.8  # percent
STEEP_FROM = 4.0  # percent: the grade to which 'steeper' changes a level place


class SlopeAim(NamedTuple):
    """The grade in percent at which a new slope aims, and the ranges in which it may lie."""

    grade: float
    room: tuple[float, float]
    wide_room: tuple[float, float]
    least: tuple[float, float]
    """The least grade of each segment of a longer stretch, and another one if the first cannot be built."""
    most: float


AIMS: dict[Steepness | None, SlopeAim] = {
    None: SlopeAim(5.0, (3.0, 12.0), (1.3, 13.0), (4.0, 3.0), 12.0),
    "gently": SlopeAim(3.0, (2.0, 5.0), (1.3, 5.5), (2.5, 2.0), 4.5),
    "steeply": SlopeAim(9.5, (8.0, 15.0), (6.5, 15.0), (9.0, 8.0), 14.0),
}
"""Aims of "uphill", "gently uphill" and "steeply uphill", inside the meanings in ``brief.words``."""


@dataclass(frozen=True, slots=True)
class SlopeOfAll:
    """Changes the incline of each segment of several elements; no incline exceeds what the rules allow.

    The size of an incline i becomes |i| * ``times`` + ``more`` percent, limited by ``least`` and ``most``.
    """

    names: frozenset[str]
    times: float = 1.0
    more: float = 0.0
    least: float = -inf
    """Lower limit of the size of the new incline."""
    most: float = inf
    """Upper limit of the size of the new incline."""
    sign: int = 0
    """1 for uphill, -1 for downhill, 0 if each segment keeps its sign."""
    only: Way | None = None
    """The segments that change: those uphill, downhill or level before; None for all."""
    stretch: RoadStretch | None = None
    """The stretch of the road in which segments change; None for the whole road."""

    def apply(self, elements: RoadElements, world: World) -> RoadElements:
        """Returns the elements with the new inclines."""
        at, out = 0.0, list[RoadElement]()
        for element in elements:
            out.append(self._applied(element, at, world) if element.name in self.names else element)
            at += element.length
        return tuple(out)

    def _applied(self, element: RoadElement, at: float, world: World) -> RoadElement:
        limit = 100 * world.limits.max_grade - 0.2
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


def is_too_steep_or_flat(change: Change, element: RoadElement) -> bool:
    """Returns whether a segment of an element violates the limit that a change sets for slopes."""
    return any(change.is_outside(abs(segment.incline)) for segment in element.segments)


def bounded_slopes(change: Change, elements: Sequence[RoadElement]) -> SlopeOfAll:
    """Returns the edit step that makes every element at most, or at least, as steep as the change asks."""
    names, bound = frozenset(element.name for element in elements), change.to or 0.0
    if change.bound < 0:
        return SlopeOfAll(names, least=0, most=bound)
    up = sum(element.incline * element.length for element in elements) >= 0
    return SlopeOfAll(names, least=bound, most=inf, sign=1 if up else -1)


def slope_steps(change: Change, element: RoadElement, found: Measures, world: World) -> list[EditStep]:
    """Returns alternative steps, each of which gives one turn or straight another grade.

    There are none if the element already has this grade.

    Raises:
        EditError: the grade is steeper than the rules allow, or cannot become steeper.
    """
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
        return _graded(element, 1, aim, (aim - 0.5, aim + 0.5), (aim - PERCENT_SLACK, aim + PERCENT_SLACK))
    if change.way == "flat":
        if abs(now) < CLEARLY_LEVEL and all(abs(s.incline) < LEVEL for s in element.segments):
            return []
        return _graded(element, 1, 0.0, (-0.5, 0.5), (-CLEARLY_LEVEL, CLEARLY_LEVEL))
    if change.way and not change.more:
        aim_at = AIMS[change.steepness]
        is_so = way(now) == change.way and (not change.steepness or _is_in(abs(now), aim_at.room))
        return [] if is_so else _graded(element, sign, aim_at.grade, aim_at.room, aim_at.wide_room)
    if change.more > 0 and change.way and way(now) != change.way:
        return _graded(element, sign, 6.0, (3.0, 12.0))
    if change.more < 0:
        is_level = abs(now) < LEVEL
        return [] if is_level else _graded(element, 1, FLATTER * now, (0.1 * now, 0.9 * now))
    steep = max(abs(now) * (1 + (STEEPER - 1) * change.dose), abs(now) + STEEPER_BY * change.dose)
    steep = min(steep if abs(now) >= LEVEL else STEEP_FROM, limit - 0.3)
    if steep <= abs(now) + 0.4:
        raise EditError(f"it is as steep as the rules allow there: {now:.1f} % of {limit:g} %")
    return _graded(element, sign, steep, (min(abs(now) + 0.4, steep - 0.2), min(steep + 1.5, limit)))


def _is_in(grade: float, room: tuple[float, float]) -> bool:
    return room[0] <= grade <= room[1]


def _refuse_too_steep(grade: float, limit: float) -> None:
    if grade > limit:
        raise EditError(
            f"{round(grade, 1):g} % is steeper than the {limit:g} % that the rules allow; ask for less"
        )


def _graded(element: RoadElement, sign: int, aim: float, *rooms: tuple[float, float]) -> list[EditStep]:
    """Returns a step per range of grades in percent, all with the same aim; downhill if ``sign`` is -1."""
    ends = [sorted((sign * one, sign * other)) for one, other in rooms]
    return [Adjust(element, grade=Wanted(sign * aim, Range(low, high))) for low, high in ends]


def road_slope_candidates(
    change: Change, elements: Sequence[RoadElement], world: World
) -> tuple[EditCandidate, ...]:
    """Returns the candidates that change the grades of many elements; none if the grades are as requested.

    Raises:
        EditError: the grade is steeper than the rules allow.
    """
    names = frozenset(element.name for element in elements)
    limit = 100 * world.limits.max_grade
    sign = change.sign
    _refuse_too_steep(change.to or 0.0, limit)
    inclines = [segment.incline for element in elements for segment in element.segments]
    if change.way == "flat" or change.to == 0:
        slopes = [SlopeOfAll(names, least=0, most=0)]
    elif change.to is not None:
        falls = sum(element.incline * element.length for element in elements) < 0
        slopes = [SlopeOfAll(names, least=change.to, most=change.to, sign=sign or (-1 if falls else 1))]
    elif change.by is not None:
        slopes = [SlopeOfAll(names, more=(change.more or 1) * change.by)]
    elif change.times is not None:
        slopes = [SlopeOfAll(names, times=change.times)]
    elif sign and not change.more:
        aim_at = AIMS[change.steepness]
        room = aim_at.room if change.steepness else (1.5, inf)
        if inclines and all(_is_in(incline * sign, room) for incline in inclines):
            return ()
        slopes = [SlopeOfAll(names, least=low, most=aim_at.most, sign=sign) for low in aim_at.least]
    elif change.more < 0:
        if all(abs(incline) < LEVEL for incline in inclines):
            return ()
        slopes = [SlopeOfAll(names, times=times) for times in (FLATTER, 0.75)]
    elif all(abs(incline) < LEVEL for incline in inclines):
        slopes = [SlopeOfAll(names, least=STEEP_FROM, most=limit, sign=sign or 1)]
    else:
        shares = [1 + (times - 1) * change.dose for times in (STEEPER, 1.3, 1.15)]
        slopes = [SlopeOfAll(names, times=times) for times in shares]
    return tuple((slope,) for slope in slopes)


def stretch_candidates(
    change: Change, elements: RoadElements, stretch: RoadStretch, world: World
) -> tuple[EditCandidate, ...]:
    """Returns the candidates that change the grades or the climb of one stretch of the road.

    Args:
        change: the change of a slope or a climb.
        elements: all elements of the road.
        stretch: the stretch of the road that changes.
        world: the limits that the rules check.

    Raises:
        EditError: as for ``road_slope_candidates`` and ``climb_candidates``.
    """
    parts = within(elements, stretch)
    if change.what == "climb":
        ways = climb_candidates(change, parts, world)
    elif change.bound:
        is_beyond = any(is_too_steep_or_flat(change, element) for element in parts)
        ways = ((bounded_slopes(change, parts),),) if is_beyond else ()
    else:
        ways = road_slope_candidates(change, parts, world)
    return tuple((replace(step, stretch=stretch),) for (step,) in ways if isinstance(step, SlopeOfAll))


def part_slope_candidates(
    change: Change, elements: Sequence[RoadElement], world: World
) -> tuple[EditCandidate, ...]:
    """Returns the candidates that change only segments that climb, fall or are level, as the target says.

    For "the uphill part at 8 %", these are the segments that climb.

    Raises:
        EditError: the grade is steeper than the rules allow.
    """
    steps = (step for (step,) in road_slope_candidates(change, elements, world))
    return tuple((only_parts(change, step),) for step in steps if isinstance(step, SlopeOfAll))


def only_parts(change: Change, step: SlopeOfAll) -> SlopeOfAll:
    """Returns the step, restricted to the segments that climb, fall or are level, as the target says.

    Segments that climb or fall continue to do so, unless the change names another direction.
    """
    assert change.target is not None
    sign = step.sign
    if change.way is None and change.target.way != "flat":
        sign = 1 if change.target.way == "up" else -1
    return replace(step, only=change.target.way, sign=sign)


def climb_candidates(
    change: Change, elements: Sequence[RoadElement], world: World
) -> tuple[EditCandidate, ...]:
    """Returns the candidate that changes how many metres some elements climb in total.

    If all segments already climb (or fall) as required, their grades are scaled, unless one would become too
    steep. Otherwise the grades become equal.

    Raises:
        EditError: the change gives no climb in metres or only a limit, or the required grade is steeper than
            the rules allow.
    """
    length = sum(element.length for element in elements)
    rises = [segment.incline * segment.distance / 100 for each in elements for segment in each.segments]
    now = sum(rises)
    if change.bound or (change.to is None and change.by is None and change.times is None):
        raise EditError(f"'{change.words}' gives no climb in metres; write for example: road: climb =5")
    times = 1.0 if change.times is None else change.times
    aim = now + change.more * change.by if change.by is not None else now * times
    aim = change.to if change.to is not None else aim
    grade = 100 * aim / length
    limit = 100 * world.limits.max_grade - 0.2
    _refuse_too_steep(abs(grade), limit)
    names = frozenset(element.name for element in elements)
    steepest = max(abs(segment.incline) for each in elements for segment in each.segments)
    if aim and all(rise * aim > 0 for rise in rises) and steepest * aim / now <= limit:
        return ((SlopeOfAll(names, times=aim / now),),)
    return ((SlopeOfAll(names, least=abs(grade), most=abs(grade), sign=1 if aim >= 0 else -1),),)
