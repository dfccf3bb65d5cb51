"""Changes the free elements of a road as little as needed to meet requirements. Main function: ``fit``.

    elements --checked_road--> what is wrong? --aim_of--> limits --least_change--> segments --graded--> road

An edit first freezes every element that the request does not name: the element's lengths, turns and radii
stay exactly as they are. Only if no valid road is found that way, all elements are free. The road as a whole
may be shifted or rotated, so that it stays inside the map.

Parabolas join the grades of a road. A short level turn between two climbs is therefore measured as climbing,
and a short slope is measured flatter than it is written. So the inclines of an element are changed by the
measured error, and the road is measured again. If an incline is at its limit, the neighbouring inclines are
changed instead.

In a proposal, every turn must be measured with the slope that was proposed or is required. All inclines may
change, as long as each still climbs, falls or is level. In an edited road, only the inclines of elements with
a required grade may change; parabolas are added where two slopes newly meet.

The limits are rows of a matrix: a . lengths + b . |turns| <= c, all in metres. A minimum radius can be
written as such a limit: if a segment turns by ``turn`` radians over ``length`` metres, and its maximum
curvature is ``peak`` times its mean curvature, its minimum radius is length / (peak * turn). The plan is a
polyline that follows its lengths and turns:

    step m of segment i:   z += d_i / steps_i * exp(1j * (heading + turns before i + share_m * turn_i))

``share_m`` is the fraction of the segment's turn that is completed at that step. It is taken from the built
curve, and kept while lengths and turns change a little.

The objective is a weighted sum of squared relative changes. Its weights make a few larger changes cost no
more than many small ones. For each limit that is exceeded, the squared excess in metres is added as a
penalty, whose weight grows from round to round. Each step solves for all free lengths, all free turns and the
place on the map at once (Levenberg-Marquardt)."""

from collections.abc import Collection, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from math import ceil, floor, inf, radians
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roadgpt import check
from roadgpt.brief.outline import Feature, Outline
from roadgpt.brief.ranges import Range, overlap
from roadgpt.brief.words import LEAST_STRAIGHT
from roadgpt.check.extremes import lowest
from roadgpt.check.matching import complaints, fits, turn_complaints
from roadgpt.check.measures import LEAST_TURN, LEVEL, MeasuredFeature, RoadMeasures, measure, way
from roadgpt.check.rules.below_floor import ROUNDING
from roadgpt.check.rules.too_abrupt import abrupt_place
from roadgpt.design import vertical
from roadgpt.design.compose import Windows
from roadgpt.design.elements import ABOVE_GROUND
from roadgpt.design.layout import neighbours
from roadgpt.errors import DesignError
from roadgpt.geometry import PieceCurve
from roadgpt.geometry.curve import Array
from roadgpt.geometry.nearness import Complex, Indices, meeting
from roadgpt.geometry.pieces import joined
from roadgpt.road import Design, Geometry, Road, Segment, World, build
from roadgpt.road.builder import elevation_of, pieces_of
from roadgpt.road.design import MAX_TURN
from roadgpt_edit.onto_map import moved_onto_map
from roadgpt_edit.road_elements import (
    RoadElement,
    RoadElements,
    features_of,
    shows_slopes,
    shows_turns,
    with_inclines,
    with_segments,
)


class Requirements(NamedTuple):
    """The requirements for a road, in addition to those for each of its elements."""

    world: World  # the size of the map, and the limits that the rules check
    length: Range | None = None  # of the whole road, in metres; None if it is open
    before: Design | None = None
    """The road before an edit; the parabolas between its slopes are kept. With None, they are chosen
    anew, and each turn must be measured with the slope that it has in the design."""
    geometry: Geometry = "arcs"


@dataclass(frozen=True)
class FittedRoad:
    """A design with the road that was built from it, the findings of the rules, and measurements."""

    design: Design  # the design, moved inside the map and above the ground if necessary
    elements: RoadElements
    road: Road
    findings: tuple[check.Finding, ...]
    requirements: Requirements

    @cached_property
    def found(self) -> RoadMeasures:
        """The measured turns, straights and grades."""
        return measure(self.road.centreline())

    @cached_property
    def has_turns(self) -> bool:
        """Whether the measured road has the same sequence of left and right turns as the elements."""
        return shows_turns(self.found, self.elements)

    @cached_property
    def seen(self) -> tuple[MeasuredFeature | None, ...]:
        """The measured feature of each element; only defined if ``has_turns`` is True."""
        return features_of(self.elements, self.found)

    @cached_property
    def objection(self) -> str:
        """A sentence that says which rule or requirement the road does not meet; empty if it meets all of
        them."""
        if self.findings:
            return self.findings[0].sentence
        if not self.has_turns:
            wanted, shown = sum(element.is_turn for element in self.elements), len(self.found.turns)
            if wanted != shown:
                return f"{shown} turns would be seen and not {wanted}, as some run into each other"
            return "a turn would be seen to the wrong side"
        if self.requirements.before is None and not shows_slopes(self.found, self.elements):
            return "a turn would be seen on another slope"
        return self._unmet()

    def _unmet(self) -> str:
        turns = 0
        for element, seen in zip(self.elements, self.seen, strict=True):
            turns += element.is_turn
            asked = element.asked
            if asked and not seen and asked.length and asked.length.lo >= LEAST_STRAIGHT:
                return f"a straight of {element.length:.1f} m would not be seen"
            if not asked or not seen or fits(seen, asked):
                continue
            if element.is_turn:
                return turn_complaints(turns, seen, asked)[0].sentence
            wanted = f"asked for {asked.length or 'any'} m at {asked.grade or 'any'} %"
            return f"the straight would be {seen.length:.1f} m long at {seen.grade:.1f} %, {wanted}"
        whole = replace(FREE, length=self.requirements.length)
        return next((complaint.sentence for complaint in complaints(self.found, whole)), "")


