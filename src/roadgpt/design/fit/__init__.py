"""Changes the free elements of a road as little as needed to meet requirements. Main function: ``fit``.

    elements --look--> what is wrong? --aim_of--> limits --least_change--> segments --graded--> look --> Look

An edit first freezes every element that the request does not name: the element's lengths, turns and radii
stay exactly as they are. Only if no valid road is found that way, all elements are free. The road as a whole
may be shifted or rotated, so that it stays inside the map."""

from collections.abc import Collection
from math import ceil, inf

import numpy as np

from roadgpt import check
from roadgpt.check.extremes import lowest
from roadgpt.check.rules.below_floor import ROUNDING
from roadgpt.design.elements import ABOVE_GROUND
from roadgpt.design.fit.grades import graded
from roadgpt.design.fit.look import Look, Requirements
from roadgpt.design.fit.solver import MARGINS, TIGHT, aim_of, least_change
from roadgpt.design.layout import moved_onto_map
from roadgpt.design.road_elements import RoadElements, with_segments
from roadgpt.road import Design, build

CENTIMETRE = 100.0  # per metre: heights are written in centimetres
ROUNDS = 2  # of solving: the second with the transitions that result from the first
MOST_SEGMENTS = 60  # free segments; a road with more is not fitted


def fit(
    design: Design,
    elements: RoadElements,
    requirements: Requirements,
    frozen: Collection[str] = frozenset(),
) -> Look:
    """Finds a road that meets all requirements and differs from the design as little as possible.

    ``design`` is the road after the steps of an edit and then ``graded``, and ``elements`` are its turns and
    straights in driving order, each with its requirement. ``frozen`` are the names of the elements whose
    lengths, turns and radii stay as they are. Returns a Look at that road, with an empty ``objection``; if no
    such road was found, a Look at the design, moved inside the map if possible. Raises UsageError if no road
    can be built from these segments."""
    world, outline, before = requirements.world, requirements.outline, requirements.before
    first = look(design, elements, requirements)
    free = np.array([element.name not in frozen for element in elements for _ in element.segments])
    if not first.objection or not 1 <= free.sum() <= MOST_SEGMENTS:
        return first
    last = first
    for margins in MARGINS if before is None else (TIGHT, *MARGINS):
        segments = None
        for _ in range(ROUNDS):
            found = least_change(aim_of(first, last, segments, free, margins))
            if found is None:
                break
            segments = found
        if segments is None:  # there is no such road; with wider margins even less
            break
        if before and segments == last.design.segments:
            continue
        design = first.design.model_copy(update={"segments": segments})
        design = graded(design, first.elements, outline, world, before)
        last = look(design, first.elements, requirements)
        if not last.objection:
            return last if before else _restored(last, first)
    return first


def look(design: Design, elements: RoadElements, requirements: Requirements) -> Look:
    """Builds and checks the road of a design, and returns a Look at it. The elements of the Look are
    ``elements`` with the segments of the design. If the road is not inside the map and above the ground, it
    is moved there if possible."""
    world, geometry = requirements.world, requirements.geometry
    elements = with_segments(elements, design.segments)
    road = world.lay(build(design, geometry))
    moved = design
    findings = check.inspect(road, None, world)
    if any(finding.rule == "inside_map" or finding.stops for finding in findings):
        # a design that becomes a spline is placed as if it were built of arcs, which lie close by
        moved = moved_onto_map(design, world) or design
    _, low = lowest(road.elevation, road.length)
    if low < world.site.z_floor - ROUNDING:
        x, y, z = moved.starting_point
        height = ceil((world.site.z_floor + ABOVE_GROUND + z - low) * CENTIMETRE) / CENTIMETRE
        moved = moved.model_copy(update={"starting_point": (x, y, height)})
    if moved != design:
        road = world.lay(build(moved, geometry))
        findings = check.inspect(road, None, world)
    return Look(moved, elements, road, findings, requirements)


def _restored(mended: Look, first: Look) -> Look:
    """Returns a repaired road, which meets all rules and requirements, with changed values set back to the
    proposed ones where it then still meets them."""
    trials: list[tuple[float, int, str]] = []
    pairs = zip(first.design.segments, mended.design.segments, strict=True)
    for index, (one, other) in enumerate(pairs):
        for name in ("distance", "turn_degrees", "incline", "transition", "vertical_radius", "radius"):
            before, after = getattr(one, name), getattr(other, name)
            if before != after:
                away = abs((before or 12.0) - (after or 12.0)) / max(abs(before or 12.0), 1.0)
                trials.append((inf if name == "radius" else away, index, name))
    for _, index, name in sorted(trials):  # the smallest changes first
        rows = list(mended.design.segments)
        was, now = first.design.segments[index], rows[index]
        if name == "radius" and (was.distance, was.turn_degrees) != (now.distance, now.turn_degrees):
            continue  # the radius belongs to the proposed distance and angle
        rows[index] = now.model_copy(update={name: getattr(was, name)})
        tried = first.design.model_copy(update={"segments": tuple(rows)})
        seen = look(tried, first.elements, first.requirements)
        if not seen.objection:
            mended = seen
    return mended


__all__ = ["Look", "Requirements", "fit", "look"]
