"""What a search can know of a road before it is driven: the surrogate beside plainer ways.

    python benchmarks/bench_surrogate.py           150 roads
    python benchmarks/bench_surrogate.py 500 -j 2 [--wet]  as in docs/explanation/search.md

Roads of "a flat road", drafts changed three times, are driven by beamng_like, or with --wet by assumes_dry
at a friction of 0.572. Some teach, the rest are the test: Spearman's rho of margins, AUC of failures, and the
share of failures among the 20 that look hardest; the mean over 8 ways to part them.
"""

import argparse
import sys
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path

import numpy as np
from scipy.stats import rankdata, spearmanr
from sklearn.linear_model import RidgeCV
from sklearn.preprocessing import StandardScaler

from roadgpt.road import Limits, Site, World
from roadgpt.run import Setup, brief_of, prove
from roadgpt_search.surrogate import Surrogate, hazard_of, target_of
from roadgpt_search.variation import VariationContext, VariationTask, candidate_of, sketch

WORLD = World(site=Site(map_size=200.0, z_floor=0.0), limits=Limits(oob_tolerance=0.85))
SPLITS = 8
HARDEST = 20
LEARNT = (20, 50, 100, 200)  # roads, of which one half at most
Predict = Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]


def driven(seed: int, wet: bool) -> tuple[np.ndarray, float, bool] | None:
    """Features of a road, its margin in metres, and whether the car failed."""
    brief = brief_of("| flat turns=1..", WORLD, Setup(reader="plan"))
    setting = VariationContext(brief, WORLD, "sbft")
    one = sketch(VariationTask("wild", (), "", (seed,), setting))
    road = candidate_of((one, setting)) if one else None
    if one is None or road is None:
        return None
    world = WORLD.changed(friction=0.572) if wet else WORLD
    driver = f"{Path(__file__).resolve().parent / 'assumes_dry.py'}:AssumesDry" if wet else "beamng_like"
    run = prove(road.design, 0, world, Setup(driver=driver))
    return (one.surrogate_features, run.verdict.margin, run.outcome == "FAIL") if run.verdict else None


def curvature(known: np.ndarray, targets: np.ndarray, fresh: np.ndarray) -> np.ndarray:
    return -hazard_of([*fresh])


def ridge(known: np.ndarray, targets: np.ndarray, fresh: np.ndarray) -> np.ndarray:
    scaler = StandardScaler().fit(np.c_[known, known**2])
    model = RidgeCV(np.logspace(-1, 3, 9)).fit(scaler.transform(np.c_[known, known**2]), targets)
    return np.asarray(model.predict(scaler.transform(np.c_[fresh, fresh**2])))


def trees(known: np.ndarray, targets: np.ndarray, fresh: np.ndarray) -> np.ndarray:
    return Surrogate([*known], targets[:, None].tolist()).opinions([*fresh])[..., 0].mean(axis=0)


WAYS: dict[str, Predict] = {
    "largest lane curvature over 13 m, nothing learnt": curvature,
    "ridge regression on the features and their squares": ridge,
    "trees (the surrogate)": trees,
}


def auc(score: np.ndarray, failed: np.ndarray) -> float:
    positive = failed.sum()
    if positive in (0, len(failed)):
        return float("nan")
    ranks = rankdata(score)[failed].sum()
    return float((ranks - positive * (positive + 1) / 2) / (positive * (len(failed) - positive)))


def main(roads: int, workers: int, wet: bool) -> None:
    with ProcessPoolExecutor(workers) as pool:
        found = [one for one in pool.map(partial(driven, wet=wet), range(roads), chunksize=5) if one]
    if len(found) < 2 * LEARNT[0]:
        sys.exit(f"{len(found)} of {roads} drafts became roads; the table needs {2 * LEARNT[0]}")
    signs = np.array([one[0] for one in found])
    margins = np.array([one[1] for one in found])
    failed = np.array([one[2] for one in found])
    targets = np.array([target_of(*one[1:]) for one in found])
    print(f"{len(found)} roads, {100 * failed.mean():.1f} % failed\n")
    print(f"| learnt from | way | rho of margins | AUC of failures | failures among the {HARDEST} | ms |")
    print("|---|---|---|---|---|---|")
    for n in LEARNT:
        if n > len(found) / 2:
            break
        for name, way in WAYS.items():
            rows = []
            for split in range(SPLITS):
                order = np.random.default_rng(split).permutation(len(found))
                a, b = order[:n], order[n:]
                begun = time.process_time()
                expected = way(signs[a], targets[a], signs[b])
                spent = 1000 * (time.process_time() - begun)
                hardest = np.argsort(expected, kind="stable")[:HARDEST]
                rho = spearmanr(expected, margins[b])[0]
                rows.append((rho, auc(-expected, failed[b]), failed[b][hardest].mean(), spent))
            rho, area, share, spent = np.nanmean(rows, axis=0)
            print(f"| {n} | {name} | {rho:.2f} | {area:.3f} | {100 * share:.0f} % | {spent:.0f} |")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("roads", type=int, nargs="?", default=150)
    parser.add_argument("-j", "--jobs", type=int, default=2)
    parser.add_argument("--wet", action="store_true")
    asked = parser.parse_args()
    main(asked.roads, asked.jobs, asked.wet)
