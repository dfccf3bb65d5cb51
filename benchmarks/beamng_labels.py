"""How well beamng_like in our simulator tells which recorded roads BeamNG's AI failed.

    python benchmarks/beamng_labels.py LABELS.csv.gz [--every 3] [--cut 4.0]

LABELS has a row per road: run, k0..k16 (curvature every 10 m, 1/m), failed, max_oob, as recorded by the SBFT
tool competition's executor at 70 km/h and aggression 0.7. Every second run, by name, is the half that the
cut was chosen on; the other half is the test.
"""

import argparse
import csv
import gzip
import itertools
import math

import numpy as np
from scipy.stats import rankdata, spearmanr

from roadgpt.drive import simulate
from roadgpt.drive.drivers.beamng_like import BeamngLike
from roadgpt.road import Road, World

STEP = 10.0  # m between curvatures
HEADING = 1.57  # rad, of every recorded road's start
TOLERANCE = 0.85  # of the recordings


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


def main(labels: str, every: int, cut: float) -> None:
    with gzip.open(labels, "rt", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    fitted = set(sorted({row["run"] for row in rows})[::2])
    world = World(map_size=1000, oob_tolerance=TOLERANCE)
    for half in ("chosen on", "test"):
        some = [row for row in rows if (row["run"] in fitted) == (half == "chosen on")][::every]
        score = np.array(
            [
                simulate(
                    road_of([float(row[f"k{i}"]) for i in range(17)]),
                    world,
                    BeamngLike(cut=cut),
                    keep_driving=True,
                ).max_outside
                for row in some
            ]
        )
        failed = np.array([row["failed"] == "1" for row in some])
        recorded = np.array([float(row["max_oob"]) for row in some])
        ours = score > TOLERANCE
        print(
            f"{half}: {len(some)} roads, fails {ours.mean():.3f} (recorded {failed.mean():.3f}), "
            f"AUC {auc(score, failed):.3f}, Spearman {spearmanr(score, recorded)[0]:.3f}, "
            f"precision {failed[ours].mean():.2f}, recall {ours[failed].mean():.2f}",
            flush=True,
        )


if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("labels")
    parser.add_argument("--every", type=int, default=1)
    parser.add_argument("--cut", type=float, default=4.0)
    asked = parser.parse_args()
    main(asked.labels, asked.every, asked.cut)
