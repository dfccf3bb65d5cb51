"""States which lengths and turns a plan may have, as an Aim for the solver. Main function: ``aim_of``.

The limits of lengths and turns are rows of a matrix: a . lengths + b . |turns| <= c, all in metres. A minimum
radius can be written as such a limit: if a segment turns by ``turn`` radians over ``length`` metres, and its
maximum curvature is ``peak`` times its mean curvature, its minimum radius is length / (peak * turn).

The plan is a polyline that follows its lengths and turns:

    step m of segment i:   z += d_i / steps_i * exp(1j * (heading + turns before i + share_m * turn_i))

``share_m`` is the fraction of the segment's turn that is completed at that step. It is taken from the built
curve, and kept while lengths and turns change a little.
"""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from math import inf, radians
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roadgpt.brief.outline import Feature, Outline
from roadgpt.brief.ranges import Range
from roadgpt.check.measures import LEAST_TURN, MeasuredFeature
from roadgpt.design.fit.look import Look
from roadgpt.design.road_elements import RoadElement, RoadElements
from roadgpt.geometry import PieceCurve
from roadgpt.geometry.curve import Array
from roadgpt.geometry.nearness import Complex
from roadgpt.geometry.pieces import joined
from roadgpt.road import Segment, World
from roadgpt.road.alignment import pieces_of
from roadgpt.road.design import MAX_TURN

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


class Margins(NamedTuple):
    """Distances that a repaired road keeps from the limits of the rules."""

    radius: float = 1.045
    """Factor by which the smallest radius that the rules allow is multiplied, because the competition's
    spline cuts corners.
    """
    seen: float = 12.0
    """Smallest angle of a turn, in degrees."""
    apart: float = 15.5
    """Smallest distance between two successive turns that go the same way, in metres."""
    clear: float = 1.1
    """Distance in metres between two parts of the road, in addition to its width."""
    edge: float = 0.6
    """Distance in metres between the road and the border of the map."""
    promise: float = 0.04
    """Margin inside a required range of lengths or radii, as a fraction of each bound of the range."""


TIGHT = Margins(1.03, 12.0, 14.0, 0.5, 0.3, 0.02)
"""Margins of an edited road. Most of the road stays as it is, and it may lie close to the limits."""
MARGINS = (Margins(), Margins(1.07, 13.5, 18.0, 1.5, 1.0, 0.1), Margins(1.12, 15.0, 22.0, 2.5, 1.5, 0.2))


class PlanPolyline(NamedTuple):
    """A plan as a polyline."""

    owner: NDArray[np.intp]
    """Index of the segment to which each step of the polyline belongs, ``(k,)``."""
    share: Array
    """Fraction (0 to 1) of its segment's turn that is completed in the middle of each step, ``(k,)``."""
    peak: Array
    """Ratio of the largest to the mean curvature of each segment; 0 for straights."""

    def walk(self, lengths: Array, turns: Array, heading: float) -> tuple[Complex, Complex]:
        """Returns the points ``(k + 1,)`` of the polyline as x + iy, starting at the origin, and its steps
        ``(k,)``, for these lengths and turns of the segments, in metres and radians.
        """
        count = np.bincount(self.owner, minlength=len(lengths))
        before = np.concatenate([[0.0], np.cumsum(turns)[:-1]])
        angle = heading + before[self.owner] + self.share * turns[self.owner]
        steps = (lengths / count)[self.owner] * np.exp(1j * angle)
        return np.concatenate([[0j], np.cumsum(steps)]), steps

    def slopes(self, lengths: Array, steps: Complex) -> tuple[Complex, Complex]:
        """Returns the derivatives of all points with respect to each length and each turn, ``(k + 1, n)``
        each.
        """
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

    lengths: Array
    """Length of each segment in metres."""
    turns: Array
    """Turning angle of each segment in radians, left positive."""
    free: NDArray[np.bool_]
    """Whether the length and the turn of each segment may change; the others are constants."""
    proposed: tuple[Segment, ...]
    """The segments as proposed, with these lengths and turns."""
    figure: PlanPolyline
    rows: Array
    """Matrix of the limits of lengths and turns, ``(m, 2 n)``."""
    most: Array
    """Right-hand sides of the limits, ``(m,)``."""
    world: World
    margins: Margins


