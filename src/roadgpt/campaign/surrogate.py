"""A surrogate model of the simulator: predicts how a drive on a road will end, and how uncertain that is.

It is a forest of extremely randomised trees (``extra_trees``) that learns from the results of the search so
far, at most from the last 1500 roads. The spread of the trees' predictions shows the uncertainty. On
RoadGPT's own drives it separated failures from passes after 50 tests (AUC 0.99); ridge regression on the same
features and their squares needed several hundred; see docs/explanation/search.md.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from roadgpt.campaign.extra_trees import grow
from roadgpt.geometry.curve import Array

TREES = 60
LEAF = 2  # roads in one leaf, at least
FEWEST = 10  # roads; with fewer, there is nothing to learn from
FAILED = (
    -0.3
)  # m, learnt for every failure: a drive ends where it fails, so its margin does not tell how badly it fails
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
        """Learns from the last ``MOST`` roads.

        Args:
            features: the features of each road, ``(n, features)``, see ``surrogate_features``.
            outcomes: the values to predict for each road, ``(n, k)``: the margin in metres, as returned by
                ``target_of``, and features of the drive.
            guesses: for the column of each outcome that is nearly proportional to a feature, the columns of
                the features to choose from. The trees learn only how the outcome deviates from the
                best-fitting feature, so that values beyond all known values can be predicted.
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
        """Returns the predictions of each tree for n roads and k outcomes, in the units of the outcomes; the
        array has the shape ``(TREES, n, k)``.
        """
        looks = np.asarray(features, float)
        found = np.asarray(self._forest.predict(looks) * self._scale + self._mean)
        for outcome, (feature, factor) in self._factors.items():
            found[..., outcome] += factor * looks[:, feature]
        return found


def target_of(margin: float, failed: bool) -> float:
    """Returns the margin, in metres, that the surrogate learns to predict for a drive.

    All failures get the same negative margin.
    """
    return FAILED if failed else margin


def _best_guess(looks: Array, columns: Sequence[int], values: Array) -> tuple[int, float]:
    """Returns the column to which the values are most nearly proportional, and the factor."""
    guesses = looks[:, list(columns)]
    factors = values @ guesses / np.maximum((guesses**2).sum(axis=0), LEAST_SQUARE)
    errors = ((values[:, None] - factors * guesses) ** 2).sum(axis=0)
    best = int(np.argmin(errors))
    return columns[best], float(factors[best])
