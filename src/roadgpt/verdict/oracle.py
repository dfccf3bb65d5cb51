"""Computes the SBFT competition's out-of-bounds values at every control step of a drive.

Source: SBFT tool competition, self_driving/oob_monitor.py, applied to the driven lane. If
``World.limits.lane_departure`` is set, the car is also out of bounds while a front tyre is beyond a lane
marking.
"""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from roadgpt.drive import Drive
    from roadgpt.road import Road, World

ROUNDING = 1e-3  # m, error of the poses in a stored drive, which are rounded


class Oracle(NamedTuple):
    """How far the car was out of its lane during a drive: arrays of shape ``(n,)``, one value per step."""

    is_oob: NDArray[np.bool_]
    """Whether the car is out of its lane, as ``is_outside`` defines it.

    The value is False at the step at which the car reaches the goal or is stuck, because the competition
    does not check the lane at this step.
    """
    oob_counter: NDArray[np.int64]
    """Number of times the car has gone out of its lane so far."""
    max_oob_percentage: NDArray[np.float64]
    """Largest share of the car outside its lane, 0 to 1, since it last went out of its lane.

    It is 0 until the car first goes out of its lane, and restarts each time it goes out again, as in the
    competition's code.
    """
    oob_distance: NDArray[np.float64]
    """Half the width of the lane minus the distance of the car's centre from the lane's middle, in metres."""
    oob_percentage: NDArray[np.float64]
    """Share of the car's bounding box outside its lane, 0 to 1."""


def consult(road: "Road", drive: "Drive", world: "World") -> Oracle:
    """Returns the out-of-bounds values of all steps of a drive."""
    share = drive["outside"]
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


def is_outside(road: "Road", drive: "Drive", world: "World") -> NDArray[np.bool_]:
    """Returns for each step whether the car is out of its lane.

    The car is out of its lane if the share of its bounding box outside the lane exceeds the tolerance. If
    ``World.limits.lane_departure`` is set, it is also out of its lane while a front tyre is beyond a lane
    marking.
    """
    out: NDArray[np.bool_] = drive["outside"] > world.limits.oob_tolerance
    out |= has_departed(road, drive, world)
    out[drive.lane_steps :] = False
    return out


def has_departed(road: "Road", drive: "Drive", world: "World") -> NDArray[np.bool_]:
    """Returns for each step whether the outer edge of a front tyre is beyond the outer edge of a marking.

    The result is False at every step if ``world.limits.lane_departure`` is not set.
    """
    if not world.limits.lane_departure:
        return np.zeros(len(drive), bool)
    from roadgpt.drive.marking_monitor import MarkingMonitor

    beyond = MarkingMonitor.for_tyres(road, world, drive.car).along(drive)
    gone: NDArray[np.bool_] = beyond > 0
    # A drive that ended with a departure has departed at its last step, in spite of rounding.
    gone[-1] |= drive.ended == "out_of_lane" and beyond[-1] > -ROUNDING
    return gone
