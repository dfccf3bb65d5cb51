"""Extremely randomised trees for regression (Geurts, Ernst and Wehenkel 2006), implemented with numpy only.

Every tree learns from all samples. At each node, one threshold per feature is chosen at random, uniformly
between the smallest and the largest value in the node's samples; the node splits at the threshold that gives
the smallest sum of squared errors. All nodes of one depth, of all trees, are split together. The algorithm is
that of scikit-learn's ``ExtraTreesRegressor``; the tests compare the two.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roadgpt.geometry.curve import Array

PURE = 1e-12  # variance, of targets of about unit variance, below which a node is not split any further
CONSTANT = 1e-7  # a feature that varies by less within a node splits nothing


class Forest(NamedTuple):
    """Regression trees, stored as arrays with one row per node; the root nodes come first."""

    feature: NDArray[np.intp]
    """The feature ``(nodes,)`` at which each node splits; -1 for a leaf."""
    threshold: Array
    """The threshold ``(nodes,)`` of each node: samples up to this value of the feature go to the left
    child.
    """
    left: NDArray[np.intp]
    """The row ``(nodes,)`` of each node's left child; the right child is in the next row."""
    value: Array
    """The mean target ``(nodes, k)`` of the samples in each node."""
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
    """Returns a forest trained on samples and targets; the same arguments give the same forest.

    Args:
        samples: features ``(n, features)`` of the training samples, finite.
        targets: values ``(n, k)`` to predict for each sample, preferably scaled to unit variance.
        trees: number of trees.
        least: smallest number of samples in a leaf.
        seed: seed of the random thresholds.
    """
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