FREE = Outline(groups=(), turns=Range())  # nothing is required of the whole road
ROUNDS = 24  # of changing inclines
ROOMIER = (1.0, 1.5, 2.5)  # factors on the room for parabolas of a proposal
PARABOLAS = tuple(
    (ease, is_widened) for is_widened in (False, True) for ease in vertical.EASES
)  # of an edited road
CLEAR = 0.1  # percentage points off the edge of up, down and level
INSIDE = 0.2  # percentage points off the edge of a required grade, or a third of its width
SURPLUS = 0.05  # percentage points more than is missing, for rounding
CLASSES = {"up": Range(LEVEL), "down": Range(-inf, -LEVEL), "flat": Range(-LEVEL, LEVEL)}
CLEAR_GRADES = {name: room.drawn_in(CLEAR, 0.5) for name, room in CLASSES.items()}


class _Slopes(NamedTuple):
    """The grades of elements and segments, in percent: which are accepted, aimed at and possible."""

    elements: RoadElements
    accepted: tuple[Range | None, ...]
    """Mean grades of each element that may be measured; None if the element is not measured."""
    aims: tuple[Range, ...]  # mean grades to aim at for each element; they lie inside those that are accepted
    bounds: tuple[Range, ...]  # inclines that each segment may have

    def within_bounds(self, grades: Array) -> Array:
        """Returns the inclines of all segments, limited to those that are possible."""
        return np.clip(grades, [bound.lo for bound in self.bounds], [bound.hi for bound in self.bounds])

    def missing(self, found: RoadMeasures) -> Array:
        """Returns, for each segment, the percentage points by which the measured grade of its element must
        change to reach the aim, ``(n,)``; 0 if the grade is accepted."""
        out = np.zeros(len(self.bounds))
        if not shows_turns(found, self.elements):
            return out
        seen = features_of(self.elements, found)
        for element, accepted, aim, one in zip(self.elements, self.accepted, self.aims, seen, strict=True):
            if accepted and one and one.grade not in accepted:
                by = float(np.clip(one.grade, aim.lo, aim.hi)) - one.grade
                out[list(element.members)] = by + np.copysign(SURPLUS, by)
        return out

    def moved(self, grades: Array, missing: Array) -> Array:
        """Returns grades changed by ``missing`` within their limits; neighbours change by the remainder."""
        after = self.within_bounds(grades + missing)
        rest = grades + missing - after
        for i in np.flatnonzero(np.abs(rest) > 1e-9):
            for j in (i - 1, i + 1):
                if 0 <= j < len(grades) and not missing[j]:
                    after[j] = np.clip(after[j] + rest[i], self.bounds[j].lo, self.bounds[j].hi)
        return after


def graded(design: Design, elements: RoadElements, world: World, before: Design | None = None) -> Design:
    """Returns the design with inclines and parabolas for which the measured grades are as required.

    If all such designs violate the rule ``too_abrupt``, the last of them is returned. If no design has the
    required grades, the first one tried is returned. The plan and the start stay the same. ``before`` is the
    road before an edit, and None for a proposal."""
    limit = Range(-100 * world.limits.max_grade, 100 * world.limits.max_grade)
    slopes = _slopes_of_edit(elements, limit) if before else _slopes_of_proposal(elements, world, limit)
    lengths, inclines = [s.distance for s in design.segments], [s.incline for s in design.segments]
    start = slopes.within_bounds(np.array(inclines))
    road, pace = build(design), vertical.Pace.of(design, world)
    points, stations = road.centreline(), road.sample().s
    short = {i for e in elements if not e.is_turn and e.length < vertical.SHORTEST_SLOPE for i in e.members}
    kept: Design | None = None
    for attempt in range(len(PARABOLAS if before else ROOMIER)):
        grades = start
        for _ in range(ROUNDS):
            segments = with_inclines(design.segments, grades)
            if before:
                segments = _with_new_parabolas(segments, before.segments, pace, *PARABOLAS[attempt])
            else:
                segments = vertical.widened(segments, pace)
                if vertical.too_abrupt(segments, pace):
                    room = ROOMIER[attempt]
                    grades = vertical.made_to_fit(grades, lengths, inclines, short, slopes.bounds, pace, room)
                    segments = vertical.widened(with_inclines(design.segments, grades), pace)
            points[:, 2] = elevation_of(segments, 0.0).height(stations)
            missing = slopes.missing(measure(points))
            moved = slopes.moved(grades, missing)
            if np.array_equal(moved, grades):
                break
            grades = moved
        tried = design.model_copy(update={"segments": segments})
        if not missing.any() and abrupt_place(world.lay(build(tried)), None, world) is None:
            return tried
        kept = tried if kept is None or not missing.any() else kept
    assert kept is not None
    return kept


