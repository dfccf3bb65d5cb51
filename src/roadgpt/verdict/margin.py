r"""Computes the margin: the distance in metres from failing, at every step of a drive.

    margin = how much farther sideways the car, with its present pose, could be moved before it fails

The car fails when more than the tolerance of its box is outside the right lane, or when its box reaches over
the end of the ground (carriageway and shoulder; on a mesh road without a shoulder, that end comes first on
the right). The share of a rotated box beyond a straight line is the tail of a trapezoid, so the position at
which the share equals the tolerance is known exactly; the curvature of the lane under the box is taken into
account to second order. If lane departures count, the car fails as soon as the outer edge of a front tyre
passes that of a marking.

                 ____________
                /|          |\          density of the box across the lane, at an angle psi to it:
               / |          | \         half-widths a = L/2 sin psi and b = W/2 cos psi, added
     _________/__|__________|__\_____
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
EPSILON = 1e-9  # m, smallest amount of a negative margin
LEAST_STRETCH = 0.2  # lower bound of the metres on the inside of a bend per metre of road


class LateralExtent(NamedTuple):
    """The car's box across the lane, per step; shapes ``(n,)``."""

    middle: FloatArray
    """m to the left of the centre line, middle of the box, with the curvature of the lane under it taken into
    account."""
    long: FloatArray
    """m, half the extent across the lane of the pair of sides with the larger extent."""
    short: FloatArray
    """m, half the extent across the lane of the other pair."""


def lateral_extent(road: "Road", drive: "Drive") -> LateralExtent:
    """Returns the extent of the car's box across its lane, at every step."""
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
    """Returns the distance in metres from the lane's edge to the box's middle, positive outwards, at which
    the share outside equals the tolerance."""
    tail = min(tolerance, 1 - tolerance)
    a, b = box.long, box.short
    in_slope = a + b - np.sqrt(8 * a * b * tail)
    in_plateau = (1 - 2 * tail) * a
    far = np.where(tail <= b / (2 * a), in_slope, in_plateau)
    return np.asarray(far if tolerance >= 0.5 else -far, float)


def margins(road: "Road", drive: "Drive", world: "World") -> FloatArray:
    """Returns the metres to failing at every step, shape ``(n,)``; negative exactly where the oracle says
    outside."""
    box = lateral_extent(road, drive)
    half = world.lane_width / 2
    in_lane = half + allowed_overhang(world.oob_tolerance, box) - np.abs(box.middle + half)
    ground = world.lane_width + world.verge - np.abs(box.middle) - box.long - box.short
    if world.lane_departure:
        from roadgpt.drive.marking_monitor import MarkingMonitor

        in_lane = np.minimum(in_lane, -MarkingMonitor.for_tyres(road, world, drive.car).along(drive))
    outside = is_outside(road, drive, world)
    inside = np.maximum(np.minimum(in_lane, ground), 0.0)
    # The oracle's polygon and the formula differ by millimetres; the oracle decides on which side of 0 it is.
    return np.asarray(np.where(outside, np.minimum(in_lane, -EPSILON), inside), float)
