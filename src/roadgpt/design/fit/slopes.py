"""Changes inclines as little as needed, so that every slope is measured as proposed and as required.

Parabolas join the grades of a road, so a short level turn between two climbs is measured as climbing itself.
If a turn is measured with a wrong grade, its incline is changed by the error, as long as the turn stays in
its class (up, down or level). The rest of the error is corrected at its neighbours.
"""

from collections.abc import Sequence
from math import inf

import numpy as np

from roadgpt.brief.outline import Outline
from roadgpt.brief.words import Range, overlap
from roadgpt.check.measures import LEVEL, measure, way
from roadgpt.design.heights import Windows, climbing
from roadgpt.design.road_elements import RoadElement
from roadgpt.design.vertical import SHORTEST_SLOPE, Pace, made_to_fit, runs_of, too_abrupt, widened
from roadgpt.errors import DesignError
from roadgpt.geometry.curve import Array
from roadgpt.road import Segment, World, build
from roadgpt.road.design import Design
from roadgpt.road.elevation import elevation_of

ROUNDS = 24
ROOMIER = (1.0, 1.5, 2.5)  # factors on the room for parabolas, so that a slope is measured between them
TENTH = 10.0  # per percent
CLEAR = 0.1  # percentage points off the edge of up, down and level
SURPLUS = 0.05  # percentage points more than is missing
CLASSES = {
    "up": Range(LEVEL + CLEAR),
    "down": Range(-inf, -LEVEL - CLEAR),
    "flat": Range(CLEAR - LEVEL, LEVEL - CLEAR),
}


def sloped(
    design: Design,
    proposed: Sequence[Segment],
    elements: Sequence[RoadElement],
    outline: Outline,
    world: World,
) -> Design:
    """Returns the design with inclines at which every turn is measured with the slope that it should have.

    If none are found, the last inclines that were tried are returned. The plan and the start stay the same.

    Args:
        design: the design, whose plan and start stay the same.
        proposed: the segments of the design with the inclines that were proposed.
        elements: the turns and gaps of the design, each with its requirement.
        outline: requirements for the whole road.
        world: the limits that the rules check, such as the steepest grade.
    """
    windows = [_window(element, outline, world) for element in elements]
    own = [window for window, element in zip(windows, elements, strict=True) for _ in element.segments]
    loose = [_loose(segment, window, world) for segment, window in zip(proposed, own, strict=True)]
    segments, lengths = design.segments, [segment.distance for segment in design.segments]
    grades = np.array([np.clip(s.incline, r.lo, r.hi) for s, r in zip(proposed, loose, strict=True)])
    if outline.climb:
        inner, climb = outline.climb.drawn_in(0.3, 0.2), float(grades @ lengths) / 100
        if climb not in inner:
            grades = climbing(grades, np.array(lengths), loose, float(np.clip(climb, inner.lo, inner.hi)))
    road, pace = build(design), Pace.of(design, world)
    points, stations = road.centreline(), road.sample().s
    most = 100 * world.limits.max_grade
    unseen = {i for element in elements if not _is_seen(element) for i in element.members}
    runs = runs_of([segment.incline for segment in proposed], unseen)
    bounds = [(-most, most) if i in unseen else (room.lo, room.hi) for i, room in enumerate(loose)]
    for roomier in ROOMIER:
        now = grades
        for _ in range(ROUNDS):
            tried = widened(with_inclines(segments, now), pace)
            if too_abrupt(tried, pace):
                now = np.array(made_to_fit(now.tolist(), lengths, runs, bounds, pace, roomier))
                tried = widened(with_inclines(segments, now), pace)
            points[:, 2] = elevation_of(tried, 0.0).height(stations)
            missing = _missing(points, elements, windows)
            if not missing.any():
                break
            now = _moved(now, missing, loose)
        if not missing.any() and not too_abrupt(tried, pace):
            break
    return design.model_copy(update={"segments": tried})


def _is_seen(element: RoadElement) -> bool:
    """Returns whether an element is long enough to need a slope of its own."""
    return element.is_turn or element.length >= SHORTEST_SLOPE


def with_inclines(segments: Sequence[Segment], grades: Array) -> list[Segment]:
    """Returns the segments with other inclines, rounded to a tenth of a percent.

    A segment whose incline changes by less than rounding stays the same object.
    """
    out = []
    for segment, grade in zip(segments, grades.tolist(), strict=True):
        incline = round(grade * TENTH) / TENTH
        is_same = abs(incline - segment.incline) < 0.05
        out.append(segment if is_same else segment.model_copy(update={"incline": incline}))
    return out


def _window(element: RoadElement, outline: Outline, world: World) -> Range:
    """Returns the grades in percent that an element may be measured with: its class, and what is required."""
    class_ = CLASSES[way(element.incline)]
    try:
        promised = Windows(outline, world)
        asked = promised.of(element.asked) if element.asked else promised.base
    except DesignError:  # the Brief contradicts itself: then the rules say so
        asked = None
    meets = overlap(class_, asked) or class_
    return meets if meets.lo <= meets.hi else asked or class_


def _loose(segment: Segment, window: Range, world: World) -> Range:
    """Returns the inclines in percent that a segment may have: of its own class, and in a required window."""
    limit = Range(-100 * world.limits.max_grade, 100 * world.limits.max_grade)
    span = CLASSES[way(segment.incline)]
    class_ = Range(max(min(span.lo, segment.incline), limit.lo), min(max(span.hi, segment.incline), limit.hi))
    if window in CLASSES.values():  # nothing is required: a turn of several slopes keeps every one
        return class_
    for room in (overlap(class_, window), overlap(window, limit)):
        if room and room.lo <= room.hi:
            return room
    return limit


def _missing(points: Array, elements: Sequence[RoadElement], windows: Sequence[Range]) -> Array:
    """Returns by how many percentage points the turn of every segment is measured off its window."""
    out = np.zeros(elements[-1].members.stop)
    turns = [pair for pair in zip(elements, windows, strict=True) if pair[0].is_turn]
    found = measure(points).turns
    if len(found) != len(turns):
        return out
    for seen, (element, window) in zip(found, turns, strict=True):
        by = float(np.clip(seen.grade, window.lo, window.hi)) - seen.grade
        if by and window != CLASSES[way(seen.grade)]:
            out[list(element.members)] = by + np.copysign(SURPLUS, by)
    return out


def _moved(grades: Array, missing: Array, loose: Sequence[Range]) -> Array:
    """Returns grades moved by what is missing, as far as they may; the rest is moved at their neighbours."""
    low, high = np.array([r.lo for r in loose]), np.array([r.hi for r in loose])
    wanted = grades + missing
    after = np.clip(wanted, low, high)
    rest = wanted - after
    for i in np.flatnonzero(np.abs(rest) > 1e-9):
        for j in (i - 1, i + 1):
            if 0 <= j < len(grades) and not missing[j]:
                after[j] = np.clip(after[j] + rest[i], low[j], high[j])
    return np.asarray(after)
