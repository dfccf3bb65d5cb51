"""Steepens a road whose climb is required, because its ends at junctions are level."""

import math
from collections.abc import Sequence

from roadgpt.network.stretch import level_ends
from roadgpt.road import Segment
from roadgpt.road.design import vertical_curves_of

STEADY = 1.0  # percent; a road whose mean grade is less remains unchanged
ROUNDS = 4  # of steepening, since each round also makes the level ends a little longer
TENTH = 10.0  # per percentage point: grades are written to the tenth


def climbing(
    segments: Sequence[Segment], is_level: tuple[bool, bool], steepest: float
) -> tuple[Segment, ...]:
    """Returns the segments, steepened so that level ends do not change the mean grade of the road.

    Up to four rounds of steepening bring the mean grade close to its original value. A road whose mean grade
    is below 1 % is returned unchanged. Vertical radii that no longer fit are reduced.

    ``is_level`` says whether the road is level at its start, and at its end. Steepening stops before a grade
    exceeds ``steepest`` percent.
    """
    length = sum(segment.distance for segment in segments)
    wanted = sum(segment.distance * segment.incline for segment in segments) / length
    found = tuple(segments)
    if abs(wanted) < STEADY:
        return found
    for _ in range(ROUNDS):
        profile = level_ends(found, 0.0, is_level)
        mean = 100 * float(profile.height(length) - profile.height(0.0)) / length
        if mean * wanted <= 0 or abs(mean) >= abs(wanted):
            break
        steeper = [_steeper(segment, wanted / mean) for segment in found]
        if any(abs(segment.incline) > steepest for segment in steeper):
            break
        found = tuple(steeper)
    return _fitted(found)


def _steeper(segment: Segment, factor: float) -> Segment:
    """Returns the segment with its grade multiplied by ``factor``; its vertical curve keeps its length."""
    radius = segment.vertical_radius
    changed = {
        "incline": round(TENTH * segment.incline * factor) / TENTH,
        "vertical_radius": None if radius is None else math.floor(TENTH * radius / factor) / TENTH,
    }
    return segment.model_copy(update=changed)


def _fitted(segments: tuple[Segment, ...]) -> tuple[Segment, ...]:
    """Returns the segments with vertical radii reduced where there is too little room for them."""
    found = list(segments)
    for curve in vertical_curves_of(segments):
        asked = found[curve.number].vertical_radius
        if asked is not None and curve.radius < asked:
            fits = math.floor(TENTH * curve.radius) / TENTH
            found[curve.number] = found[curve.number].model_copy(update={"vertical_radius": fits})
    return tuple(found)
