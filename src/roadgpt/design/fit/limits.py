"""Writes the limits of lengths and turns as rows of a matrix: a . lengths + b . |turns| <= c, all in metres.

A minimum radius can be written as such a limit: if a segment turns by ``turn`` radians over ``length``
metres, and its maximum curvature is ``peak`` times its mean curvature, its minimum radius is length / (peak *
turn).
"""

from collections.abc import Sequence
from itertools import pairwise
from math import inf, radians
from typing import NamedTuple

import numpy as np

from roadgpt.brief.outline import Feature, Outline
from roadgpt.brief.words import Range
from roadgpt.check.measures import LEAST_TURN
from roadgpt.design.road_elements import RoadElement
from roadgpt.geometry.curve import Array
from roadgpt.road import Segment, World

LEAST_TRANSITION = 0.1  # of a segment that turns, for each clothoid: as short as it may be made
METRES_PER_RADIAN = 30.0  # how heavy a missing radian weighs beside a missing metre
SHARE_KEPT = 0.2  # of every length and turn: less would not be the segment that was proposed
CLEARLY = 260.0  # m: of a turn that is to be seen as one, the largest radius (the measure says 300)
SLIGHT_BEND = 9.0  # degrees: what was proposed as no turn stays less
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
    """Smallest distance between two successive turns to the same side, in metres."""
    clear: float = 1.1
    """Distance in metres between two parts of the road, in addition to its width."""
    edge: float = 0.6
    """Distance in metres between the road and the border of the map."""
    promise: float = 0.04
    """Margin inside a required range of lengths or radii, as a fraction of each bound of the range."""


TIGHT = Margins(1.03, 12.0, 14.0, 0.5, 0.3, 0.02)
"""Margins of a changed road, most of which stays as it is, and which may lie close to the limits."""
MARGINS = (Margins(), Margins(1.07, 13.5, 18.0, 1.5, 1.0, 0.1), Margins(1.12, 15.0, 22.0, 2.5, 1.5, 0.2))


class Rows:
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


def limits_of(
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
    rows = Rows(len(segments))
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


def _seen(rows: Rows, element: RoadElement, peak: Array, margins: Margins) -> None:
    """A turn stays one that is seen, and whole; a slighter bend stays slight."""
    members = list(element.members)
    if not element.degrees:
        return
    if not element.is_turn:
        rows.turned(members, Range(0, max(SLIGHT_BEND, abs(element.degrees))))
        return
    least = LEAST_TURN + 0.4 * (margins.seen - LEAST_TURN)  # of a turn that was proposed with hardly as many
    rows.turned(members, Range(max(min(abs(element.degrees), margins.seen), least)))
    bends = [abs(segment.turn_degrees) / segment.distance for segment in element.segments]
    tightest = members[bends.index(max(bends))]
    for index in {*members[1:-1], tightest}:
        bent = peak[index] if index == tightest else 1.0
        rows.add({index: 1.0}, {index: -bent * CLEARLY}, 0.0)


def _wish(rows: Rows, element: RoadElement, wish: Feature, peak: Array, margins: Margins) -> None:
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
    """A range without its edges: that share of them, and no more than some of its width."""
    most = min(WIDTH_KEPT_OFF + share, 0.4) * (span.hi - span.lo)
    low = span.lo + min(share * abs(span.lo), most) if span.lo > -inf else span.lo
    return Range(low, span.hi - min(share * span.hi, most) if span.hi < inf else inf)


def _separate(rows: Rows, elements: Sequence[RoadElement], margins: Margins) -> None:
    """Between two turns of one hand lies so much that they are seen as two."""
    turns = [element for element in elements if element.is_turn]
    for one, other in pairwise(turns):
        if one.side == other.side:
            rows.within(range(one.members.stop, other.first), Range(margins.apart))
