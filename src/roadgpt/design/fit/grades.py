"""Changes inclines until the measured grades of the elements are as they should be. Main function:
``graded``.

Parabolas join the grades of a road. A short level turn between two climbs is therefore measured as climbing,
and a short slope is measured flatter than it is written. So the inclines of an element are changed by the
measured error, and the road is measured again. If an incline is at its limit, the neighbouring inclines are
changed instead.

In a proposal, every turn must be measured with the slope that was proposed or is required. All inclines may
change, as long as each still climbs, falls or is level. In an edited road, only the inclines of
elements with a required grade may change; parabolas are added where two slopes newly meet."""

from math import inf
from typing import NamedTuple

import numpy as np

from roadgpt.brief.outline import Outline
from roadgpt.brief.ranges import Range, overlap
from roadgpt.check.measures import LEVEL, Measures, measure, way
from roadgpt.check.rules.too_abrupt import inspect as abrupt_places
from roadgpt.design.heights import climbing
from roadgpt.design.road_elements import (
    RoadElements,
    features_of,
    shows_turns,
    with_inclines,
)
from roadgpt.design.vertical import (
    EASES,
    SHORTEST_SLOPE,
    Pace,
    made_to_fit,
    too_abrupt,
    widened,
    with_new_parabolas,
)
from roadgpt.design.windows import Windows
from roadgpt.errors import DesignError
from roadgpt.geometry.curve import Array
from roadgpt.road import Design, World, build
from roadgpt.road.builder import elevation_of

ROUNDS = 24  # of changing inclines
ROOMIER = (1.0, 1.5, 2.5)  # factors on the room for parabolas of a proposal
PARABOLAS = tuple((ease, is_widened) for is_widened in (False, True) for ease in EASES)  # of an edited road
CLEAR = 0.1  # percentage points off the edge of up, down and level
INSIDE = 0.2  # percentage points off the edge of a required grade, or a third of its width
SURPLUS = 0.05  # percentage points more than is missing, for rounding
CLASSES = {"up": Range(LEVEL), "down": Range(-inf, -LEVEL), "flat": Range(-LEVEL, LEVEL)}
CLEARLY = {name: room.drawn_in(CLEAR, 0.5) for name, room in CLASSES.items()}


class _Slopes(NamedTuple):
    """The grades of elements and segments, in percent: which are accepted, aimed at and possible."""

    elements: RoadElements
    accepted: tuple[Range | None, ...]
    """Mean grades of each element that may be measured; None if the element is not measured."""
    aims: tuple[Range, ...]  # mean grades to aim at for each element; they lie inside those that are accepted
    bounds: tuple[Range, ...]  # inclines that each segment may have

    def within_bounds(self, grades: Array) -> Array:
        """Returns the inclines of all segments, limited to those that are possible."""
        return np.clip(grades, [bound.lo for bound in self.bounds], [bound.hi for bound in self.bounds])

    def missing(self, found: Measures) -> Array:
        """Returns, for each segment, the percentage points by which the measured grade of its element must
        change to reach the aim, ``(n,)``; 0 if the grade is accepted."""
        out = np.zeros(len(self.bounds))
        if not shows_turns(found, self.elements):
            return out
        seen = features_of(self.elements, found)
        for element, accepted, aim, one in zip(self.elements, self.accepted, self.aims, seen, strict=True):
            if accepted and one and one.grade not in accepted:
                by = float(np.clip(one.grade, aim.lo, aim.hi)) - one.grade
                out[list(element.members)] = by + np.copysign(SURPLUS, by)
        return out

    def moved(self, grades: Array, missing: Array) -> Array:
        """Returns grades changed by ``missing`` within their limits; neighbours change by the remainder."""
        after = self.within_bounds(grades + missing)
        rest = grades + missing - after
        for i in np.flatnonzero(np.abs(rest) > 1e-9):
            for j in (i - 1, i + 1):
                if 0 <= j < len(grades) and not missing[j]:
                    after[j] = np.clip(after[j] + rest[i], self.bounds[j].lo, self.bounds[j].hi)
        return after


