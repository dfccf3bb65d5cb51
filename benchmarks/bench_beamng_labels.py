"""Is the simulator a fair judge? How well predictors tell which recorded roads BeamNG's AI failed.

    python benchmarks/bench_beamng_labels.py --labels LABELS.csv.gz [--every 20] [--keep DRIVES.npz]

See beamng_labels.py for the file; without one there is nothing to do. What learns, learns from the first half
of the runs; every figure is of the other half, with 95 % of 1,000 bootstrap samples of its roads. --keep: the
drives are read from there if the file exists, else written there.
"""

import argparse
import os
import sys
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.stats import rankdata, spearmanr
from sklearn.ensemble import GradientBoostingClassifier, GradientBoostingRegressor

from beamng_labels import TOLERANCE, BeamngLabels, auc, halves, road_of
from roadgpt.drive import simulate
from roadgpt.drive.drivers.beamng_like import BeamngLike
from roadgpt.drive.driving_line import stations
from roadgpt.road import Limits, Site, World

WORLD = World(site=Site(map_size=1000), limits=Limits(oob_tolerance=TOLERANCE))
PERIOD = 1.33  # s between two looks of the competition's oracle, as measured
CONTROL = 0.02  # s
PHASES = 8  # of its first look, over one period
FIRST, LAST = 25.0, 8.0  # m of a road in which a car is still launched, or is already at the goal
WINDOW = 5.0  # m, half-width of the mean of the lane's curvature
SAMPLES = 1000


class Seen(NamedTuple):
    """What a road and our drive on it come to."""

    lane: np.ndarray
    """Most curvature of the right lane's middle, 1/m, to the left and to the right."""
    drive: np.ndarray
    """Largest share outside: of every control step, then of each phase of the coarse oracle."""


def seen(curvatures: list[float]) -> Seen:
    road = road_of(curvatures)
    s = stations(road)
    k = road.curvature(s)
    lane = k / np.maximum(1 + WORLD.section.lane_width / 2 * k, 0.2)
    half = round(WINDOW / s[1])
    mean = np.convolve(np.pad(lane, half, mode="edge"), np.ones(2 * half + 1) / (2 * half + 1), "valid")
    mean = mean[(s > FIRST) & (s < road.length - LAST)]
    drive = simulate(road, WORLD, BeamngLike(), keep_driving=True)
    share = np.asarray(drive["outside"][: drive.lane_steps])
    looks = round(PERIOD / CONTROL)
    phases = [share[round(looks * i / PHASES) :: looks].max(initial=0.0) for i in range(PHASES)]
    return Seen(np.array([mean.max(), -mean.min()]), np.array([share.max(), *phases]))


def seen_all(labels: BeamngLabels, jobs: int) -> Seen:
    with ProcessPoolExecutor(jobs) as pool:
        found = list(pool.map(seen, labels.curvature.tolist(), chunksize=20))
    return Seen(np.array([one.lane for one in found]), np.array([one.drive for one in found]))


def features(labels: BeamngLabels, roads: Seen) -> np.ndarray:
    """Curvatures as they are, sorted, and what is known to tell most."""
    k = labels.curvature
    three = np.abs(k[:, :-2] + k[:, 1:-1] + k[:, 2:])
    turns = np.abs(np.diff(k, axis=1))
    most = np.sort(three, axis=1)[:, -4:]
    return np.column_stack([k, np.sort(k, axis=1), most, turns.max(1), turns.sum(1), roads.lane])


def learnt(known: np.ndarray, rest: np.ndarray, labels: BeamngLabels) -> tuple[np.ndarray, np.ndarray]:
    """Scores by boosting: of a classifier of failures, of a regressor of the rank of the share outside."""
    how = {"n_estimators": 200, "learning_rate": 0.04, "max_depth": 3, "subsample": 0.5, "random_state": 0}
    classifier = GradientBoostingClassifier(**how).fit(known, labels.failed)
    regressor = GradientBoostingRegressor(**how).fit(known, rankdata(labels.max_oob))
    return classifier.predict_proba(rest)[:, 1], regressor.predict(rest)


Measure = Callable[[np.ndarray, BeamngLabels], float]


def measured(measure: Measure, score: np.ndarray, labels: BeamngLabels) -> str:
    rng = np.random.default_rng(0)
    count = len(score)
    some = []
    for _ in range(SAMPLES):
        chosen = rng.integers(0, count, count)
        some.append(measure(score[chosen], BeamngLabels(*(column[chosen] for column in labels))))
    low, high = np.percentile(some, [2.5, 97.5])
    return f"{measure(score, labels):.3f} ({low:.3f} to {high:.3f})"


