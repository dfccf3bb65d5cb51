"""From a Drive to a Verdict."""

from typing import TYPE_CHECKING

import numpy as np

from roadgpt.errors import UsageError
from roadgpt.verdict.margin import NOTHING, margins
from roadgpt.verdict.oracle import consult, is_outside
from roadgpt.verdict.verdict import Cause, Side, Verdict

if TYPE_CHECKING:
    from roadgpt.drive import Drive
    from roadgpt.road import Road, World

CAUSES: dict[str, Cause] = {
    "out_of_lane": "out of lane",
    "fell": "fell",
    "stuck": "stuck",
    "timeout": "timeout",
}

# The competition's own words; it adds the name of the simulation. A car that falls has left the lane, for it.
SBFT: dict[Cause | None, str] = {
    None: "Successful test",
    "out of lane": "Car drove out of the lane",
    "fell": "Car drove out of the lane",
    "stuck": "Car is not moving fast enough",
    "timeout": "Timeout Simulation",
}


def judge(road: "Road", drive: "Drive", world: "World") -> Verdict:
    """Whether the car kept its lane, by how many metres, and where it first did not.

    What comes first decides: a car that left its lane and later came to the goal, fell or got stuck (it was
    told to keep driving) failed out of its lane. At one and the same step the competition asks for the goal
    first, then for motion, then for the lane: that step counts neither for the margin nor for ``max_oob``.

    Raises:
        UsageError: the drive was ended at another, smaller tolerance than ``world.oob_tolerance``.
    """
    step, cause = _first_failure(drive, world)
    every = margins(road, drive, world)
    least = float(every[: drive.lane_steps].min())
    left = _left(drive, step, world)
    side: Side | None = ("left" if left else "right") if cause in ("out of lane", "fell") else None
    if cause == "fell":
        least = min(least, -NOTHING)
    return Verdict(
        outcome="FAIL" if cause else "PASS",
        cause=cause,
        description=_sentence(road, drive, step, cause, side, least),
        sbft_description=SBFT[cause],
        max_oob=drive.max_outside,
        margin=least,
        oob_counter=int(consult(drive, world).oob_counter[-1]),
        at_s=float(drive["s"][step]) if cause else None,
        at_xy=(float(drive["x"][step]), float(drive["y"][step])) if cause else None,
        at_time=float(drive["time"][step]) if cause else None,
        side=side,
    )


def _first_failure(drive: "Drive", world: "World") -> tuple[int, Cause | None]:
    """The step at which the drive failed and why; the last step and None when it did not."""
    last = len(drive) - 1
    out = is_outside(drive, world)
    if out.any():
        return int(np.argmax(out)), "out of lane"
    if drive.ended == "out_of_lane":
        raise UsageError(
            f"the drive was ended with {drive['outside'][last]:.3f} of the car outside its lane, which "
            f"a tolerance of {world.oob_tolerance:g} allows: drive the road again with this tolerance"
        )
    return last, CAUSES.get(drive.ended)


def _left(drive: "Drive", step: int, world: "World") -> bool:
    return bool(drive["t"][step] > -world.lane_width / 2)


def _sentence(
    road: "Road", drive: "Drive", step: int, cause: Cause | None, side: Side | None, margin: float
) -> str:
    reached = f"after {drive['s'][step]:.0f} m"
    fast = f"at {drive['speed'][step] * 3.6:.0f} km/h"
    if cause == "out of lane":
        return f"left its lane to the {side} {reached} {fast}"
    if cause == "fell":
        return f"fell off the road to the {side} {reached} {fast}"
    if cause == "stuck":
        return f"was stuck {reached}: it moved less than 1 m in 10 s"
    if cause == "timeout":
        return f"ran out of time {reached} of {road.length:.0f} m"
    return f"kept its lane to the goal {reached}, never closer than {margin:.2f} m to failing"