def _with_new_parabolas(
    segments: tuple[Segment, ...], before: Sequence[Segment], pace: vertical.Pace, ease: float, widens: bool
) -> tuple[Segment, ...]:
    """Returns segments with new parabolas wherever two grades meet that did not meet ``before`` a change. If
    ``widens``, unchanged segments get parabolas as well, and all radii that are smaller than the rule
    allows are increased."""
    known = {(a.incline, b.incline, b.vertical_radius) for a, b in pairwise(before)}
    opened = frozenset(
        i
        for i, (a, b) in enumerate(pairwise(segments), 1)
        if a.incline != b.incline
        and (a.incline, b.incline, b.vertical_radius) not in known
        and (widens or b not in before)
    )
    segments = vertical.joined(segments, pace, ease, opened) if opened else segments
    return vertical.widened(segments, pace) if widens else segments


def _slopes_of_edit(elements: RoadElements, limit: Range) -> _Slopes:
    asked = [element.asked.grade if element.asked else None for element in elements]
    aims = (grade.drawn_in(INSIDE, 1 / 3) if grade else limit for grade in asked)
    bounds = (
        limit if grade else Range(segment.incline, segment.incline)
        for element, grade in zip(elements, asked, strict=True)
        for segment in element.segments
    )
    return _Slopes(elements, tuple(asked), tuple(aims), tuple(bounds))


def _slopes_of_proposal(elements: RoadElements, world: World, limit: Range) -> _Slopes:
    windows = Windows(FREE, world)
    accepted, aims, bounds = list[Range | None](), list[Range](), list[Range]()
    for element in elements:
        class_, *ways = map(way, (element.incline, *(s.incline for s in element.segments)))
        asked: Range | None = None
        with suppress(DesignError):  # steeper than allowed: then the rules say so
            asked = windows.of(element.asked) if element.asked else None
        aim = overlap(CLEAR_GRADES[class_], asked) or CLEAR_GRADES[class_]
        if asked and aim.lo > aim.hi:
            aim = asked
        own = []
        for segment, one in zip(element.segments, ways, strict=True):
            clear, now = CLEAR_GRADES[one], segment.incline
            room = Range(min(clear.lo, now), max(clear.hi, now))
            rooms = overlap(overlap(room, limit), asked and aim), overlap(limit, asked and aim)
            own.append(next((room for room in rooms if room and room.lo <= room.hi), limit))
        if not element.is_turn and element.length < vertical.SHORTEST_SLOPE:  # it needs no slope of its own
            own = [limit] * len(own)
        bounds += own
        aims.append(aim)
        accepted.append((aim if asked else CLASSES[class_]) if element.is_turn else None)
    return _Slopes(elements, tuple(accepted), tuple(aims), tuple(bounds))


SPACING = 2.0  # m between points of the polyline, about
MOST_POINTS = 500  # of a polyline, about
FADES = 3.0, 2.0  # m by which a straight, or a turn, may be measured shorter than it is written
LEAST_TRANSITION = 0.1  # share of a turning segment to which each of its clothoids may be shortened
METRES_PER_RADIAN = 30.0  # weight of a missing radian relative to a missing metre
SHARE_KEPT = 0.2  # of every length and turn: less would not be the segment that was proposed
CLEARLY = 260.0  # m: largest radius of a turn that must be seen as one (measurements have a limit of 300)
SLIGHT_BEND = 9.0  # degrees: a bend that was proposed too slight for a turn stays below this
WIDTH_KEPT_OFF = 0.2  # of a promised range, at either end, besides the margin of promises
ANGLE_MARGIN = 0.4  # degrees, off what was promised
LENGTH_WEIGHT, TURN_WEIGHT = 1.0, 1.4  # of a relative change
LEAST_TURN_COUNTED = radians(15)  # changes of slighter turns are taken as relative to this
SPARSE = 2  # steps between the points that are held apart
HEADINGS = np.radians([0, 5, -5, 10, -10, 15, -15, 20, -20, 30, -30, 40, -40, 45])  # of the start, in order
PENALTIES = (0.05, 1.0, 20.0)  # per square metre by which a limit is broken
STEPS = 25  # at every penalty, at most
SETTLED = 1e-5  # relative gain
FEW = 0.04  # relative change; values that change by more get a smaller weight in the second round
MOST_WORK = 2e7  # points squared, times steps: after this much no further start is tried (about 2 s)
BROKEN = 0.15  # m: a limit, margins included, may be broken by this much
CHEAP = 0.05  # cost of a change for each segment, below which no other start is tried
TENTH, CENTIMETRE = 10.0, 100.0  # per degree or metre, per metre: how changed numbers are written
SHORTEST_TRANSITION = 0.1  # m
STARTS = (1.0, 0.8, 0.6, 0.45, 0.3, 0.2)  # shares of all free turns where the search starts


