"""Builds the road between two junctions from segments, with its cross-section. It is level where it meets a
junction.

Where the route joins a road from a ramp, or leaves a road by a ramp, the line between the directions of this
road lies beside its reference line, so that the reference line of the route can lead along the ramp."""

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

from roadgpt.brief.words import MOST_LANES
from roadgpt.errors import UsageError
from roadgpt.geometry import CubicProfile, ElevationProfile, GradeProfile, Piece, PieceCurve
from roadgpt.geometry.elevation import Cubic, closed
from roadgpt.geometry.pieces import joined
from roadgpt.plural import plural
from roadgpt.road import Design, Profile, Road, Segment, World
from roadgpt.road.builder import elevation_of, pieces_of
from roadgpt.road.design import (
    CREST_RADIUS,
    MEDIAN,
    MOST_OF_SEGMENT,
    JunctionDesign,
    LanesChangeDesign,
    LanesDesign,
    PlaceDesign,
    RampDesign,
)
from roadgpt.road.profile import LaneStrip, Width, as_cubics, width_at
from roadgpt.road.road import reversed_cubics, reversed_road
from roadgpt.road.world import OWN

LEVEL = 1e-9  # ratio; a smaller grade is level
LANDING = 6.0  # m of level road before a junction: a little more than the length of a car that waits there
MOST_OF_LANDING = 0.4  # largest share of a segment that the level road may take
MAIN = LanesDesign(forward=2, backward=0)
"""The lanes of a road that a ramp joins, where none are given: one carriageway of a motorway."""
RAMP = LanesDesign(forward=1, backward=0)
MOST_OF_ROAD = 0.8  # largest share of a road that the taper of a lane may take


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
    ``CREST_RADIUS``, or smaller where the segment is too short."""
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
    within ``distance`` metres. The first knot is at station 0, and the grade is constant up to the second."""
    (_, grade), *rest = knots
    if abs(grade) < LEVEL:
        return knots
    room = min(rest[0][0], distance)
    landing = min(LANDING, MOST_OF_LANDING * room)
    length = min(CREST_RADIUS * abs(grade), MOST_OF_SEGMENT * room - landing)
    return [(0.0, 0.0), (landing, 0.0), (landing + length, grade), *rest]


def without_level_ends(road: Road, is_level: tuple[bool, bool]) -> Road:
    """Returns a road without the level ends that ``road_of`` made where ``is_level`` is true: the grade
    beside a level end continues to the end of the road."""
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
    return [knots[0], *(b for a, b in pairwise(knots) if b[0] > a[0])]


def climb_between(z: float, end: float, length: float) -> GradeProfile:
    """Returns the heights over ``length`` metres from height ``z`` to height ``end``: level at both ends,
    with one grade between the two vertical curves."""
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


def joined_heights(roads: Sequence[Road]) -> ElevationProfile:
    """Returns the heights along roads that follow each other, from the start of the first one: grades, or
    cubics if a road is given by cubics."""
    start, knots, first = 0.0, list[tuple[float, float]](), roads[0].elevation
    profiles = [road.elevation for road in roads if isinstance(road.elevation, GradeProfile)]
    if isinstance(first, GradeProfile) and len(profiles) == len(roads):
        for road, profile in zip(roads, profiles, strict=True):
            here = [(start + s, grade) for s, grade in profile.knots]
            knots += here[1:] if knots else here
            start += road.length
            knots[-1] = (start, knots[-1][1])
        return GradeProfile.of(first.z0, _increasing(knots))
    rows = list[tuple[float, Cubic]]()
    for road in roads:
        own = road.elevation
        if isinstance(own, GradeProfile):
            table = [(s, (*own.at(s), float(own.vertical_curvature(s)) / 2, 0.0)) for s in own.stations[:-1]]
        else:
            assert isinstance(own, CubicProfile)
            table = as_cubics(own).rows
        rows += [(start + s, cubic) for s, cubic in table if 0 <= s < road.length - LEVEL]
        start += road.length
    return CubicProfile.of_rows(rows)


