"""Checks that a drive is physically possible: the car must move at the speed it reports, without jumps.

Between two samples, a car can travel only a limited distance:

    distance <= speed * dt + 1/2 HARDEST dt^2 + SLACK

Here ``speed`` is the larger of the speeds at the two samples, but at most FASTEST.
"""

import numpy as np

from roadgpt.drive.drive import Drive
from roadgpt.errors import SimulationError

HARDEST = 300.0  # m/s^2: 30 g, more than a car survives in one piece
SLACK = 0.5  # m, tolerance for samples that were taken slightly before or after their time stamps
FASTEST = 200.0  # m/s; the fastest production cars reach 135, a car that falls 100 m reaches 44
STANDING = 20.0  # m; if the speeds amount to a longer distance than this ...
SHARE = 1 / 3  # ... the car must have moved at least this share of that distance

FAILED = ", so the simulation failed, which says nothing about the driver; drive the road again"


def check_motion(drive: Drive) -> None:
    """Checks that the recorded positions and speeds of a drive are possible for a car.

    Raises:
        SimulationError: a position or a speed is not a finite number, the car jumped, or its motion does not
            match its speed.
    """
    place = np.stack([drive[name] for name in ("x", "y", "z")], axis=-1)
    time, speed = drive["time"], np.abs(drive["speed"])
    if not (np.isfinite(place).all() and np.isfinite(time).all() and np.isfinite(speed).all()):
        raise SimulationError(
            f"{drive.simulator} reported a position, a time or a speed that is not a finite number{FAILED}"
        )
    way = np.linalg.norm(np.diff(place, axis=0), axis=1)
    dt = np.maximum(np.diff(time), 0.0)
    fast = np.minimum(np.maximum(speed[1:], speed[:-1]), FASTEST)
    over = way - (fast * dt + HARDEST * dt**2 / 2 + SLACK)
    if len(over) and over.max() > 0:
        step = int(np.argmax(over > 0))
        raise SimulationError(
            f"{drive.simulator} moved the car by {way[step]:.1f} m within {np.diff(time)[step]:.2f} s, "
            f"{drive['s'][step]:.0f} m along the road and at {speed[step] * 3.6:.0f} km/h: no car can do that"
            f"{FAILED}"
        )
    told = float((np.minimum(speed[1:], speed[:-1]) * dt).sum())
    if told > STANDING and way.sum() < SHARE * told:
        raise SimulationError(
            f"{drive.simulator} reported speeds that amount to {told:.0f} m, but positions that amount to "
            f"{way.sum():.0f} m{FAILED}"
        )