class Margins(NamedTuple):
    """Distances that a repaired road keeps from the limits of the rules."""

    radius: float = 1.045
    """Factor by which the smallest radius that the rules allow is multiplied, because the competition's
    spline cuts corners."""
    seen: float = 12.0  # smallest angle of a turn, in degrees
    apart: float = 15.5  # smallest distance between two successive turns that go the same way, in metres
    clear: float = 1.1  # distance in metres between two parts of the road, in addition to its width
    edge: float = 0.6  # distance in metres between the road and the border of the map
    promise: float = 0.04
    """Margin inside a required range of lengths or radii, as a fraction of each bound of the range."""


TIGHT = Margins(1.03, 12.0, 14.0, 0.5, 0.3, 0.02)
"""Margins of an edited road. Most of the road stays as it is, and it may lie close to the limits."""
MARGINS = (Margins(), Margins(1.07, 13.5, 18.0, 1.5, 1.0, 0.1), Margins(1.12, 15.0, 22.0, 2.5, 1.5, 0.2))


class PlanPolyline(NamedTuple):
    """A plan as a polyline."""

    owner: NDArray[np.intp]  # index of the segment to which each step of the polyline belongs, ``(k,)``
    share: Array
    """Fraction (0 to 1) of its segment's turn that is completed in the middle of each step, ``(k,)``."""
    peak: Array  # ratio of the largest to the mean curvature of each segment; 0 for straights

    def walk(self, lengths: Array, turns: Array, heading: float) -> tuple[Complex, Complex]:
        """Returns the points ``(k + 1,)`` of the polyline as x + iy, starting at the origin, and its steps
        ``(k,)``, for these lengths and turns of the segments, in metres and radians."""
        count = np.bincount(self.owner, minlength=len(lengths))
        before = np.concatenate([[0.0], np.cumsum(turns)[:-1]])
        angle = heading + before[self.owner] + self.share * turns[self.owner]
        steps = (lengths / count)[self.owner] * np.exp(1j * angle)
        return np.concatenate([[0j], np.cumsum(steps)]), steps

    def slopes(self, lengths: Array, steps: Complex) -> tuple[Complex, Complex]:
        """Returns the derivatives of all points with respect to each length and each turn, ``(k + 1, n)``
        each."""
        n, k = len(lengths), len(steps)
        own = self.owner[:, None] == np.arange(n)
        behind = np.where(own, self.share[:, None], self.owner[:, None] > np.arange(n))
        by_length, by_turn = np.zeros((k + 1, n), complex), np.zeros((k + 1, n), complex)
        np.cumsum(own * (steps[:, None] / lengths), axis=0, out=by_length[1:])
        np.cumsum(1j * behind * steps[:, None], axis=0, out=by_turn[1:])
        return by_length, by_turn


def polyline_of(segments: Sequence[Segment]) -> PlanPolyline:
    """Returns the polyline of the plan that is built from these segments."""
    pieces = pieces_of(segments)
    curve = PieceCurve(0.0, 0.0, 0.0, joined(pieces))
    step = max(SPACING, curve.length / MOST_POINTS)
    owner, share, peak = list[int](), list[Array](), np.zeros(len(segments))
    at, first = 0.0, 0
    for index, segment in enumerate(segments):
        steps = max(2, round(segment.distance / step))
        owner += [index] * steps
        middles = at + segment.distance * (np.arange(steps) + 0.5) / steps
        turn = np.radians(segment.turn_degrees)
        if abs(turn) < 1e-9:
            share.append(np.zeros(steps))
            first += 1
        else:
            entry = curve.heading(np.array([at]))
            share.append((curve.heading(middles) - entry) / turn)
            bent = max(max(abs(p.k0), abs(p.k1)) for p in pieces[first : first + 5] if p.length > 1e-9)
            peak[index] = bent * segment.distance / abs(turn)
            first += 5
        at += segment.distance
    return PlanPolyline(np.array(owner), np.concatenate(share), peak)


