"""Changes inclines until the measured grades of the elements are as they should be. Main function:
``graded``.

Parabolas join the grades of a road. A short level turn between two climbs is therefore measured as climbing,
and a short slope is measured flatter than it is written. So the inclines of an element are changed by the
measured error, and the road is measured again. If an incline is at its limit, the neighbouring inclines are
changed instead.

In a proposal, every turn must be measured with the slope that was proposed or is required. All inclines may
change, as long as each still climbs, falls or is level. In an edited road, only the inclines of
elements with a required grade may change; parabolas are added where two slopes newly meet.
"""

from collections.abc import Iterator, Sequence
from math import inf
from typing import NamedTuple

import numpy as np

from roadgpt.brief.outline import Outline
from roadgpt.brief.words import Range, overlap
from roadgpt.check.measures import LEVEL, Measures, measure, way
from roadgpt.check.rules.too_abrupt import inspect as abrupt_places
from roadgpt.design.heights import Windows, climbing
from roadgpt.design.road_elements import (
    RoadElement,
    RoadElements,
    features_of,
    shows_turns,
)
from roadgpt.design.vertical import (
    EASES,
    SHORTEST_SLOPE,
    Pace,
    made_to_fit,
    too_abrupt,
    widened,
    with_inclines,
    with_new_parabolas,
)
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


class _Slope(NamedTuple):
    """The grades of one element, in percent."""

    element: RoadElement
    accepted: Range | None
    """Mean grades that may be measured; None if the element is not measured."""
    aim: Range
    """Mean grades to aim at; they lie inside those that are accepted."""
    bounds: list[Range]
    """Inclines that each segment may have."""


def graded(
    design: Design, elements: RoadElements, outline: Outline, world: World, before: Design | None = None
) -> Design:
    """Returns the design with inclines and parabolas for which the measured grades are as required.

    If no such design obeys the rule ``too_abrupt``, the last one with the required grades is returned; if
    there is none, the first that was tried. The plan and the start stay the same.

    Args:
        design: the design as it was proposed, or after the steps of an edit.
        elements: the elements of the design, each with its requirement.
        outline: requirements for the whole road.
        world: the limits that the rules check, such as the steepest grade.
        before: the road before an edit; None for a proposal.
    """
    slopes = list(_slopes(elements, outline, world, before is not None))
    bounds = [bound for slope in slopes for bound in slope.bounds]
    lows, highs = np.array([bound.lo for bound in bounds]), np.array([bound.hi for bound in bounds])
    lengths, inclines = [s.distance for s in design.segments], [s.incline for s in design.segments]
    start = np.clip(inclines, lows, highs)
    climb = outline.climb.drawn_in(0.3, 0.2) if outline.climb else Range()
    metres = float(start @ lengths) / 100
    if metres not in climb:
        metres = min(max(metres, climb.lo), climb.hi)
        start = climbing(start, np.array(lengths), bounds, metres)
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
                    grades = made_to_fit(grades, lengths, inclines, short, bounds, pace, ROOMIER[attempt])
                    segments = widened(with_inclines(design.segments, grades), pace)
            points[:, 2] = elevation_of(segments, 0.0).height(stations)
            missing = _missing(slopes, measure(points))
            moved = _moved(grades, missing, lows, highs)
            if np.array_equal(moved, grades):
                break
            grades = moved
        tried = design.model_copy(update={"segments": segments})
        if not missing.any() and not abrupt_places(world.lay(build(tried)), None, world):
            return tried
        kept = tried if kept is None or not missing.any() else kept
    assert kept is not None
    return kept


def _slopes(elements: RoadElements, outline: Outline, world: World, is_edited: bool) -> Iterator[_Slope]:
    """Yields the grades of each element.

    In an edited road, elements without a required grade keep their inclines. In a proposal, turns go up, down
    or level as proposed, or as required.
    """
    limit = Range(-100 * world.limits.max_grade, 100 * world.limits.max_grade)
    for element in elements:
        asked = element.asked.grade if element.asked else None
        if is_edited:
            bounds = [limit if asked else Range(s.incline, s.incline) for s in element.segments]
            yield _Slope(element, asked, asked.drawn_in(INSIDE, 1 / 3) if asked else limit, bounds)
            continue
        class_, *ways = map(way, (element.incline, *(s.incline for s in element.segments)))
        try:
            windows = Windows(outline, world)
            asked = windows.of(element.asked) if element.asked else windows.base
        except DesignError:  # the Brief contradicts itself: then the rules say so
            asked = None
        aim = overlap(CLEARLY[class_], asked) or CLEARLY[class_]
        if asked and aim.lo > aim.hi:
            aim = asked
        bounds = []
        for segment, own in zip(element.segments, ways, strict=True):
            room = Range(min(CLEARLY[own].lo, segment.incline), max(CLEARLY[own].hi, segment.incline))
            rooms = overlap(overlap(room, limit), asked and aim), overlap(limit, asked and aim)
            bounds.append(next((room for room in rooms if room and room.lo <= room.hi), limit))
        if not element.is_turn and element.length < SHORTEST_SLOPE:  # it needs no slope of its own
            bounds = [limit] * len(bounds)
        accepted = aim if asked else CLASSES[class_]
        yield _Slope(element, accepted if element.is_turn else None, aim, bounds)


def _missing(slopes: Sequence[_Slope], found: Measures) -> Array:
    """Returns, for each segment, the percentage points by which the measured grade of its element must change
    to reach the aim, ``(n,)``; 0 if the grade is accepted.
    """
    elements = tuple(slope.element for slope in slopes)
    out = np.zeros(elements[-1].members.stop)
    if shows_turns(found, elements):
        for (element, accepted, aim, _), seen in zip(slopes, features_of(elements, found), strict=True):
            if accepted and seen and seen.grade not in accepted:
                by = float(np.clip(seen.grade, aim.lo, aim.hi)) - seen.grade
                out[list(element.members)] = by + np.copysign(SURPLUS, by)
    return out


def _moved(grades: Array, missing: Array, lows: Array, highs: Array) -> Array:
    """Returns grades changed by ``missing`` within their limits; neighbours are changed by the remainder."""
    after = np.clip(grades + missing, lows, highs)
    rest = grades + missing - after
    for i in np.flatnonzero(np.abs(rest) > 1e-9):
        for j in (i - 1, i + 1):
            if 0 <= j < len(grades) and not missing[j]:
                after[j] = np.clip(after[j] + rest[i], lows[j], highs[j])
    return np.asarray(after)
