"""Converts elements to RoadGPT's segments and back.

In RoadGPT's format, a turn of more than 70 degrees is split into several segments; an element is the whole
turn. Elements that the planner drafted can be recovered from their segments exactly, because their numbers
are rounded to the precision of design files.
"""

from collections.abc import Iterator, Sequence
from itertools import pairwise
from math import ceil, floor, radians

from roadgpt.brief.element import Element
from roadgpt.brief.ranges import Range
from roadgpt.road import Segment
from roadgpt.road.alignment import LONGEST_TRANSITION, TRANSITION_SHARE
from roadgpt.road.design import MAX_TURN

MILLIMETRE = 1000.0  # per metre: distances are written to the millimetre
TENTH = 10.0  # per unit: angles, transitions and inclines are written to the tenth
HUNDREDTH = 100.0  # per metre: radii are written to the centimetre
MOST_TRANSITION = 0.55  # of a segment's arc: with more it could not keep its radius (see road.alignment)
SHORTEST = 0.5  # m, of a straight that is written
SPARE = 1.0  # m: a turn longer than its radius needs by more than this is a turn between two straights


def turn_element(
    angle: float,
    hand: int,
    radius: float,
    transition: float,
    required_grade: Range | None = None,
    required_climb: Range | None = None,
) -> Element:
    """Returns a turn with numbers rounded to the precision of design files.

    The angle is in degrees and positive; ``hand`` is 1 for a left turn, -1 for a right turn. The transition
    at each end is shortened to at most 0.55 of the arc length of one segment, so that it fits.
    """
    parts = segments_of_turn(angle)
    share = round(angle / parts * TENTH) / TENTH
    radius = ceil(radius * HUNDREDTH) / HUNDREDTH
    most = MOST_TRANSITION * radius * radians(share)
    transition = max(floor(min(transition, most) * TENTH), 1) / TENTH
    return Element(
        turn=hand * share * parts,
        radius=radius,
        transition=transition,
        required_grade=required_grade,
        required_climb=required_climb,
    )


def as_written(element: Element) -> Element:
    """Returns the element with its length, angle, radius and transition rounded to the precision of design
    files.
    """
    if not element.turn:
        return element._replace(straight=max(element.straight, SHORTEST))
    hand = 1 if element.turn > 0 else -1
    written = turn_element(abs(element.turn), hand, element.radius, element.transition)
    return element._replace(turn=written.turn, radius=written.radius, transition=written.transition)


def segments_of_turn(angle: float) -> int:
    """Returns the number of RoadGPT segments into which a turn of ``angle`` degrees is split."""
    return max(1, ceil(angle / MAX_TURN - 1e-9))


def cut(element: Element) -> list[Segment]:
    """Cuts an element into segments; the element must be rounded to the precision of design files."""
    if not element.turn:
        return [
            Segment(
                distance=round(element.straight * MILLIMETRE) / MILLIMETRE,
                direction="straight",
                incline=element.incline,
                vertical_radius=element.vertical_radius,
            )
        ]
    parts = segments_of_turn(abs(element.turn))
    share = element.turn / parts
    arc = element.radius * radians(abs(share))
    out = []
    for part in range(parts):
        ends = (part == 0) + (part == parts - 1)
        # outer parts a hair long, inner ones a hair short: so every part can keep the radius
        exact = (arc + ends * element.transition / 2) * MILLIMETRE
        out.append(
            Segment(
                distance=(ceil(exact) if ends else floor(exact)) / MILLIMETRE,
                direction="left" if element.turn > 0 else "right",
                incline=element.incline,
                turn_degrees=round(share * TENTH) / TENTH,
                radius=element.radius if ends else None,
                transition=element.transition if ends else None,
                vertical_radius=None if part else element.vertical_radius,
            )
        )
    return out


def straight(length: float, incline: float) -> Segment:
    """Returns a straight segment with numbers rounded to the precision of design files."""
    return Segment(distance=round(max(length, 1.0), 1), direction="straight", incline=round(incline, 1))


def turn_segments(
    degrees: float, hand: int, radius: float, transition: float, incline: float
) -> tuple[Segment, ...]:
    """Returns the segments into which a turn with these values is cut."""
    turn = turn_element(degrees, hand, radius, transition)
    return tuple(cut(turn._replace(incline=round(incline * TENTH) / TENTH)))


def elements_of(segments: Sequence[Segment]) -> tuple[Element, ...]:
    """Returns the elements that these segments form, in driving order; neighbouring straights with the same
    incline become one element.
    """
    out: list[Element] = []
    for group in _groups(segments):
        for element in _of_group(group):
            last = out[-1] if out else None
            if last and not last.turn and not element.turn and last.incline == element.incline:
                out[-1] = last._replace(straight=last.straight + element.straight)
            else:
                out.append(element)
    return tuple(out)


def _groups(segments: Sequence[Segment]) -> Iterator[list[Segment]]:
    """Yields groups of segments: all segments of one turn, or a single straight segment."""
    group = [segments[0]]
    for before, segment in pairwise(segments):
        if _goes_on(before, segment, group[0].radius):
            group.append(segment)
        else:
            yield group
            group = [segment]
    yield group


def _goes_on(before: Segment, segment: Segment, radius: float | None) -> bool:
    """Returns whether a segment is part of the same turn as the segment before it."""
    same = (before.turn_degrees, before.incline) == (segment.turn_degrees, segment.incline)
    return bool(segment.turn_degrees) and same and (segment.radius is None or segment.radius == radius)


def _of_group(group: Sequence[Segment]) -> Iterator[Element]:
    first = group[0]
    length = sum(segment.distance for segment in group)
    turn = sum(segment.turn_degrees for segment in group)
    if not turn:
        yield Element(length, incline=first.incline, vertical_radius=first.vertical_radius)
        return
    transition = first.transition or min(TRANSITION_SHARE * first.distance, LONGEST_TRANSITION)
    radius = (length - transition) / radians(abs(turn))
    spare = 0.0
    if first.radius and first.radius < radius:
        spare = length - transition - first.radius * radians(abs(turn))
        radius = first.radius
    straight = Element(spare / 2, incline=first.incline)
    bend = Element(turn=round(turn, 6), radius=radius, transition=transition, incline=first.incline)
    row = (straight, bend, straight) if spare > SPARE else (bend,)
    yield from (row[0]._replace(vertical_radius=first.vertical_radius), *row[1:])


def required_hills(plan: Sequence[Element]) -> int:
    """Returns how often the required grades force a road to change between climbing and falling."""
    required = (element.required_grade for element in plan)
    climbs = [grade.lo > 0 for grade in required if grade and 0 not in grade]
    return sum(one != other for one, other in pairwise(climbs))
