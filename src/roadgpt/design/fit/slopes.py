"""The smallest change of inclines that keeps every slope what it was proposed to be, and what was promised.

Parabolas join the grades of a road, so a short level turn between two climbs is measured as climbing itself.
The incline of what is measured wrong is moved by what is missing, as far as it stays up, down or level
itself; then its neighbours are moved towards it.
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
ROOMIER = (1.0, 1.5, 2.5)  # times the room that parabolas need, so that a slope is seen between them
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
    """Returns the design with inclines at which every slope is kept; plan and start stay as they are."""
    windows = [_window(element, outline, world) for element in elements]
    own = [window for window, element in zip(windows, elements, strict=True) for _ in element.segments]
    segments = list(design.segments)
    loose = [_loose(segment, window, world) for segment, window in zip(proposed, own, strict=True)]
    grades = np.array([np.clip(s.incline, r.lo, r.hi) for s, r in zip(proposed, loose, strict=True)])
    if outline.climb:
        grades = _climbing(grades, segments, loose, outline.climb)
    points = build(design).centreline()
    stations = build(design).sample().s
    pace = Pace.of(design, world)
    lengths, inclines = [s.distance for s in segments], [s.incline for s in proposed]
    most = 100 * world.max_grade
    unseen = {i for element in elements if not _is_seen(element) for i in element.members}
    runs = runs_of(inclines, unseen)
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
    """Is it long enough for its slope to be looked for?"""
    return element.is_turn or element.length >= SHORTEST_SLOPE


def with_inclines(segments: Sequence[Segment], grades: Array) -> list[Segment]:
    """Returns the segments with other inclines, rounded to a tenth; unchanged ones stay the same objects."""
    rounded = [round(float(g) * TENTH) / TENTH for g in grades]
    return [
        s if s.incline == g else s.model_copy(update={"incline": g})
        for s, g in zip(segments, [_plain(g, s) for g, s in zip(rounded, segments, strict=True)], strict=True)
    ]


def _plain(grade: float, segment: Segment) -> float:
    """What was written, where rounding is all that parts them."""
    return segment.incline if abs(grade - segment.incline) < 0.05 else grade


def _window(element: RoadElement, outline: Outline, world: World) -> Range:
    """Percent that the measured slope must lie in: its class as proposed, and what was promised."""
    class_ = CLASSES[way(element.incline)]
    try:
        promised = Windows(outline, world)
        asked = promised.of(element.asked) if element.asked else promised.base
    except DesignError:  # the Brief contradicts itself: then the rules say so
        asked = None
    meets = overlap(class_, asked) or class_
    return meets if meets.lo <= meets.hi else asked or class_


def _loose(segment: Segment, window: Range, world: World) -> Range:
    """Percent that a segment may be written with: its own class, and the window where one was promised."""
    limit = Range(-100 * world.max_grade, 100 * world.max_grade)
    class_ = overlap(_class_of(segment.incline), limit) or limit
    if window in CLASSES.values():  # nothing was promised: a turn of several slopes keeps every one
        return class_
    meets = overlap(class_, window) or class_
    if meets.lo <= meets.hi:
        return meets
    inside = overlap(window, limit) or limit
    return inside if inside.lo <= inside.hi else limit


def _class_of(incline: float) -> Range:
    """Up, down or level, wide enough for what was written."""
    span = CLASSES[way(incline)]
    return Range(min(span.lo, incline), max(span.hi, incline))


def _climbing(grades: Array, segments: Sequence[Segment], loose: Sequence[Range], climb: Range) -> Array:
    """All grades shifted alike, each as far as it may, until the road climbs what was asked."""
    lengths = np.array([s.distance for s in segments])
    margin = min(0.3, 0.2 * (climb.hi - climb.lo))
    now = grades @ lengths / 100
    target = float(np.clip(now, climb.lo + margin, climb.hi - margin))
    return grades if abs(target - now) < 1e-9 else climbing(grades, lengths, loose, target)


def _missing(points: Array, elements: Sequence[RoadElement], windows: Sequence[Range]) -> Array:
    """Percentage points that the slope of every segment's turn is away from its window."""
    out = np.zeros(elements[-1].members.stop)
    turns = [pair for pair in zip(elements, windows, strict=True) if pair[0].is_turn]
    found = measure(points).turns
    if len(found) != len(turns):
        return out
    for stretch, (element, window) in zip(found, turns, strict=True):
        by = max(window.lo - stretch.grade, 0.0) + min(window.hi - stretch.grade, 0.0)
        # the measure's own edge of a class, where nothing narrower was promised
        if (
            way(stretch.grade) == way(float(np.clip(stretch.grade, window.lo, window.hi)))
            and window in CLASSES.values()
        ):
            by = 0.0
        out[list(element.members)] = by + np.copysign(SURPLUS, by) if by else 0.0
    return out


def _moved(grades: Array, missing: Array, loose: Sequence[Range]) -> Array:
    """Grades moved by what is missing, each as far as it may; what remains is moved at its neighbours."""
    low, high = np.array([r.lo for r in loose]), np.array([r.hi for r in loose])
    wanted = grades + missing
    after = np.clip(wanted, low, high)
    rest = wanted - after
    for i in np.flatnonzero(np.abs(rest) > 1e-9):
        for j in (i - 1, i + 1):
            if 0 <= j < len(grades) and not missing[j]:
                after[j] = np.clip(after[j] + rest[i], low[j], high[j])
    return np.asarray(after)


__all__ = ["sloped", "with_inclines"]
