"""Changes inclines until elements are measured with the grades that they should have. Main function:
``graded``.

Parabolas join the grades of a road. A short level turn between two climbs is therefore measured as climbing,
and a short slope is measured flatter than it is written. So the inclines of an element are changed by the
measured error, and the road is measured again. What an element may not change is changed at its neighbours.

In a proposal, every turn must be measured with the slope that was proposed or is required, and all inclines
may change as long as they stay up, down or level. In an edited road, only the inclines of elements with a
required grade may change, and joints of slopes that did not meet before get parabolas.
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
    with_inclines,
)
from roadgpt.design.vertical import (
    EASES,
    SHORTEST_SLOPE,
    Pace,
    changed_joints,
    joined,
    made_to_fit,
    runs_of,
    too_abrupt,
    widened,
)
from roadgpt.errors import DesignError
from roadgpt.geometry.curve import Array
from roadgpt.road import Design, Segment, World, build
from roadgpt.road.elevation import elevation_of

ROUNDS = 24  # of changing inclines
ROOMIER = (1.0, 1.5, 2.5)  # factors on the room for parabolas of a proposal
PARABOLAS = tuple((ease, is_widened) for is_widened in (False, True) for ease in EASES)  # of an edited road
CLEAR = 0.1  # percentage points off the edge of up, down and level
INSIDE = 0.2  # percentage points off the edge of a required grade, or a third of its width
SURPLUS = 0.05  # percentage points more than is missing, for rounding
CLASSES = {"up": Range(LEVEL), "down": Range(-inf, -LEVEL), "flat": Range(-LEVEL, LEVEL)}


class _Slope(NamedTuple):
    """The grades of one element, in percent."""

    element: RoadElement
    accepted: Range | None
    """Mean grades that may be measured; None if the element is not measured."""
    aim: Range
    """Mean grades to aim at; they lie inside those that are accepted."""
    bounds: tuple[Range, ...]
    """Inclines that each segment may have."""


def graded(
    design: Design, elements: RoadElements, outline: Outline, world: World, before: Design | None = None
) -> Design:
    """Returns the design with inclines and parabolas with which elements are measured as required.

    If none are found, it returns the design with the last inclines that were measured as required, or else
    with the first that were tried. The plan and the start stay the same.

    Args:
        design: the design as it was proposed, or after the steps of an edit.
        elements: the elements of the design, each with its requirement.
        outline: requirements for the whole road.
        world: the limits that the rules check, such as the steepest grade.
        before: the road before an edit; None for a proposal.
    """
    slopes = tuple(_of_edit(elements, world) if before else _of_proposal(elements, outline, world))
    bounds = [bound for slope in slopes for bound in slope.bounds]
    lows, highs = np.array([bound.lo for bound in bounds]), np.array([bound.hi for bound in bounds])
    start = _start(design, bounds, outline)
    road, pace = build(design), Pace.of(design, world)
    points, stations = road.centreline(), road.sample().s
    kept: Design | None = None
    for attempt in range(len(PARABOLAS if before else ROOMIER)):
        grades = start
        for _ in range(ROUNDS):
            segments = with_inclines(design.segments, grades)
            if before:
                segments = _with_new_parabolas(segments, before.segments, pace, *PARABOLAS[attempt])
            else:
                segments = widened(segments, pace)
                if too_abrupt(segments, pace):
                    grades = _with_room(grades, design, slopes, bounds, pace, ROOMIER[attempt])
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


def _of_edit(elements: RoadElements, world: World) -> Iterator[_Slope]:
    """Yields the grades of an edited road; those without a requirement stay as they are."""
    limit = Range(-100 * world.limits.max_grade, 100 * world.limits.max_grade)
    for element in elements:
        asked = element.asked.grade if element.asked else None
        if asked:
            bounds = (limit,) * len(element.segments)
            yield _Slope(element, asked, asked.drawn_in(INSIDE, 1 / 3), bounds)
        else:
            yield _Slope(element, None, limit, tuple(Range(s.incline, s.incline) for s in element.segments))


def _of_proposal(elements: RoadElements, outline: Outline, world: World) -> Iterator[_Slope]:
    """Yields the grades of a proposal; turns go up, down or level as proposed, or as required."""
    limit = Range(-100 * world.limits.max_grade, 100 * world.limits.max_grade)
    for element in elements:
        class_ = CLASSES[way(element.incline)]
        try:
            windows = Windows(outline, world)
            asked = windows.of(element.asked) if element.asked else windows.base
        except DesignError:  # the Brief contradicts itself: then the rules say so
            asked = None
        aim = overlap(class_.drawn_in(CLEAR, 0.5), asked) or class_
        if asked and aim.lo > aim.hi:
            aim = asked
        if _is_short(element):
            bounds = [limit] * len(element.segments)
        else:
            bounds = [_loose(segment, asked and aim, limit) for segment in element.segments]
        accepted = aim if asked else class_
        yield _Slope(element, accepted if element.is_turn else None, aim, tuple(bounds))


def _is_short(element: RoadElement) -> bool:
    """Returns whether an element is too short to need a slope of its own."""
    return not element.is_turn and element.length < SHORTEST_SLOPE


def _loose(segment: Segment, required: Range | None, limit: Range) -> Range:
    """Returns the inclines that a segment may have: those of its own class, and in a required range."""
    class_ = CLASSES[way(segment.incline)].drawn_in(CLEAR, 0.5)
    class_ = Range(min(class_.lo, segment.incline), max(class_.hi, segment.incline))
    rooms = overlap(overlap(class_, limit), required), overlap(required, limit)
    return next((room for room in rooms if room and room.lo <= room.hi), limit)


def _start(design: Design, bounds: Sequence[Range], outline: Outline) -> Array:
    """Returns the allowed inclines that are nearest to those of the design and have the required climb."""
    pairs = zip(design.segments, bounds, strict=True)
    grades = np.array([np.clip(segment.incline, bound.lo, bound.hi) for segment, bound in pairs])
    lengths = np.array([segment.distance for segment in design.segments])
    climb = float(grades @ lengths) / 100
    inner = outline.climb.drawn_in(0.3, 0.2) if outline.climb else None
    if inner is None or climb in inner:
        return grades
    return climbing(grades, lengths, bounds, float(np.clip(climb, inner.lo, inner.hi)))


def _with_new_parabolas(
    segments: tuple[Segment, ...], before: tuple[Segment, ...], pace: Pace, ease: float, is_widened: bool
) -> tuple[Segment, ...]:
    """Returns the segments of an edited road with parabolas where slopes meet that did not meet before.

    Unless ``is_widened``, segments that the road had before keep their parabolas, even at such joints.
    """
    opened = changed_joints(before, segments)
    if not is_widened:
        opened = frozenset(i for i in opened if segments[i] not in before)
    segments = joined(segments, pace, ease, opened) if opened else segments
    return widened(segments, pace) if is_widened else segments


def _with_room(
    grades: Array, design: Design, slopes: Sequence[_Slope], bounds: Sequence[Range], pace: Pace, room: float
) -> Array:
    """Returns inclines with room for parabolas; straights that are too short to have a slope join others."""
    short = {i for slope in slopes if _is_short(slope.element) for i in slope.element.members}
    runs = runs_of([segment.incline for segment in design.segments], short)
    lengths = [segment.distance for segment in design.segments]
    return np.array(made_to_fit(grades.tolist(), lengths, runs, [(b.lo, b.hi) for b in bounds], pace, room))


def _missing(slopes: Sequence[_Slope], found: Measures) -> Array:
    """Returns by how many percentage points the element of each segment is measured off its aim, ``(n,)``;
    0 if its grade is accepted.
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
    """Returns grades moved by what is missing, as far as they may; the rest is moved at their neighbours."""
    after = np.clip(grades + missing, lows, highs)
    rest = grades + missing - after
    for i in np.flatnonzero(np.abs(rest) > 1e-9):
        for j in (i - 1, i + 1):
            if 0 <= j < len(grades) and not missing[j]:
                after[j] = np.clip(after[j] + rest[i], lows[j], highs[j])
    return np.asarray(after)