def aim_of(
    first: Look,
    last: Look,
    now: tuple[Segment, ...] | None,
    free: NDArray[np.bool_],
    margins: Margins,
) -> Aim:
    """Returns the lengths and turns that a plan should have, and all limits for them.

    Args:
        first: the road as it was proposed.
        last: the last road that was tried; it shows how much measured values differ from written ones.
        now: the segments found so far, which show where each segment turns; None if there are none yet.
        free: whether the length and the turn of each segment may change, ``(n,)``.
        margins: distances to keep from the limits.
    """
    world, outline = first.requirements.world, first.requirements.outline
    proposed = first.design.segments
    lengths = np.array([s.distance for s in proposed])
    turns = np.radians([s.turn_degrees for s in proposed])
    figure = polyline_of(now or proposed)
    rows, most = _limits_of(proposed, _as_written(first, last), figure.peak, outline, world, margins)
    return Aim(lengths, turns, free, proposed, figure, rows, most, world, margins)


def _as_written(first: Look, last: Look) -> RoadElements:
    """Returns the elements, with required measured values converted to the values to write in the design."""
    figure = polyline_of(last.design.segments)
    seen = last.seen if last.has_turns else (None,) * len(last.elements)
    return tuple(
        replace(element, asked=_shifted(element.asked, now, feature, figure))
        if element.asked and element.segments
        else replace(element, asked=None)
        for element, now, feature in zip(first.elements, last.elements, seen, strict=True)
    )


def _shifted(asked: Feature, now: RoadElement, seen: MeasuredFeature | None, figure: PlanPolyline) -> Feature:
    """Returns a feature's ranges of measured values, converted to ranges of the values to write."""
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

    def within(self, members: Sequence[int], span: Range | None) -> None:
        """Adds the limits of the total length of some segments, in metres."""
        if span and span.lo > 0:
            self.add(dict.fromkeys(members, -1.0), {}, -span.lo)
        if span and span.hi < inf:
            self.add(dict.fromkeys(members, 1.0), {}, span.hi)

    def turned(self, members: Sequence[int], span: Range | None) -> None:
        """Adds the limits of the total turning angle of some segments, in degrees."""
        if span and span.lo > 0:
            self.add({}, dict.fromkeys(members, -METRES_PER_RADIAN), -METRES_PER_RADIAN * radians(span.lo))
        if span and span.hi < inf:
            self.add({}, dict.fromkeys(members, METRES_PER_RADIAN), METRES_PER_RADIAN * radians(span.hi))

    def done(self) -> tuple[Array, Array]:
        """Returns the matrix ``(m, 2 n)`` and the right-hand side ``(m,)``."""
        return np.array(self.rows).reshape(-1, 2 * self.count), np.array(self.most)


def _limits_of(
    segments: Sequence[Segment],
    elements: Sequence[RoadElement],
    peak: Array,
    outline: Outline,
    world: World,
    margins: Margins,
) -> tuple[Array, Array]:
    """Returns all limits of lengths and turns as a matrix ``(m, 2 n)`` and a right-hand side ``(m,)``;
    ``peak`` is the ratio of maximum to mean curvature of each of the ``n`` segments.
    """
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
    _separate(rows, elements, margins)
    whole = range(len(segments))
    rows.within(whole, Range(world.limits.min_length + 2.0))
    if outline.length:
        rows.within(whole, _drawn_in(outline.length, margins.promise / 4))
    if outline.turning:
        turning = [i for i, segment in enumerate(segments) if segment.turn_degrees]
        rows.turned(turning, _drawn_in(outline.turning, margins.promise / 4))
    return rows.done()


def _seen(rows: _Rows, element: RoadElement, peak: Array, margins: Margins) -> None:
    """Adds limits so that a turn is still measured as one turn, and a slight bend is still not measured."""
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
    length = _drawn_in(wish.length, margins.promise) if wish.length else None
    rows.within(members, length)
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


def _separate(rows: _Rows, elements: Sequence[RoadElement], margins: Margins) -> None:
    """Keeps two turns that go the same way far enough apart to be measured as two."""
    turns = [element for element in elements if element.is_turn]
    for one, other in pairwise(turns):
        if one.side == other.side:
            rows.within(range(one.members.stop, other.first), Range(margins.apart))
