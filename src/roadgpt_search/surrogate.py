"""Predicts without a drive how a drive on a road will end, and how uncertain that is.

A forest of extremely randomised trees (Geurts, Ernst and Wehenkel 2006) learns from features of the driven
roads; the spread of the trees' predictions shows the uncertainty. On RoadGPT's own drives it separated
failures from passes after 50 tests (AUC 0.99); ridge regression on the same features and their squares needed
several hundred; see docs/explanation/search.md. In a tree, one threshold per feature is drawn at each node
between the smallest and the largest value there, and the node splits where the squared errors are smallest;
all nodes of one depth, of all trees, are split together. The algorithm is that of scikit-learn's
``ExtraTreesRegressor``; the tests compare the two.

The best predictor of recorded outcomes is the curvature of the middle of the driven lane, averaged over some
metres. With lanes of 4 m, this curvature is k / (1 + 2k), where k is the curvature of the centre line. The
first 25 m are left out, since the car starts from rest, and the last 8 m, which are not driven.

A drive ends where the car leaves its lane, so the standard deviation of the steering angle (STD_SA) depends
on how far the car came. STD_SA is therefore estimated from the start to the end of the road and to several
places where the car may fail. A logistic regression on what a car has just met at stations 3 m apart, the
speed at which it would enter the bend, the bend, and how suddenly the curvature changed, learns from earlier
departures the chance that the car leaves its lane there. With ``lane_centring``, an estimate up to the true
place misses STD_SA by 4.5 degrees; the best one without knowledge of this place misses it by 13 degrees.
"""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roadgpt.geometry.curve import Array
from roadgpt.road import World
from roadgpt_search.behaviour import curvature_of_lane

STARTING = 25.0  # m, in which the car is still slow
ENDING = 8.0  # m, that are not driven
WINDOWS = (3, 7, 13, 21, 35)  # samples, about 1 m apart, over which curvature is averaged
STRAIGHT = 0.01  # 1/m: less is straight enough to gain speed
SHORTEST = 5  # m; a shorter stretch does not count as a straight
LONGEST = 120.0  # m; on a longer straight the car gains no more speed
AROUND = 10  # samples to either side of the tightest place, whose slopes and crests count
NEARLY = 0.9  # share of the largest curvature, at which a place may be the one where the car fails
LATERAL = 6.3  # m/s^2, rough limits of a car, from which its speed is estimated
SPEEDING_UP, GENTLY = 5.0, 2.0  # m/s^2, of a keen and of a gentle driver
ENTERING = 10  # samples before a place, where the speed at which a car enters a bend is taken
WHEELBASE = 2.83  # m

PLACES = ("left", "right", "first", "rush_left", "rush_right")  # where a car may leave its lane
NAMES = (
    *(f"{side}_{window}" for side in ("left", "right") for window in WINDOWS),
    "mean", "root_mean_square", "change", "switches", "run_up", "grade_there", "crest_there", "crest", "fall",
    "length", "steering", *(f"steering_to_{place}" for place in PLACES), "first", "rush_left", "rush_right",
)  # fmt: skip
STEERING = tuple(NAMES.index(name) for name in NAMES if name.startswith("steering"))
"""Indices of the features that estimate STD_SA up to different places. The place where the car leaves
its lane decides to which of these features STD_SA is nearly proportional.
"""


class RoadSamples(NamedTuple):
    """A road as n equally spaced samples, about 1 m apart; each array has the shape ``(n,)``."""

    s: Array  # stations in metres
    curvature: Array  # curvature of the centre line in 1/m
    grade: Array  # grade as a ratio
    middle: Array  # offset of the middle of the driven lane in metres, positive to the left


def features_of_samples(samples: RoadSamples, world: World) -> NDArray[np.float64]:
    """Returns the features of a road, each scaled to a magnitude of about 1; shape ``(len(NAMES),)``."""
    length = float(samples.s[-1])
    kept = (samples.s >= STARTING) & (samples.s <= length - ENDING)
    if np.count_nonzero(kept) < 2:
        kept = np.ones(len(samples.s), bool)
    all_of_lane = curvature_of_lane(samples.curvature, samples.middle)
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
    """Returns the square of the speed, m^2/s^2, of a car that starts from rest, accelerates up to the speed
    limit or what the curvature allows, and brakes in no time."""
    most = np.minimum(world.limits.speed_limit**2, LATERAL / np.maximum(np.abs(lane), 1e-6))
    most[0] = 0.0
    gained = 2 * acceleration * s
    return np.asarray(gained + np.minimum.accumulate(most - gained))


