"""Computes the five features of a test in the SBFT competition: two of the road and three of the drive.

    MAX_CURV   1/m: largest curvature of circles through points i, i+2, i+4; the last triple is left out
    DIR_COV    share of 25 bins, from 0 to 360 degrees, that contain a direction of the road (angle to north)
    STD_SA     degrees: standard deviation of the steering wheel's angle
    MEAN_LP, MAX_LP    m: mean and largest distance from the edge of the lane (``oob_distance``)

Source: the competition's test_analysis.py (2024), after DeepHyperion (ISSTA 2021). Its peculiarities are
kept: DIR_COV divides by the 26 edges of the bins, and computes angles by arccos, so that angles never exceed
180 degrees and a full circle scores 0.5.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from roadgpt.check.sbft import radii
from roadgpt.run.execution import ExecutionRecord

BINS = 25
FEWEST_RECORDS = 3  # with fewer, a drive has no features


def features_of(points: ArrayLike, records: Sequence[ExecutionRecord] = ()) -> dict[str, float]:
    """Returns the features of a test, by name.

    Args:
        points: interpolated points of the road ``(n, 2)`` or ``(n, 3)``, about one per metre.
        records: the execution data of the drive on this road; with fewer than three records, the features of
            the drive are left out.
    """
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
    """Returns the features of a drive by name, from the angle of the steering wheel in degrees and
    ``oob_distance`` in metres at each record; none for fewer than three records.
    """
    if len(steering) < FEWEST_RECORDS:
        return {}
    found = {
        "STD_SA": float(np.std(steering)),
        "MEAN_LP": float(np.mean(distances)),
        "MAX_LP": float(np.max(distances)),
    }
    return {name: round(value, 6) for name, value in found.items()}
