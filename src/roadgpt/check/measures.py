"""Measures finished roads, routes and maps: turns, straights and grades; junctions with kind, directions,
exits and signs; blocks, ends and distances.

Turns, straights and grades are measured on the points of a centre line, without any other information. Angles
are in degrees, lengths in metres, and grades in percent, uphill positive. The centre line is resampled about
every metre in plan:

* Curvature: change of heading per metre, averaged over 5 m.
* Turn: a part of the road that bends to one side with a curvature above a limit of 1/300 per metre. If the
  description asks for wider turns, as on a motorway, the limit is lower. Parts that bend to the same side and
  are less than 8 m apart are merged into one turn, except parts that turn by less than 4 degrees. The angle
  of a turn includes its ends, up to where the curvature falls below a tenth of the limit or changes sign. A
  bend of less than 10 degrees is not a turn.
* Straight: a part of 10 m or more between two turns, or between a turn and an end of the road. It is divided
  into pieces where its grade, over 10 m windows, changes between up (1 % or more), flat and down (-1 % or
  less). Pieces shorter than 6 m are ignored.

Source: the definitions of an independent road checker. ``tests/authorities`` compares its measurements with
those of this module.

The direction of an arm of a junction is the direction of the straight line from the junction to the point
15 m along the arm. On a shorter road, the line leads to the far end. So a bend within these 15 m changes the
direction."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import islice, pairwise
from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roadgpt.brief.junctions import RAMPS, side_of
from roadgpt.brief.outline import USUALLY_WIDEST
from roadgpt.errors import UsageError
from roadgpt.geometry import CubicProfile, PieceCurve
from roadgpt.geometry.curve import Array
from roadgpt.geometry.nearness import Indices
from roadgpt.geometry.pieces import along_all
from roadgpt.language.names import Control, JunctionKind, LaneKind, Side, Way
from roadgpt.network import Connection, Junction, Network, NetworkRoad, RoadEnd
from roadgpt.network.network import kinds_of
from roadgpt.road.design import LEAST_WIDTH

if TYPE_CHECKING:
    from roadgpt.network import Passage, Roundabout, Route

STEP = 1.0  # m between stations
FADES = 10.0  # times the widest radius: straighter parts do not belong to the angle of a turn
SMOOTHED = 5  # stations that a curvature is averaged over
JOINED = 8.0  # m: parts that bend to one side and are closer together are one turn
SLIGHT = 4.0  # degrees: a part that turns less is not joined to others
LEAST_TURN = 10.0  # degrees
LEAST_STRAIGHT = 10.0  # m
LEAST_PIECE = 6.0  # m
LEVEL = 1.0  # percent: less is flat
HALF_WINDOW = 5  # stations to either side for the grade that cuts a straight into pieces
LONG_WINDOW, SHORT_WINDOW = 20, 10  # stations: for climbing and falling, and for the steepest place
FULL = 0.9  # of the width of a lane, above which it is not yet in its taper
OUT = 15.0  # m, from a contact to the point that gives the direction of its arm
LANE_STEP = 0.5  # m, between stations at which the width of a lane is measured
STRAIGHT_ROAD = math.radians(5.0)  # largest change of heading of a road that counts as straight


@dataclass(frozen=True, slots=True)
class MeasuredFeature:
    """A turn, a straight, or a piece of a straight, as measured on a finished road."""

    kind: Literal["turn", "straight"]
    start: float  # station in metres where the feature starts, measured in plan
    end: float
    side: Literal["left", "right"] | None
    degrees: float
    """Absolute change of heading in degrees. A turn includes its ends, where the curvature fades out; a
    straight excludes the 5 m at either end."""
    radius: float  # radius in metres at the tightest place
    grade: float  # mean grade in percent, from end to end
    inner_grade: float
    """Mean grade in percent over the middle half. It is close to the design grade even where vertical curves
    take up the ends of a short slope."""
    pieces: tuple["MeasuredFeature", ...] = ()
    """The pieces of a straight, each with one class of grade (up, flat or down); empty for a turn."""
    slopes: tuple["MeasuredFeature", ...] = ()
    """The parts of a turn before and behind its highest place, or its lowest one, if that lies in its middle
    half and one part climbs and the other falls; else empty."""

    @property
    def length(self) -> float:
        """The length of the feature in plan, in metres."""
        return self.end - self.start

    @property
    def climb(self) -> float:
        """How many metres the feature rises from its start to its end; negative if it falls."""
        return self.grade * self.length / 100


class GradeChange(NamedTuple):
    """A change of grade between two parts of a straight that both go up, or both go down."""

    grade: float  # a grade in percent: the mean of the grades that are requested of the two parts
    rises: bool  # whether the grade of the second part is the larger one; -4 percent is larger than -8


class CentreLine(NamedTuple):
    """The resampled centre line: stations and heights in metres, heading in radians, curvature in 1/m."""

    s: Array
    z: Array
    heading: Array
    curvature: Array


@dataclass(frozen=True, slots=True)
class RoadMeasures:
    """The measured turns, straights, grades and lengths of a road."""

    features: tuple[MeasuredFeature, ...]  # turns and straights in driving order
    length: float  # length in plan in metres
    climb: float  # height difference in metres from start to end
    grade: float  # mean grade in percent, from start to end
    lowest_grade: float  # lowest grade over any 20 m in percent; negative if the road falls there
    highest_grade: float  # highest grade over any 20 m in percent; negative if the road falls everywhere
    steepest: float  # greatest absolute grade over any 10 m in percent
    hills: int  # number of changes between climbing and falling; grades are averaged over 20 m
    radius: float  # radius in metres at the tightest place of the road
    turning: float  # sum of the absolute changes of heading along the road in degrees
    line: CentreLine = field(repr=False, compare=False)  # the points that were measured

    @property
    def turns(self) -> tuple[MeasuredFeature, ...]:
        """The turns in driving order."""
        return tuple(f for f in self.features if f.kind == "turn")

    @property
    def straights(self) -> tuple[MeasuredFeature, ...]:
        """The straights in driving order."""
        return tuple(f for f in self.features if f.kind == "straight")

    @property
    def gaps(self) -> tuple[tuple[MeasuredFeature, ...], ...]:
        """The straights before the first turn, between consecutive turns, and after the last turn: with n
        turns n + 1 entries, each empty where there is no straight."""
        out: list[tuple[MeasuredFeature, ...]] = [()]
        for feature in self.features:
            if feature.kind == "turn":
                out.append(())
            else:
                out[-1] += (feature,)
        return tuple(out)

    def count(self, side: Literal["left", "right"]) -> int:
        """Returns the number of turns to the given side, left or right."""
        return sum(turn.side == side for turn in self.turns)

    def ways(self, feature: MeasuredFeature) -> set[Literal["up", "down", "flat"]]:
        """Returns in which ways a feature goes: up, down or flat, over 10 m at any of its stations."""
        first, last = np.searchsorted(self.line.s, (feature.start, feature.end)).tolist()
        return {way(grade) for grade in _local_grades(self.line, first, last)}

    def cut(self, piece: MeasuredFeature, changes: Sequence[GradeChange]) -> tuple[MeasuredFeature, ...]:
        """Cuts a piece of a straight at the given changes of its grade, over 10 m, and returns the parts.
        With n changes there are n + 1 parts, or fewer if the piece does not have all the changes in order. A
        part may be as short as one station."""
        first, last = (int(at) for at in np.searchsorted(self.line.s, (piece.start - 1e-6, piece.end - 1e-6)))
        local = _local_grades(self.line, first, last)
        cuts = [0]
        for change in changes:
            is_after = (local > change.grade) == change.rises
            before = np.flatnonzero(~is_after[cuts[-1] :])[:1] + cuts[-1]
            cuts += [int(at) for start in before for at in np.flatnonzero(is_after[start:])[:1] + start]
        marks = [first + cut for cut in cuts] + [last]
        return tuple(_feature(self.line, "straight", a, b) for a, b in pairwise(marks))


class _Bend(NamedTuple):
    sign: int
    first: int
    last: int
    degrees: float


def measure(points: ArrayLike, widest: float = USUALLY_WIDEST) -> RoadMeasures:
    """Measures a road given by points ``(n, 2)`` or ``(n, 3)`` in metres of its centre line, about 1 m apart.
    Bends wider than ``widest`` metres are not turns. Raises UsageError if there are fewer than two different
    points, or a number is not finite."""
    line = _resampled(points)
    s, z = line.s, line.z
    features = _features(line, _turns(line, widest))
    climb = float(z[-1] - z[0])
    long = _windows(line, LONG_WINDOW if len(s) > 2 * LONG_WINDOW else max(2, len(s) // 4))
    short = _windows(line, min(SHORT_WINDOW, len(s) - 1))
    ways = np.sign(long[np.abs(long) >= LEVEL])
    return RoadMeasures(
        features=features,
        length=float(s[-1]),
        climb=climb,
        grade=100 * climb / float(s[-1]),
        lowest_grade=float(long.min()),
        highest_grade=float(long.max()),
        steepest=float(np.abs(short).max()),
        hills=int(np.count_nonzero(ways[1:] != ways[:-1])),
        radius=_radius(line.curvature),
        turning=float(np.degrees(np.abs(np.diff(line.heading)).sum())),
        line=line,
    )


def way(grade: float) -> Literal["up", "down", "flat"]:
    """Returns "up" for a grade of 1 percent or more, "down" for -1 percent or less, and "flat" otherwise."""
    if grade >= LEVEL:
        return "up"
    return "down" if grade <= -LEVEL else "flat"


def ups_and_downs(heights: ArrayLike) -> str:
    """Returns how many metres a road with these heights climbs and falls in all, such as "+10.0 -2.5"."""
    steps = np.diff(heights)
    ways = (float(steps[steps > 0].sum()), float(steps[steps < 0].sum()))
    return " ".join(f"{each:+.1f}" for each in ways if abs(each) >= 0.05) or "+0.0"


def _resampled(points: ArrayLike) -> CentreLine:
    p = np.asarray(points, float)
    if p.ndim != 2 or p.shape[1] < 2 or not np.isfinite(p[:, :3]).all():
        raise UsageError("a centre line is two or more points of two or three finite numbers each")
    steps = np.hypot(np.diff(p[:, 0]), np.diff(p[:, 1]))
    fresh = np.append(True, steps > 1e-6)
    if not fresh[1:].any():
        raise UsageError(
            "the points of the centre line all lie in one place; give at least two different ones"
        )
    if not fresh.all():
        p = p[fresh]
        steps = np.hypot(np.diff(p[:, 0]), np.diff(p[:, 1]))
    along = np.append(0.0, np.cumsum(steps))
    s = np.linspace(0.0, along[-1], max(round(float(along[-1]) / STEP), 3) + 1)
    x, y = np.interp(s, along, p[:, 0]), np.interp(s, along, p[:, 1])
    z = np.interp(s, along, p[:, 2]) if p.shape[1] > 2 else np.zeros_like(s)
    heading = np.arctan2(np.gradient(y), np.gradient(x))
    heading[1:] -= np.cumsum(np.round(np.diff(heading) / (2 * np.pi))) * (2 * np.pi)
    bend = np.gradient(heading) / (s[1] - s[0])
    reach = SMOOTHED // 2
    padded = np.concatenate([np.full(reach, bend[0]), bend, np.full(reach, bend[-1])])
    return CentreLine(s, z, heading, np.convolve(padded, np.full(SMOOTHED, 1 / SMOOTHED), "valid"))


def _radius(curvature: Array) -> float:
    return float(1 / max(np.abs(curvature).max(), 1e-9))


def _windows(line: CentreLine, width: int) -> Array:
    return np.asarray(100 * (line.z[width:] - line.z[:-width]) / (line.s[width:] - line.s[:-width]))


def _stretches(values: NDArray[np.int8]) -> tuple[Indices, Indices]:
    cuts = np.flatnonzero(values[1:] != values[:-1])
    return np.concatenate([[0], cuts + 1]), np.concatenate([cuts, [len(values) - 1]])


def _signs(values: Array, least: float) -> NDArray[np.int8]:
    return (values > least).astype(np.int8) - (values < -least).astype(np.int8)


def _turns(line: CentreLine, widest: float) -> list[_Bend]:
    signs, faint = _signs(line.curvature, 1 / widest), _signs(line.curvature, 1 / (FADES * widest))
    first, last = _stretches(signs)
    curved = signs[first] != 0
    from_, to = _stretches(faint)

    def measured(bends: Sequence[_Bend]) -> list[_Bend]:
        """Returns the bends with their angles, measured out to where the curvature fades."""
        out = []
        for bend in bends:
            a = from_[np.searchsorted(from_, bend.first, "right") - 1]
            b = to[np.searchsorted(to, bend.last)]
            turned = abs(float(np.degrees(line.heading[b] - line.heading[a])))
            out.append(bend._replace(degrees=turned))
        return out

    found = [
        _Bend(int(signs[a]), int(a), int(b), 0.0) for a, b in zip(first[curved], last[curved], strict=True)
    ]
    found = measured(_joined(found, line.s))
    found = measured(_joined([bend for bend in found if bend.degrees >= SLIGHT], line.s))
    return [bend for bend in found if bend.degrees >= LEAST_TURN]


def _joined(bends: Sequence[_Bend], s: Array) -> list[_Bend]:
    out: list[_Bend] = []
    for bend in bends:
        before = out[-1] if out else None
        if before and before.sign == bend.sign and s[bend.first] - s[before.last] < JOINED:
            out[-1] = before._replace(last=bend.last)
        else:
            out.append(bend)
    return out


def _features(line: CentreLine, bends: Sequence[_Bend]) -> tuple[MeasuredFeature, ...]:
    s, out = line.s, list[MeasuredFeature]()
    marks = [0, *(index for bend in bends for index in (bend.first, bend.last)), len(s) - 1]
    gaps = list(zip(marks[::2], marks[1::2], strict=True))
    for (a, b), bend in zip(gaps, [*bends, None], strict=True):
        if s[b] - s[a] >= LEAST_STRAIGHT:
            out.append(_straight(line, a, b))
        if bend:
            side: Literal["left", "right"] = "left" if bend.sign > 0 else "right"
            turn = _feature(line, "turn", bend.first, bend.last, side, bend.degrees)
            out.append(replace(turn, slopes=_slopes_of_turn(line, bend.first, bend.last)))
    return tuple(out)


def _slopes_of_turn(line: CentreLine, first: int, last: int) -> tuple[MeasuredFeature, ...]:
    heights, quarter = line.z[first : last + 1], (last - first) / 4
    for at in (int(heights.argmax()), int(heights.argmin())):
        if quarter <= at <= last - first - quarter:
            ends = (first, first + at), (first + at, last)
            slopes = tuple(_feature(line, "straight", a, b) for a, b in ends if b > a)
            if {way(slope.grade) for slope in slopes} == {"up", "down"}:
                return slopes
    return ()


def _feature(
    line: CentreLine,
    kind: Literal["turn", "straight"],
    first: int,
    last: int,
    side: Literal["left", "right"] | None = None,
    degrees: float = 0.0,
) -> MeasuredFeature:
    last = min(max(last, first + 1), len(line.s) - 1)
    first = min(first, last - 1)
    if kind == "straight":
        inner = min(SMOOTHED, (last - first) // 2)
        degrees = abs(float(np.degrees(line.heading[last - inner] - line.heading[first + inner])))
    start, end = float(line.s[first]), float(line.s[last])
    grade = 100 * float(line.z[last] - line.z[first]) / (end - start)
    radius = _radius(line.curvature[first : last + 1])
    off = (last - first) // 4
    a, b = first + off, last - off
    inner_grade = 100 * float(line.z[b] - line.z[a]) / float(line.s[b] - line.s[a])
    return MeasuredFeature(kind, start, end, side, degrees, radius, grade, inner_grade)


def _straight(line: CentreLine, first: int, last: int) -> MeasuredFeature:
    """Returns a straight with its pieces; if all of them are too short to count, it is its only piece."""
    local = _local_grades(line, first, last)
    classes = (local >= LEVEL).astype(np.int8) - (local <= -LEVEL).astype(np.int8)
    whole, cuts = _feature(line, "straight", first, last), [*zip(*_stretches(classes), strict=True)]
    if len(cuts) == 1:
        return replace(whole, pieces=(whole,))
    found = (_feature(line, "straight", first + int(a), min(first + int(b) + 1, last)) for a, b in cuts)
    pieces = tuple(piece for piece in found if piece.length >= LEAST_PIECE)
    return replace(whole, pieces=pieces or (whole,))


def _local_grades(line: CentreLine, first: int, last: int) -> Array:
    """Returns the grade in percent over 10 m around each station from ``first`` to ``last``."""
    here = np.arange(first, last + 1)
    before, after = np.maximum(here - HALF_WINDOW, 0), np.minimum(here + HALF_WINDOW, len(line.s) - 1)
    return np.asarray(100 * (line.z[after] - line.z[before]) / (line.s[after] - line.s[before]))


TurnLane = tuple[Way | None, float]


class MeasuredRamp(NamedTuple):
    """The ramp of a merge or exit."""

    way: Connection  # the way between the ramp and the main road
    side: Side  # the side of the main road on which the ramp lies
    lane: float  # length in metres of the lane for acceleration or deceleration without its taper; 0 if none
    taper: float  # length in metres of the part in which this lane is at most 0.9 of its full width


@dataclass(frozen=True)
class MeasuredJunction:
    """A junction as a route passes it. Angles are in degrees, lengths in metres."""

    s: float  # station at which the route enters the junction
    kinds: tuple[JunctionKind, ...]
    """The kinds that the junction may be called; empty if its angles fit no kind."""
    gaps: tuple[float, ...]
    """Angles between neighbouring arms, counter-clockwise from the arm of arrival; clockwise with traffic on
    the left."""
    turn: float
    """Change of direction of the route, left positive; 180 if the route leaves on the arm of arrival."""
    exit: int
    """Number of the arm on which the route leaves. Arms are counted from 1 in the order of ``gaps``; the arm
    of arrival comes last."""
    ways: tuple[float, ...]
    """Changes of direction from the arm of arrival to each other arm, left positive, in the same order as
    ``gaps``."""
    control: Control  # the sign or the light that the route meets
    ring: "Roundabout | None"  # None for other junctions
    ring_lanes: int  # the number of lanes of the ring of a roundabout; 0 for other junctions
    ramp: MeasuredRamp | None  # that of a merge or exit; None for other junctions
    is_ramp: bool  # whether the route comes from the ramp or goes to it
    all_controls: tuple[Control, ...]
    """The sign or the light of each arm that has lanes into the junction."""
    only_in: tuple[Way, ...]
    """The sides of one-way arms that lead to the junction; the arm of arrival is left out."""
    only_out: tuple[Way, ...]  # the sides of one-way arms that lead away from the junction
    turn_lanes: tuple[TurnLane, ...]
    """The lanes that begin on the road of arrival and lead to one side only: the side, and the length in
    metres, up to the junction, in which the lane has more than 0.9 of its full width."""

    @property
    def arms(self) -> int:
        """The number of arms."""
        return len(self.gaps)

    @property
    def sides(self) -> tuple[Way, ...]:
        """The side to which each change of direction in ``ways`` leads: "left", "straight" or "right"."""
        return tuple(side_of(turn) for turn in self.ways)

    @property
    def ways_on(self) -> tuple[Way, ...]:
        """The sides on which traffic can leave the junction: ``sides`` without those of ``only_in``."""
        on = list(self.sides)
        for side in self.only_in:
            on.remove(side)
        return tuple(on)


def measured_junctions(route: "Route") -> list[MeasuredJunction]:
    """Returns the junctions that a route passes, in driving order. A roundabout counts as one junction."""
    passages = route.passages
    directions = iter(directions_of(route.network, [end for each in passages for end in each.arms]))
    return [_measured(route.network, each, [*islice(directions, len(each.arms))]) for each in passages]


@dataclass(frozen=True)
class MeasuredLanes:
    """A place where the number of lanes changes, where the route changes it, a crosswalk or a bus bay."""

    s: float  # station in metres
    kind: LaneKind
    side: Side | None  # the side of the lane that ends or begins, or to which the route changes
    behind: float = 0.0
    """Distance in metres along the route from ``s`` to the place where the ending lane becomes too narrow for
    a car, or the new lane wide enough. For a change of lanes: to the middle of the first change. Negative if
    before ``s``."""


def measured_places(route: "Route") -> list[MeasuredJunction | MeasuredLanes]:
    """Returns what a route passes, in driving order: junctions, and places where lanes change."""
    found: list[MeasuredJunction | MeasuredLanes] = [*measured_junctions(route), *_lane_places(route)]
    return sorted(found, key=lambda each: each.s)


def _lane_places(route: "Route") -> Iterator[MeasuredLanes]:
    network = route.network
    for (_, one), (start, two) in pairwise(route.roads):
        if RoadEnd(one.id, "end") not in network.continued_at or is_beside_place(network, one, two):
            continue
        before, after = one.profile.count[0], two.profile.count[0]
        lanes = [leg.lane for leg in route.legs if leg.road == two.id]
        if after != before:
            pairs = network.continued_at[RoadEnd(two.id, "start")].lanes
            own = two.profile.side
            is_left = (own > 0) == ((own, own) in pairs)
            side: Side = "left" if is_left else "right"
            if after < before:
                yield MeasuredLanes(start, "lane_drop", side, -_narrow_part(one, at_end=True))
            else:
                yield MeasuredLanes(start, "lane_gain", side, _narrow_part(two, at_end=False))
        elif network.continued_at[RoadEnd(one.id, "end")].crosswalk:
            yield MeasuredLanes(start, "crosswalk", None)
        elif "parking" in (strip.kind for strip in two.profile.along):
            yield MeasuredLanes(start, "bus_bay", None)
        elif len(lanes) > 1:
            is_left = (lanes[1] > lanes[0]) == two.profile.leads_along(lanes[0])
            middle = two.road.length / len(lanes[1:]) / 2
            yield MeasuredLanes(start, "lane_change", "left" if is_left else "right", middle)


def _narrow_part(member: NetworkRoad, at_end: bool) -> float:
    length = member.road.length
    s = np.linspace(0.0, length, math.ceil(length / LANE_STEP) + 1)
    found = 0.0
    for width in (member.profile.lanes[lane].width for lane in member.profile.along_ids):
        if isinstance(width, CubicProfile):
            wide = np.append(s[width.height(s) >= LEAST_WIDTH], [] if at_end else length)
            found = max(found, length - wide.max(initial=0.0) if at_end else wide[0])
    return float(found)


def is_beside_place(network: Network, one: NetworkRoad, two: NetworkRoad) -> bool:
    """Returns whether a change of lanes between two roads belongs to a ramp or to the island of a crosswalk:
    the first road begins at a merge and has the lane for acceleration, or the second ends at an exit and has
    the lane for deceleration; or one of them has the island."""
    ends = (RoadEnd(one.id, "start"), "merge"), (RoadEnd(two.id, "end"), "diverge")
    crossed = {end for each in network.continuations if each.crosswalk for end in (each.before, each.after)}
    is_island = one.profile.is_divided != two.profile.is_divided
    if is_island and not crossed.isdisjoint((RoadEnd(one.id, "start"), RoadEnd(two.id, "end"))):
        return True
    return any(
        (number := network.junction_at.get(end)) is not None and network.junction(number).kind == kind
        for end, kind in ends
    )


def ramp_of(network: Network, junction: Junction) -> MeasuredRamp | None:
    """Returns the ramp of a merge or exit; None for other junctions."""
    if junction.kind not in RAMPS:
        return None
    roads = [network.road(each.road).road for each in junction.connections]
    turns = [float(road.heading(road.length) - road.heading(0.0)) for road in roads]
    way, turn = max(zip(junction.connections, turns, strict=True), key=lambda pair: abs(pair[1]))
    is_merge = junction.kind == "merge"
    beside = network.road((way.outgoing if is_merge else way.incoming).road)
    lanes = network.lanes_out_of(way.outgoing) if is_merge else network.lanes_into(way.incoming)
    is_outer = (turn > 0) == network.left_hand
    width = beside.profile.lanes[lanes[-1 if is_outer else 0]].width
    full = taper = 0.0
    if isinstance(width, CubicProfile):
        s = np.linspace(0.0, beside.road.length, max(2, round(beside.road.length)))
        full = float(np.mean(width.height(s) > FULL * width.extremes()[1])) * beside.road.length
        taper = beside.road.length - full
    return MeasuredRamp(way, "left" if turn > 0 else "right", full, taper)


def _measured(network: Network, passage: "Passage", directions: Sequence[float]) -> MeasuredJunction:
    ring = network.roundabout_of.get(passage.entered.id)
    ramp = ramp_of(network, passage.entered)
    around = 1 if not network.left_hand else -1
    gaps = [around * (b - a) % 360 for a, b in pairwise([*directions, directions[0]])]
    own: JunctionKind = passage.entered.kind if gaps[1:] else "turning_circle"
    ways = tuple((each - directions[0]) % 360 - 180 for each in directions[1:])
    return MeasuredJunction(
        passage.start,
        kinds_of(gaps) if ring is None and ramp is None else (own,),
        tuple(gaps),
        180.0 if passage.exit == len(passage.arms) else ways[passage.exit - 1],
        passage.exit,
        ways,
        passage.control,
        ring,
        0 if ring is None else network.road(ring.ring[0]).profile.count[0],
        ramp,
        ramp is not None and (ramp.way.incoming, ramp.way.outgoing) == (passage.arrival, passage.departure),
        tuple(arm.control for arm in passage.entered.arms if network.lanes_into(arm.end)),
        *_one_way_sides(network, passage, ways),
        tuple(_turn_lanes(network, passage, ways)),
    )


def _one_way_sides(
    network: Network, passage: "Passage", ways: tuple[float, ...]
) -> tuple[tuple[Way, ...], tuple[Way, ...]]:
    """Returns the sides of the arms whose traffic only drives to a junction, or only away from it."""
    into, out = list[Way](), list[Way]()
    for end, turn in zip(passage.arms[1:], ways, strict=True):
        if not network.lanes_out_of(end):
            into.append(side_of(turn))
        elif not network.lanes_into(end):
            out.append(side_of(turn))
    return tuple(into), tuple(out)


def _turn_lanes(network: Network, passage: "Passage", ways: Sequence[float]) -> Iterator[TurnLane]:
    sides = dict(zip(passage.arms[1:], map(side_of, ways), strict=True))
    member, own = network.road(passage.arrival.road), passage.arrival
    away = np.linspace(0.0, member.road.length, math.ceil(member.road.length / LANE_STEP) + 1)
    ways_on = [each for each in passage.entered.connections if each.incoming == own]
    for lane in network.lanes_into(own):
        width = member.profile.lanes[lane].width
        led = {sides.get(each.outgoing) for each in ways_on if lane in [way[0] for way in each.lanes]}
        if isinstance(width, CubicProfile) and len(led) == 1:
            s = away if own.contact == "start" else member.road.length - away
            full = width.height(s) > FULL * width.extremes()[1]
            if full[0] and not full[-1]:
                yield led.pop(), float(away[np.argmin(full)])


def directions_of(network: Network, arms: Sequence[RoadEnd]) -> list[float]:
    """Returns the directions of arms out of their junctions, in degrees counter-clockwise from +x."""
    plans, stations = [], []
    for end in arms:
        plan = network.road(end.road).road.plan
        assert isinstance(plan, PieceCurve)
        far = min(OUT, plan.length)
        plans.append(plan)
        stations.append(np.array([0.0, far] if end.contact == "start" else [plan.length, plan.length - far]))
    points = along_all(plans, stations)[0] if plans else np.empty((0, 2))
    return [math.degrees(math.atan2(y, x)) for x, y in (points[1::2] - points[::2]).tolist()]


@dataclass(frozen=True)
class MeasuredNode:
    """A junction or a roundabout of a map."""

    place: tuple[float, float]  # its middle (x, y) in metres
    kinds: tuple[JunctionKind, ...]
    """The kinds that the junction may be called; empty if its angles fit no kind."""
    controls: frozenset[Control]  # the signs and lights of its arms


@dataclass(frozen=True)
class MeasuredMap:
    """The measures of a whole network."""

    nodes: tuple[MeasuredNode, ...]
    """The junctions. A roundabout counts as one junction."""
    blocks: int  # the number of areas that roads enclose
    ends: int  # the number of road ends that meet no junction
    parts: int  # the number of separate parts, which no roads connect; 1 for a connected map
    distances: tuple[float, ...]
    """For each straight road between two junctions, the distance in metres between their middles."""
    length: float  # the length in metres of all roads outside junctions


def measured_map(network: Network) -> MeasuredMap:
    """Measures a network; a roundabout counts as one junction."""
    found = [_node(network, junctions) for _, junctions in network.nodes]
    number_of = {junction.id: n for n, (_, group) in enumerate(network.nodes) for junction in group}
    roads = network.roads_outside
    joined, distances, ends = list[tuple[int, int]](), list[float](), 0
    for member in roads:
        met = []
        for contact in (RoadEnd(member.id, "start"), RoadEnd(member.id, "end")):
            junction = network.junction_at.get(contact)
            if junction is None:
                ends += 1
                met.append(len(found) + ends - 1)
            else:
                met.append(number_of[junction])
        joined.append((met[0], met[1]))
        if max(met) < len(found) and _is_straight(network, member.id):
            distances.append(math.dist(found[met[0]].place, found[met[1]].place))
    count = len(found) + ends
    part_of = [*range(count)]
    for one, other in joined:
        part_of = [part_of[one] if part == part_of[other] else part for part in part_of]
    parts = len({*part_of})
    length = sum(member.road.length for member in roads)
    return MeasuredMap(tuple(found), len(roads) - count + parts, ends, parts, tuple(distances), length)


def _node(network: Network, junctions: tuple[Junction, ...]) -> MeasuredNode:
    is_ring = junctions[0].id in network.roundabout_of
    # the first arm of each junction of a roundabout is the one that is no part of the ring
    arms = [each.arms[0] for each in junctions] if is_ring else list(junctions[0].arms)
    directions = directions_of(network, [arm.end for arm in arms])
    around = -1 if is_ring and network.left_hand else 1
    gaps = [around * (b - a) % 360 for a, b in pairwise([*directions, directions[0]])]
    own: JunctionKind = "roundabout" if gaps[1:] else "turning_circle"
    kinds = (own,) if is_ring else kinds_of(gaps)
    x, y, _ = junctions[0].node
    return MeasuredNode((x, y), kinds, frozenset(arm.control for arm in arms))


def _is_straight(network: Network, number: int) -> bool:
    road = network.road(number).road
    return abs(float(road.heading(road.length) - road.heading(0.0))) < STRAIGHT_ROAD and math.isclose(
        road.length, math.dist(road.at(0.0)[:2].tolist(), road.at(road.length)[:2].tolist()), rel_tol=0.01
    )