def hazard_of(signs: Sequence[Array]) -> Array:
    """Estimates how hard each of n roads is, ``(n,)``: the largest curvature of the lane, averaged over about
    13 m, as a multiple of 0.06 1/m."""
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


PURE = 1e-12  # variance, of targets of about unit variance, below which a node is not split any further
CONSTANT = 1e-7  # a feature that varies by less within a node splits nothing


class Forest(NamedTuple):
    """Regression trees, stored as arrays with one row per node; the root nodes come first."""

    feature: NDArray[np.intp]  # the feature ``(nodes,)`` at which each node splits; -1 for a leaf
    threshold: Array
    """The threshold ``(nodes,)`` of each node: samples up to this value of the feature go to the left
    child.
    """
    left: NDArray[np.intp]
    """The row ``(nodes,)`` of each node's left child; the right child is in the next row."""
    value: Array  # the mean target ``(nodes, k)`` of the samples in each node
    trees: int

    def predict(self, samples: Array) -> Array:
        """Returns the prediction of every tree, ``(trees, n, k)``, for samples ``(n, features)``."""
        at = np.tile(np.arange(self.trees)[:, None], len(samples))
        every = np.arange(len(samples))
        while (inner := self.feature[at] >= 0).any():
            goes_right = samples[every, self.feature[at]] > self.threshold[at]
            at = np.where(inner, self.left[at] + goes_right, at)
        return self.value[at]


def grow(samples: Array, targets: Array, trees: int, least: int, seed: int) -> Forest:
    """Returns a forest trained on finite features ``(n, features)`` and targets ``(n, k)``, preferably of
    unit variance; a leaf has at least ``least`` samples. The same arguments give the same forest."""
    rng = np.random.default_rng(seed)
    rows = np.tile(np.arange(len(samples)), trees)  # samples of the nodes at this depth, node after node
    starts = np.arange(trees) * len(samples)
    levels: list[Forest] = []
    made = 0
    while len(starts):
        ends = np.append(starts[1:], len(rows))
        split = _split(samples[rows], targets[rows], starts, ends - starts, least, rng)
        made += len(starts)
        is_inner = split.feature >= 0
        left = np.where(is_inner, made + 2 * (np.cumsum(is_inner) - 1), -1)
        levels.append(split._replace(left=left, trees=trees))
        node = np.repeat(np.arange(len(starts)), ends - starts)
        stays = is_inner[node]
        rows, node = rows[stays], node[stays]
        goes_right = samples[rows, split.feature[node]] > split.threshold[node]
        child = left[node] + goes_right - made
        order = np.argsort(child, kind="stable")
        rows = rows[order]
        starts = np.searchsorted(child[order], np.arange(2 * int(is_inner.sum())))
    return Forest(
        np.concatenate([level.feature for level in levels]),
        np.concatenate([level.threshold for level in levels]),
        np.concatenate([level.left for level in levels]),
        np.concatenate([level.value for level in levels]),
        trees,
    )


def _split(
    samples: Array, targets: Array, starts: NDArray[np.intp], sizes: NDArray[np.intp], least: int,
    rng: np.random.Generator,
) -> Forest:  # fmt: skip
    """Returns the nodes of one depth with their splits; the rows of ``samples`` are grouped by node."""
    node = np.repeat(np.arange(len(starts)), sizes)
    sums = np.add.reduceat(targets, starts)
    value = sums / sizes[:, None]
    spread = np.add.reduceat((targets - value[node]) ** 2, starts).sum(axis=1) / sizes
    low, high = np.minimum.reduceat(samples, starts), np.maximum.reduceat(samples, starts)
    drawn = low + rng.random(low.shape) * (high - low)
    threshold = np.where(drawn < high, drawn, low)
    is_left = samples <= threshold[node]
    left = np.add.reduceat(is_left, starts, dtype=np.intp)
    right = sizes[:, None] - left
    gain = np.zeros(low.shape)
    for target, whole in zip(targets.T, sums.T, strict=True):
        part = np.add.reduceat(is_left * target[:, None], starts)
        gain += part**2 / np.maximum(left, 1) + (whole[:, None] - part) ** 2 / np.maximum(right, 1)
    is_open = (sizes >= 2 * least) & (spread > PURE)
    may = (high - low > CONSTANT) & (np.minimum(left, right) >= least) & is_open[:, None]
    best = np.where(may, gain, -np.inf).argmax(axis=1)
    at = np.arange(len(starts)), best
    feature = np.where(may[at], best, -1)
    return Forest(feature, threshold[at], feature, value, 0)


