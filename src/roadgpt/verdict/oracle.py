"""Computes the competition's out-of-bounds record at every control step, as in the execution data of a test.

Source: SBFT tool competition, self_driving/oob_monitor.py, with the right lane as its lane. If the World
demands lane departures, the car is also out of bounds at these.
"""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from roadgpt.drive import Drive
    from roadgpt.road import Road, World

ROUNDING = 1e-3  # m, error of the poses in a stored drive, which are rounded


class Oracle(NamedTuple):
    """The record, as arrays over the steps of a drive, shapes ``(n,)``."""

    is_oob: NDArray[np.bool_]
    """Whether the share outside exceeds the tolerance, or a lane departure counts. Always False at the step
    of the goal or of being stuck, at which the competition does not check the lane any more."""
    oob_counter: NDArray[np.int64]
    """How many times the car has gone outside so far."""
    max_oob_percentage: NDArray[np.float64]
    """Largest share outside since the car last went outside, 0..1; 0 before the first time. As in the
    competition's own code, the maximum of earlier times is forgotten."""
    oob_distance: NDArray[np.float64]
    """Metres: half a lane width minus the distance of the car's centre from the middle of the right lane."""
    oob_percentage: NDArray[np.float64]
    """Share of the car's box outside the right lane, 0..1."""


def consult(road: "Road", drive: "Drive", world: "World") -> Oracle:
    """Returns the record of a whole drive."""
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
    half = world.lane_width / 2
    distance = half - np.abs(drive["t"] + half)
    return Oracle(out, counter.astype(np.int64), largest, distance, share)


def is_outside(road: "Road", drive: "Drive", world: "World") -> NDArray[np.bool_]:
    """Returns for each step whether the car is out of its lane, by the competition's oracle or by a lane
    departure that counts."""
    out: NDArray[np.bool_] = drive["outside"] > world.oob_tolerance
    out |= has_departed(road, drive, world)
    out[drive.lane_steps :] = False
    return out


def has_departed(road: "Road", drive: "Drive", world: "World") -> NDArray[np.bool_]:
    """Returns for each step whether the outer edge of a front tyre is beyond that of a marking; False
    everywhere if the World does not demand lane departures."""
    if not world.lane_departure:
        return np.zeros(len(drive), bool)
    from roadgpt.drive.marking_monitor import MarkingMonitor

    beyond = MarkingMonitor.for_tyres(road, world, drive.car).along(drive)
    gone: NDArray[np.bool_] = beyond > 0
    # A drive that ended with a departure has departed at its last step, in spite of rounding.
    gone[-1] |= drive.ended == "out_of_lane" and beyond[-1] > -ROUNDING
    return gone