class Aim(NamedTuple):
    """The lengths and turns that a plan should have, and the limits that it must meet."""

    lengths: Array  # length of each segment in metres
    turns: Array  # turning angle of each segment in radians, left positive
    free: NDArray[np.bool_]
    """Whether the length and the turn of each segment may change; the others are constants."""
    proposed: tuple[Segment, ...]  # the segments as proposed, with these lengths and turns
    figure: PlanPolyline
    rows: Array  # matrix of the limits of lengths and turns, ``(m, 2 n)``
    most: Array  # right-hand sides of the limits, ``(m,)``
    world: World
    margins: Margins


def aim_of(
    first: FittedRoad,
    last: FittedRoad,
    now: tuple[Segment, ...] | None,
    free: NDArray[np.bool_],
    margins: Margins,
) -> Aim:
    """Returns the lengths and turns that a plan should have, and all limits for them.

    ``first`` is the road as it was proposed, and ``last`` the last road that was tried, which shows how much
    measured values differ from written ones. ``now`` are the segments found so far, which show where each
    segment turns; None if there are none yet. ``free`` says whether the length and the turn of each segment
    may change, ``(n,)``."""
    proposed = first.design.segments
    lengths = np.array([s.distance for s in proposed])
    turns = np.radians([s.turn_degrees for s in proposed])
    figure = polyline_of(now or proposed)
    rows, most = _limits_of(first, _as_written(first, last), figure.peak, margins)
    return Aim(lengths, turns, free, proposed, figure, rows, most, first.requirements.world, margins)


def _as_written(first: FittedRoad, last: FittedRoad) -> RoadElements:
    figure = polyline_of(last.design.segments)
    seen = last.seen if last.has_turns else (None,) * len(last.elements)
    return tuple(
        replace(element, asked=_shifted(element.asked, now, feature, figure))
        if element.asked and element.segments
        else replace(element, asked=None)
        for element, now, feature in zip(first.elements, last.elements, seen, strict=True)
    )


def _shifted(asked: Feature, now: RoadElement, seen: MeasuredFeature | None, figure: PlanPolyline) -> Feature:
    degrees, radius, length = asked.degrees, asked.radius, asked.length
    if seen is None:
        if length and length.lo > 0:
            length = Range(length.lo + FADES[bool(now.degrees)], length.hi)
        return replace(asked, length=length)
    if length:
        more = now.length - seen.length
        length = Range(length.lo + more, length.hi + more)
    if degrees:
        more = abs(now.degrees) - seen.degrees
        most = MAX_TURN * len(now.segments)
        degrees = Range(degrees.lo + more, min(degrees.hi + more, max(most, abs(now.degrees))))
    if radius:
        tightest = min(
            segment.distance / max(figure.peak[i], 1.0) / radians(abs(segment.turn_degrees))
            for i, segment in zip(now.members, now.segments, strict=True)
            if segment.turn_degrees
        )
        radius = Range(radius.lo * tightest / seen.radius, radius.hi * tightest / seen.radius)
    return replace(asked, degrees=degrees, radius=radius, length=length)


class _Rows:
    """Collects limits as rows of a matrix."""

    def __init__(self, count: int) -> None:
        self.count = count
        self.rows: list[Array] = []
        self.most: list[float] = []

    def add(self, lengths: dict[int, float], turns: dict[int, float], most: float) -> None:
        """Adds the limit ``lengths . d + turns . |t| <= most``."""
        row = np.zeros(2 * self.count)
        for index, factor in lengths.items():
            row[index] += factor
        for index, factor in turns.items():
            row[self.count + index] += factor
        self.rows.append(row)
        self.most.append(most)

    def within(self, members: Sequence[int], span: Range) -> None:
        """Adds the limits of the total length of some segments, in metres."""
        for sign, limit in ((-1.0, span.lo), (1.0, span.hi)):
            if limit > 0 and limit < inf:
                self.add(dict.fromkeys(members, sign), {}, sign * limit)

    def turned(self, members: Sequence[int], span: Range) -> None:
        """Adds the limits of the total turning angle of some segments, in degrees."""
        for unit, limit in ((-METRES_PER_RADIAN, span.lo), (METRES_PER_RADIAN, span.hi)):
            if limit > 0 and limit < inf:
                self.add({}, dict.fromkeys(members, unit), unit * radians(limit))