TREES = 60
LEAF = 2  # roads in one leaf, at least
FEWEST = 10  # roads; with fewer, there is nothing to learn from
FAILED = -0.3  # m, learnt for every failure: a drive ends where it fails, whatever its margin would become
MOST = 1500  # roads to learn from, the latest ones
LEAST_SQUARE = 1e-9  # of a guess, so that nothing is divided by 0


class Surrogate:
    """Predicts the outcomes of drives on roads that have not been driven yet."""

    def __init__(
        self,
        features: Sequence[Array],
        outcomes: Sequence[Sequence[float]],
        guesses: Mapping[int, Sequence[int]] | None = None,
    ) -> None:
        """Learns from the last ``MOST`` roads: their features, see ``features_of_samples``, and for each the
        values to predict, first the margin of ``target_of``.

        ``guesses`` has, for an outcome that is nearly proportional to a feature, the columns of features to
        choose from. The trees learn only how it deviates from the best of them, so that values beyond all
        known ones can be predicted.
        """
        known, looks = np.asarray(outcomes[-MOST:], float), np.asarray(features[-MOST:], float)
        self._factors: dict[int, tuple[int, float]] = {}
        for outcome, columns in (guesses or {}).items():
            feature, factor = _best_guess(looks, columns, known[:, outcome])
            self._factors[outcome] = (feature, factor)
            known[:, outcome] -= factor * looks[:, feature]
        self._mean, scale = known.mean(axis=0), known.std(axis=0)
        self._scale = np.where(scale > 0, scale, 1.0)
        targets = (known - self._mean) / self._scale
        self._forest = grow(looks, targets, TREES, LEAF, seed=0)

    def opinions(self, features: Sequence[Array]) -> Array:
        """Returns the predictions of each tree for n roads and k outcomes, in the outcomes' units: ``(TREES,
        n, k)``."""
        looks = np.asarray(features, float)
        found = np.asarray(self._forest.predict(looks) * self._scale + self._mean)
        for outcome, (feature, factor) in self._factors.items():
            found[..., outcome] += factor * looks[:, feature]
        return found


def target_of(margin: float, failed: bool) -> float:
    """Returns the margin, in metres, that the surrogate learns: the same negative one for all failures."""
    return FAILED if failed else margin


def _best_guess(looks: Array, columns: Sequence[int], values: Array) -> tuple[int, float]:
    guesses = looks[:, list(columns)]
    factors = values @ guesses / np.maximum((guesses**2).sum(axis=0), LEAST_SQUARE)
    errors = ((values[:, None] - factors * guesses) ** 2).sum(axis=0)
    best = int(np.argmin(errors))
    return columns[best], float(factors[best])


FIRST, SPACING = 20.0, 3.0  # m: the first station, and from one to the next
LAGS = (0, 8, 16)  # samples, about 1 m apart, by which a sign lies before the station
SUDDEN = 8  # samples, over which a change of curvature counts
LARGEST = 2.0  # of each sign; beyond it, nothing more is learnt
SCALES = (0.1, 15.0, 0.01)  # of m/s^2, of 1/m, and of m^0.5/s^3, so that signs are about 1
RIDGE = 5.0  # weight of the squared coefficients
STEPS = 12  # of Newton's method, at most
ENOUGH = 1e-4  # of the misfit; a step that gains less is the last
HALVINGS = 12  # of a step that goes too far
BLOCK = 200  # rows that are multiplied at once: so few that no threads are started, which cost more
MOST_DRIVEN = 300  # roads to learn from, the latest ones
FEWEST_FAILURES = 5  # failures; with fewer, nothing is learnt
USUAL = -3.0  # logit of the chance to leave the lane at a station, to begin with
RARELY = 30.0  # largest logit


class RoadStations(NamedTuple):
    """A road at m stations."""

    s: Array  # stations in metres, ``(m,)``
    signs: Array  # what a car has just met at each station, ``(m, signs)``; the last column is 1
    steering: Array
    """Standard deviation of the wheels' angle from the start to each station, radians, ``(m,)``."""


def stations_of(samples: RoadSamples, world: World) -> RoadStations:
    """Returns the stations of a road; there is at least one."""
    s, lane = samples.s, curvature_of_lane(samples.curvature, samples.middle)
    square = squared_speed(s, lane, world, GENTLY)
    entering = before(square, ENTERING)
    bend = moving_mean(lane, 5)
    rush = entering * moving_mean(lane, 7)
    sudden = (bend - before(bend, SUDDEN)) * entering**1.5
    signs = []
    for values, scale, lags in zip((rush, bend, sudden), SCALES, (LAGS, LAGS[:2], LAGS), strict=True):
        signs += [before(scale * values, lag) for lag in lags]
    places = np.arange(FIRST, max(s[-1] - ENDING, FIRST + 1), SPACING)
    at = np.minimum(np.searchsorted(s, places), len(s) - 1)
    both = np.array(signs).T[at]
    sides = np.clip(np.concatenate([both, -both], axis=1), 0.0, LARGEST)
    speed = np.sqrt(square[at])[:, None] / 20
    columns = [sides, sides**2, speed, np.ones((len(at), 1))]
    return RoadStations(s[at], np.concatenate(columns, axis=1), steering_so_far(s, lane, world)[at])


