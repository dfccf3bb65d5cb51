"""Spans: turns and straights with their measures, before they are cut into RoadGPT's segments.

A turn is a clothoid, an arc and a clothoid:   length = radius * angle + ramp
"""

from math import ceil, floor, inf, radians
from typing import NamedTuple

from roadgpt.brief.words import Range
from roadgpt.road import Segment
from roadgpt.road.design import MAX_TURN

MILLIMETRE = 1000.0  # per metre: distances are written to the millimetre
TENTH = 10.0  # per unit: angles, ramps and inclines are written to the tenth
HUNDREDTH = 100.0  # per metre: radii are written to the centimetre
MOST_RAMP = 0.55  # of a segment's arc: with more, a segment could not keep its radius (see road.alignment)


class Span(NamedTuple):
    """A turn, or a straight where ``turn`` is 0."""

    length: float
    """Metres along the plan."""
    turn: float = 0.0
    """Degrees, left positive."""
    radius: float = inf
    """Metres."""
    ramp: float = 0.0
    """Metres, of the clothoid at either end."""
    grade: Range | None = None
    """Percent, that its slope as a whole must lie in; None where nothing is promised."""
    promised: Range | None = None
    """Metres, of a straight that was asked for; None of a turn, or of a straight that only joins others."""

    @property
    def is_elastic(self) -> bool:
        """May it be made longer?"""
        return not self.turn and (self.promised is None or self.promised.hi == inf)

    @property
    def curvature(self) -> float:
        """Of the arc, 1/m, left positive; 0 of a straight."""
        return (1 if self.turn > 0 else -1) / self.radius


class Slope(NamedTuple):
    """A stretch of one incline."""

    length: float
    """Metres."""
    incline: float
    """Percent."""
    radius: float | None = None
    """Metres, of the parabola from the slope before; None leaves it open."""


Inclines = list[Slope]
"""The slopes of a span, in order."""


def turn_span(angle: float, hand: int, radius: float, ramp: float, grade: Range | None) -> Span:
    """A turn with its numbers rounded as they will be written; the ramp is kept as short as segments need.

    Args:
        angle: degrees, positive.
        hand: 1 to the left, -1 to the right.
        radius: metres.
        ramp: metres, of each clothoid.
        grade: percent, promised.
    """
    parts = segments_of_turn(angle)
    share = round(angle / parts * TENTH) / TENTH
    radius = ceil(radius * HUNDREDTH) / HUNDREDTH
    most = MOST_RAMP * radius * radians(share)
    ramp = max(floor(min(ramp, most) * TENTH), 1) / TENTH
    angle = share * parts
    return Span(radius * radians(angle) + ramp, hand * angle, radius, ramp, grade)


def segments_of_turn(angle: float) -> int:
    """How many of RoadGPT's segments a turn of so many degrees takes."""
    return max(1, ceil(angle / MAX_TURN - 1e-9))


def cut(span: Span, inclines: Inclines) -> list[Segment]:
    """RoadGPT's segments of a span.

    Args:
        span: the turn or straight.
        inclines: its slopes; of a turn just one.
    """
    if not span.turn:
        return [
            Segment(
                distance=round(length * MILLIMETRE) / MILLIMETRE,
                direction="straight",
                incline=incline,
                vertical_radius=radius,
            )
            for length, incline, radius in inclines
        ]
    _, incline, vertical = inclines[0]
    parts = segments_of_turn(abs(span.turn))
    share = span.turn / parts
    arc = span.radius * radians(abs(share))
    direction = "left" if span.turn > 0 else "right"
    out = []
    for part in range(parts):
        ends = (part == 0) + (part == parts - 1)
        # outer parts a hair long, inner ones a hair short: so every part can keep the radius
        exact = (arc + ends * span.ramp / 2) * MILLIMETRE
        distance = (ceil(exact) if ends else floor(exact)) / MILLIMETRE
        out.append(
            Segment(
                distance=distance,
                direction=direction,
                incline=incline,
                turn_degrees=round(share * TENTH) / TENTH,
                radius=span.radius if ends else None,
                transition=span.ramp if ends else None,
                vertical_radius=None if part else vertical,
            )
        )
    return out
