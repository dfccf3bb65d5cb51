"""The competition's out-of-bounds record at every control step, as it stands in the execution data of a test.

Source: SBFT tool competition, self_driving/oob_monitor.py, with the right lane as its lane. Where the World
asks for lane departures, the car is out at these, too.
"""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from roadgpt.drive import Drive
    from roadgpt.road import Road, World

ROUNDING = 1e-3  # m, by which the poses of a drive that was kept in whole steps may be off


class Oracle(NamedTuple):
    """Arrays over the steps of a drive, shapes ``(n,)``."""

    is_oob: NDArray[np.bool_]
    """The share outside is above the tolerance, or a lane departure counts; never at the step of the goal or
    of being stuck, where the competition does not ask for the lane any more."""
    oob_counter: NDArray[np.int64]
    """How many times, up to now, the car went outside."""
    max_oob_percentage: NDArray[np.float64]
    """Largest share while outside, since it last went outside, 0..1; 0 before the first time.
    That is the competition's: its own code forgets the earlier maximum."""
    oob_distance: NDArray[np.float64]
    """Half a lane minus the distance of the car's centre from the middle of the right lane, metres."""
    oob_percentage: NDArray[np.float64]
    """Share of the car's box outside the right lane, 0..1."""


def consult(road: "Road", drive: "Drive", world: "World") -> Oracle:
    """The record of a whole drive."""
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
    """Where the car is out of its lane, per step: for the competition, or by a departure that counts."""
    out: NDArray[np.bool_] = drive["outside"] > world.oob_tolerance
    out |= has_departed(road, drive, world)
    out[drive.lane_steps :] = False
    return out


def has_departed(road: "Road", drive: "Drive", world: "World") -> NDArray[np.bool_]:
    """Where the outer edge of a front tyre is beyond that of a marking, per step; nowhere in a World that
    does not ask for it."""
    if not world.lane_departure:
        return np.zeros(len(drive), bool)
    from roadgpt.drive.marking import Marking

    beyond = Marking.for_tyres(road, world, drive.car).along(drive)
    gone: NDArray[np.bool_] = beyond > 0
    # A drive that was ended by its departure has departed at its last step, whatever was rounded since.
    gone[-1] |= drive.ended == "out_of_lane" and beyond[-1] > -ROUNDING
    return gone