class DepartureModel:
    """Knows where a car left its lane on driven roads."""

    def __init__(self, roads: Sequence[RoadStations], failed_at: Sequence[float | None]) -> None:
        """Learns from the last 300 driven roads; ``failed_at`` is the station in metres where the car left
        its lane on each of them, or None."""
        rows, leaves = [], []
        for road, end in zip(roads[-MOST_DRIVEN:], failed_at[-MOST_DRIVEN:], strict=True):
            reached = road.s < end if end is not None else np.ones(len(road.s), bool)
            reached[0] = True
            rows.append(road.signs[reached])
            leaves.append(np.zeros(len(rows[-1])))
            leaves[-1][-1] = end is not None
        self._weights = logistic(np.concatenate(rows), np.concatenate(leaves))

    def predict(self, roads: Sequence[RoadStations]) -> Array:
        """Returns three features of n roads, ``(n, 3)``, each scaled to a magnitude of about 1: the standard
        deviation of the wheels' angle up to the departure (0.1 radians count as 1), as a mean over all
        stations weighted by the chance of a departure there, and up to the likeliest departure; and the
        chance that the car leaves its lane."""
        counts = np.array([len(road.s) for road in roads])
        starts = np.cumsum(counts) - counts
        logit = np.concatenate([road.signs @ self._weights for road in roads])
        stays = -np.logaddexp(0.0, np.clip(logit, -RARELY, RARELY))  # logarithm of the chance to stay
        here = np.exp(stays) * np.exp(np.clip(logit, -RARELY, RARELY))
        so_far = np.cumsum(stays) - stays
        so_far -= np.repeat(so_far[starts], counts)
        share = here * np.exp(so_far)
        steering = np.concatenate([road.steering for road in roads])
        chance = np.add.reduceat(share, starts)
        mean = np.add.reduceat(share * steering, starts) / np.maximum(chance, 1e-12)
        ends = starts + counts
        tops = [a + int(share[a:b].argmax()) for a, b in zip(starts, ends, strict=True)]
        return np.stack([mean / 0.1, steering[tops] / 0.1, chance], axis=1)


def logistic(rows: Array, leaves: Array) -> Array:
    """Fits ``leaves`` ``(n,)``, 1 where the car left its lane, by a logistic regression on ``rows`` ``(n,
    signs)``, whose last column is 1, and returns the coefficients. The penalty is RIDGE / 2 times the sum of
    the other coefficients' squares, for columns with a standard deviation of 1."""
    scale = rows.std(axis=0)
    scale[scale < 1e-9] = 1.0
    table = rows / scale
    ridge = np.full(table.shape[1], RIDGE)
    ridge[-1] = 0.0
    weights = np.zeros(table.shape[1])
    weights[-1] = USUAL
    blocks = [slice(first, first + BLOCK) for first in range(0, len(table), BLOCK)]
    worst = _misfit(_logits(table, weights, blocks), leaves, weights, ridge)
    for _ in range(STEPS):
        chance = 1 / (1 + np.exp(-np.clip(_logits(table, weights, blocks), -RARELY, RARELY)))
        missed, bent = chance - leaves, chance * (1 - chance) + 1e-9
        slope, curved = ridge * weights, np.diag(ridge)
        for one in blocks:
            slope = slope + table[one].T @ missed[one]
            curved = curved + table[one].T @ (table[one] * bent[one, None])
        step = np.linalg.solve(curved, slope)
        for _ in range(HALVINGS):
            misfit = _misfit(_logits(table, weights - step, blocks), leaves, weights - step, ridge)
            if misfit < worst:
                break
            step = step / 2
        if worst - misfit < ENOUGH:
            break
        weights, worst = weights - step, misfit
    return np.asarray(weights / scale)


def _logits(table: Array, weights: Array, blocks: Sequence[slice]) -> Array:
    return np.concatenate([table[one] @ weights for one in blocks])


def _misfit(logits: Array, leaves: Array, weights: Array, ridge: Array) -> float:
    """Returns what the regression makes small: the surprise at what happened, and the penalty."""
    return float((np.logaddexp(0.0, logits) - leaves * logits).sum() + (ridge * weights**2).sum() / 2)
