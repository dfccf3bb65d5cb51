"""Features of a road that predict, without a drive, how close a car will come to leaving its lane.

The best predictor of recorded outcomes is the curvature of the middle of the driven lane, averaged over some
metres; with lanes of 4 m it is k / (1 + 2k), where k is the curvature of the centre line. The first 25 m are
left out, since the car starts from rest, and the last 8 m, since the test ends 8 m before the end of the
road. The features include the largest averages of this curvature in left and in right bends over windows of
several lengths, how fast the curvature changes, the length of the straight before the tightest bend, slopes,
and crests.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from roadgpt.geometry.curve import Array
from roadgpt.road import Road, World

STARTING = 25.0  # m, in which the car is still slow
ENDING = 8.0  # m, that are not driven
WINDOWS = (3, 7, 13, 21, 35)  # samples, about 1 m apart, over which curvature is averaged
TIGHTEST = 0.2  # 1 + 2k is kept above this
STRAIGHT = 0.01  # 1/m: less is straight enough to gain speed
SHORTEST = 5  # m; a shorter stretch does not count as a straight
LONGEST = 120.0  # m; on a longer straight the car gains no more speed
AROUND = 10  # samples to either side of the tightest place, whose slopes and crests count

NAMES = (
    *(f"left_{window}" for window in WINDOWS),
    *(f"right_{window}" for window in WINDOWS),
    "mean",
    "root_mean_square",
    "change",
    "switches",
    "run_up",
    "grade_there",
    "crest_there",
    "crest",
    "fall",
    "length",
)


def surrogate_features_of(road: Road, world: World) -> NDArray[np.float64]:
    """Returns the features of a road, ``(len(NAMES),)``, each scaled to a magnitude of about 1."""
    samples = road.sample()
    kept = (samples.s >= STARTING) & (samples.s <= road.length - ENDING)
    if np.count_nonzero(kept) < 2:
        kept = np.ones(len(samples.s), bool)
    bend, grade = samples.curvature[kept], samples.grade[kept]
    middle = world.profile_of(road).middle(samples.s[kept])
    lane = bend / np.maximum(1 - middle * bend, TIGHTEST)
    means = [_mean(lane, window) for window in WINDOWS]
    crest = -np.gradient(_mean(grade, WINDOWS[1]))
    tight = int(np.abs(means[1]).argmax())
    there = slice(max(tight - AROUND, 0), tight + AROUND)
    size = np.abs(means[1])
    return np.array(
        [
            *(max(float(mean.max()), 0.0) / 0.06 for mean in means),
            *(max(float(-mean.min()), 0.0) / 0.06 for mean in means),
            float(size.mean()) / 0.03,
            float(np.sqrt((lane**2).mean())) / 0.03,
            float(np.abs(np.diff(lane)).max()) / 0.02,
            np.count_nonzero(np.diff(np.sign(np.round(means[1], 3)))) / 10,
            _run_up(size, tight) / 50,
            float(grade[tight]) / 0.1,
            float(crest[there].max()) / 0.005,
            float(crest.max()) / 0.005,
            float(-grade.min()) / 0.1,
            road.length / 200,
        ]
    )


def hazard_of(signs: Sequence[Array]) -> Array:
    """Estimates how hard each road is, without a drive: returns the largest curvature of its lane,
    averaged over about 13 m, as a multiple of 0.06 1/m. ``signs`` holds the features of each road.
    """
    table = np.asarray(signs)
    columns = [NAMES.index(f"{side}_{WINDOWS[2]}") for side in ("left", "right")]
    return np.asarray(table[:, columns].max(axis=1))


def _mean(values: Array, window: int) -> Array:
    """Returns the moving average over ``window`` values; the first and last values are repeated beyond the
    ends."""
    half = window // 2
    total = np.concatenate([[0.0], np.cumsum(np.pad(values, half, mode="edge"))])
    return np.asarray((total[window:] - total[:-window]) / window)


def _run_up(size: Array, tight: int) -> float:
    """Returns the length of the last straight before the tightest place, in samples of about 1 m: at most
    120, and 0 if there is no straight."""
    bends = np.flatnonzero(size[: tight + 1] >= STRAIGHT)
    gaps = np.diff(bends, prepend=-1) - 1
    straights = gaps[gaps >= SHORTEST]
    return float(min(straights[-1], LONGEST)) if len(straights) else 0.0
