"""Converts elements to a Design on the map, with grades that do not change too abruptly for the speed."""

from collections.abc import Sequence
from math import ceil

import numpy as np

from roadgpt.brief.element import Element
from roadgpt.brief.ranges import Range
from roadgpt.check.extremes import lowest
from roadgpt.design.elements import as_written, cut
from roadgpt.design.heights import rounded
from roadgpt.design.layout import MapPose
from roadgpt.design.vertical import SHORTEST_SLOPE, Pace, joined, made_to_fit, too_abrupt, widened
from roadgpt.road import Design, Segment, World
from roadgpt.road.builder import elevation_of
from roadgpt.road.design import MAX_INCLINE

ABOVE_GROUND = 1.0  # m from the ground to the lowest place of a road
CENTIMETRE = 100.0  # per metre: heights are written in centimetres


def segments_of(elements: Sequence[Element], world: World) -> tuple[Segment, ...]:
    """Returns the segments of elements, with grades rounded so that each is clearly up, down or flat.

    If the change between two grades is too abrupt for the expected speed, the grades are brought closer
    together.
    """
    written = [as_written(element) for element in elements]
    pace = Pace.along(written, world)
    inclines = [element.incline for element in elements]
    segments = joined(_cut(written, inclines), pace)
    if not too_abrupt(segments, pace):
        return segments
    most = min(100 * world.limits.max_grade, MAX_INCLINE)
    lengths = [element.length for element in written]
    short = {i for i, element in enumerate(written) if not element.turn and lengths[i] < SHORTEST_SLOPE}
    grades = made_to_fit(
        np.array(inclines), lengths, inclines, short, [Range(-most, most)] * len(written), pace
    )
    return widened(joined(_cut(written, grades.tolist()), pace), pace)


def _cut(written: Sequence[Element], grades: Sequence[float]) -> list[Segment]:
    """Returns the segments of elements with these inclines in percent."""
    pairs = zip(written, grades, strict=True)
    sloped = (element._replace(incline=float(rounded(np.array(grade))) + 0.0) for element, grade in pairs)
    return [segment for element in sloped for segment in cut(element)]


def design_of(elements: Sequence[Element], place: MapPose, world: World) -> Design:
    """Returns a design of these elements that starts at ``place``, with its lowest point 1 m above the ground
    or above height 0, whichever is higher.
    """
    return design_at(place, segments_of(elements, world), max(0.0, world.site.z_floor) + ABOVE_GROUND)


def design_at(place: MapPose, segments: tuple[Segment, ...], ground: float) -> Design:
    """Returns a design of these segments that starts at ``place``, with its lowest point at height
    ``ground``.
    """
    return Design(
        starting_point=(place.x, place.y, start_height(segments, ground)),
        theta=place.theta,
        segments=segments,
    )


def start_height(segments: Sequence[Segment], ground: float) -> float:
    """Returns the start height in metres for which the lowest point is at height ``ground``."""
    profile = elevation_of(segments, 0.0)
    _, sag = lowest(profile, profile.stations[-1])
    return ceil((ground - sag) * CENTIMETRE) / CENTIMETRE