def _limits_of(
    first: FittedRoad, elements: Sequence[RoadElement], peak: Array, margins: Margins
) -> tuple[Array, Array]:
    """Returns all limits of lengths and turns as a matrix ``(m, 2 n)`` and a right-hand side ``(m,)``;
    ``peak`` is the ratio of maximum to mean curvature of each of the ``n`` segments."""
    world, length, segments = first.requirements.world, first.requirements.length, first.design.segments
    rows = _Rows(len(segments))
    radius = world.limits.min_radius * margins.radius
    shortest = 1 / (1 - LEAST_TRANSITION)
    for index, segment in enumerate(segments):
        rows.add({index: -1.0}, {}, -SHARE_KEPT * segment.distance)
        if segment.turn_degrees:
            turn = abs(radians(segment.turn_degrees))
            rows.add({}, {index: -METRES_PER_RADIAN}, -METRES_PER_RADIAN * SHARE_KEPT * turn)
            rows.add({index: -1.0}, {index: radius * min(peak[index], shortest)}, 0.0)
    for element in elements:
        _seen(rows, element, peak, margins)
        if element.asked:
            _wish(rows, element, element.asked, peak, margins)
    turns = [element for element in elements if element.is_turn]
    for one, other in pairwise(turns):
        if one.side == other.side:  # to be measured as two
            rows.within(range(one.members.stop, other.first), Range(margins.apart))
    whole = range(len(segments))
    rows.within(whole, Range(world.limits.min_length + 2.0))
    if length:
        rows.within(whole, _drawn_in(length, margins.promise / 4))
    return np.array(rows.rows).reshape(-1, 2 * len(segments)), np.array(rows.most)


def _seen(rows: _Rows, element: RoadElement, peak: Array, margins: Margins) -> None:
    members = list(element.members)
    if not element.degrees:
        return
    if not element.is_turn:
        rows.turned(members, Range(0, max(SLIGHT_BEND, abs(element.degrees))))
        return
    least = LEAST_TURN + 0.4 * (margins.seen - LEAST_TURN)  # for a turn proposed with a small angle
    rows.turned(members, Range(max(min(abs(element.degrees), margins.seen), least)))
    bends = [abs(segment.turn_degrees) / segment.distance for segment in element.segments]
    tightest = members[bends.index(max(bends))]
    for index in {*members[1:-1], tightest}:
        bent = peak[index] if index == tightest else 1.0
        rows.add({index: 1.0}, {index: -bent * CLEARLY}, 0.0)


def _wish(rows: _Rows, element: RoadElement, wish: Feature, peak: Array, margins: Margins) -> None:
    members = list(element.members)
    if wish.length:
        rows.within(members, _drawn_in(wish.length, margins.promise))
    if not element.degrees:
        return
    if wish.degrees:
        rows.turned(members, wish.degrees.drawn_in(ANGLE_MARGIN, 0.2))
    if wish.radius:
        radius = _drawn_in(wish.radius, margins.promise)
        for index in members:
            if radius.lo > 0:
                rows.add({index: -1.0}, {index: radius.lo * max(peak[index], 1.0)}, 0.0)
        if radius.hi < inf:
            tightest = max(members, key=lambda i: peak[i])
            rows.add({tightest: 1.0}, {tightest: -radius.hi * max(peak[tightest], 1.0)}, 0.0)


def _drawn_in(span: Range, share: float) -> Range:
    """Returns a range narrowed at both ends by ``share`` of each bound, limited to a part of its width."""
    most = min(WIDTH_KEPT_OFF + share, 0.4) * (span.hi - span.lo)
    low = span.lo + min(share * abs(span.lo), most) if span.lo > -inf else span.lo
    return Range(low, span.hi - min(share * span.hi, most) if span.hi < inf else inf)


def least_change(aim: Aim) -> tuple[Segment, ...] | None:
    """Returns the segments with the cheapest change that was found; None if no change meets the limits.
    Limits that concern only frozen segments are ignored."""
    concerned = (aim.rows[:, np.tile(aim.free, 2)] != 0).any(axis=1)
    aim = aim._replace(rows=aim.rows[concerned], most=aim.most[concerned])
    found: list[tuple[float, Array, Array]] = []
    work = 0
    for share in STARTS:
        cost, lengths, turns, broken, steps = _descended(aim, share)
        work += steps * len(aim.figure.owner) ** 2
        if broken <= BROKEN:
            found.append((cost, lengths, turns))
        if work > MOST_WORK or len(found) == 2:
            break
        if broken <= BROKEN and share == 1.0 and cost < CHEAP * len(aim.lengths):
            break
    if not found:
        return None
    _, lengths, turns = min(found, key=lambda one: one[0])
    return _written(aim, lengths, turns)


def _descended(aim: Aim, share: float) -> tuple[float, Array, Array, float, int]:
    """Returns the cost of a change, the lengths in metres and the turns in radians of all segments, the
    largest amount in metres by which a limit is exceeded, and the number of steps of the solver."""
    n = len(aim.lengths)
    hands = np.where(aim.turns < 0, -1.0, 1.0)
    start = np.concatenate([aim.lengths, np.where(aim.free, share, 1.0) * np.abs(aim.turns), [0.0, 0.0, 0.0]])
    start[2 * n :] = _laid(aim, start, hands)
    by_turn = np.where(aim.turns != 0, TURN_WEIGHT / np.maximum(np.abs(aim.turns), LEAST_TURN_COUNTED), 100.0)
    units = np.concatenate([LENGTH_WEIGHT / aim.lengths, by_turn])
    weights = np.ones(2 * n)
    v, steps = start, 0
    for round_ in range(2):
        for penalty in PENALTIES[round_:]:
            v, taken = _settled(aim, hands, units, weights, v, penalty)
            steps += taken
        change = np.abs(units * (v[: 2 * n] - _proposed(aim)))
        weights = np.sqrt(FEW / (change + FEW))
    change = units * (v[: 2 * n] - _proposed(aim))
    broken, _ = _misses(aim, hands, v, with_slopes=False)
    most = float(broken.max(initial=0.0))
    return float(change @ change), v[:n], hands * v[n : 2 * n], most, steps


