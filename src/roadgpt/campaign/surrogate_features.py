"""Features of a road that predict, without a drive, how close a car will come to leaving its lane.

The best predictor of recorded outcomes is the curvature of the middle of the driven lane, averaged over some
metres. With lanes of 4 m, this curvature is k / (1 + 2k), where k is the curvature of the centre line. The
first 25 m are left out, since the car starts from rest. The last 8 m are left out, since they are not driven.
The features include the largest averages of this curvature in left and in right bends over windows of
several lengths, how fast the curvature changes, the length of the straight before the tightest bend, slopes,
and crests.

A drive ends where the car leaves its lane, so the standard deviation of the steering angle (STD_SA) depends
on how far the car came. STD_SA is therefore estimated from the start to the end of the road, and from the
start to each of several places where the car may fail.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roadgpt.geometry.curve import Array
from roadgpt.road import World

STARTING = 25.0  # m, in which the car is still slow
ENDING = 8.0  # m, that are not driven
WINDOWS = (3, 7, 13, 21, 35)  # samples, about 1 m apart, over which curvature is averaged
TIGHTEST = 0.2  # 1 + 2k is kept above this
STRAIGHT = 0.01  # 1/m: less is straight enough to gain speed
SHORTEST = 5  # m; a shorter stretch does not count as a straight
LONGEST = 120.0  # m; on a longer straight the car gains no more speed
AROUND = 10  # samples to either side of the tightest place, whose slopes and crests count
NEARLY = 0.9  # share of the largest curvature, at which a place may be the one where the car fails
LATERAL = 6.3  # m/s^2, rough limits of a car, from which its speed is estimated
SPEEDING_UP, GENTLY = 5.0, 2.0  # m/s^2, of a keen and of a gentle driver
ENTERING = 10  # samples before a place, where the speed at which a car enters a bend is taken
WHEELBASE = 2.83  # m

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
    "steering",
    "steering_to_left",
    "steering_to_right",
    "steering_to_first",
    "steering_to_rush_left",
    "steering_to_rush_right",
    "first",
    "rush_left",
    "rush_right",
)
STEERING = tuple(NAMES.index(name) for name in NAMES if name.startswith("steering"))
"""Indices of the features that estimate STD_SA up to different places. The place where the car leaves
its lane decides to which of these features STD_SA is nearly proportional.
"""


class RoadSamples(NamedTuple):
    """A road as n equally spaced samples, about 1 m apart; each array has the shape ``(n,)``."""

    s: Array
    """Stations in metres."""
    curvature: Array
    """Curvature of the centre line in 1/m."""
    grade: Array
    """Grade as a ratio."""
    middle: Array
    """Offset of the middle of the driven lane in metres, positive to the left."""


def features_of_samples(samples: RoadSamples, world: World) -> NDArray[np.float64]:
    """Returns the features of a road, each scaled to a magnitude of about 1; shape ``(len(NAMES),)``."""
    length = float(samples.s[-1])
    kept = (samples.s >= STARTING) & (samples.s <= length - ENDING)
    if np.count_nonzero(kept) < 2:
        kept = np.ones(len(samples.s), bool)
    all_of_lane = lane_curvature(samples)
    lane, grade = all_of_lane[kept], samples.grade[kept]
    means = [moving_mean(lane, window) for window in WINDOWS]
    crest = -np.gradient(moving_mean(grade, WINDOWS[1]))
    tight = int(np.abs(means[1]).argmax())
    there = slice(max(tight - AROUND, 0), tight + AROUND)
    size = np.abs(means[1])
    steering = steering_so_far(samples.s, all_of_lane, world)
    # the lateral acceleration of a car that accelerates gently and does not brake before a bend
    entering = before(squared_speed(samples.s, all_of_lane, world, GENTLY), ENTERING)
    rush = (entering * moving_mean(all_of_lane, WINDOWS[1]))[kept]
    # a car may leave its lane at the tightest places to the left and to the right, at the first that is
    # nearly as tight as the tightest, and at the greatest rushes
    bends = np.abs(means[2])
    first = (bends >= NEARLY * bends.max()).argmax()
    likely = (means[2].argmax(), means[2].argmin(), first, rush.argmax(), rush.argmin())
    places = [int(np.flatnonzero(kept)[i]) for i in likely]
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
            length / 200,
            *(float(steering[place]) / 0.1 for place in (-1, *places)),
            float(samples.s[places[2]]) / 200,
            max(float(rush.max()), 0.0) / 10,
            max(float(-rush.min()), 0.0) / 10,
        ]
    )


def lane_curvature(samples: RoadSamples) -> Array:
    """Returns the curvature in 1/m of the middle of the driven lane at each sample."""
    return samples.curvature / np.maximum(1 - samples.middle * samples.curvature, TIGHTEST)


def steering_so_far(s: Array, lane: Array, world: World) -> Array:
    """Returns the standard deviation over time of the wheels' angle from the start to each sample,
    radians."""
    speed = np.sqrt(np.maximum(squared_speed(s, lane, world, SPEEDING_UP), 1.0))
    angle = np.arctan(WHEELBASE * lane)
    time = np.cumsum(1 / speed)
    mean, square = np.cumsum(angle / speed) / time, np.cumsum(angle**2 / speed) / time
    return np.sqrt(np.maximum(square - mean**2, 0.0))


def before(values: Array, lag: int) -> Array:
    """Returns for each sample the value ``lag`` samples earlier; near the start, the first value."""
    return np.asarray(values[np.maximum(np.arange(len(values)) - lag, 0)])


def squared_speed(s: Array, lane: Array, world: World, acceleration: float) -> Array:
    """Returns the square of a car's speed at each sample, m^2/s^2. The car starts from rest and brakes
    in no time. It accelerates up to the speed limit or to the speed that the curvature allows.
    """
    most = np.minimum(world.limits.speed_limit**2, LATERAL / np.maximum(np.abs(lane), 1e-6))
    most[0] = 0.0
    gained = 2 * acceleration * s
    return np.asarray(gained + np.minimum.accumulate(most - gained))


def hazard_of(signs: Sequence[Array]) -> Array:
    """Estimates without a drive how hard each of n roads is from its features; returns shape ``(n,)``.

    The estimate is the largest curvature of the lane, averaged over about 13 m, as a multiple of 0.06 1/m.
    """
    table = np.asarray(signs)
    columns = [NAMES.index(f"{side}_{WINDOWS[2]}") for side in ("left", "right")]
    return np.asarray(table[:, columns].max(axis=1))


def moving_mean(values: Array, window: int) -> Array:
    """Returns the moving average over ``window`` values, with the first and the last repeated at the ends."""
    half = window // 2
    ends = np.full(half, values[0]), np.full(half, values[-1])
    total = np.concatenate([[0.0], np.cumsum(np.concatenate([ends[0], values, ends[1]]))])
    return np.asarray((total[window:] - total[:-window]) / window)


def _run_up(size: Array, tight: int) -> float:
    """Returns the length of the last straight before the tightest place, in samples of about 1 m: at most
    120, and 0 if there is no straight."""
    bends = np.flatnonzero(size[: tight + 1] >= STRAIGHT)
    gaps = np.diff(bends, prepend=-1) - 1
    straights = gaps[gaps >= SHORTEST]
    return float(min(straights[-1], LONGEST)) if len(straights) else 0.0
