"""How well `roadgpt sdc` orders and selects tests that BeamNG's AI was recorded on.

    python benchmarks/sdc_labels.py LABELS.csv.gz [--every 1]

LABELS as for beamng_labels.py: recorded at 70 km/h, aggression 0.7 and a tolerance of 0.85, not at the SDC
competition's 120 km/h, risk 1.5 and 0.5. Every second run, by name, is told to the service; the others are
ordered. APFD: 1 when all failures come first, 0.5 in a random order.
"""

import argparse
import csv
import gzip

import numpy as np

from beamng_labels import auc, road_of
from roadgpt_sbft.sdc.risk import LINE_ONLY, RiskModel, fit_model, order, risk_features


def apfd(ranked: np.ndarray) -> float:
    """Of outcomes in the order in which tests are run."""
    places = np.flatnonzero(ranked) + 1
    count = len(ranked)
    return float(1 - places.sum() / (count * len(places)) + 1 / (2 * count))


def told(name: str, model: RiskModel, features: list, failed: np.ndarray) -> str:
    scores = model.scores(features)
    chosen = model.select(features)
    return (
        f"{name}: AUC {auc(scores, failed):.2f}, APFD {apfd(failed[order(scores)]):.2f}; "
        f"selects {len(chosen)} of {len(failed)}, {failed[chosen].mean():.0%} of them fail "
        f"(of all, {failed.mean():.0%})"
    )


def main(labels: str, every: int) -> None:
    with gzip.open(labels, "rt", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    known_runs = set(sorted({row["run"] for row in rows})[::2])
    halves = []
    for is_known in (True, False):
        some = [row for row in rows if (row["run"] in known_runs) == is_known][::every]
        points = [road_of([float(row[f"k{i}"]) for i in range(17)]).control_points().tolist() for row in some]
        failed = np.array([row["failed"] == "1" for row in some])
        halves.append((points, failed))
    (known, known_failed), (rest, failed) = (
        ([risk_features(points) for points in roads], outcomes) for roads, outcomes in halves
    )
    model = fit_model(known, known_failed.tolist())
    print(told("by the planned line alone", LINE_ONLY, rest, failed))
    print(told(f"after {len(known)} known outcomes", model, rest, failed))


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("labels")
    parser.add_argument("--every", type=int, default=1)
    main(**vars(parser.parse_args()))