def _proposed(aim: Aim) -> Array:
    return np.concatenate([aim.lengths, np.abs(aim.turns)])


def _laid(aim: Aim, v: Array, hands: Array) -> Array:
    """Returns the first heading tried at which the road fits on the map, or else that with the smallest
    bounding box, and the start that centres it there. If the search always began at heading 0, a straight
    road would be shortened, because a small rotation by itself gains nothing."""
    n = len(aim.lengths)
    z, _ = aim.figure.walk(v[:n], hands * v[n : 2 * n], 0.0)
    turned = np.exp(1j * HEADINGS)[:, None] * z
    box = np.maximum(np.ptp(turned.real, axis=1), np.ptp(turned.imag, axis=1))
    size = aim.world.site.map_size
    fits = np.flatnonzero(box <= size - aim.world.section.road_width - 2 * aim.margins.edge)
    best = int(fits[0]) if fits.size else int(box.argmin())
    x, y = turned[best].real, turned[best].imag
    middle = np.array([np.ptp(x) / 2 + x.min(), np.ptp(y) / 2 + y.min()])
    return np.concatenate([HEADINGS[best : best + 1], size / 2 - middle])


def _settled(
    aim: Aim, hands: Array, units: Array, weights: Array, v: Array, penalty: float
) -> tuple[Array, int]:
    n, damping = len(aim.lengths), 1e-3
    free = np.concatenate([np.tile(aim.free, 2), [True] * 3])
    scale = np.concatenate([1 / units, [0.3, 20.0, 20.0]])[free]
    own = np.diag(np.concatenate([weights**2, np.full(3, 1e-8)])[free])

    def total(at: Array) -> float:
        change = weights * units * (at[: 2 * n] - _proposed(aim))
        missed, _ = _misses(aim, hands, at, with_slopes=False)
        return float(change @ change + penalty * (missed @ missed))

    now = total(v)
    for taken in range(STEPS):
        missed, slopes = _misses(aim, hands, v)
        slopes = slopes[:, free] * scale
        change = np.concatenate([weights**2 * units * (v[: 2 * n] - _proposed(aim)), np.zeros(3)])[free]
        matrix = own + penalty * (slopes.T @ slopes)
        down = change + penalty * (slopes.T @ missed)
        for _ in range(6):
            step = np.linalg.solve(matrix + damping * np.diag(np.diag(matrix) + 1e-6), -down)
            step *= min(1.0, 0.5 / max(np.abs(step[:-3]).max(), 1e-12))
            after = v.copy()
            after[free] += scale * step
            after[: 2 * n] = np.maximum(after[: 2 * n], 0.0)
            after[:n] = np.maximum(after[:n], 0.1 * aim.lengths)
            then = total(after)
            if then < now:
                break
            damping *= 6
        else:
            return v, taken
        v, gained, now, damping = after, now - then, then, max(damping / 8, 1e-9)
        if gained < SETTLED * (now + 1e-9):
            break
    return v, taken


def _misses(aim: Aim, hands: Array, v: Array, with_slopes: bool = True) -> tuple[Array, Array]:
    """Returns the metres by which limits are exceeded, ``(m,)``, and their derivatives by every unknown."""
    n = len(aim.lengths)
    by_rows = aim.rows @ v[: 2 * n] - aim.most
    over = by_rows > 0
    z, steps = aim.figure.walk(v[:n], hands * v[n : 2 * n], v[2 * n])
    border, size = aim.world.section.road_width / 2 + aim.margins.edge, aim.world.site.map_size
    x, y = z.real + v[2 * n + 1], z.imag + v[2 * n + 2]
    outside = np.stack([border - x, border - y, x + border - size, y + border - size])
    out = outside > 0
    one, other = _meeting(z, v[:n], aim)
    apart = aim.world.section.road_width + aim.margins.clear
    away = z[other] - z[one]
    far = np.maximum(np.abs(away), 1e-6)
    missed = np.concatenate([by_rows[over], outside[out], apart - far])
    if not with_slopes:
        return missed, missed
    by_length, by_turn = aim.figure.slopes(v[:n], steps)
    moves = np.concatenate([by_length, by_turn * (hands * (aim.turns != 0)), 1j * z[:, None]], axis=1)
    rows = np.concatenate([aim.rows[over], np.zeros((int(over.sum()), 3))], axis=1)
    which, point = np.nonzero(out)
    sign = np.where(which < 2, -1.0, 1.0)[:, None]
    along_y = (which % 2)[:, None]
    own = np.where(along_y, moves[point].imag, moves[point].real)
    box = sign * np.concatenate([own, 1 - along_y, along_y], axis=1)
    part = (moves[other] - moves[one]) * (away.conj() / far)[:, None]
    clear = np.concatenate([-part.real, np.zeros((len(one), 2))], axis=1)
    return missed, np.concatenate([rows, box, clear])


