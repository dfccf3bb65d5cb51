"""Finds lengths and turns that meet all requirements. Main function: ``planned``.

The limits of lengths and turns are rows of a matrix: a . lengths + b . |turns| <= c, all in metres. A minimum
radius can be written as such a limit: if a segment turns by ``turn`` radians over ``length`` metres, and its
maximum curvature is ``peak`` times its mean curvature, its minimum radius is length / (peak * turn).
"""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from math import ceil, floor, inf, radians

import numpy as np
from numpy.typing import NDArray

from roadgpt.brief.outline import Feature, Outline
from roadgpt.brief.words import Range
from roadgpt.check.measures import LEAST_TURN, MeasuredFeature
from roadgpt.design.fit.look import Look
from roadgpt.design.fit.solver import Aim, Margins, PlanPolyline, least_change, polyline_of
from roadgpt.design.road_elements import RoadElement, RoadElements
from roadgpt.geometry.curve import Array
from roadgpt.road import Segment, World
from roadgpt.road.design import MAX_TURN

ROUNDS = 2  # of solving: the second with the transitions that result from the first
TENTH, CENTIMETRE = 10.0, 100.0  # per degree or metre, per metre: how changed numbers are written
SHORTEST_TRANSITION = 0.1  # m
FADES = 3.0, 2.0  # m by which a straight, or a turn, may be measured shorter than it is written
LEAST_TRANSITION = 0.1  # share of a turning segment to which each of its clothoids may be shortened
METRES_PER_RADIAN = 30.0  # weight of a missing radian relative to a missing metre
SHARE_KEPT = 0.2  # of every length and turn: less would not be the segment that was proposed
CLEARLY = 260.0  # m: largest radius of a turn that must be seen as one (measurements have a limit of 300)
SLIGHT_BEND = 9.0  # degrees: a bend that was proposed too slight for a turn stays below this
WIDTH_KEPT_OFF = 0.2  # of a promised range, at either end, besides the margin of promises
ANGLE_MARGIN = 0.4  # degrees, off what was promised


TIGHT = Margins(1.03, 12.0, 14.0, 0.5, 0.3, 0.02)
"""Margins of an edited road. Most of the road stays as it is, and it may lie close to the limits."""
MARGINS = (Margins(), Margins(1.07, 13.5, 18.0, 1.5, 1.0, 0.1), Margins(1.12, 15.0, 22.0, 2.5, 1.5, 0.2))


def planned(first: Look, last: Look, free: NDArray[np.bool_], margins: Margins) -> tuple[Segment, ...] | None:
    """Returns the segments with lengths and turns that meet all limits, changed as little as possible.

    Args:
        first: the road as it was proposed.
        last: the last road that was tried; it shows how much measured values differ from written ones.
        free: whether the length and the turn of each segment may change, ``(n,)``.
        margins: distances to keep from the limits.

    Returns:
        The segments, or None if there is no such road.
    """
    world, outline = first.requirements.world, first.requirements.outline
    proposed = first.design.segments
    lengths = np.array([s.distance for s in proposed])
    turns = np.radians([s.turn_degrees for s in proposed])
    elements = _as_written(first, last)
    now: tuple[Segment, ...] | None = None
    for _ in range(ROUNDS):
        figure = polyline_of(now or proposed)
        rows, most = _limits_of(proposed, elements, figure.peak, outline, world, margins)
        found = least_change(Aim(lengths, turns, free, figure, rows, most, world, margins))
        if found is None:
            break
        now = _written(proposed, found.lengths, found.turns, free, world.limits.min_radius * margins.radius)
    return now


def _as_written(first: Look, last: Look) -> RoadElements:
    """Returns the elements, with required measured values converted to the values to write in the design."""
    figure = polyline_of(last.design.segments)
    is_seen = first.requirements.brief is None and last.has_turns
    seen = last.seen if is_seen else (None,) * len(last.elements)
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


def _written(
    proposed: tuple[Segment, ...], lengths: Array, turns: Array, free: NDArray[np.bool_], radius: float
) -> tuple[Segment, ...]:
    """Returns the segments with new lengths and turns, rounded.

    Radii are scaled accordingly. A radius that becomes too small is removed together with its transition, and
    a transition that becomes too long is shortened.
    """
    out = []
    for segment, length, turn, may_change in zip(proposed, lengths, turns, free, strict=True):
        if not may_change:
            out.append(segment)
            continue
        distance, degrees = (
            _rounded(float(length), segment.distance),
            _rounded(float(np.degrees(turn)), segment.turn_degrees),
        )
        update: dict[str, float | None] = {"distance": distance, "turn_degrees": degrees}
        if segment.radius and degrees:
            grown = segment.radius * (distance / segment.distance) * (segment.turn_degrees / degrees)
            fits_in = grown >= radius
            update["radius"] = (
                ceil(grown * CENTIMETRE) / CENTIMETRE
                if fits_in and grown != segment.radius
                else segment.radius
                if fits_in
                else None
            )
            if not fits_in:
                update["transition"] = None
        transition = update.get("transition", segment.transition)
        if degrees and not update.get("radius"):
            most = max(distance - radius * abs(np.radians(degrees)), SHORTEST_TRANSITION)
            if (transition or min(distance / 4, 12.0)) > most:
                update["transition"] = floor(most * TENTH) / TENTH
        out.append(segment.model_copy(update=update))
    return tuple(out)


def _rounded(value: float, before: float) -> float:
    """Returns a value rounded to a tenth; the value before, if the difference is at most 0.5 %."""
    return before if abs(value - before) <= 0.005 * abs(before) else round(value * TENTH) / TENTH


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
        """Adds the constraint that the total length of the given segments lies within a range, in metres."""
        if span and span.lo > 0:
            self.add(dict.fromkeys(members, -1.0), {}, -span.lo)
        if span and span.hi < inf:
            self.add(dict.fromkeys(members, 1.0), {}, span.hi)

    def turned(self, members: Sequence[int], span: Range | None) -> None:
        """Adds the constraint that the total turning angle of the given segments lies within a range, in
        degrees.
        """
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
    """Returns all limits of lengths and turns as a matrix ``(m, 2 n)`` and a right-hand side ``(m,)``.

    Args:
        segments: The ``n`` segments as proposed.
        elements: The turns and straights that the segments form, some with requirements of their own.
        peak: Ratio of maximum to mean curvature of each segment, ``(n,)``.
        outline: The requirements of the whole road.
        world: The limits that the rules check, such as the steepest grade.
        margins: The distances to keep from the limits.
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
