"""Gives single elements of a road the required grades, and leaves all other slopes as they are.

A short turn between two slopes is measured flatter than it is written, as parabolas join the slopes. So the
inclines of an element are changed by the measured error, and the road is measured again.
"""

from collections.abc import Iterator, Sequence

import numpy as np

from roadgpt.check.measures import Measures, measure
from roadgpt.design.fit.slopes import with_inclines
from roadgpt.design.road_elements import (
    RoadElement,
    RoadElements,
    joined,
    seen_as,
    shows_turns,
)
from roadgpt.design.vertical import EASES, Pace, changed_joints, widened
from roadgpt.design.vertical import joined as with_parabolas
from roadgpt.road import Design, Segment, World, build
from roadgpt.road.elevation import elevation_of

ROUNDS = 6  # of moving inclines
INSIDE = 0.2  # percentage points off the edge of what was asked for, or a third of its width


def graded(design: Design, elements: RoadElements, before: Design, world: World) -> Iterator[Design]:
    """Yields versions of the design that have the required grades, and parabolas at new joints of slopes.

    A joint is new if its two slopes did not meet before the change. The first designs have the most
    comfortable parabolas, and keep the parabolas at segments that the road had before the change. The later
    designs make room for parabolas to which the rules would object. If none has the required grades, the
    first one is yielded.

    Args:
        design: The changed road.
        elements: The numbered elements of that road, some with a required grade.
        before: The road before the change.
        world: The limits that the rules check, such as the steepest grade.
    """
    pace = Pace.of(design, world)
    road = build(design)
    points, stations = road.centreline(), road.sample().s
    asks = any(element.asked and element.asked.grade for element in elements)
    first: tuple[Segment, ...] | None = None
    is_met = False
    for beside in (False, True):
        for ease in EASES if asks else (1.0,):
            now = elements
            for _ in range(ROUNDS):
                tried = _rounded_off(joined(now), before.segments, pace, ease, beside)
                points[:, 2] = elevation_of(tried, 0.0).height(stations)
                missing = dict(_missing(now, measure(points))) if asks else {}
                if not missing:
                    break
                now = tuple(_raised(element, missing.get(element.name, 0.0), world) for element in now)
            first = first or tried
            if not missing:
                is_met = True
                yield design.model_copy(update={"segments": tried})
    if not is_met:
        yield design.model_copy(update={"segments": first})


def _rounded_off(
    segments: Sequence[Segment], before: Sequence[Segment], pace: Pace, ease: float, beside: bool
) -> tuple[Segment, ...]:
    opened = changed_joints(before, segments)
    if not beside:
        opened = frozenset(i for i in opened if segments[i] not in before)
    out = with_parabolas(segments, pace, ease, opened) if opened else tuple(segments)
    return widened(out, pace) if beside else out


def _missing(elements: RoadElements, found: Measures) -> Iterator[tuple[str, float]]:
    """Names of elements whose grade is not as asked for, and the percentage points that are missing."""
    if not shows_turns(found, elements):
        return
    for element in elements:
        asked = element.asked.grade if element.asked else None
        seen = seen_as(element.name, elements, found) if asked else None
        if asked and seen and seen.grade not in asked:
            inner = asked.drawn_in(INSIDE, 1 / 3)
            yield element.name, float(np.clip(seen.grade, inner.lo, inner.hi)) - seen.grade


def _raised(element: RoadElement, by: float, world: World) -> RoadElement:
    return with_grade(element, element.incline + by, world) if by else element


def with_grade(element: RoadElement, grade: float, world: World) -> RoadElement:
    """Returns the element with another mean grade, in percent.

    Its inclines are scaled if all of them already climb or fall as the new grade does; otherwise they become
    equal.
    """
    limit = 100 * world.limits.max_grade - 0.2
    aim = float(np.clip(grade, -limit, limit))
    inclines = np.array([s.incline for s in element.segments])
    mean = element.incline
    if abs(mean) >= 1 and (inclines * np.sign(mean) > 0.5).all() and aim * mean > 0:
        inclines = np.clip(inclines * aim / mean, -limit, limit)
    else:
        inclines = np.full(len(inclines), aim)
    return element.with_segments(with_inclines(element.segments, inclines))