def _meeting(z: Complex, lengths: Array, aim: Aim) -> tuple[Indices, Indices]:
    """Returns pairs of points that lie nearer to each other than the road may come to itself. Only every
    second point is compared. Points with no free segment between them are left out, because their distance
    cannot change."""
    owner = aim.figure.owner
    count = np.bincount(owner, minlength=len(lengths))
    s = np.concatenate([[0.0], np.cumsum((lengths / count)[owner])])[::SPARSE]
    moved = np.concatenate([[0], np.cumsum(aim.free[owner])])[::SPARSE]
    points, apart = z[::SPARSE], aim.world.section.road_width + aim.margins.clear
    other, one = meeting(points, s, points, s, apart, neighbours(apart))
    free = moved[other] > moved[one]
    return SPARSE * one[free], SPARSE * other[free]


def _written(aim: Aim, lengths: Array, turns: Array) -> tuple[Segment, ...]:
    """Returns the segments with new lengths and turns, rounded. Radii are scaled accordingly. A radius that
    becomes too small is removed together with its transition, and a transition that becomes too long is
    shortened."""
    tightest = aim.world.limits.min_radius * aim.margins.radius
    out = []
    for segment, length, turn, may_change in zip(aim.proposed, lengths, turns, aim.free, strict=True):
        if not may_change:
            out.append(segment)
            continue
        distance = _rounded(float(length), segment.distance)
        degrees = _rounded(float(np.degrees(turn)), segment.turn_degrees)
        radius, transition = segment.radius, segment.transition
        if radius and degrees:
            grown = radius * (distance / segment.distance) * (segment.turn_degrees / degrees)
            if grown < tightest:
                radius = transition = None
            elif grown != radius:
                radius = ceil(grown * CENTIMETRE) / CENTIMETRE
        if degrees and not radius:
            most = max(distance - tightest * abs(np.radians(degrees)), SHORTEST_TRANSITION)
            if (transition or min(distance / 4, 12.0)) > most:
                transition = floor(most * TENTH) / TENTH
        update = {"distance": distance, "turn_degrees": degrees, "radius": radius, "transition": transition}
        out.append(segment.model_copy(update=update))
    return tuple(out)


def _rounded(value: float, before: float) -> float:
    """Returns a value rounded to a tenth; the value before, if the difference is at most 0.5 %."""
    return before if abs(value - before) <= 0.005 * abs(before) else round(value * TENTH) / TENTH


SOLVED = 2  # of solving: the second with the transitions that result from the first
MOST_SEGMENTS = 60  # free segments; a road with more is not fitted


def fit(
    design: Design, elements: RoadElements, requirements: Requirements, frozen: Collection[str] = frozenset()
) -> FittedRoad:
    """Finds a road that meets all requirements and differs from the design as little as possible.

    ``design`` is the road after the steps of an edit and then ``graded``, and ``elements`` are its turns and
    straights in driving order, each with its requirement. ``frozen`` are the names of the elements whose
    lengths, turns and radii stay as they are. Returns that FittedRoad, with an empty ``objection``; if no
    such road was found, that of the design, moved inside the map if possible. Raises UsageError if no road
    can be built from these segments."""
    world, before = requirements.world, requirements.before
    first = checked_road(design, elements, requirements)
    free = np.array([element.name not in frozen for element in elements for _ in element.segments])
    if not first.objection or not 1 <= free.sum() <= MOST_SEGMENTS:
        return first
    last = first
    for margins in MARGINS if before is None else (TIGHT, *MARGINS):
        segments = None
        for _ in range(SOLVED):
            found = least_change(aim_of(first, last, segments, free, margins))
            if found is None:
                break
            segments = found
        if segments is None:  # there is no such road; with wider margins even less
            break
        if before and segments == last.design.segments:
            continue
        design = first.design.model_copy(update={"segments": segments})
        design = graded(design, first.elements, world, before)
        last = checked_road(design, first.elements, requirements)
        if not last.objection:
            return last if before else _restored(last, first)
    return first


def checked_road(design: Design, elements: RoadElements, requirements: Requirements) -> FittedRoad:
    """Builds and checks the road of a design, and returns its FittedRoad. The elements of that are
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
    return FittedRoad(moved, elements, road, findings, requirements)


def _restored(mended: FittedRoad, first: FittedRoad) -> FittedRoad:
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
        seen = checked_road(tried, first.elements, first.requirements)
        if not seen.objection:
            mended = seen
    return mended


__all__ = ["FittedRoad", "Requirements", "checked_road", "fit"]
