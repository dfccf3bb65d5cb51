"""Computes the observation ``state``: numbers that describe the car in its lane and the road ahead of it."""

import numpy as np
from numpy.typing import NDArray

from roadgpt.geometry import wrap_angle
from roadgpt.road import Road, World

Floats = NDArray[np.float32]

AHEAD = (2.0, 5.0, 10.0, 15.0, 20.0, 30.0, 40.0, 60.0)  # m ahead of the car
LABELS = (
    "speed", "speed_limit", "offset", "heading_error", "yaw_rate", "steer", "vy", "friction",
    *(f"curvature_{metres:g}" for metres in AHEAD),
    *(f"grade_{metres:g}" for metres in AHEAD),
)  # fmt: skip
"""Names of the 24 numbers of the observation, in their order."""
SCALES = np.array(
    [20.0, 20.0, 2.0, 0.5, 0.5, 0.5, 2.0, 1.0, *[0.05] * len(AHEAD), *[0.15] * len(AHEAD)], np.float32
)
"""Typical sizes by which the numbers are divided, in the order of LABELS: m/s, m/s, m, rad, rad/s, rad, m/s,
1, then 1/m for curvatures and ratios for grades."""
MOST = 20.0  # limit of each number after the division


class Preview:
    """Table of a road's curvature, grade and heading, and of the middle of its lane, for quick lookup."""

    def __init__(self, road: Road, world: World, step: float = 0.5) -> None:
        """Samples the road every ``step`` metres; beyond its end the road continues straight and level."""
        s = np.arange(0.0, road.length + max(AHEAD) + step, step)
        on = s <= road.length
        held = np.minimum(s, road.length)
        self._step = step
        self._bends = np.where(on, road.curvature(held), 0.0)
        self._grades = np.where(on, road.grade(held), 0.0)
        self._headings = road.heading(held)
        self._middles = world.profile_of(road).middle(held)
        self._ahead = np.round(np.array(AHEAD) / step).astype(int)

    def numbers(self, row: dict[str, float], world: World) -> Floats:
        """Returns the observation ``(24,)`` for one step of a drive; ``row`` maps the names of a Drive's
        columns to their values in this step."""
        last = len(self._bends) - 1
        here = min(max(round(row["s"] / self._step), 0), last)
        ahead = np.minimum(here + self._ahead, last)
        car = (
            row["speed"],
            world.limits.speed_limit,
            row["t"] - self._middles[here],
            float(wrap_angle(row["heading"] - self._headings[here])),
            row["yaw_rate"],
            row["steer"],
            row["vy"],
            world.site.friction,
        )
        every = np.concatenate([car, self._bends[ahead], self._grades[ahead]])
        return np.clip(every / SCALES, -MOST, MOST).astype(np.float32)
