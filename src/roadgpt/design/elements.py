"""Converts elements to RoadGPT's segments and back, and to a Design on the map.

In RoadGPT's format, a turn of more than 70 degrees is split into several segments; an element is the whole
turn. Elements that the planner drafted can be recovered from their segments exactly, because their numbers
are rounded to the precision of design files. Grades that change too abruptly for the speed are brought closer
together when elements are written as segments."""

from collections.abc import Iterator, Sequence
from itertools import pairwise
from math import ceil, floor, radians

import numpy as np

from roadgpt.brief.element import Element
from roadgpt.brief.ranges import Range
from roadgpt.check.extremes import lowest
from roadgpt.check.measures import LEVEL
from roadgpt.design.layout import MapPose
from roadgpt.design.vertical import SHORTEST_SLOPE, Pace, joined, made_to_fit, too_abrupt, widened
from roadgpt.geometry.curve import Array
from roadgpt.road import Design, Segment, World
from roadgpt.road.builder import LONGEST_TRANSITION, TRANSITION_SHARE, elevation_of
from roadgpt.road.design import MAX_INCLINE, MAX_TURN

MILLIMETRE = 1000.0  # per metre: distances are written to the millimetre
TENTH = 10.0  # per unit: angles, transitions and inclines are written to the tenth
HUNDREDTH = 100.0  # per metre: radii are written to the centimetre
MOST_TRANSITION = 0.55  # of a segment's arc: with more it could not keep its radius (see road.builder)
SHORTEST = 0.5  # m, of a straight that is written
UNCLEAR = 0.2  # percentage points around the edge of flat, where rounding would decide
SPARE = 1.0  # m: a turn longer than its radius needs by more than this is a turn between two straights
ABOVE_GROUND = 1.0  # m from the ground to the lowest place of a road
CENTIMETRE = 100.0  # per metre: heights are written in centimetres


def turn_element(
    angle: float,
    hand: int,
    radius: float,
    transition: float,
    required_grade: Range | None = None,
    required_climb: Range | None = None,
    has_bump: bool = False,
) -> Element:
    """Returns a turn with numbers rounded to the precision of design files. The angle is in degrees and
    positive; ``hand`` is 1 for a left turn, -1 for a right turn. The transition at each end is shortened to
    at most 0.55 of the arc length of one segment, so that it fits. With ``has_bump``, a crest or a dip lies
    in its middle."""
    parts = 2 * segments_of_turn(angle / 2) if has_bump else segments_of_turn(angle)
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
        half="both" if has_bump else "",
    )


def as_written(element: Element) -> Element:
    """Returns the element with its numbers rounded to the precision of design files."""
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
        distance = round(element.straight * MILLIMETRE) / MILLIMETRE
        slope = {"incline": element.incline, "vertical_radius": element.vertical_radius}
        return [Segment(distance=distance, direction="straight", **slope)]
    parts = segments_of_turn(abs(element.turn))
    share = element.turn / parts
    arc = element.radius * radians(abs(share))
    out = []
    for part in range(parts):
        ends = (part == 0 and element.half != "second") + (part == parts - 1 and element.half != "first")
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
    degrees: float, hand: int, radius: float, transition: float, *inclines: float
) -> tuple[Segment, ...]:
    """Returns the segments into which a turn with these values is cut. With two inclines, each half of the
    turn has its own."""
    turn = turn_element(degrees, hand, radius, transition, has_bump=len(inclines) > 1)
    halves = zip(turn.halves, (round(incline * TENTH) / TENTH for incline in inclines), strict=True)
    return tuple(segment for half, grade in halves for segment in cut(half._replace(incline=grade)))


def rounded(values: Array) -> Array:
    """Returns grades in percent, rounded to a tenth so that each is clearly flat or clearly not."""
    steep = np.abs(values)
    near = np.abs(steep - LEVEL) < UNCLEAR
    clear = np.where(near, LEVEL + np.where(steep < LEVEL, -UNCLEAR, UNCLEAR), steep)
    return np.asarray(np.round(np.copysign(clear, values) * TENTH) / TENTH)


def elements_of(segments: Sequence[Segment]) -> tuple[Element, ...]:
    """Returns the elements that these segments form, in driving order; neighbouring straights with the same
    incline become one element."""
    out: list[Element] = []
    for group in _groups(segments):
        for element in _of_group(group):
            last = out[-1] if out else None
            if last and not last.turn and not element.turn and last.incline == element.incline:
                out[-1] = last._replace(straight=last.straight + element.straight)
            else:
                out.append(element)
    return tuple(out)


def _groups(segments: Sequence[Segment]) -> list[list[Segment]]:
    """Returns groups of segments: all segments of one turn, or a single straight segment."""
    groups: list[list[Segment]] = []
    for segment in segments:
        first, before = (groups[-1][0], groups[-1][-1]) if groups else (segment, segment)
        same = (before.turn_degrees, before.incline) == (segment.turn_degrees, segment.incline)
        if groups and segment.turn_degrees and same and segment.radius in (None, first.radius):
            groups[-1].append(segment)
        else:
            groups.append([segment])
    return groups


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


def segments_of(elements: Sequence[Element], world: World) -> tuple[Segment, ...]:
    """Returns the segments of elements, with grades rounded so that each is clearly up, down or flat. If the
    change between two grades is too abrupt for the expected speed, the grades are brought closer together."""
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
    pairs = zip(written, (rounded(np.array(grades)) + 0.0).tolist(), strict=True)
    return [segment for element, grade in pairs for segment in cut(element._replace(incline=grade))]


def design_of(elements: Sequence[Element], place: MapPose, world: World) -> Design:
    """Returns a design of these elements that starts at ``place``, with its lowest point 1 m above the ground
    or above height 0, whichever is higher."""
    return design_at(place, segments_of(elements, world), max(0.0, world.site.z_floor) + ABOVE_GROUND)


def design_at(place: MapPose, segments: tuple[Segment, ...], ground: float) -> Design:
    """Returns a design of these segments that starts at ``place``, with its lowest point at height
    ``ground``."""
    start = (place.x, place.y, start_height(segments, ground))
    return Design(starting_point=start, theta=place.theta, segments=segments)


def start_height(segments: Sequence[Segment], ground: float) -> float:
    """Returns the start height in metres for which the lowest point is at height ``ground``."""
    profile = elevation_of(segments, 0.0)
    _, sag = lowest(profile, profile.stations[-1])
    return ceil((ground - sag) * CENTIMETRE) / CENTIMETRE