def graded(
    design: Design, elements: RoadElements, outline: Outline, world: World, before: Design | None = None
) -> Design:
    """Returns the design with inclines and parabolas for which the measured grades are as required.

    If all such designs violate the rule ``too_abrupt``, the last of them is returned. If no design has the
    required grades, the first one tried is returned. The plan and the start stay the same. ``before`` is the
    road before an edit, and None for a proposal."""
    slopes = _slopes_of_edit(elements, world) if before else _slopes_of_proposal(elements, outline, world)
    lengths, inclines = [s.distance for s in design.segments], [s.incline for s in design.segments]
    start = slopes.within_bounds(np.array(inclines))
    climb = outline.climb.drawn_in(0.3, 0.2) if outline.climb else Range()
    metres = float(start @ lengths) / 100
    if metres not in climb:
        metres = min(max(metres, climb.lo), climb.hi)
        start = climbing(start, np.array(lengths), slopes.bounds, metres)
    road, pace = build(design), Pace.of(design, world)
    points, stations = road.centreline(), road.sample().s
    short = {i for e in elements if not e.is_turn and e.length < SHORTEST_SLOPE for i in e.members}
    kept: Design | None = None
    for attempt in range(len(PARABOLAS if before else ROOMIER)):
        grades = start
        for _ in range(ROUNDS):
            segments = with_inclines(design.segments, grades)
            if before:
                segments = with_new_parabolas(segments, before.segments, pace, *PARABOLAS[attempt])
            else:
                segments = widened(segments, pace)
                if too_abrupt(segments, pace):
                    room = ROOMIER[attempt]
                    grades = made_to_fit(grades, lengths, inclines, short, slopes.bounds, pace, room)
                    segments = widened(with_inclines(design.segments, grades), pace)
            points[:, 2] = elevation_of(segments, 0.0).height(stations)
            missing = slopes.missing(measure(points))
            moved = slopes.moved(grades, missing)
            if np.array_equal(moved, grades):
                break
            grades = moved
        tried = design.model_copy(update={"segments": segments})
        if not missing.any() and not abrupt_places(world.lay(build(tried)), None, world):
            return tried
        kept = tried if kept is None or not missing.any() else kept
    assert kept is not None
    return kept


def _slopes_of_edit(elements: RoadElements, world: World) -> _Slopes:
    """Returns the grades of an edited road: elements without a required grade keep their inclines."""
    limit = Range(-100 * world.limits.max_grade, 100 * world.limits.max_grade)
    asked = [element.asked.grade if element.asked else None for element in elements]
    aims = (grade.drawn_in(INSIDE, 1 / 3) if grade else limit for grade in asked)
    bounds = (
        limit if grade else Range(segment.incline, segment.incline)
        for element, grade in zip(elements, asked, strict=True)
        for segment in element.segments
    )
    return _Slopes(elements, tuple(asked), tuple(aims), tuple(bounds))


def _slopes_of_proposal(elements: RoadElements, outline: Outline, world: World) -> _Slopes:
    """Returns the grades of a proposal: turns go up, down or level as proposed, or as required."""
    limit = Range(-100 * world.limits.max_grade, 100 * world.limits.max_grade)
    accepted, aims, bounds = list[Range | None](), list[Range](), list[Range]()
    for element in elements:
        class_, *ways = map(way, (element.incline, *(s.incline for s in element.segments)))
        try:
            windows = Windows(outline, world)
            asked = windows.of(element.asked) if element.asked else windows.base
        except DesignError:  # the Brief contradicts itself: then the rules say so
            asked = None
        aim = overlap(CLEARLY[class_], asked) or CLEARLY[class_]
        if asked and aim.lo > aim.hi:
            aim = asked
        own = []
        for segment, one in zip(element.segments, ways, strict=True):
            room = Range(min(CLEARLY[one].lo, segment.incline), max(CLEARLY[one].hi, segment.incline))
            rooms = overlap(overlap(room, limit), asked and aim), overlap(limit, asked and aim)
            own.append(next((room for room in rooms if room and room.lo <= room.hi), limit))
        if not element.is_turn and element.length < SHORTEST_SLOPE:  # it needs no slope of its own
            own = [limit] * len(own)
        bounds += own
        aims.append(aim)
        accepted.append((aim if asked else CLASSES[class_]) if element.is_turn else None)
    return _Slopes(elements, tuple(accepted), tuple(aims), tuple(bounds))
