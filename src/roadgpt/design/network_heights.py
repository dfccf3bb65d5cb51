"""Makes up for the level ends of a road between junctions of which a difference of heights is required."""

import math
from collections.abc import Sequence

from roadgpt.network.stretch import level_ends
from roadgpt.road import Segment
from roadgpt.road.elevation import vertical_curves_of

STEADY = 1.0  # percent; of a road that climbs or falls less on average, the heights are left as they are
ROUNDS = 4  # of making it steeper; each makes the level ends a little longer, too
TENTH = 10.0  # per percentage point: grades are written to the tenth


def climbing(
    segments: Sequence[Segment], is_level: tuple[bool, bool], steepest: float
) -> tuple[Segment, ...]:
    """Returns the segments with grades so much steeper that the mean grade is what it was without level ends.

    Args:
        segments: the segments of a road.
        is_level: whether the road is level at its start, and at its end.
        steepest: the steepest grade allowed, in percent; where it is exceeded, nothing is changed.
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
    """Returns the segment with a grade so many times as steep; its vertical curve keeps its length."""
    radius = segment.vertical_radius
    changed = {
        "incline": round(TENTH * segment.incline * factor) / TENTH,
        "vertical_radius": None if radius is None else math.floor(TENTH * radius / factor) / TENTH,
    }
    return segment.model_copy(update=changed)


def _fitted(segments: tuple[Segment, ...]) -> tuple[Segment, ...]:
    """Returns the segments with the vertical radii that have room between their neighbours."""
    found = list(segments)
    for curve in vertical_curves_of(segments):
        asked = found[curve.number].vertical_radius
        if asked is not None and curve.radius < asked:
            fits = math.floor(TENTH * curve.radius) / TENTH
            found[curve.number] = found[curve.number].model_copy(update={"vertical_radius": fits})
    return tuple(found)
