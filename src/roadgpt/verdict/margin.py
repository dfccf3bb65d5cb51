r"""How many metres the car was from failing, at every step of a drive.

    margin = how much farther to its side the car, standing as it does, could be moved before it fails

It fails when more than the tolerance of its box is outside the right lane, or when its box reaches over the
end of firm ground (carriageway and verge; on a mesh road without verge that end comes first, to the right).
The share of a turned box beyond a straight line is the tail of a trapezoid, so the place where the share is
the tolerance is known exactly; the bend of the lane under the box is counted to second order. Where lane
departures count, it fails as soon as a front tyre's outer edge passes that of a marking.

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
THINNEST = 1e-9  # m, half-width of a box seen exactly end-on
NOTHING = 1e-9  # m, the least by which a car that failed is said to have failed
LEAST_STRETCH = 0.2  # of a metre that a metre of road leaves on the inside of a bend


class Stand(NamedTuple):
    """How the car's box lies across the lane, per step; shapes ``(n,)``."""

    middle: FloatArray
    """m to the left of the centre line, of the box's middle, the lane's bend under it counted."""
    long: FloatArray
    """m, half of what the longer pair of the box's sides takes up across the lane."""
    short: FloatArray
    """m, likewise of the shorter pair."""


def stand(road: "Road", drive: "Drive") -> Stand:
    """Where the car's box lies across its lane."""
    s, t, box = drive["s"], drive["t"], drive.car
    psi = wrap_angle(drive["heading"] - road.heading(s))
    bend = road.curvature(s)
    bend = bend / np.maximum(1 - bend * t, LEAST_STRETCH)
    sin, cos = np.sin(psi), np.cos(psi)
    # Mean of -k u^2 / 2 over the box, u the way along the lane from the centre of gravity.
    spread = (box.ahead * cos) ** 2 + ((box.length * cos) ** 2 + (box.width * sin) ** 2) / 12
    middle = t + box.ahead * sin - bend * spread / 2
    a, b = np.abs(box.length * sin) / 2, np.abs(box.width * cos) / 2
    return Stand(middle, np.maximum(a, b), np.maximum(np.minimum(a, b), THINNEST))


def reach(tolerance: float, box: Stand) -> FloatArray:
    """Metres that the box's middle may be beyond the lane's edge before the share outside is the
    tolerance."""
    tail = min(tolerance, 1 - tolerance)
    a, b = box.long, box.short
    in_slope = a + b - np.sqrt(8 * a * b * tail)
    in_plateau = (1 - 2 * tail) * a
    far = np.where(tail <= b / (2 * a), in_slope, in_plateau)
    return np.asarray(far if tolerance >= 0.5 else -far, float)


def margins(road: "Road", drive: "Drive", world: "World") -> FloatArray:
    """Metres to failing at every step, shape ``(n,)``; negative exactly where the oracle says outside."""
    box = stand(road, drive)
    half = world.lane_width / 2
    in_lane = half + reach(world.oob_tolerance, box) - np.abs(box.middle + half)
    ground = world.lane_width + world.verge - np.abs(box.middle) - box.long - box.short
    if world.lane_departure:
        from roadgpt.drive.marking import Marking

        in_lane = np.minimum(in_lane, -Marking.for_tyres(road, world, drive.car).along(drive))
    outside = is_outside(road, drive, world)
    inside = np.maximum(np.minimum(in_lane, ground), 0.0)
    # The oracle's polygon and the formula differ by millimetres; the oracle decides on which side of 0 it is.
    return np.asarray(np.where(outside, np.minimum(in_lane, -NOTHING), inside), float)