def turned(road: Road) -> Road:
    """Returns a road that leads from the end of a road with lanes to its start, with the same lanes. The car
    keeps to the outermost driving lane."""
    profile, length = road.profile, road.length
    assert profile is not None

    def back(width: Width) -> Width:
        if not isinstance(width, CubicProfile):
            return width
        return closed(reversed_cubics(as_cubics(width), length).rows, length)

    left, right = (
        tuple(replace(lane, width=back(lane.width)) for lane in side)
        for side in (profile.right, profile.left)
    )
    ids, angle, offset = profile.against_ids, profile.superelevation_angle, back(profile.offset)
    own = replace(
        profile,
        left=left,
        right=right,
        driven=abs(ids[-1]) - 1 if ids else 0,
        offset=offset.negative if isinstance(offset, CubicProfile) else 0.0 - offset,
        superelevation_angle=None if angle is None else as_cubics(back(angle)).negative,
    )
    return reversed_road(road).with_profile(own)


def parts_of(road: Road, s: float) -> tuple[Road, Road]:
    """Returns the parts of a road before and behind a station in metres, without cross-sections."""
    plan, heights = road.plan, road.elevation
    assert isinstance(plan, PieceCurve)
    assert isinstance(heights, GradeProfile)
    before, behind, start = list[Piece](), list[Piece](), 0.0
    for piece in plan.pieces:
        cut = min(max(s - start, 0.0), piece.length)
        middle = piece.k0 + (piece.k1 - piece.k0) * cut / piece.length
        before.append(Piece(cut, piece.k0, middle))
        behind.append(Piece(piece.length - cut, middle, piece.k1))
        start += piece.length
    height, grade = heights.at(s)
    low = [*(knot for knot in heights.knots if knot[0] < s), (s, grade)]
    high = [(0.0, grade), *((at - s, each) for at, each in heights.knots if at > s)]
    first = PieceCurve(plan.x, plan.y, plan.heading0, joined(before))
    second = PieceCurve(*first.end, joined(behind))
    return Road(first, GradeProfile.of(heights.z0, low)), Road(second, GradeProfile.of(height, high))


def joined_plans(roads: Sequence[Road]) -> PieceCurve:
    """Returns the reference lines of roads, one after another, from the start of the first one."""
    plans = [road.plan for road in roads if isinstance(road.plan, PieceCurve)]
    if len(plans) < len(roads):
        raise TypeError("the reference lines of a network are given by pieces")
    return replace(plans[0], pieces=tuple(piece for plan in plans for piece in plan.pieces))


def joined_roads(roads: Sequence[Road]) -> Road:
    """Returns one road made of roads that continue each other. Its cross-section is that of the road with the
    fewest lanes in the direction of the roads."""
    if len(roads) == 1:
        return roads[0]
    profiles = [road.profile for road in roads if road.profile is not None]
    profile = min(profiles, key=lambda profile: profile.count)
    return Road(joined_plans(roads), joined_heights(roads), profile=profile)


def stretch_profiles(design: Design, world: World) -> list[Profile]:
    """Returns the cross-section of each road of a route, with the tapers of lanes that end or begin; for a
    map, the one that all its roads have. For errors see ``refuse_other_lanes`` and ``profiles_between``."""
    section = world.section
    refuse_other_lanes(world)
    first = design.lanes or LanesDesign(width=section.lane_width)
    lengths = [sum(segment.distance for segment in segments) for segments in design.stretches]
    return profiles_between(first, design.junctions, lengths, section.shoulder)


def refuse_other_lanes(world: World) -> None:
    """Raises UsageError if the World asks for lanes or banked bends that networks do not have."""
    changed = [name for name, usual in OWN.items() if getattr(world.section, name) != usual]
    if changed:
        flags = ", ".join(f"--{name.replace('_', '-')}" for name in changed)
        raise UsageError(f"a network takes its lanes from its design, and has level roads; leave out {flags}")


