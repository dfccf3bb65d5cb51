r"""Computes the margin of a drive at every step: the distance to failure in metres.

    margin = how far the car could be shifted sideways, with its heading unchanged, before it fails

The car fails if the share of its bounding box outside its lane exceeds the tolerance. While the car is in its
lane, the margin is at most the distance from the box to the outer edge of the carriageway and its shoulder.
Across the lane, the area of a rotated box is distributed as the trapezoid below. The position at which the
share equals the tolerance is therefore computed exactly. The curvature of the lane under the box is taken
into account to second order. If lane departures count, the car also fails as soon as the outer edge of a
front tyre crosses the outer edge of a lane marking.

                 ____________
                /|          |\          density of the box across the lane, at an angle psi to it:
               / |          | \         two uniform densities convolved, with half-widths
     _________/__|__________|__\_____   a = L/2 sin psi and b = W/2 cos psi
            -(a+b)     0      a+b
"""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from roadgpt.geometry import wrap_angle
from roadgpt.verdict.oracle import is_outside

if TYPE_CHECKING:
    from roadgpt.drive import Drive
    from roadgpt.road import Road, World

FloatArray = NDArray[np.float64]
THINNEST = 1e-9  # m, lower bound of a half-width, for a box seen exactly end-on
EPSILON = 1e-9  # m; a negative margin is at least this far below 0
LEAST_STRETCH = 0.2  # lower bound of the metres on the inside of a bend per metre of road


class LateralExtent(NamedTuple):
    """The extent of the car's bounding box across the lane at each of the n steps of a drive."""

    middle: FloatArray
    """Offset of the box's middle in metres to the left of the centre line; shape ``(n,)``.

    It is corrected for the curvature of the lane under the box.
    """
    long: FloatArray
    """Half of the larger projection in metres, ``(n,)``. The two projections are those of the box's length
    and of the box's width across the lane.
    """
    short: FloatArray
    """Half of the smaller projection in metres, ``(n,)``."""


def lateral_extent(road: "Road", drive: "Drive") -> LateralExtent:
    """Returns the extent of the car's bounding box across its lane, at every step of a drive."""
    s, t, box = drive["s"], drive["t"], drive.car
    psi = wrap_angle(drive["heading"] - road.heading(s))
    bend = road.curvature(s)
    bend = bend / np.maximum(1 - bend * t, LEAST_STRETCH)
    sin, cos = np.sin(psi), np.cos(psi)
    # Mean of -k u^2 / 2 over the box, u the way along the lane from the centre of gravity.
    spread = (box.ahead * cos) ** 2 + ((box.length * cos) ** 2 + (box.width * sin) ** 2) / 12
    middle = t + box.ahead * sin - bend * spread / 2
    a, b = np.abs(box.length * sin) / 2, np.abs(box.width * cos) / 2
    return LateralExtent(middle, np.maximum(a, b), np.maximum(np.minimum(a, b), THINNEST))


def allowed_overhang(tolerance: float, box: LateralExtent) -> FloatArray:
    """Returns how far beyond the lane's edge the middle of the box may be before the car fails.

    The distance is in metres, positive outwards. At this distance, the share of the box outside the lane
    equals ``tolerance`` (0 to 1).
    """
    tail = min(tolerance, 1 - tolerance)
    a, b = box.long, box.short
    in_slope = a + b - np.sqrt(8 * a * b * tail)
    in_plateau = (1 - 2 * tail) * a
    far = np.where(tail <= b / (2 * a), in_slope, in_plateau)
    return np.asarray(far if tolerance >= 0.5 else -far, float)


def margins(road: "Road", drive: "Drive", world: "World") -> FloatArray:
    """Returns the margin in metres at every step of a drive, shape ``(n,)``.

    It is negative exactly where the car is out of its lane. It is 0 where the car still counts as in its
    lane, but its box extends beyond the carriageway and its shoulder.
    """
    box = lateral_extent(road, drive)
    s, profile = drive["s"], world.profile_of(road)
    half, middle, rims = profile.width(s) / 2, profile.middle(s), profile.rims(s)
    in_lane = half + allowed_overhang(world.limits.oob_tolerance, box) - np.abs(box.middle - middle)
    ground = np.minimum(rims.left - box.middle, box.middle - rims.right) - box.long - box.short
    if world.limits.lane_departure:
        from roadgpt.drive.marking_monitor import MarkingMonitor

        in_lane = np.minimum(in_lane, -MarkingMonitor.for_tyres(road, world, drive.car).along(drive))
    outside = is_outside(road, drive, world)
    inside = np.maximum(np.minimum(in_lane, ground), 0.0)
    # The oracle's polygon and the formula differ by millimetres; the oracle decides on which side of 0 it is.
    return np.asarray(np.where(outside, np.minimum(in_lane, -EPSILON), inside), float)
