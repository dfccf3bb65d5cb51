"""The competition's out-of-bounds record at every control step, as it stands in the execution data of a test.

Source: SBFT tool competition, self_driving/oob_monitor.py, with the right lane as its lane.
"""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from roadgpt.drive import Drive
    from roadgpt.road import World


class Oracle(NamedTuple):
    """Arrays over the steps of a drive, shapes ``(n,)``."""

    is_oob: NDArray[np.bool_]
    """The share outside is above the tolerance; never at the step of the goal or of being stuck, where the
    competition does not ask for the lane any more."""
    oob_counter: NDArray[np.int64]
    """How many times, up to now, the car went outside."""
    max_oob_percentage: NDArray[np.float64]
    """Largest share while outside, since it last went outside, 0..1; 0 before the first time.
    That is the competition's: its own code forgets the earlier maximum."""
    oob_distance: NDArray[np.float64]
    """Half a lane minus the distance of the car's centre from the middle of the right lane, metres."""
    oob_percentage: NDArray[np.float64]
    """Share of the car's box outside the right lane, 0..1."""


def consult(drive: "Drive", world: "World") -> Oracle:
    """The record of a whole drive."""
    share = drive["outside"]
    out = is_outside(drive, world)
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


def is_outside(drive: "Drive", world: "World") -> NDArray[np.bool_]:
    """Where the car is out of its lane for the competition, per step."""
    out: NDArray[np.bool_] = drive["outside"] > world.oob_tolerance
    out[drive.lane_steps :] = False
    return out