def profiles_between(
    first: LanesDesign, places: Sequence[PlaceDesign], lengths: Sequence[float], shoulder: float
) -> list[Profile]:
    """Returns the cross-sections of the roads before, between and behind the places that a route passes.
    ``first`` are the lanes of the first road; the lengths of the roads and the width of the shoulders are in
    metres.

    Raises UsageError in four cases: a road would have no lane or too many lanes; the lanes of a road
    contradict the lane drop, gain or change before this road; a ramp on the left would cross oncoming lanes;
    the ramp that the route takes has oncoming traffic or more than one lane."""
    lanes = [first]
    for number, place in enumerate(places, 1):
        lanes.append(_behind(number, place, lanes[-1]))
    found = [_profile(each, shoulder) for each in lanes]
    offsets = _offsets(places, lanes)
    around = (None, *places, None)
    for n, length in enumerate(lengths):
        before, after = around[n], around[n + 1]
        if offsets[n]:
            found[n] = replace(found[n], offset=offsets[n])
        if isinstance(after, RampDesign) and after.is_on_left:
            main = [lanes[n + (after.kind == "merge")]] if after.take == "ramp" else lanes[n : n + 2]
            if any(each.backward for each in main):
                raise UsageError(
                    f"junction {n + 1}: the ramp lies on the side of oncoming traffic and would cross its "
                    'lanes; give the road that it joins or leaves "backward": 0, or leave its side out'
                )
        gain = before if isinstance(before, LanesChangeDesign) and before.kind == "lane_gain" else None
        drop = after if isinstance(after, LanesChangeDesign) and after.kind == "lane_drop" else None
        if gain is not None or drop is not None:
            found[n] = _tapered(found[n], gain, drop, length)
        if before is not None and before.kind == "bus_bay":
            found[n] = _with_bay(found[n], length)
        is_ramp = _is_ramp(after, "merge") or _is_ramp(before, "diverge")
        if is_ramp and (lanes[n].forward, lanes[n].backward) != (1, 0):
            raise UsageError(
                f"junction {n + _is_ramp(after, 'merge')}: the route comes or goes by the ramp, which has "
                'one lane and no oncoming traffic; give that road "lanes": {"forward": 1, "backward": 0}'
            )
    return found


def _offsets(places: Sequence[PlaceDesign], lanes: Sequence[LanesDesign]) -> list[float]:
    """Returns the offset of the line between the directions from the reference line, in metres for each road.
    It changes only at junctions and where the route leads from a ramp to the main road, or the other way."""
    found: list[float] = []
    for n in range(len(lanes)):
        before = places[n - 1] if n else None
        if n == 0 or isinstance(before, JunctionDesign):
            found.append(_first_offset(places[n:], lanes[n:]))
        elif isinstance(before, RampDesign) and _is_ramp(before, "merge"):
            found.append(found[-1] + _beside_ramp(before, lanes[n - 1], lanes[n]))
        elif isinstance(before, RampDesign) and _is_ramp(before, "diverge"):
            found.append(found[-1] - _beside_ramp(before, lanes[n], lanes[n - 1]))
        else:
            found.append(found[-1])
    return found


def _first_offset(places: Sequence[PlaceDesign], lanes: Sequence[LanesDesign]) -> float:
    """Returns the offset with which the reference line leads along the ramp of the next exit; 0 if the route
    takes no such exit before the next junction."""
    for place, (own, behind) in zip(places, pairwise(lanes), strict=False):
        if isinstance(place, RampDesign) and _is_ramp(place, "diverge"):
            return _beside_ramp(place, behind, own)
        if isinstance(place, JunctionDesign) or _is_ramp(place, "merge"):
            break
    return 0.0


