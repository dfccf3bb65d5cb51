"""Builds the road between two junctions from segments. The road is level where it meets a junction."""

import math
from collections.abc import Sequence
from itertools import pairwise

from roadgpt.geometry import GradeProfile, PieceCurve
from roadgpt.geometry.pieces import joined
from roadgpt.road import Profile, Road, Segment
from roadgpt.road.alignment import pieces_of
from roadgpt.road.builder import elevation_of
from roadgpt.road.elevation import CREST_RADIUS, MOST_OF_SEGMENT

LEVEL = 1e-9  # ratio; a smaller grade is level
LANDING = 6.0  # m of level road before a junction: a little more than the length of a car that waits there
MOST_OF_LANDING = 0.4  # largest share of a segment that the level road may take


def road_of(
    segments: Sequence[Segment],
    start: tuple[float, float, float],
    heading: float,
    profile: Profile,
    is_level: tuple[bool, bool],
) -> Road:
    """Returns the road that segments describe.

    Args:
        segments: At least one segment.
        start: The point in metres at which the road begins.
        heading: The heading there in radians.
        profile: The cross-section.
        is_level: Whether the road is level at the start, and whether it is level at the end. A level end is a
            few metres long; a vertical curve within the first or last segment joins it to the grade of this
            segment. The radius is ``CREST_RADIUS``, or smaller where the segment is too short.
    """
    x, y, z = start
    plan = PieceCurve(x, y, heading, joined(pieces_of(segments)))
    return Road(plan, level_ends(segments, z, is_level), profile=profile)


def level_ends(segments: Sequence[Segment], z: float, is_level: tuple[bool, bool]) -> GradeProfile:
    """Returns the heights along segments, from a height of ``z`` metres; for ``is_level`` see ``road_of``."""
    found = elevation_of(segments, z)
    knots = list(zip(found.stations, found.grades, strict=True))
    share = 0.5 if all(is_level) and len(segments) == 1 else 1.0
    if is_level[0]:
        knots = _from_level(knots, share * segments[0].distance)
    if is_level[1]:
        end = knots[-1][0]
        knots = _from_level([(end - s, g) for s, g in reversed(knots)], share * segments[-1].distance)
        knots = [(end - s, g) for s, g in reversed(knots)]
    return GradeProfile(z, tuple(s for s, _ in knots), tuple(g for _, g in knots))


def _from_level(knots: list[tuple[float, float]], distance: float) -> list[tuple[float, float]]:
    """Returns the knots (station, grade) with a level part at the start, and a vertical curve behind it.

    Args:
        knots: The knots; the first one is at station 0, and the grade is constant up to the second one.
        distance: Length in metres of the first segment, or of the half of it that may be used.
    """
    (_, grade), *rest = knots
    if abs(grade) < LEVEL:
        return knots
    room = min(rest[0][0], distance)
    landing = min(LANDING, MOST_OF_LANDING * room)
    length = min(CREST_RADIUS * abs(grade), MOST_OF_SEGMENT * room - landing)
    return [(0.0, 0.0), (landing, 0.0), (landing + length, grade), *rest]


def without_level_ends(road: Road, is_level: tuple[bool, bool]) -> Road:
    """Returns a road with the heights that it would have if ``road_of`` had not made its ends level.

    Args:
        road: The road; its heights are given by grades.
        is_level: Whether ``road_of`` made its start level, and whether it made its end level.
    """
    profile = road.elevation
    assert isinstance(profile, GradeProfile)
    knots = list(zip(profile.stations, profile.grades, strict=True))
    steep = [n for n, (_, grade) in enumerate(knots) if abs(grade) >= LEVEL]
    if not steep:
        return road
    if is_level[0]:
        knots = [(0.0, knots[steep[0]][1]), *knots[steep[0] :]]
    if is_level[1]:
        last = steep[-1] - len(profile.grades)
        knots = [*knots[: len(knots) + last + 1], (profile.stations[-1], knots[last][1])]
    kept = [knots[0], *(b for a, b in pairwise(knots) if b[0] > a[0])]
    heights = GradeProfile(profile.z0, tuple(s for s, _ in kept), tuple(g for _, g in kept))
    return Road(road.plan, heights, profile=road.profile)


def climb_between(z: float, end: float, length: float) -> GradeProfile:
    """Returns heights that lead from one height to another: level at both ends, with one grade between the
    two vertical curves.

    Args:
        z: The height in metres at the start.
        end: The height in metres at the end.
        length: The length of the road in metres.
    """
    climb = end - z
    if abs(climb) < LEVEL:
        return GradeProfile(z, (0.0, length), (0.0, 0.0))
    landing = min(LANDING, MOST_OF_LANDING * length)
    free = length - 2 * landing
    # two vertical curves of length R g at the grade g: climb = g (free - R g)
    inside = free**2 - 4 * CREST_RADIUS * abs(climb)
    grade = (free - math.sqrt(max(inside, 0.0))) / (2 * CREST_RADIUS)
    curve = CREST_RADIUS * grade
    if inside < 0 or 2 * curve > MOST_OF_SEGMENT * free:
        curve = MOST_OF_SEGMENT * free / 2
    grade = climb / (free - curve)
    stations = (0.0, landing, landing + curve, length - landing - curve, length - landing, length)
    return GradeProfile(z, stations, (0.0, 0.0, grade, grade, 0.0, 0.0))


def joined_grades(roads: Sequence[Road]) -> GradeProfile:
    """Returns the heights along one or more roads that follow each other, from the start of the first one.

    Raises:
        TypeError: The elevation of a road is not a GradeProfile.
    """
    knots: list[tuple[float, float]] = []
    start, height = 0.0, 0.0
    for n, road in enumerate(roads):
        own = road.elevation
        if not isinstance(own, GradeProfile):
            raise TypeError("the heights of a network are given by grades")
        height = height if n else own.z0
        here = [(start + s, g) for s, g in zip(own.stations, own.grades, strict=True)]
        knots += here[1:] if knots else here
        start += road.length
        knots[-1] = (start, knots[-1][1])
    kept = [knots[0], *(b for a, b in pairwise(knots) if b[0] > a[0])]
    return GradeProfile(height, tuple(s for s, _ in kept), tuple(g for _, g in kept))


def joined_roads(roads: Sequence[Road]) -> Road:
    """Returns one road made of roads that continue each other.

    Its cross-section is that of the road with the fewest lanes in the direction of the roads.

    Raises:
        TypeError: The elevation of a road is not a GradeProfile.
    """
    if len(roads) == 1:
        return roads[0]
    first = roads[0].plan
    pieces = tuple(piece for road in roads for piece in road.plan.pieces)  # type: ignore[attr-defined]
    assert isinstance(first, PieceCurve)
    profiles = [road.profile for road in roads if road.profile is not None]
    plan = PieceCurve(first.x, first.y, first.heading0, pieces)
    return Road(plan, joined_grades(roads), profile=min(profiles, key=lambda profile: profile.count))
