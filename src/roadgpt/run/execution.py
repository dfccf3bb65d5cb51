"""Converts a Run to the SBFT competition's ``test.NNNN.json``: execution data, and features.

``execution_data`` is one list of 17 fields per sample:

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

The features are two of the road and three of the drive:

    MAX_CURV   1/m: largest curvature of circles through points i, i+2, i+4; the last triple is left out
    DIR_COV    share of 25 bins, from 0 to 360 degrees, that contain a direction of the road (angle to north)
    STD_SA     degrees: standard deviation of the steering wheel's angle
    MEAN_LP, MAX_LP    m: mean and largest distance from the edge of the lane (``oob_distance``)

Source: the competition's test_analysis.py (2024), after DeepHyperion (ISSTA 2021). Its peculiarities are
kept: DIR_COV divides by the 26 edges of the bins, and computes angles by arccos, so that angles never exceed
180 degrees and a full circle scores 0.5.

The test file differs from the competition's own in three points. A field that the competition omits, such as
the execution data of an invalid road, is present and empty. Interpolated points are [x, y, z] instead of
[x, y]. Where the map is not the usual one, ``world`` states its size. The description of a drive uses the
competition's wording; ``verdict.json`` has RoadGPT's.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roadgpt.brief.words import USUAL_MAP
from roadgpt.drive import Drive
from roadgpt.geometry import radii
from roadgpt.road import Road, World
from roadgpt.run.atomic import json_text
from roadgpt.run.model import Run
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
    return list(column.tolist())


BINS = 25
FEWEST_RECORDS = 3  # with fewer, a drive has no features


def features_of(points: ArrayLike, records: Sequence[ExecutionRecord] = ()) -> dict[str, float]:
    """Returns the features of a test, by name, from interpolated points of the road, about one per metre, and
    the execution data; with fewer than three records, those of the drive are left out."""
    plan = np.asarray(points, float)[:, :2]
    curvature = float((1 / radii(plan)).max(initial=0.0))  # 0 for a straight road or fewer than six points
    step = np.diff(plan, axis=0)
    length = np.sqrt((step**2).sum(axis=1))
    moves = length > 0
    angle = np.degrees(np.arccos(np.clip(step[moves, 1] / length[moves], -1, 1)))
    edges = np.linspace(0.0, 360.0, BINS + 1)
    coverage = len(np.unique(np.digitize(angle, edges))) / len(edges)
    found = {"MAX_CURV": round(curvature, 6), "DIR_COV": round(coverage, 6)}
    steering = [record.steering for record in records]
    return found | features_of_drive(steering, [record.oob_distance for record in records])


def features_of_drive(steering: Sequence[float], distances: Sequence[float]) -> dict[str, float]:
    """Returns the features of a drive by name, from the steering wheel's angle in degrees and
    ``oob_distance`` in metres."""
    if len(steering) < FEWEST_RECORDS:
        return {}
    found = {"STD_SA": np.std(steering), "MEAN_LP": np.mean(distances), "MAX_LP": np.max(distances)}
    return {name: round(float(value), 6) for name, value in found.items()}


DECIMALS = 5
PER_POINT = 1.0  # m


def test_of(run: Run) -> dict[str, Any]:
    """Returns the content of a Run's test file as a dictionary with the competition's order of fields."""
    points, control, records = np.empty((0, 3)), np.empty((0, 2)), list[ExecutionRecord]()
    if run.road is not None:
        points = np.round(run.road.centreline(PER_POINT), DECIMALS) + 0.0
        control = np.round(run.road.control_points(), DECIMALS) + 0.0
        records = [] if run.drive is None else records_of(run.road, run.drive, run.world)
    size = run.world.site.map_size
    return {
        "is_valid": run.is_valid,
        "validation_message": run.validation_message,
        "road_points": control.tolist(),
        "interpolated_points": points.tolist(),
        "id": run.index,
        "execution_data": records,
        "test_outcome": None if run.outcome == "VALID" else run.outcome,
        "description": run.verdict.sbft_description if run.verdict else run.description,
        "features": features_of(points, records) if run.is_valid else {},
    } | ({} if size == USUAL_MAP else {"world": {"map_size": size}})


def test_name(index: int) -> str:
    """Returns the name of the test file of road ``index``."""
    return f"test.{index:04d}.json"


def test_text(run: Run) -> str:
    """Returns the content of the Run's test file."""
    return json_text(test_of(run), indent=None)