def _beside_ramp(place: RampDesign, ramp: LanesDesign, main: LanesDesign) -> float:
    """Returns the offset in metres of the main road's line between the directions from that of the ramp."""
    return -ramp.width if place.is_on_left else main.forward * main.width


def _is_ramp(place: PlaceDesign | None, kind: str) -> bool:
    return isinstance(place, RampDesign) and place.kind == kind and place.take == "ramp"


def _behind(number: int, place: PlaceDesign, before: LanesDesign) -> LanesDesign:
    if isinstance(place, LanesChangeDesign):
        step = {"lane_drop": -1, "lane_gain": 1}.get(place.kind, 0)
        count = plural(before.forward + step, "lane")
        if not 1 <= before.forward + step <= MOST_LANES:
            raise UsageError(
                f"junction {number}: a {place.kind} leaves {count}, and a road has 1 to {MOST_LANES}; give "
                "the road before it other lanes"
            )
        if place.lanes is None:
            return before.model_copy(update={"forward": before.forward + step})
        if place.lanes.forward != before.forward + step or place.lanes.width != before.width:
            raise UsageError(
                f"junction {number}: the road behind a {place.kind} has {count} here, {before.width:g} m "
                "wide; give these, or leave its lanes out"
            )
        return place.lanes
    if isinstance(place, RampDesign) and place.take == "main":
        return before
    if place.lanes is not None or not isinstance(place, RampDesign):
        return place.lanes or before
    return (MAIN if place.kind == "merge" else RAMP).model_copy(update={"width": before.width})


def _profile(lanes: LanesDesign, shoulder: float) -> Profile:
    made = Profile.of(lanes.forward, lanes.backward, lanes.width, shoulder)
    if lanes.edge != "solid":
        left, right = (
            tuple(replace(lane, marking=lanes.edge) if lane.marking == "solid" else lane for lane in side)
            for side in (made.left, made.right)
        )
        made = replace(made, left=left, right=right)
    if lanes.divided:
        made = replace(made, left=(LaneStrip("median", MEDIAN, "solid"), *made.left), centre_marking="solid")
    return made if lanes.centre is None else replace(made, centre_marking=lanes.centre)


BAY = [(0.0, 0.0), (25.0, 3.0), (43.0, 3.0), (58.0, 0.0)]
"""Stations and depths in metres of a bus bay: 25 m to go in, 18 m to stand, 15 m to go out (RASt 06)."""


def _with_bay(profile: Profile, length: float) -> Profile:
    """Returns the cross-section with a bus bay between the lanes along the road and the shoulder."""
    if length < BAY[-1][0]:
        raise UsageError(
            f"a bus bay needs {BAY[-1][0]:.0f} m of the road behind it, which is {length:.0f} m long; make "
            "that road longer"
        )
    count, bay = profile.count[0], LaneStrip("parking", CubicProfile.smooth(BAY))
    return replace(profile, right=(*profile.right[:count], bay, *profile.right[count:]))


def _tapered(
    profile: Profile, gain: LanesChangeDesign | None, drop: LanesChangeDesign | None, length: float
) -> Profile:
    """Returns the cross-section with a lane whose width rises from 0 at the start, and a lane whose width
    falls to 0 at the end. Both may be the same lane."""
    outer = profile.count[0] - 1
    first, last = (None if each is None else 0 if each.side == "left" else outer for each in (gain, drop))
    most = MOST_OF_ROAD * length / (2 if first == last else 1)
    lanes = list(profile.right)
    for index, lane in enumerate(lanes):
        full = width_at(lane.width, 0.0)
        knots = [(0.0, full)]
        if gain is not None and index == first:
            knots = [(0.0, 0.0), (min(gain.length, most), full)]
        if drop is not None and index == last:
            knots += [(length - min(drop.length, most), full), (length, 0.0)]
        if len(knots) > 1:
            lanes[index] = replace(lane, width=CubicProfile.smooth(knots))
    return replace(profile, right=tuple(lanes))