def of_failures(score: np.ndarray, labels: BeamngLabels) -> float:
    return auc(score, labels.failed)


def of_ranks(score: np.ndarray, labels: BeamngLabels) -> float:
    return float(spearmanr(score, labels.max_oob)[0])


def row(name: str, score: np.ndarray, labels: BeamngLabels, is_share: bool = False) -> str:
    first = np.argsort(-score, kind="stable")[:100]
    cells = [
        name,
        measured(of_failures, score, labels),
        measured(of_ranks, score, labels),
        f"{labels.failed[first].mean():.2f}",
        f"{100 * (score > TOLERANCE).mean():.1f} %" if is_share else "",
    ]
    return f"| {' | '.join(cells)} |"


def table(known: BeamngLabels, known_seen: Seen, rest: BeamngLabels, rest_seen: Seen) -> None:
    """Prints the predictors of the test half."""
    k, ours = rest.curvature, rest_seen.drive
    plain = [features(known, known_seen), features(rest, rest_seen)]
    both = [np.column_stack([f, s.drive]) for f, s in zip(plain, (known_seen, rest_seen), strict=True)]
    print("| predictor | AUC of failures | Spearman, share outside | failed of the first 100 | fails |")
    print("|---|---|---|---|---|")
    lines: Sequence[tuple[str, np.ndarray, bool]] = (
        ("largest curvature", np.abs(k).max(1), False),
        ("sum of curvatures", np.abs(k).sum(1), False),
        ("largest sum of three", np.abs(k[:, :-2] + k[:, 1:-1] + k[:, 2:]).max(1), False),
        ("largest curvature of the right lane, ends left out", rest_seen.lane.max(1), False),
        *zip(("boosting, failures", "boosting, ranks"), learnt(*plain, known), (False, False), strict=True),
        ("**`beamng_like`, every 20 ms**", ours[:, 0], True),
        ("`beamng_like`, every 1.33 s, one phase", ours[:, 1], True),
        ("**`beamng_like`, every 1.33 s, mean of 8 phases**", ours[:, 1:].mean(1), True),
        *zip(
            ("boosting with our drive, failures", "boosting with our drive, ranks"),
            learnt(*both, known),
            (False, False),
            strict=True,
        ),
    )
    for name, score, is_share in lines:
        print(row(name, score, rest, is_share), flush=True)


def verdicts(name: str, labels: BeamngLabels, roads: Seen) -> str:
    ours = roads.drive[:, 0] > TOLERANCE
    return (
        f"{name}: {len(ours)} roads; ours fails {100 * ours.mean():.1f} %, BeamNG's "
        f"{100 * labels.failed.mean():.1f} %; of those that ours fails, BeamNG's failed "
        f"{100 * labels.failed[ours].mean():.0f} %; of those that BeamNG's failed, ours fails "
        f"{100 * ours[labels.failed].mean():.0f} %"
    )


def ceiling(roads: Seen) -> str:
    """How well one phase of the coarse oracle foretells another of the very same drives."""
    one, other = roads.drive[:, 1], roads.drive[:, 1 + PHASES // 2]
    failed = other > np.quantile(other, 0.932)  # the 6.8 % that failed in the recordings
    found = f"AUC {auc(one, failed):.2f}, Spearman {spearmanr(one, other)[0]:.2f}"
    return f"one phase by another of the same drives: {found}"


def main(labels: str, every: int, jobs: int, keep: Path | None) -> None:
    if not Path(labels).is_file():
        print("no labels here: give them with --labels LABELS.csv.gz", file=sys.stderr)
        return
    known, rest = (half.every(every) for half in halves(labels))
    if keep and keep.is_file():
        kept = np.load(keep)
        known_seen, rest_seen = (
            Seen(kept[f"{half}_lane"], kept[f"{half}_drive"]) for half in ("known", "rest")
        )
    else:
        known_seen, rest_seen = seen_all(known, jobs), seen_all(rest, jobs)
    if keep and not keep.is_file():
        by_name = zip(("known", "rest"), (known_seen, rest_seen), strict=True)
        np.savez(keep, **{f"{half}_{name}": v for half, s in by_name for name, v in s._asdict().items()})
    print(f"{verdicts('fitted to', known, known_seen)}\n{verdicts('test', rest, rest_seen)}\n")
    table(known, known_seen, rest, rest_seen)
    print(f"\n{ceiling(rest_seen)}")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--labels", default="beamng_labels.csv.gz")
    parser.add_argument("--every", type=int, default=1, help="of so many roads, one")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--keep", type=Path, default=None)
    main(**vars(parser.parse_args()))
