r"""Computes the SBFT competition's out-of-bounds values, and the margin, at every control step of a drive.

Source: SBFT tool competition, self_driving/oob_monitor.py, applied to the driven lane. If
``World.limits.lane_departure`` is set, the car is also out of bounds while a front tyre is beyond a lane
marking.

    margin = how far the car could be shifted sideways, with its heading unchanged, before it fails

The car fails if the share of its bounding box outside its lane exceeds the tolerance. While the car is in its
lane, the margin is at most the distance from the box to the outer edge of the carriageway and its shoulder.
Across the lane, the area of a rotated box is distributed as the trapezoid below, so the position at which the
share equals the tolerance is computed exactly; the lane's curvature under the box counts to second order.

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
from roadgpt.geometry.curve import LEAST_STRETCH, Array

if TYPE_CHECKING:
    from roadgpt.drive import Drive
    from roadgpt.road import Road, World

ROUNDING = 1e-3  # m, error of the poses in a stored drive, which are rounded
THINNEST = 1e-9  # m, lower bound of a half-width, for a box seen exactly end-on
BoolArray = NDArray[np.bool_]
EPSILON = 1e-9  # m; a negative margin is at least this far below 0


class Oracle(NamedTuple):
    """How far the car was out of its lane during a drive: arrays of shape ``(n,)``, one value per step."""

    is_oob: BoolArray
    """Whether the car is out of its lane, as ``is_outside`` defines it; not where that does not count, such
    as at the step at which it reaches the goal or is stuck (``Drive.counts``)."""
    oob_counter: NDArray[np.int64]
    """Number of times the car has gone out of its lane so far."""
    max_oob_percentage: Array
    """Largest share of the car outside its lane, 0 to 1, since it last went out of it, as in the
    competition's code; 0 until it first does."""
    oob_distance: Array
    """Half the width of the lane minus the distance of the car's centre from the lane's middle, in metres."""
    oob_percentage: Array
    """Share of the car's bounding box outside its lane, 0 to 1."""


def consult(road: "Road", drive: "Drive", world: "World") -> Oracle:
    """Returns the out-of-bounds values of all steps of a drive."""
    share, road = drive["outside"], drive.followed(road, world)
    out = is_outside(road, drive, world)
    went = out & ~np.concatenate([[False], out[:-1]])
    counter = np.cumsum(went)
    largest = np.zeros(len(share))
    best = 0.0
    for i in range(len(share)):
        if out[i]:
            best = share[i] if went[i] else max(best, share[i])
        largest[i] = best
    s, profile = drive["s"], world.profile_of(road)
    distance = profile.width(s) / 2 - np.abs(drive["t"] - profile.middle(s))
    return Oracle(out, counter.astype(np.int64), largest, distance, share)


def is_outside(road: "Road", drive: "Drive", world: "World") -> BoolArray:
    """Returns for each step whether the share of the car's bounding box outside its lane exceeds the
    tolerance, or a front tyre is beyond a lane marking, if ``World.limits.lane_departure`` is set."""
    out: BoolArray = drive["outside"] > world.limits.oob_tolerance
    out |= has_departed(road, drive, world)
    return out & drive.counts


def has_departed(road: "Road", drive: "Drive", world: "World") -> BoolArray:
    """Returns for each step whether the outer edge of a front tyre is beyond the outer edge of a marking;
    never if ``world.limits.lane_departure`` is not set."""
    if not world.limits.lane_departure:
        return np.zeros(len(drive), bool)
    from roadgpt.drive.lane_position import MarkingMonitor

    beyond = MarkingMonitor.for_tyres(drive.followed(road, world), world, drive.car).along(drive)
    gone: BoolArray = beyond > 0
    # A drive that ended with a departure has departed at its last step, in spite of rounding.
    gone[-1] |= drive.ended == "out_of_lane" and beyond[-1] > -ROUNDING
    return gone


class LateralExtent(NamedTuple):
    """The extent of the car's bounding box across the lane at each of the n steps of a drive."""

    middle: Array
    """Offset of the box's middle in metres to the left of the centre line, corrected for the curvature of the
    lane under the box; shape ``(n,)``."""
    long: Array
    """Half of the larger of the projections of its length and its width across the lane, in metres."""
    short: Array
    """Half of the smaller one."""


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


def allowed_overhang(tolerance: float, box: LateralExtent) -> Array:
    """Returns how far beyond the lane's edge, in metres outwards, the middle of the box is when the share of
    the box outside the lane equals ``tolerance`` (0 to 1), and the car fails."""
    tail = min(tolerance, 1 - tolerance)
    a, b = box.long, box.short
    in_slope = a + b - np.sqrt(8 * a * b * tail)
    in_plateau = (1 - 2 * tail) * a
    far = np.where(tail <= b / (2 * a), in_slope, in_plateau)
    return np.asarray(far if tolerance >= 0.5 else -far, float)


def margins(road: "Road", drive: "Drive", world: "World") -> Array:
    """Returns the margin in metres at every step of a drive, shape ``(n,)``: negative exactly where the car
    is out of its lane, and 0 where it is not, but its box extends beyond the carriageway and its shoulder."""
    box, road = lateral_extent(road, drive), drive.followed(road, world)
    s, profile = drive["s"], world.profile_of(road)
    half, middle, rims = profile.width(s) / 2, profile.middle(s), profile.rims(s)
    in_lane = half + allowed_overhang(world.limits.oob_tolerance, box) - np.abs(box.middle - middle)
    ground = np.minimum(rims.left - box.middle, box.middle - rims.right) - box.long - box.short
    if world.limits.lane_departure:
        from roadgpt.drive.lane_position import MarkingMonitor

        in_lane = np.minimum(in_lane, -MarkingMonitor.for_tyres(road, world, drive.car).along(drive))
    outside = is_outside(road, drive, world)
    inside = np.maximum(np.minimum(in_lane, ground), 0.0)
    # The oracle's polygon and the formula differ by millimetres; the oracle decides on which side of 0 it is.
    return np.asarray(np.where(outside, np.minimum(in_lane, -EPSILON), inside), float)
