"""Changes the free elements of a road as little as needed to meet requirements. Main function: ``fit``.

    elements --look--> what is wrong? --least_change--> lengths and turns --slopes--> look --> ... --> Look

A repair leaves all elements of a proposal free. An edit freezes every element that the request does not name:
its lengths, turns and radii stay exactly as they are. The road as a whole may be shifted or rotated, so that
it stays inside the map.
"""

from collections.abc import Collection
from math import inf

import numpy as np

from roadgpt.design.fit.grades import graded
from roadgpt.design.fit.look import Look, Requirements, look
from roadgpt.design.fit.plan import MARGINS, TIGHT, planned
from roadgpt.design.road_elements import RoadElements
from roadgpt.road import Design

MOST_SEGMENTS = 60  # that are free; on a road with more, none is fitted


def fit(
    design: Design,
    elements: RoadElements,
    requirements: Requirements,
    frozen: Collection[str] = frozenset(),
) -> Look:
    """Finds a road that meets all requirements and differs from the design as little as possible.

    Args:
        design: The road as it was proposed, or after the steps of an edit.
        elements: The turns and straights of the road in driving order, each with its requirement; together
            they contain all segments of the design.
        requirements: The other requirements for the road.
        frozen: Names of the elements whose lengths, turns and radii stay as they are.

    Returns:
        A Look at that road, with an empty ``objection``. If no such road is found, a Look at a road that
        meets everything except the proposed slopes, or else at the design, moved inside the map if possible.

    Raises:
        UsageError: No road can be built from these segments.
    """
    if requirements.before is None:
        first = look(design, elements, requirements)
    else:
        first = _on_grades(design, elements, requirements)
    free = np.array([element.name not in frozen for element in elements for _ in element.segments])
    if not first.objection or not 1 <= free.sum() <= MOST_SEGMENTS:
        return first
    best, last = None, first
    for margins in MARGINS if requirements.before is None else (TIGHT, *MARGINS):
        segments = planned(first, last, free, margins)
        if segments is None:  # there is no such road; with wider margins even less
            break
        if requirements.before and segments == last.design.segments:
            continue
        drawn = first.design.model_copy(update={"segments": segments})
        last = _on_grades(drawn, first.elements, requirements)
        if not last.objection:
            return last if requirements.before else _restored(last, first)
        if best is None and requirements.before is None and last.keeps_all_but_slopes:
            best = last
    return best or first


def _on_grades(design: Design, elements: RoadElements, needs: Requirements) -> Look:
    """Returns the road with grades that are measured as required."""
    design = graded(design, elements, needs.outline, needs.world, needs.before)
    return look(design, elements, needs)


def _restored(mended: Look, first: Look) -> Look:
    """The road with all that need not have changed put back as proposed, the smallest changes first."""
    trials: list[tuple[float, int, str]] = []
    pairs = zip(first.design.segments, mended.design.segments, strict=True)
    for index, (one, other) in enumerate(pairs):
        for name in ("distance", "turn_degrees", "incline", "transition", "vertical_radius", "radius"):
            before, after = getattr(one, name), getattr(other, name)
            if before != after:
                away = abs((before or 12.0) - (after or 12.0)) / max(abs(before or 12.0), 1.0)
                trials.append((inf if name == "radius" else away, index, name))
    for _, index, name in sorted(trials):
        rows = list(mended.design.segments)
        was, now = first.design.segments[index], rows[index]
        if name == "radius" and (was.distance, was.turn_degrees) != (now.distance, now.turn_degrees):
            continue  # it belongs to them
        rows[index] = now.model_copy(update={name: getattr(was, name)})
        segments = tuple(rows)
        tried = first.design.model_copy(update={"segments": segments})
        seen = look(tried, first.elements, first.requirements)
        if not seen.objection:
            mended = seen
    return mended


__all__ = ["Look", "Requirements", "fit", "look"]
