"""Roads that BeamNG's AI was recorded on, as the benchmarks read them.

A file of labels has a row per road: run, k0..k16 (curvature every 10 m, 1/m), failed, max_oob, as recorded by
the SBFT tool competition's executor at 70 km/h and aggression 0.7. Every second run, by name, is the half
that anything is fitted to; the other half is the test.
"""

import csv
import gzip
import itertools
import math
from typing import NamedTuple

import numpy as np
from scipy.stats import rankdata

from roadgpt.road import Road

STEP = 10.0  # m between curvatures
HEADING = 1.57  # rad, of every recorded road's start
TOLERANCE = 0.85  # of the recordings
CURVATURES = 17


class BeamngLabels(NamedTuple):
    """Arrays over roads."""

    curvature: np.ndarray
    """Shape (n, 17), 1/m."""
    failed: np.ndarray
    max_oob: np.ndarray
    """Largest share outside that was recorded, 0..1."""

    def every(self, step: int) -> "BeamngLabels":
        return BeamngLabels(*(column[::step] for column in self))


def halves(path: str) -> tuple[BeamngLabels, BeamngLabels]:
    """(fitted to, test)"""
    with gzip.open(path, "rt", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    fitted = set(sorted({row["run"] for row in rows})[::2])
    of = np.array([row["run"] in fitted for row in rows])
    labels = BeamngLabels(
        np.array([[float(row[f"k{i}"]) for i in range(CURVATURES)] for row in rows]),
        np.array([row["failed"] == "1" for row in rows]),
        np.array([float(row["max_oob"]) for row in rows]),
    )
    first, second = (BeamngLabels(*(column[which] for column in labels)) for which in (of, ~of))
    return first, second


def road_of(curvatures: list[float]) -> Road:
    """The control points as the recorded generator made them: the trapezoid rule, twice."""
    x = y = 0.0
    heading, points = HEADING, [(0.0, 0.0)]
    for k0, k1 in itertools.pairwise(curvatures):
        turned = heading + (k0 + k1) * STEP / 2
        x += (math.cos(heading) + math.cos(turned)) * STEP / 2
        y += (math.sin(heading) + math.sin(turned)) * STEP / 2
        heading = turned
        points.append((x, y))
    return Road.through(points)


def auc(score: np.ndarray, failed: np.ndarray) -> float:
    positive = failed.sum()
    ranks = rankdata(score)[failed].sum()
    return float((ranks - positive * (positive + 1) / 2) / (positive * (len(failed) - positive)))
