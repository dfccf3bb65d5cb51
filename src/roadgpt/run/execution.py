"""Converts a Drive to the SBFT competition's ``execution_data``: one list of 17 fields per sample.

    timer            s
    pos, dir, vel    [x, y, z]: centre of gravity, m; unit vector ahead; m/s
    steering         degrees at the steering wheel, left positive
    steering_input   -1 to 1: share of full lock
    brake, brake_input, throttle, throttle_input     0 to 1
    wheelspeed       m/s
    vel_kmh          whole km/h
    is_oob           more than the tolerated share of the car's box is outside its lane, or, if
                     ``lane_departure`` is set, a front tyre is beyond a marking
    oob_counter      how often the car has left its lane so far
    max_oob_percentage    0 to 1: largest share of the car's box outside its lane since the car last left it
    oob_distance     m: half the lane's width minus the car's distance from the middle of the lane;
                     negative outside
    oob_percentage   0 to 1: share of the car's box outside its lane

Source: the competition's simulation record (2024). The competition's simulator reports the angle of the
steering wheel; RoadGPT converts the angle of the front wheels with a typical saloon's steering ratio.
``verdict.consult`` computes the last five fields.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roadgpt.drive import Drive
from roadgpt.road import Road, World
from roadgpt.verdict import consult

RATE = 10.0  # Hz, of the records; the Drive itself has 50
STEERING_RATIO = 15.0  # steering wheel to front wheels


class ExecutionRecord(NamedTuple):
    """One sample of a drive; the fields are in the competition's order."""

    timer: float
    pos: list[float]
    dir: list[float]
    vel: list[float]
    steering: float
    steering_input: float
    brake: float
    brake_input: float
    throttle: float
    throttle_input: float
    wheelspeed: float
    vel_kmh: int
    is_oob: bool
    oob_counter: int
    max_oob_percentage: float
    oob_distance: float
    oob_percentage: float


FIELDS = ExecutionRecord._fields


def records_of(road: Road, drive: Drive, world: World) -> list[ExecutionRecord]:
    """Returns records of the Drive at 10 Hz, and also of its last step and of every step at which the car
    leaves its lane."""
    oracle = consult(road, drive, world)
    keep = _steps(drive["time"], np.diff(oracle.oob_counter, prepend=0) > 0)
    ahead, velocity = _directions(drive)
    place = np.stack([drive["x"], drive["y"], drive["z"]], axis=-1)
    wheel = np.degrees(drive["steer"])
    columns = {
        "timer": drive["time"],
        "pos": place,
        "dir": ahead,
        "vel": velocity,
        "steering": wheel * STEERING_RATIO,
        "steering_input": np.clip(drive["steer"] / drive.car.lock, -1, 1),
        "brake": drive["brake"],
        "brake_input": drive["brake"],
        "throttle": drive["throttle"],
        "throttle_input": drive["throttle"],
        "wheelspeed": np.abs(drive["vx"]),
        "vel_kmh": np.round(drive["speed"] * 3.6).astype(int),
        **oracle._asdict(),
    }
    rows = zip(*(_plain(columns[name][keep]) for name in FIELDS), strict=True)
    return [ExecutionRecord(*row) for row in rows]


def _steps(time: NDArray[np.float64], leaves: NDArray[np.bool_]) -> NDArray[np.intp]:
    """Returns the indices of the steps that are recorded."""
    period = np.floor(time * RATE + 1e-6)
    is_first = np.r_[True, np.diff(period) > 0]
    is_first[-1] = True
    return np.flatnonzero(is_first | leaves)


def _directions(drive: Drive) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Returns the unit vectors in which the car points and its velocities in m/s: both ``(n, 3)``."""
    heading, pitch, roll = drive["heading"], drive["pitch"], drive["roll"]
    ahead = np.stack([np.cos(heading) * np.cos(pitch), np.sin(heading) * np.cos(pitch), np.sin(pitch)])
    level = np.stack([-np.sin(heading), np.cos(heading), np.zeros_like(heading)])  # left, before it rolls
    upright = np.cross(ahead, level, axis=0)
    left = np.cos(roll) * level + np.sin(roll) * upright
    up = np.cos(roll) * upright - np.sin(roll) * level
    velocity = drive["vx"] * ahead + drive["vy"] * left + drive["vz"] * up
    return ahead.T, velocity.T


def _plain(column: NDArray[np.generic]) -> list[object]:
    if column.dtype.kind == "f":
        column = np.round(column.astype(float), 4) + 0.0  # no negative zeros
    listed: list[object] = column.tolist()
    return listed
