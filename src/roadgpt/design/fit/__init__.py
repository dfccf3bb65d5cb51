"""Changes the free elements of a road as little as needed to meet requirements. Main function: ``fit``.

    elements --look--> what is wrong? --least_change--> lengths and turns --slopes--> look --> ... --> Look

A full repair leaves all elements of a proposal free. An edit first freezes every element that the request
does not name: the element's lengths, turns and radii stay exactly as they are. The road as a whole may be
shifted or rotated, so that it stays inside the map.
"""

from collections.abc import Collection

import numpy as np

from roadgpt.design.fit.grades import graded
from roadgpt.design.fit.look import Look, Requirements, look, restored
from roadgpt.design.fit.plan import MARGINS, TIGHT, planned
from roadgpt.design.road_elements import RoadElements
from roadgpt.road import Design

MOST_SEGMENTS = 60  # free segments; a road with more is not fitted


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
        A Look at that road, with an empty ``objection``. If no such road was found, a Look at a road that
        breaks no rule, but whose turns have other slopes than proposed. If neither was found, a Look at the
        design, moved inside the map if possible.

    Raises:
        UsageError: No road can be built from these segments.
    """
    world, outline, before = requirements.world, requirements.outline, requirements.before
    if before:
        design = graded(design, elements, outline, world, before)
    first = look(design, elements, requirements)
    free = np.array([element.name not in frozen for element in elements for _ in element.segments])
    if not first.objection or not 1 <= free.sum() <= MOST_SEGMENTS:
        return first
    best, last = None, first
    for margins in MARGINS if before is None else (TIGHT, *MARGINS):
        segments = planned(first, last, free, margins)
        if segments is None:  # there is no such road; with wider margins even less
            break
        if before and segments == last.design.segments:
            continue
        design = first.design.model_copy(update={"segments": segments})
        design = graded(design, first.elements, outline, world, before)
        last = look(design, first.elements, requirements)
        if not last.objection:
            return last if before else restored(last, first)
        if best is None and before is None and last.keeps_all_but_slopes:
            best = last
    return best or first


__all__ = ["Look", "Requirements", "fit", "look"]
