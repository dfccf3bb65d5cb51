"""Builds the road between two junctions from segments. The road is level where it meets a junction."""

import math
from collections.abc import Sequence
from dataclasses import replace
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
    """Returns the road that segments describe, from a point in metres with a heading in radians.

    ``is_level`` says whether the road is level at its start and at its end. A level end is a few metres long;
    a vertical curve within the first or last segment joins it to the grade of this segment. The radius is
    ``CREST_RADIUS``, or smaller where the segment is too short.
    """
    x, y, z = start
    plan = PieceCurve(x, y, heading, joined(pieces_of(segments)))
    return Road(plan, level_ends(segments, z, is_level), profile=profile)


def level_ends(segments: Sequence[Segment], z: float, is_level: tuple[bool, bool]) -> GradeProfile:
    """Returns the heights along segments, from a height of ``z`` metres; for ``is_level`` see ``road_of``."""
    knots = elevation_of(segments, z).knots
    share = 0.5 if all(is_level) and len(segments) == 1 else 1.0
    if is_level[0]:
        knots = _from_level(knots, share * segments[0].distance)
    if is_level[1]:
        end = knots[-1][0]
        knots = _from_level([(end - s, g) for s, g in reversed(knots)], share * segments[-1].distance)
        knots = [(end - s, g) for s, g in reversed(knots)]
    return GradeProfile.of(z, knots)


def _from_level(knots: list[tuple[float, float]], distance: float) -> list[tuple[float, float]]:
    """Returns the knots (station, grade) with a level part at the start and a vertical curve behind it, both
    within ``distance`` metres. The first knot is at station 0, and the grade is constant up to the second.
    """
    (_, grade), *rest = knots
    if abs(grade) < LEVEL:
        return knots
    room = min(rest[0][0], distance)
    landing = min(LANDING, MOST_OF_LANDING * room)
    length = min(CREST_RADIUS * abs(grade), MOST_OF_SEGMENT * room - landing)
    return [(0.0, 0.0), (landing, 0.0), (landing + length, grade), *rest]


def without_level_ends(road: Road, is_level: tuple[bool, bool]) -> Road:
    """Returns a road without the level ends that ``road_of`` made where ``is_level`` is true. The grade
    beside a level end continues to the end of the road. The heights of ``road`` must be given by grades.
    """
    profile = road.elevation
    assert isinstance(profile, GradeProfile)
    knots = profile.knots
    steep = [n for n, (_, grade) in enumerate(knots) if abs(grade) >= LEVEL]
    if not steep:
        return road
    if is_level[0]:
        knots = [(0.0, knots[steep[0]][1]), *knots[steep[0] :]]
    if is_level[1]:
        last = steep[-1] - len(profile.grades)
        knots = [*knots[: len(knots) + last + 1], (profile.stations[-1], knots[last][1])]
    return Road(road.plan, GradeProfile.of(profile.z0, _increasing(knots)), profile=road.profile)


def _increasing(knots: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    """Returns the knots without those at the station of the knot before."""
    return [knots[0], *(b for a, b in pairwise(knots) if b[0] > a[0])]


def climb_between(z: float, end: float, length: float) -> GradeProfile:
    """Returns the heights over ``length`` metres from height ``z`` to height ``end``: level at both ends,
    with one grade between the two vertical curves.
    """
    climb = end - z
    if abs(climb) < LEVEL:
        return GradeProfile.level(length, z)
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
    Raises TypeError if the elevation of a road is not a GradeProfile.
    """
    knots: list[tuple[float, float]] = []
    start, height = 0.0, 0.0
    for n, road in enumerate(roads):
        own = road.elevation
        if not isinstance(own, GradeProfile):
            raise TypeError("the heights of a network are given by grades")
        height = height if n else own.z0
        here = [(start + s, grade) for s, grade in own.knots]
        knots += here[1:] if knots else here
        start += road.length
        knots[-1] = (start, knots[-1][1])
    return GradeProfile.of(height, _increasing(knots))


def joined_plans(roads: Sequence[Road]) -> PieceCurve:
    """Returns the reference lines of roads, one after another, from the start of the first one."""
    plans = []
    for road in roads:
        if not isinstance(road.plan, PieceCurve):
            raise TypeError("the reference lines of a network are given by pieces")
        plans.append(road.plan)
    return replace(plans[0], pieces=tuple(piece for plan in plans for piece in plan.pieces))


def joined_roads(roads: Sequence[Road]) -> Road:
    """Returns one road made of roads that continue each other. Its cross-section is that of the road with the
    fewest lanes in the direction of the roads. For errors see ``joined_grades``.
    """
    if len(roads) == 1:
        return roads[0]
    profiles = [road.profile for road in roads if road.profile is not None]
    profile = min(profiles, key=lambda profile: profile.count)
    return Road(joined_plans(roads), joined_grades(roads), profile=profile)
