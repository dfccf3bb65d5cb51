"""Poses, and the curve of a connecting road between two of them: a clothoid, an arc and a clothoid between
two straight lines.

The two lines meet at one point. Take a curve that turns by ``turn`` radians and whose arc has a radius of 1
m: it begins ``tangent_length(turn)`` metres before this point and ends the same distance behind it. A curve
of radius R is R times as large."""

import math
from functools import lru_cache
from typing import NamedTuple

import scipy

from roadgpt.geometry import Piece
from roadgpt.geometry.curve import Point
from roadgpt.geometry.pieces import joined

SHARE = 0.3  # share of the angle of a turn that belongs to the two clothoids; the rest belongs to the arc
STRAIGHT = 1e-9  # rad; a way with a smaller turn is a straight line


class NetworkPose(NamedTuple):
    """A point in metres and a heading in radians."""

    point: Point
    heading: float

    def ahead(self, metres: float, turn: float = 0.0) -> "NetworkPose":
        """Returns the pose ``metres`` straight ahead at the same height, turned by ``turn`` radians."""
        (x, y, z), h = self.point, self.heading
        return NetworkPose((x + metres * math.cos(h), y + metres * math.sin(h), z), h + turn)


@lru_cache(maxsize=1024)
def tangent_length(turn: float) -> float:
    """Returns the distance from the start of a curve to the point where its tangents meet, in arc radii;
    ``turn`` is more than 0 and less than pi radians. A clothoid of length L before an arc of radius 1 turns
    by L / 2 and moves the arc inwards by ``shift`` and forwards by ``ahead``."""
    ramp = SHARE * turn
    scale = math.sqrt(math.pi * ramp)
    s, c = scipy.special.fresnel(ramp / scale)
    ahead = scale * float(c) - math.sin(ramp / 2)
    shift = scale * float(s) - (1 - math.cos(ramp / 2))
    return (1 + shift) * math.tan(turn / 2) + ahead


def curve_between(before: float, after: float, turn: float) -> tuple[Piece, ...]:
    """Returns pieces that lead from one line to another along a curve with the largest radius that fits.

    The lines meet ``before`` metres behind the start and ``after`` metres before the end, both more than 0.
    The shorter one decides the radius; on the other line, a straight remains. ``turn`` is the change of
    heading in radians, positive to the left, between -pi and pi."""
    if abs(turn) < STRAIGHT:
        return (Piece(before + after),)
    tangent = min(before, after)
    radius = tangent / tangent_length(abs(turn))
    k = math.copysign(1 / radius, turn)
    ramp, arc = SHARE * abs(turn) * radius, (1 - SHARE) * abs(turn) * radius
    return joined(
        (
            Piece(before - tangent),
            Piece(ramp, 0.0, k),
            Piece(arc, k, k),
            Piece(ramp, k, 0.0),
            Piece(after - tangent),
        )
    )
